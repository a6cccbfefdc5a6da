//! What must hold of every schematic: every element and every cord is drawn, nothing runs into anything else.

#![allow(dead_code, reason = "every test binary takes what it needs")]

mod boxes;
pub mod marks;
mod ways;

use std::collections::BTreeSet;

use patchcord_core::circuit::Circuit;
use patchcord_draw::plot::{Area, Label, Stroke};
use patchcord_draw::schematic::{Diagram, Net, PlacedSymbol, Point, Schematic, Source, Standing, Value};

const STANDING: Standing = Standing { volts: -12.34, position: None };

/// The schematic of a circuit, with a voltage at every output.
pub fn schematic(circuit: &Circuit) -> Schematic {
    Schematic::new(circuit, "", "", &|_| Some(STANDING)).unwrap_or_else(|error| panic!("{error}"))
}

/// The same with macros opened in their places.
pub fn opened(circuit: &Circuit) -> Schematic {
    Schematic::opened(circuit, "", "", &|_| Some(STANDING)).unwrap_or_else(|error| panic!("{error}"))
}

/// Draws a circuit and looks at everything that must hold; `what` is the name that failures give it.
pub fn check(circuit: &Circuit, what: &str) {
    let drawn = schematic(circuit);
    for drawn in [&drawn, &opened(circuit)] {
        diagrams(drawn).for_each(|diagram| check_diagram(diagram, what));
        no_texts_overlap(drawn, what);
        marks::nothing_runs_through_texts(drawn, what);
    }
    every_element_once(&opened(circuit).main, circuit, what);
    every_given_setting_is_told(&opened(circuit), circuit, what);
    boxes::check(&drawn, circuit, what);
    if circuit.patch().instances.is_empty() {
        assert_eq!(drawn, opened(circuit), "{what}");
    }
}

/// The circuit and the macros in it.
pub fn diagrams(drawn: &Schematic) -> impl Iterator<Item = &Diagram> {
    std::iter::once(&drawn.main).chain(drawn.macros.iter().map(|opened| &opened.diagram))
}

/// Every setting that the patch gives stands at the symbol or in the lists of the sheet.
fn every_given_setting_is_told(drawn: &Schematic, circuit: &Circuit, what: &str) {
    let drawing = drawn.drawing();
    for element in circuit.elements() {
        let Some(placed) = drawn.main.symbols.iter().find(|placed| placed.symbol.name == element.name) else {
            continue;
        };
        let rows = element.kind.settings.iter().zip(&element.settings);
        for (row, _) in rows.filter(|(_, given)| given.is_some()) {
            let setting = placed
                .symbol
                .setting(row.name)
                .unwrap_or_else(|| panic!("{what}: {} of {}", row.name, element.name));
            let told = told(&setting.shown, &setting.value);
            let at_symbol = placed.labels().any(|label| has(&label.text, &told));
            let listed = drawn.lists.iter().flat_map(|list| &list.rows).any(|listed| {
                let names = [element.name.clone(), format!("{} {}", element.name, row.name)];
                names.contains(&listed.name) && (has(&listed.value, &told) || has(&listed.text, &told))
            });
            assert!(at_symbol || listed, "{what}: {} of {} is {told} nowhere", row.name, element.name);
            let on_sheet = drawing.marks.iter().any(|mark| match mark {
                Stroke::Text(label) => label.text.contains('…') || has(&label.text, &told),
                _ => false,
            });
            assert!(on_sheet, "{what}: {told}");
        }
    }
}

/// What a reader looks for: the number without its unit, a word, the first point.
fn told(shown: &str, value: &Value) -> String {
    match value {
        Value::Flag(true) => "closed".to_owned(),
        Value::Flag(false) => "open".to_owned(),
        Value::Word("product") => "b/100".to_owned(),
        Value::Word("sum-of-squares") => "b²)/100".to_owned(),
        Value::Word(word) => (*word).to_owned(),
        Value::Number(_) | Value::Points(_) => shown.split(' ').next().unwrap_or_default().to_owned(),
    }
}

fn has(text: &str, word: &str) -> bool {
    text.split([' ', ',']).any(|other| other == word || other == word.trim_end_matches(','))
}

fn check_diagram(drawn: &Diagram, what: &str) {
    no_symbol_stands_on_another(drawn, what);
    every_cord_leads_from_output_to_jack(drawn, what);
    no_cords_share_a_line(drawn, what);
    no_cord_runs_through_a_symbol_or_a_text(drawn, what);
    marks::check(drawn, what);
    ways::check(drawn, what);
}

fn every_element_once(drawn: &Diagram, circuit: &Circuit, what: &str) {
    let names: Vec<&str> = drawn.symbols.iter().map(|placed| placed.symbol.name.as_str()).collect();
    let patch = circuit.patch();
    let wanted: Vec<&str> = patch.drives.keys().chain(patch.elements.keys()).map(String::as_str).collect();
    assert_eq!(names, wanted, "{what}");
    let jacks = drawn.symbols.iter().map(|placed| placed.symbol.jacks.len()).sum::<usize>();
    let cords: usize = (0..circuit.elements().len()).map(|element| circuit.cords(element).len()).sum();
    assert_eq!(jacks, cords, "{what}");
}

fn no_symbol_stands_on_another(drawn: &Diagram, what: &str) {
    for (one, placed) in drawn.symbols.iter().enumerate() {
        let apart = |other: &PlacedSymbol| !overlap(&placed.area, &other.area);
        assert!(
            drawn.symbols[one + 1..].iter().all(apart),
            "{what}: {} stands on another",
            placed.symbol.name
        );
        assert!(placed.symbol.jacks.len() <= placed.inputs.len(), "{what}: {}", placed.symbol.name);
    }
}

