//! The patch panel by its data: every cord of the circuit, one jack each, on as many parts as the machine has.

mod common;

use std::collections::BTreeSet;
use std::fs;
use std::sync::LazyLock;

use patchcord::circuit::Circuit;
use patchcord::elements::{Default, Jacks};
use patchcord::machines::Part;
use patchcord::patch::Patch;
use patchcord::plot::{Ink, Label, Stroke};
use patchcord::schematic::{Board, Cord, Point};

fn board(circuit: &Circuit) -> Board {
    Board::new(circuit, "").unwrap_or_else(|error| panic!("{error}"))
}

/// A point to the tenth of a pixel, to be kept in a set.
fn place(at: Point) -> (i64, i64) {
    ((10.0 * at.0).round() as i64, (10.0 * at.1).round() as i64)
}

/// The boards of all shipped patches, and of some with other elements.
static BOARDS: LazyLock<Vec<(String, Circuit, Board)>> = LazyLock::new(|| {
    let folders = ["patches/lessons", "patches/thesis", "tests/patches"];
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "json"));
    let boards = files.iter().map(|file| {
        let patch = Patch::read(file).unwrap_or_else(|error| panic!("{error}"));
        let circuit = common::circuit(&patch, &[]);
        let board = board(&circuit);
        (file.display().to_string(), circuit, board)
    });
    boards.collect()
});

/// A cord by its output, the element that it goes to, the input and the gain of its jack.
type Plugged = (String, String, String, Option<String>);

/// The cords of a circuit.
fn wanted(circuit: &Circuit) -> Vec<Plugged> {
    let mut wanted = Vec::new();
    for (index, element) in circuit.elements().into_iter().enumerate() {
        for (from, cord) in circuit.cords(index) {
            let input = &element.kind.inputs[cord.input];
            let gain = (input.jacks == Jacks::Gains).then(|| cord.gain.to_string());
            wanted.push((
                circuit.element(from).name.clone(),
                element.name.clone(),
                input.name.to_owned(),
                gain,
            ));
        }
    }
    wanted.sort();
    wanted
}

#[test]
fn every_cord_is_drawn_once_and_none_more() {
    for (file, circuit, board) in &*BOARDS {
        let told = |cord: &Cord| {
            (cord.from.clone(), cord.to.clone(), cord.input.clone(), cord.gain.map(|gain| gain.to_string()))
        };
        let mut drawn: Vec<Plugged> = board.cords.iter().map(told).collect();
        drawn.sort();
        assert_eq!(drawn, wanted(circuit), "{file}");
        let lines = board.drawing().marks.into_iter().filter(
            |mark| matches!(mark, Stroke::Line { ink: Ink::Cord(_), points, .. } if points.len() > 1),
        );
        assert_eq!(lines.count(), drawn.len(), "{file}");
    }
}

#[test]
fn every_cord_ends_in_the_jacks_that_it_tells() {
    for (file, _, board) in &*BOARDS {
        for cord in &board.cords {
            assert_eq!(seen(board, cord), told(cord), "{file}");
            assert_eq!(
                [cord.points.first(), cord.points.last()].map(|at| at.map(|at| place(*at))),
                cord.ends.map(|at| Some(place(at)))
            );
        }
        let ends = || board.cords.iter().flat_map(|cord| cord.ends.map(place));
        assert_eq!(ends().collect::<BTreeSet<_>>().len(), ends().count(), "{file}: a shared jack");
    }
}

