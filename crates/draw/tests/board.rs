//! The patch panel shows every cord of the circuit with its jacks on the parts of the machine.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::LazyLock;

use crate::common::files::{representative_files, shipped_files, test_patch_files};
use patchcord_core::circuit::Circuit;
use patchcord_core::elements::{Default, Jacks};
use patchcord_core::machines::Part;
use patchcord_core::patch::Patch;
use patchcord_draw::plot::{Ink, Label, Primitive};
use patchcord_draw::schematic::{Board, Cord, Module, Point};

/// The panel of a circuit.
fn board(circuit: &Circuit) -> Board {
    Board::new(circuit, "").unwrap_or_else(|error| panic!("{error}"))
}

/// Rounds a point to tenths of a pixel, as a key of a set.
fn rounded(point: Point) -> (i64, i64) {
    ((10.0 * point.0).round() as i64, (10.0 * point.1).round() as i64)
}

/// A file, its circuit and its panel.
type PatchPanel = (String, Circuit, Board);

fn boards(files: Vec<PathBuf>) -> Vec<PatchPanel> {
    let panels = files.into_iter().map(|file| {
        let circuit = crate::common::circuit(&crate::common::patch_of(&file), &[]);
        let board = board(&circuit);
        (file.display().to_string(), circuit, board)
    });
    panels.collect()
}

/// The panels of a few patches.
static FEW: LazyLock<Vec<PatchPanel>> =
    LazyLock::new(|| boards([representative_files(), test_patch_files()].concat()));
/// The panels of all shipped patches.
static ALL: LazyLock<Vec<PatchPanel>> = LazyLock::new(|| boards(shipped_files()));

/// Defines a test of each check on a few panels, and a slow one on all panels.
macro_rules! on_boards {
    ($($check:ident),* $(,)?) => {
        mod few {
            $(#[test]
            fn $check() {
                super::$check(&super::FEW);
            })*
        }
        mod all {
            $(#[test]
            #[ignore = "the boards of all patches take a minute"]
            fn $check() {
                super::$check(&super::ALL);
            })*
        }
    };
}

on_boards!(
    every_cord_is_drawn_exactly_once,
    every_cord_ends_in_its_jacks,
    cords_of_one_output_share_a_colour_and_neighbours_differ,
    cords_avoid_texts,
    cords_overlap_for_short_sections_only,
    no_cord_covers_another_jack,
    every_given_setting_is_on_the_sheet,
);

/// A cord: the driving element, the reading element, the input and the gain of the jack.
type CordKey = (String, String, String, Option<String>);

/// Returns the cords of a circuit in ascending order.
fn expected_cords(circuit: &Circuit) -> Vec<CordKey> {
    let mut cords = Vec::new();
    for (index, element) in circuit.elements().into_iter().enumerate() {
        for (from, cord) in circuit.cords(index) {
            let input = &element.kind.inputs[cord.input];
            let gain = (input.jacks == Jacks::Gains).then(|| cord.gain.to_string());
            cords.push((
                circuit.element(from).name.clone(),
                element.name.clone(),
                input.name.to_owned(),
                gain,
            ));
        }
    }
    cords.sort();
    cords
}

fn every_cord_is_drawn_exactly_once(boards: &[PatchPanel]) {
    for (file, circuit, board) in boards {
        let key = |cord: &Cord| {
            (cord.from.clone(), cord.to.clone(), cord.input.clone(), cord.gain.map(|gain| gain.to_string()))
        };
        let mut drawn: Vec<CordKey> = board.cords.iter().map(key).collect();
        drawn.sort();
        assert_eq!(drawn, expected_cords(circuit), "{file}");
        let lines = board.drawing().primitives.into_iter().filter(
            |primitive| matches!(primitive, Primitive::Line { ink: Ink::Cord(_), points, .. } if points.len() > 1),
        );
        assert_eq!(lines.count(), drawn.len(), "{file}");
    }
}