/// Every cord is in a net, whose lines hang together and end at the right places.
fn every_cord_leads_from_output_to_jack(drawn: &Diagram, what: &str) {
    let mut driven = BTreeSet::new();
    for net in &drawn.nets {
        let from = &drawn.symbols[net.from];
        let name = &from.symbol.name;
        assert!(starts_to_the_right(net, from.outputs[net.outlet]), "{what}: {name} leaves to the left");
        for (reader, jack) in &net.to {
            let reader_symbol = &drawn.symbols[*reader];
            let wanted = Source::Output(net.from, net.outlet);
            assert_eq!(reader_symbol.symbol.jacks[*jack].from, wanted, "{what}: {name}");
            assert!(arrives_from_the_left(net, reader_symbol.inputs[*jack]), "{what}: from {name}");
            assert!(driven.insert((*reader, *jack)), "{what}: two cords in one jack");
        }
        assert!(hangs_together(net), "{what}: the cord from {name} is torn");
    }
    let from_outputs = drawn.symbols.iter().flat_map(|placed| &placed.symbol.jacks);
    let wanted = from_outputs.filter(|jack| matches!(jack.from, Source::Output(..))).count();
    assert_eq!(driven.len(), wanted, "{what}");
}

fn starts_to_the_right(net: &Net, at: Point) -> bool {
    net.route.lines.iter().any(|[from, to]| *from == at && to.1 == at.1 && to.0 > at.0)
}

fn arrives_from_the_left(net: &Net, at: Point) -> bool {
    net.route.lines.iter().any(|[from, to]| *to == at && from.1 == at.1 && from.0 < at.0)
}

fn hangs_together(net: &Net) -> bool {
    let lines = &net.route.lines;
    let (mut reached, mut open) = (BTreeSet::from([0]), vec![0]);
    while let Some(line) = open.pop() {
        for other in 0..lines.len() {
            if meet(&lines[line], &lines[other]) && reached.insert(other) {
                open.push(other);
            }
        }
    }
    reached.len() == lines.len()
}

/// Whether lines of one net have a place in common; where they cross there is a dot.
fn meet(one: &[Point; 2], other: &[Point; 2]) -> bool {
    let overlap =
        |axis: fn(&Point) -> f64| axis(&one[0]) <= axis(&other[1]) && axis(&other[0]) <= axis(&one[1]);
    overlap(|at| at.0) && overlap(|at| at.1)
}

/// Whether an end of one lies on the other.
fn touch(one: &[Point; 2], other: &[Point; 2]) -> bool {
    one.iter().any(|at| lies_on(*at, other)) || other.iter().any(|at| lies_on(*at, one))
}

fn lies_on(at: Point, line: &[Point; 2]) -> bool {
    (line[0].0..=line[1].0).contains(&at.0) && (line[0].1..=line[1].1).contains(&at.1)
}

/// Cords of different outputs cross at most; none ends on another or runs in it.
fn no_cords_share_a_line(drawn: &Diagram, what: &str) {
    for (index, one) in drawn.nets.iter().enumerate() {
        for other in &drawn.nets[index + 1..] {
            for (a, b) in one.route.lines.iter().flat_map(|a| other.route.lines.iter().map(move |b| (a, b))) {
                let names = [one, other].map(|net| &drawn.symbols[net.from].symbol.name);
                assert!(!touch(a, b), "{what}: cords from {names:?} touch at {a:?} {b:?}");
            }
        }
    }
}

fn no_cord_runs_through_a_symbol_or_a_text(drawn: &Diagram, what: &str) {
    for net in &drawn.nets {
        let from = &drawn.symbols[net.from].symbol.name;
        for line in &net.route.lines {
            for (index, placed) in drawn.symbols.iter().enumerate() {
                let name = &placed.symbol.name;
                let is_own = net.from == index || net.to.iter().any(|(reader, _)| *reader == index);
                assert!(
                    is_own || !crosses(line, &placed.area),
                    "{what}: the cord from {from} crosses {name}"
                );
                for label in placed.labels() {
                    assert!(
                        !crosses(line, &label.area()),
                        "{what}: the cord from {from} crosses \"{}\"",
                        label.text
                    );
                }
            }
        }
    }
}

fn crosses(line: &[Point; 2], area: &Area) -> bool {
    line[0].0 < area.right && line[1].0 > area.left && line[0].1 < area.bottom && line[1].1 > area.top
}

fn overlap(one: &Area, other: &Area) -> bool {
    one.left < other.right && other.left < one.right && one.top < other.bottom && other.top < one.bottom
}

fn no_texts_overlap(drawn: &Schematic, what: &str) {
    let drawing = drawn.drawing();
    let labels: Vec<&Label> = drawing
        .marks
        .iter()
        .filter_map(|mark| match mark {
            Stroke::Text(label) => Some(label),
            _ => None,
        })
        .collect();
    for (index, one) in labels.iter().enumerate() {
        let area = one.area();
        assert!(area.left >= 0.0 && area.right <= drawing.width, "{what}: \"{}\" leaves the sheet", one.text);
        assert!(
            area.top >= 0.0 && area.bottom <= drawing.height,
            "{what}: \"{}\" leaves the sheet",
            one.text
        );
        assert!(one.size >= 9.0, "{what}: \"{}\" is too small to read", one.text);
        for other in &labels[index + 1..] {
            assert!(!overlap(&area, &other.area()), "{what}: \"{}\" on \"{}\"", one.text, other.text);
        }
    }
}
