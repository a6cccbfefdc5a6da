//! Checks of one schematic: every element and every cord is drawn, and nothing overlaps.

#![allow(dead_code, reason = "no test binary uses all helpers")]

mod directions;
pub(crate) mod legibility;
mod macro_boxes;

use std::collections::BTreeSet;

use patchcord_core::circuit::Circuit;
use patchcord_core::elements::Jacks;
use patchcord_draw::plot::{Area, Label, Primitive};
use patchcord_draw::schematic::{
    CordSource, Diagram, ElementState, Net, PlacedSymbol, Point, Schematic, SettingValue,
};

/// A cord: the driving element, the reading element, the input, and the gain if the input has gains.
pub(crate) type CordKey = (String, String, String, Option<String>);

/// Returns the cords of a circuit in ascending order.
pub(crate) fn cords_of(circuit: &Circuit) -> Vec<CordKey> {
    let mut cords = Vec::new();
    for (index, element) in circuit.elements().into_iter().enumerate() {
        for (from, cord) in circuit.cords(index) {
            let from = circuit.element(from).name.clone();
            let input = &element.kind.inputs[cord.input];
            let gain = (input.jacks == Jacks::Gains).then(|| cord.gain.to_string());
            cords.push((from, element.name.clone(), input.name.to_owned(), gain));
        }
    }
    cords.sort();
    cords
}

/// The state that is printed at every output.
const STATE: ElementState = ElementState { volts: -12.34, position: None };