/// Where a cord leaves, where it goes and what stands beside the jack, as the panel shows it.
fn seen(board: &Board, cord: &Cord) -> [String; 3] {
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

/// The same, as the cord tells it.
fn told(cord: &Cord) -> [String; 3] {
    let label = match (cord.input.as_str(), cord.gain) {
        ("x", Some(gain)) => gain.to_string(),
        (input, Some(gain)) => format!("{} {gain}", input.trim_end_matches("_x")),
        ("bias_plus", None) => "+VB".to_owned(),
        ("bias_minus", None) => "−VB".to_owned(),
        (input, None) => input.to_owned(),
    };
    [cord.from.clone(), cord.to.clone(), label]
}

#[test]
fn each_potentiometer_of_the_dead_zone_has_its_bias_and_its_setting() {
    let circuit = common::circuit(&common::slideway(), &[]);
    let board = board(&circuit);
    for (name, jacks, note) in [("DZ PB1", ["in", "+VB"], "0.2537"), ("PB2", ["in", "−VB"], "0.2537 of DZ")]
    {
        let module = board.modules.iter().find(|module| module.name == name).unwrap();
        assert!(module.inputs.iter().map(|(label, _)| label).eq(jacks), "{module:?}");
        assert_eq!(module.note, note);
    }
}

/// Whether two points are less than so far apart.
fn near(one: Point, other: Point, distance: f64) -> bool {
    (one.0 - other.0).hypot(one.1 - other.1) < distance
}

#[test]
fn cords_of_one_output_are_alike_and_neighbours_differ() {
    for (file, _, board) in &*BOARDS {
        for (index, cord) in board.cords.iter().enumerate() {
            for other in &board.cords[index + 1..] {
                let beside = cord.ends.iter().any(|one| other.ends.iter().any(|end| near(*one, *end, 30.0)));
                if cord.from == other.from {
                    assert_eq!(cord.colour, other.colour, "{file}");
                } else if beside {
                    assert_ne!(cord.colour, other.colour, "{file}: {} and {}", cord.from, other.from);
                }
            }
        }
    }
}

#[test]
fn cords_keep_off_the_texts() {
    let mut crossed = Vec::new();
    for (file, _, board) in &*BOARDS {
        let marks = board.drawing().marks;
        let texts: Vec<_> = marks
            .iter()
            .filter_map(|mark| if let Stroke::Text(label) = mark { Some(label) } else { None })
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

#[test]
fn what_the_modules_leave_out_is_listed() {
    let circuit = common::circuit(&common::slideway(), &[]);
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
        ("Drives", "v_i", "1 V = 254 µm/s"),
        ("Signals", "memory", "1 V = 0.01"),
    ] {
        assert!(rows.contains(&row), "{row:?} is not in {rows:#?}");
    }
    let text = |mark: Stroke| if let Stroke::Text(label) = mark { Some(label.text) } else { None };
    assert!(board.drawing().marks.into_iter().filter_map(text).any(|text| text == "sum-of-squares"));
}

#[test]
fn every_setting_that_a_patch_gives_stands_on_the_sheet() {
    for (file, circuit, board) in &*BOARDS {
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
fn the_1451_shows_all_its_parts() {
    let circuit = common::circuit(&common::slideway(), &[]);
    let board = board(&circuit);
    let parts: usize = Part::ALL.iter().filter_map(|part| circuit.machine().count(*part)).sum();
    // Three references, two drives and a key switch stand beside the parts.
    assert_eq!(board.modules.len(), parts + 6);
    let names: Vec<&str> = board.modules.iter().map(|module| module.name.as_str()).collect();
    for name in ["A6", "DZ PB1", "PB2", "PB3", "D1D2", "U D3D4", "D5D6", "M1", "KS1", "+100"] {
        assert_eq!(names.iter().filter(|other| **other == name).count(), 1, "{name} among {names:?}");
    }
}

#[test]
fn modules_stand_side_by_side_on_the_sheet() {
    let circuit = common::circuit(&common::slideway(), &[]);
    let board = board(&circuit);
    let drawing = board.drawing();
    for (index, module) in board.modules.iter().enumerate() {
        let [(left, top), (right, bottom)] = module.corners;
        assert!(left > 0.0 && top > 0.0 && right < drawing.width && bottom < drawing.height, "{module:?}");
        let apart = |other: &patchcord::schematic::Module| {
            let [(l, t), (r, b)] = other.corners;
            r <= left || right <= l || b <= top || bottom <= t
        };
        assert!(board.modules[index + 1..].iter().all(apart), "{module:?}");
        for at in module.inputs.iter().map(|(_, at)| at).chain(&module.outputs) {
            assert!(left < at.0 && at.0 < right && top < at.1 && at.1 < bottom, "{module:?}");
        }
    }
}