fn every_cord_ends_in_its_jacks(boards: &[PatchPanel]) {
    for (file, circuit, board) in boards {
        for cord in &board.cords {
            assert_eq!(shown_connection(board, cord), expected_connection(circuit, cord), "{file}");
            assert_eq!(
                [cord.points.first(), cord.points.last()].map(|at| at.map(|at| rounded(*at))),
                cord.ends.map(|at| Some(rounded(at)))
            );
        }
        let ends = || board.cords.iter().flat_map(|cord| cord.ends.map(rounded));
        assert_eq!(ends().collect::<BTreeSet<_>>().len(), ends().count(), "{file}: a shared jack");
    }
}

/// Returns the driving element, the reading element and the jack label of a cord from the panel.
fn shown_connection(board: &Board, cord: &Cord) -> [String; 3] {
    let from = board.modules.iter().find(|module| module.outputs.contains(&cord.ends[0])).unwrap();
    let mut jacks = board
        .modules
        .iter()
        .flat_map(|module| module.inputs.iter().map(move |(label, at)| (module, label, at)));
    let (to, label, _) = jacks.find(|(.., at)| **at == cord.ends[1]).unwrap();
    let owner = to.note.split("of ").nth(1).unwrap_or(&to.name);
    let first = |words: &str| words.split(' ').next().unwrap().replace('−', "-");
    [first(&from.name), first(owner), label.clone()]
}

/// Returns the expected names and label from the data of the cord.
fn expected_connection(circuit: &Circuit, cord: &Cord) -> [String; 3] {
    let kind = circuit.elements().into_iter().find(|element| element.name == cord.to).unwrap().kind.name;
    let gains = circuit.machine().summer_gains;
    let label = match (kind, cord.input.as_str()) {
        ("diode-lower-of", _) => "cathode".to_owned(),
        ("diode-upper-of", _) => "anode".to_owned(),
        ("inverter", _) if !gains.is_empty() => "1".to_owned(),
        _ => jack_label(cord),
    };
    [cord.from.clone(), cord.to.clone(), label]
}

/// The label of the jack of a cord.
fn jack_label(cord: &Cord) -> String {
    match (cord.input.as_str(), cord.gain) {
        ("x", Some(gain)) => gain.to_string(),
        (input, Some(gain)) => format!("{} {gain}", input.trim_end_matches("_x")),
        ("bias_plus", None) => "+VB".to_owned(),
        ("bias_minus", None) => "−VB".to_owned(),
        (input, None) => input.to_owned(),
    }
}

#[test]
fn each_potentiometer_of_the_dead_zone_has_its_bias_and_its_setting() {
    let circuit = crate::common::circuit(&crate::common::slideway(), &[]);
    let board = board(&circuit);
    for (name, jacks, note) in
        [("PB1", ["in", "+VB"], "0.2537 of DZ"), ("PB2", ["in", "−VB"], "0.2537 of DZ")]
    {
        let module = board.modules.iter().find(|module| module.name == name).unwrap();
        assert!(module.inputs.iter().map(|(label, _)| label).eq(jacks), "{module:?}");
        assert_eq!(module.note, note);
    }
}

/// Whether two points are closer than a distance.
fn near(one: Point, other: Point, distance: f64) -> bool {
    (one.0 - other.0).hypot(one.1 - other.1) < distance
}

/// Whether two cords end at one module.
fn share_a_module(board: &Board, one: &Cord, other: &Cord) -> bool {
    let at = |module: &Module, cord: &Cord| module.jacks().any(|jack| cord.ends.contains(&jack));
    board.modules.iter().any(|module| at(module, one) && at(module, other))
}

fn cords_of_one_output_share_a_colour_and_neighbours_differ(boards: &[PatchPanel]) {
    for (file, _, board) in boards {
        for (index, cord) in board.cords.iter().enumerate() {
            for other in &board.cords[index + 1..] {
                let is_near = cord.ends.iter().any(|one| other.ends.iter().any(|end| near(*one, *end, 30.0)));
                if cord.from == other.from {
                    assert_eq!(cord.colour, other.colour, "{file}");
                } else if is_near || share_a_module(board, cord, other) {
                    assert_ne!(cord.colour, other.colour, "{file}: {} and {}", cord.from, other.from);
                }
            }
        }
    }
}