/// Returns the schematic of a circuit with a voltage at every output.
pub(crate) fn schematic(circuit: &Circuit) -> Schematic {
    Schematic::new(circuit, "", "", &|_| Some(STATE)).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the same schematic with every macro instance replaced by its elements.
pub(crate) fn expanded(circuit: &Circuit) -> Schematic {
    Schematic::expanded(circuit, "", "", &|_| Some(STATE)).unwrap_or_else(|error| panic!("{error}"))
}

/// Draws a circuit and checks all rules; `case` names the circuit in failures.
pub(crate) fn check(circuit: &Circuit, case: &str) {
    let schematic = schematic(circuit);
    for schematic in [&schematic, &expanded(circuit)] {
        diagrams(schematic).for_each(|diagram| check_diagram(diagram, case));
        no_texts_overlap(schematic, case);
        legibility::nothing_crosses_texts(schematic, case);
    }
    every_element_once(&expanded(circuit).main, circuit, case);
    every_given_setting_is_shown(&expanded(circuit), circuit, case);
    macro_boxes::check(&schematic, circuit, case);
    if circuit.patch().instances.is_empty() {
        assert_eq!(schematic, expanded(circuit), "{case}");
    }
}

/// Returns the main diagram and those of the macros.
pub(crate) fn diagrams(schematic: &Schematic) -> impl Iterator<Item = &Diagram> {
    std::iter::once(&schematic.main).chain(schematic.macros.iter().map(|opened| &opened.diagram))
}

/// Checks that every setting of the patch is at its symbol or in the lists of the sheet.
fn every_given_setting_is_shown(schematic: &Schematic, circuit: &Circuit, case: &str) {
    let drawing = schematic.drawing();
    for element in circuit.elements() {
        let Some(placed) = schematic.main.symbols.iter().find(|placed| placed.symbol.name == element.name)
        else {
            continue;
        };
        let rows = element.kind.settings.iter().zip(&element.settings);
        for (row, _) in rows.filter(|(_, given)| given.is_some()) {
            let setting = placed
                .symbol
                .setting(row.name)
                .unwrap_or_else(|| panic!("{case}: {} of {}", row.name, element.name));
            let text = searched_text(&setting.shown, &setting.value);
            let at_symbol = placed.labels().any(|label| contains_word(&label.text, &text));
            let listed = schematic.lists.iter().flat_map(|list| &list.rows).any(|listed| {
                let names = [element.name.clone(), format!("{} {}", element.name, row.name)];
                names.contains(&listed.name)
                    && (contains_word(&listed.value, &text) || contains_word(&listed.text, &text))
            });
            assert!(at_symbol || listed, "{case}: {} of {} is not shown as {text}", row.name, element.name);
            let mut labels = drawing.primitives.iter().filter_map(Primitive::label);
            let on_sheet = labels.any(|label| label.text.contains('…') || contains_word(&label.text, &text));
            assert!(on_sheet, "{case}: {text}");
        }
    }
}

/// Returns the text to search for: the number without its unit, a word, or the first point.
fn searched_text(shown: &str, value: &SettingValue) -> String {
    match value {
        SettingValue::Flag(true) => "closed".to_owned(),
        SettingValue::Flag(false) => "open".to_owned(),
        SettingValue::Word("product") => "b/100".to_owned(),
        SettingValue::Word("sum-of-squares") => "b²)/100".to_owned(),
        SettingValue::Word(word) => (*word).to_owned(),
        _ => shown.split(' ').next().unwrap_or_default().to_owned(),
    }
}

/// Whether a text contains a word.
fn contains_word(text: &str, word: &str) -> bool {
    text.split([' ', ',']).any(|other| other == word || other == word.trim_end_matches(','))
}

/// Checks the rules of one diagram.
fn check_diagram(diagram: &Diagram, case: &str) {
    no_symbols_overlap(diagram, case);
    every_cord_leads_from_output_to_jack(diagram, case);
    no_cords_share_a_line(diagram, case);
    no_cord_runs_through_a_symbol_or_a_text(diagram, case);
    legibility::check(diagram, case);
    directions::check(diagram, case);
}

/// Checks that every element and drive has exactly one symbol, and every cord a jack.
fn every_element_once(diagram: &Diagram, circuit: &Circuit, case: &str) {
    let names: Vec<&str> = diagram.symbols.iter().map(|placed| placed.symbol.name.as_str()).collect();
    let patch = circuit.patch();
    let expected: Vec<&str> = patch.drives.keys().chain(patch.elements.keys()).map(String::as_str).collect();
    assert_eq!(names, expected, "{case}");
    let jacks = diagram.symbols.iter().map(|placed| placed.symbol.jacks.len()).sum::<usize>();
    let cords: usize = (0..circuit.elements().len()).map(|element| circuit.cords(element).len()).sum();
    assert_eq!(jacks, cords, "{case}");
}

/// Checks that symbols do not overlap and have a position for every jack.
fn no_symbols_overlap(diagram: &Diagram, case: &str) {
    for (first, placed) in diagram.symbols.iter().enumerate() {
        let is_separate = |other: &PlacedSymbol| !overlap(&placed.area, &other.area);
        assert!(
            diagram.symbols[first + 1..].iter().all(is_separate),
            "{case}: {} overlaps another",
            placed.symbol.name
        );
        assert!(placed.symbol.jacks.len() <= placed.inputs.len(), "{case}: {}", placed.symbol.name);
    }
}

/// Checks that every cord is in a net whose lines are connected and end at the right jacks.
fn every_cord_leads_from_output_to_jack(diagram: &Diagram, case: &str) {
    let mut driven = BTreeSet::new();
    for net in &diagram.nets {
        let from = &diagram.symbols[net.from];
        let name = &from.symbol.name;
        assert!(starts_to_the_right(net, from.outputs[net.output]), "{case}: {name} leaves to the left");
        for (reader, jack) in &net.to {
            let reader_symbol = &diagram.symbols[*reader];
            let expected = CordSource::Output(net.from, net.output);
            assert_eq!(reader_symbol.symbol.jacks[*jack].from, expected, "{case}: {name}");
            assert!(arrives_from_the_left(net, reader_symbol.inputs[*jack]), "{case}: from {name}");
            assert!(driven.insert((*reader, *jack)), "{case}: two cords in one jack");
        }
        assert!(is_connected(net), "{case}: the cord from {name} is not connected");
    }
    let from_outputs = diagram.symbols.iter().flat_map(|placed| &placed.symbol.jacks);
    let expected = from_outputs.filter(|jack| matches!(jack.from, CordSource::Output(..))).count();
    assert_eq!(driven.len(), expected, "{case}");
}

/// Whether a line of a net starts at a point and runs to the right.
fn starts_to_the_right(net: &Net, at: Point) -> bool {
    net.route.lines.iter().any(|[from, to]| *from == at && to.1 == at.1 && to.0 > at.0)
}

/// Whether a line of a net ends at a point and comes from the left.
fn arrives_from_the_left(net: &Net, at: Point) -> bool {
    net.route.lines.iter().any(|[from, to]| *to == at && from.1 == at.1 && from.0 < at.0)
}

/// Whether the lines of a net are connected.
fn is_connected(net: &Net) -> bool {
    let lines = &net.route.lines;
    let (mut connected, mut open) = (BTreeSet::from([0]), vec![0]);
    while let Some(line) = open.pop() {
        for other in 0..lines.len() {
            if meet(&lines[line], &lines[other]) && connected.insert(other) {
                open.push(other);
            }
        }
    }
    connected.len() == lines.len()
}

/// Whether two lines of a net have a point in common; a crossing has a dot.
fn meet(first: &[Point; 2], other: &[Point; 2]) -> bool {
    let overlap =
        |axis: fn(&Point) -> f64| axis(&first[0]) <= axis(&other[1]) && axis(&other[0]) <= axis(&first[1]);
    overlap(|at| at.0) && overlap(|at| at.1)
}

/// Whether an end of one line is on the other.
fn touch(first: &[Point; 2], other: &[Point; 2]) -> bool {
    first.iter().any(|at| is_on(*at, other)) || other.iter().any(|at| is_on(*at, first))
}

/// Whether a point is on a horizontal or vertical line.
fn is_on(at: Point, line: &[Point; 2]) -> bool {
    (line[0].0..=line[1].0).contains(&at.0) && (line[0].1..=line[1].1).contains(&at.1)
}

/// Checks that cords of different outputs only cross; none ends on another or overlaps it.
fn no_cords_share_a_line(diagram: &Diagram, case: &str) {
    for (index, first) in diagram.nets.iter().enumerate() {
        for other in &diagram.nets[index + 1..] {
            for (a, b) in first.route.lines.iter().flat_map(|a| other.route.lines.iter().map(move |b| (a, b)))
            {
                let names = [first, other].map(|net| &diagram.symbols[net.from].symbol.name);
                assert!(!touch(a, b), "{case}: cords from {names:?} touch at {a:?} {b:?}");
            }
        }
    }
}

/// Checks that a cord crosses no symbol except those at its ends, and no text.
fn no_cord_runs_through_a_symbol_or_a_text(diagram: &Diagram, case: &str) {
    for net in &diagram.nets {
        let from = &diagram.symbols[net.from].symbol.name;
        for line in &net.route.lines {
            for (index, placed) in diagram.symbols.iter().enumerate() {
                let name = &placed.symbol.name;
                let is_endpoint = net.from == index || net.to.iter().any(|(reader, _)| *reader == index);
                assert!(
                    is_endpoint || !crosses(line, &placed.area),
                    "{case}: the cord from {from} crosses {name}"
                );
                for label in placed.labels() {
                    assert!(
                        !crosses(line, &label.area()),
                        "{case}: the cord from {from} crosses \"{}\"",
                        label.text
                    );
                }
            }
        }
    }
}

/// Whether a horizontal or vertical line passes through an area.
fn crosses(line: &[Point; 2], area: &Area) -> bool {
    line[0].0 < area.right && line[1].0 > area.left && line[0].1 < area.bottom && line[1].1 > area.top
}

/// Whether two areas have a point in common that is not on an edge.
fn overlap(first: &Area, other: &Area) -> bool {
    first.left < other.right
        && other.left < first.right
        && first.top < other.bottom
        && other.top < first.bottom
}

/// Checks that texts are on the sheet, large enough and separate from each other.
fn no_texts_overlap(schematic: &Schematic, case: &str) {
    let drawing = schematic.drawing();
    let labels: Vec<&Label> = drawing.primitives.iter().filter_map(Primitive::label).collect();
    for (index, first) in labels.iter().enumerate() {
        let area = first.area();
        assert!(
            area.left >= 0.0 && area.right <= drawing.width,
            "{case}: \"{}\" leaves the sheet",
            first.text
        );
        assert!(
            area.top >= 0.0 && area.bottom <= drawing.height,
            "{case}: \"{}\" leaves the sheet",
            first.text
        );
        assert!(first.size >= 9.0, "{case}: \"{}\" is too small to read", first.text);
        for other in &labels[index + 1..] {
            assert!(!overlap(&area, &other.area()), "{case}: \"{}\" on \"{}\"", first.text, other.text);
        }
    }
}
