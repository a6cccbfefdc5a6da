//! The modules of the panel show all parts of the machine with their jacks and settings.

use std::collections::BTreeSet;

use super::{PatchPanel, board, slideway};
use patchcord_core::elements::SettingDefault;
use patchcord_core::machines::Part;
use patchcord_core::patch::Patch;
use patchcord_draw::plot::Primitive;
use patchcord_draw::schematic::Module;

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
        let mut labels = second.iter().filter_map(Primitive::label);
        assert!(labels.any(|label| label.text.starts_with(&words)), "{other}");
    }
}

/// The machine of the slideway. It has rows of equal parts.
const SOLARTRON: &str = "solartron-1451";

pub(super) fn all_modules_of_a_row_have_the_same_jacks(boards: &[PatchPanel]) {
    let mut panels = boards.iter().filter(|(_, circuit, _)| circuit.machine().name == SOLARTRON).peekable();
    assert!(panels.peek().is_some());
    for (file, circuit, board) in panels {
        // The panel begins with the three references and the drives.
        let mut modules = board.modules.iter().skip(3 + circuit.patch().drives.len());
        for part in
            [Part::Summer, Part::Integrator, Part::FixedPot, Part::FreePot, Part::DiodePair, Part::Multiplier]
        {
            let count = circuit.machine().count(part).unwrap();
            let row: Vec<_> = modules.by_ref().take(count).collect();
            let jacks = |module: &Module| (module.inputs.len(), module.outputs.len());
            assert!(row.iter().all(|module| jacks(module) == jacks(row[0])), "{file}: {row:#?}");
            let labels =
                |module: &Module| module.inputs.iter().map(|(label, _)| label.clone()).collect::<Vec<_>>();
            if matches!(part, Part::Summer | Part::Integrator | Part::Multiplier) {
                assert!(row.iter().all(|module| labels(module) == labels(row[0])), "{file}: {row:#?}");
            }
        }
    }
}

#[test]
fn settings_that_the_modules_omit_are_listed() {
    let (_, board) = slideway();
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
    let primitives = board.drawing().primitives;
    let mut labels = primitives.iter().filter_map(Primitive::label);
    assert!(labels.any(|label| label.text == "sum-of-squares"));
}

pub(super) fn every_given_setting_is_on_the_sheet(boards: &[PatchPanel]) {
    for (file, circuit, board) in boards {
        let rows: BTreeSet<_> =
            board.lists.iter().flat_map(|list| &list.rows).map(|row| row.name.clone()).collect();
        let names = &circuit.patch().elements;
        for element in circuit.elements().into_iter().filter(|element| names.contains_key(&element.name)) {
            let settings = || element.kind.settings.iter().zip(&element.settings);
            let is_set = |name: &str| {
                settings().any(|(row, given)| {
                    row.name == name && (given.is_some() || matches!(row.default, SettingDefault::Number(_)))
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
    let (circuit, board) = slideway();
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
    let (_, board) = slideway();
    let drawing = board.drawing();
    for (index, module) in board.modules.iter().enumerate() {
        let [(left, top), (right, bottom)] = module.corners;
        assert!(left > 0.0 && top > 0.0 && right < drawing.width && bottom < drawing.height, "{module:?}");
        let is_separate = |other: &Module| {
            let [(l, t), (r, b)] = other.corners;
            r <= left || right <= l || b <= top || bottom <= t
        };
        assert!(board.modules[index + 1..].iter().all(is_separate), "{module:?}");
        for at in module.inputs.iter().map(|(_, at)| at).chain(&module.outputs) {
            assert!(left < at.0 && at.0 < right && top < at.1 && at.1 < bottom, "{module:?}");
        }
    }
}