fn cords_avoid_texts(boards: &[PatchPanel]) {
    let mut crossed = Vec::new();
    for (file, _, board) in boards {
        let primitives = board.drawing().primitives;
        let texts: Vec<_> = primitives
            .iter()
            .filter_map(|primitive| if let Primitive::Text(label) = primitive { Some(label) } else { None })
            .collect();
        for cord in &board.cords {
            let on = |label: &&&Label| {
                let area = label.area();
                cord.points
                    .iter()
                    .any(|(x, y)| (area.left..area.right).contains(x) && (area.top..area.bottom).contains(y))
            };
            let texts = texts.iter().filter(on).map(|label| label.text.clone());
            crossed.extend(texts.map(|text| format!("{file}: {} to {} over {text}", cord.from, cord.to)));
        }
    }
    assert!(crossed.is_empty(), "{crossed:#?}");
}

/// Returns the paths of cords and links with a name for each.
fn paths(board: &Board) -> Vec<(String, [Point; 2], Vec<Point>)> {
    let cords = board.cords.iter();
    let cords = cords.map(|cord| (format!("{} to {}", cord.from, cord.to), cord.ends, dense(&cord.points)));
    let links = board.links.iter();
    let links = links.map(|link| (format!("link of {}", link.of), link.ends, dense(&link.points)));
    cords.chain(links).collect()
}

/// Returns points on a line at most two pixels apart.
fn dense(points: &[Point]) -> Vec<Point> {
    let mut dense = vec![points[0]];
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let count = ((to.0 - from.0).hypot(to.1 - from.1) / 2.0).ceil().max(1.0);
        let point =
            |fraction: f64| (from.0 + fraction * (to.0 - from.0), from.1 + fraction * (to.1 - from.1));
        dense.extend((1..=count as usize).map(|index| point(index as f64 / count)));
    }
    dense
}

fn cords_overlap_for_short_sections_only(boards: &[PatchPanel]) {
    let mut covered = Vec::new();
    for (file, _, board) in boards {
        let paths = paths(board);
        for (index, (name, ends, path)) in paths.iter().enumerate() {
            for (other, others, other_path) in &paths[index + 1..] {
                let shared = |at: &Point| ends.contains(at);
                let is_free = |at: &&Point| !others.iter().any(|end| shared(end) && near(*end, **at, 24.0));
                let on = |at: &&Point| other_path.iter().any(|point| near(**at, *point, 4.0));
                let length = 2 * path.iter().filter(is_free).filter(on).count();
                if length > 40 {
                    covered.push(format!("{file}: {name} on {other} for {length} px"));
                }
            }
        }
    }
    assert!(covered.is_empty(), "{covered:#?}");
}

fn no_cord_covers_another_jack(boards: &[PatchPanel]) {
    let mut covered = Vec::new();
    for (file, _, board) in boards {
        for (name, ends, path) in paths(board) {
            for module in &board.modules {
                let others = module.jacks().filter(|jack| !ends.contains(jack));
                let hidden = others.filter(|jack| path.iter().any(|at| near(*at, *jack, 6.0)));
                covered.extend(hidden.map(|jack| format!("{file}: {name} over {}, {jack:?}", module.name)));
            }
        }
    }
    assert!(covered.is_empty(), "{covered:#?}");
}

#[test]
fn jacks_and_plugs_are_in_front_of_all_cords() {
    let circuit = crate::common::circuit(&crate::common::slideway(), &[]);
    let primitives = board(&circuit).drawing().primitives;
    let is_cord = |primitive: &Primitive| matches!(primitive, Primitive::Line { ink: Ink::Cord(_), .. });
    let is_jack =
        |primitive: &Primitive| matches!(primitive, Primitive::Ring { .. } | Primitive::Disc { .. });
    assert!(primitives.iter().rposition(is_cord) < primitives.iter().position(is_jack));
}

/// Returns the primitives of the panel of a patch with one element of a kind.
fn drawn(kind: &str, cords: &str) -> Vec<Primitive> {
    let text = format!(r#"{{"patchcord": 1, "elements": {{"A": {{"kind": "{kind}", "in": {cords}}}}}}}"#);
    let patch = Patch::parse("one.json", &text).unwrap_or_else(|report| panic!("{report}"));
    board(&crate::common::circuit(&patch, &[])).drawing().primitives
}

#[test]
fn modules_of_different_kinds_look_different() {
    let pairs = [
        (["diode-lower-of", "diode-upper-of"], r#"["+100", "ground"]"#),
        (["sin", "cos"], r#""ground""#),
        (["log", "exp"], r#""+100""#),
        (["summer", "open-amplifier"], r#"{"x1": ["+100", "A"]}"#),
    ];
    for ([one, other], cords) in pairs {
        let (first, second) = (drawn(one, cords), drawn(other, cords));
        assert_ne!(first, second, "{one} and {other}");
        let words = other.replace('-', " ");
        let has_kind = |primitive: &Primitive| matches!(primitive, Primitive::Text(label) if label.text.starts_with(&words));
        assert!(second.iter().any(has_kind), "{other}");
    }
}

#[test]
fn dead_zone_and_limiter_are_linked() {
    let circuit = crate::common::circuit(&crate::common::slideway(), &[]);
    let board = board(&circuit);
    let module = |name: &str| board.modules.iter().find(|module| module.name == name).unwrap();
    let cord = board.cords.iter().find(|cord| cord.from == "DZ").unwrap();
    assert!(module("DZ D1D2").outputs.contains(&cord.ends[0]));
    let input = |name: &str, jack: usize| module(name).inputs[jack].1;
    let output = |name: &str, jack: usize| module(name).outputs[jack];
    let junction = module("B2").inputs.iter().find(|(label, _)| label == "SJ").unwrap().1;
    let expected = [
        ("DZ", [input("PB1", 0), input("PB2", 0)]),
        ("DZ", [output("PB1", 0), input("DZ D1D2", 0)]),
        ("DZ", [output("PB2", 0), input("DZ D1D2", 1)]),
        ("B2", [output("B2", 1), input("PB3", 0)]),
        ("B2", [output("−100", 0), input("PB3", 1)]),
        ("B2", [output("PB3", 0), input("D5D6", 0)]),
        ("B2", [output("D5D6", 0), junction]),
    ];
    assert!(board.links.iter().map(|link| (link.of.as_str(), link.ends)).eq(expected));
    let adjustment = board.lists[0].rows.iter().find(|row| row.name == "PB3").unwrap();
    assert_eq!(adjustment.text, "turn until B2 stops at 10 V");
}

#[test]
fn all_modules_of_a_row_have_the_same_jacks() {
    for stem in ["fig-8-04", "fig-8-11", "fig-8-14", "fig-8-16"] {
        let patch = crate::common::shipped(&format!("thesis/{stem}"));
        let circuit = crate::common::circuit(&patch, &[]);
        let mut modules = board(&circuit).modules.into_iter().skip(3 + patch.drives.len());
        for part in
            [Part::Summer, Part::Integrator, Part::FixedPot, Part::FreePot, Part::DiodePair, Part::Multiplier]
        {
            let count = circuit.machine().count(part).unwrap();
            let row: Vec<_> = modules.by_ref().take(count).collect();
            let jacks = |module: &Module| (module.inputs.len(), module.outputs.len());
            assert!(row.iter().all(|module| jacks(module) == jacks(&row[0])), "{stem}: {row:#?}");
            let labels =
                |module: &Module| module.inputs.iter().map(|(label, _)| label.clone()).collect::<Vec<_>>();
            if matches!(part, Part::Summer | Part::Integrator | Part::Multiplier) {
                assert!(row.iter().all(|module| labels(module) == labels(&row[0])), "{stem}: {row:#?}");
            }
        }
    }
}

#[test]
fn settings_that_the_modules_omit_are_listed() {
    let circuit = crate::common::circuit(&crate::common::slideway(), &[]);
    let board = board(&circuit);
    let rows = board
        .lists
        .iter()
        .flat_map(|list| list.rows.iter().map(|row| (list.heading, &*row.name, &*row.value)));
    let rows: BTreeSet<_> = rows.collect();
    for row in [
        ("Settings", "M1 mode", "sum-of-squares"),
        ("Settings", "KS1", "closed"),
        ("Settings", "PC5", "0.2520"),
        ("Settings", "PB3", ""),
        ("Drives", "v_i", "1 V = 254 µm/s"),
        ("Signals", "memory", "1 V = 0.01"),
    ] {
        assert!(rows.contains(&row), "{row:?} is not in {rows:#?}");
    }
    let text =
        |primitive: Primitive| if let Primitive::Text(label) = primitive { Some(label.text) } else { None };
    assert!(board.drawing().primitives.into_iter().filter_map(text).any(|text| text == "sum-of-squares"));
}

fn every_given_setting_is_on_the_sheet(boards: &[PatchPanel]) {
    for (file, circuit, board) in boards {
        let rows: BTreeSet<_> =
            board.lists.iter().flat_map(|list| &list.rows).map(|row| row.name.clone()).collect();
        let names = &circuit.patch().elements;
        for element in circuit.elements().into_iter().filter(|element| names.contains_key(&element.name)) {
            let settings = || element.kind.settings.iter().zip(&element.settings);
            let is_set = |name: &str| {
                settings().any(|(row, given)| {
                    row.name == name && (given.is_some() || matches!(row.default, Default::Number(_)))
                })
            };
            let noted = ["setting", "initial", "limit.upper"].into_iter().find(|name| is_set(name));
            for (setting, _) in settings().filter(|(_, given)| given.is_some()) {
                let is_noted = noted == Some(setting.name);
                let name = format!("{} {}", element.name, setting.name);
                let is_listed =
                    rows.contains(&name) || setting.name == "closed" && rows.contains(&element.name);
                assert!(is_noted || is_listed, "{file}: {name} is missing");
            }
        }
    }
}

#[test]
fn the_panel_shows_all_parts_of_the_machine() {
    let circuit = crate::common::circuit(&crate::common::slideway(), &[]);
    let board = board(&circuit);
    let parts: usize = Part::ALL.iter().filter_map(|part| circuit.machine().count(*part)).sum();
    // The panel also has three references, two drives and a key switch.
    assert_eq!(board.modules.len(), parts + 6);
    let names: Vec<&str> = board.modules.iter().map(|module| module.name.as_str()).collect();
    for name in ["A6", "PB1", "PB2", "PB3", "DZ D1D2", "U D3D4", "D5D6", "M1", "KS1", "+100"] {
        assert_eq!(names.iter().filter(|other| **other == name).count(), 1, "{name} among {names:?}");
    }
}

#[test]
fn modules_do_not_overlap() {
    let circuit = crate::common::circuit(&crate::common::slideway(), &[]);
    let board = board(&circuit);
    let drawing = board.drawing();
    for (index, module) in board.modules.iter().enumerate() {
        let [(left, top), (right, bottom)] = module.corners;
        assert!(left > 0.0 && top > 0.0 && right < drawing.width && bottom < drawing.height, "{module:?}");
        let is_separate = |other: &patchcord_draw::schematic::Module| {
            let [(l, t), (r, b)] = other.corners;
            r <= left || right <= l || b <= top || bottom <= t
        };
        assert!(board.modules[index + 1..].iter().all(is_separate), "{module:?}");
        for at in module.inputs.iter().map(|(_, at)| at).chain(&module.outputs) {
            assert!(left < at.0 && at.0 < right && top < at.1 && at.1 < bottom, "{module:?}");
        }
    }
}
