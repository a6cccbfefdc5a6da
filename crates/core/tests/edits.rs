//! Typed edits of patches: an edited patch is the patch that its text gives.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::common::dice::Dice;
use crate::common::{element, files, patch, patch_of, volts};
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Report, Severity};
use patchcord_core::ir::Program;
use patchcord_core::patch::{
    Amount, Edit, EditError, MacroBuilder, ParameterBuilder, Patch, PatchBuilder, PatchEditor,
};

/// Edits that are tried on each patch.
const EDITS: usize = 14;

/// One of several things, by chance.
fn one_of<'a, T>(dice: &mut Dice, items: &'a [T]) -> Option<&'a T> {
    items.get((dice.even(0.0, items.len() as f64) as usize).min(items.len().saturating_sub(1)))
}

/// A text without the positions that parts have in the document.
fn without_spans(text: &str) -> String {
    let mut parts = text.split("Span { start: ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |all, part| all + "Span" + part.split_once('}').map_or("", |(_, rest)| rest))
}

/// Everything that a patch comes to, without positions: circuit and program, or the report of what is wrong.
fn described(patch: &Patch) -> Result<String, Box<Report>> {
    let circuit = Circuit::new(patch, &[])?;
    let program = Program::new(&circuit)?;
    let mut text = String::new();
    let mut add = |part: String| writeln!(text, "{}", without_spans(&part)).unwrap();
    add(format!("{:?} {:?} {:?} {:?}", patch.title, patch.source, patch.note, patch.time_scale));
    add(format!("{:?} {:?}", patch.machine, circuit.machine().name));
    add(format!("{:?} {:?}", patch.parameters, patch.scales));
    add(format!("{:?} {:?} {:?}", patch.drives, patch.elements, patch.signals));
    add(format!("{:?} {:?}", patch.macros, patch.instances));
    add(format!("{:?} {:?} {:?}", patch.run, patch.record, patch.pictures));
    for (index, element) in circuit.elements().into_iter().enumerate() {
        add(format!("{element:?} {:?}", circuit.cords(index)));
    }
    add(format!("{:?} {:?} {:?}", circuit.stages(), circuit.signals(), circuit.parts()));
    add(format!("{program:?}"));
    Ok(text)
}

/// Compares an edited patch with the one that its text gives, with all that is reported of both.
fn check(edited: &Patch, what: &str) {
    let read = Patch::parse(edited.file(), edited.text()).unwrap_or_else(|report| panic!("{report}"));
    match (described(edited), described(&read)) {
        (Ok(found), Ok(expected)) => {
            let differs = found.lines().zip(expected.lines()).find(|(one, other)| one != other);
            assert!(found == expected, "{what}: {differs:#?}\n{}", edited.text());
        }
        (Err(found), Err(expected)) => assert_eq!(found, expected, "{what}"),
        (found, expected) => panic!("{what}: {found:?}, and read {expected:?}"),
    }
    let warnings = |patch: &Patch| Circuit::new(patch, &[]).map(|circuit| circuit.warnings());
    assert_eq!(warnings(edited).ok(), warnings(&read).ok(), "{what}");
    assert_eq!(edited.value(), read.value(), "{what}");
    let cords = |patch: &Patch| {
        let names = patch.value()["elements"].as_object().into_iter().flat_map(|all| all.keys());
        names
            .map(|name| format!("{name} {:?}", patch.written_cords(name).collect::<Vec<_>>()))
            .collect::<Vec<_>>()
    };
    assert_eq!(cords(edited), cords(&read), "{what}");
}

/// Makes one edit by chance, and says which. `None` if the patch has nothing to edit so.
fn edit(editor: &mut PatchEditor, dice: &mut Dice, number: usize) -> Option<Result<String, EditError>> {
    let patch = editor.patch().clone();
    let parameters: Vec<String> = patch.parameters.keys().cloned().collect();
    let scales: Vec<String> = patch.scales.keys().cloned().collect();
    let drives: Vec<String> = patch.drives.keys().cloned().collect();
    let own: Vec<String> = patch.elements.keys().filter(|name| !name.contains('.')).cloned().collect();
    let all: Vec<String> =
        own.iter().chain(patch.instances.keys().filter(|name| !name.contains('.'))).cloned().collect();
    let share = dice.even(0.0, 1.0);
    let done = match (dice.even(0.0, 14.0) as usize).min(13) {
        0 => {
            let name = one_of(dice, &parameters)?;
            let parameter = &patch.parameters[name];
            let (low, high) = parameter.range.unwrap_or((0.5 * parameter.value, 1.5 * parameter.value));
            editor.set_parameter(name, low + share * (high - low)).map(|()| format!("set {name}"))
        }
        1 => {
            let name = one_of(dice, &parameters)?;
            let (low, high) = patch.parameters[name].range?;
            editor.set_range(name, [low - share, high + share]).map(|()| format!("range of {name}"))
        }
        2 => {
            let name = format!("extra_{number}");
            let parameter = ParameterBuilder::new(share, "1").range([0, 1]).description("more");
            editor.put_parameter(&name, parameter);
            Ok(format!("put {name}"))
        }
        3 | 4 => {
            let name = one_of(dice, &own)?;
            let entry = &patch.elements[name];
            let kind = entry.kind;
            let formulas =
                kind.settings.iter().zip(&entry.settings).filter_map(|(row, setting)| {
                    match setting.as_ref().map(|placed| &placed.value) {
                        Some(Amount::Formula(formula)) => Some((row.name, formula.text().to_owned())),
                        _ => None,
                    }
                });
            let formulas: Vec<_> = formulas.collect();
            let (setting, formula) = one_of(dice, &formulas)?;
            let value = if share < 0.3 { json!(share) } else { json!(format!("(1.0 * {formula})")) };
            editor.set_setting(name, setting, value).map(|()| format!("{setting} of {name}"))
        }
        5 => {
            let name = one_of(dice, &own)?;
            patch.elements[name].kind.setting("initial")?;
            editor.set_initial(name, 10.0 * share).map(|()| format!("initial of {name}"))
        }
        6 => {
            editor.set_title("another title");
            editor.set_source("a test");
            editor.set_note("edited");
            editor.set_machine("unlimited");
            Ok("texts".to_owned())
        }
        7 => {
            let scale = one_of(dice, &scales).filter(|_| share < 0.5);
            let (name, unit) = match scale {
                Some(name) => (name.clone(), patch.scales[name].unit.text().to_owned()),
                None => (format!("scale_{number}"), "m".to_owned()),
            };
            editor.put_scale(&name, 1.5, &unit);
            Ok(format!("scale {name}"))
        }
        8 => {
            let scale = one_of(dice, &scales)?;
            let name = one_of(dice, &drives).filter(|_| share < 0.5).cloned();
            let name = name.unwrap_or_else(|| format!("drive-{number}"));
            editor.put_drive(&name, element("step").set("height", 0).set("scale", scale.as_str()));
            Ok(format!("drive {name}"))
        }
        9 => {
            let name = one_of(dice, &drives)?;
            editor
                .feed_drive(name, if share < 0.5 { "linear" } else { "previous" })
                .map(|()| format!("feed {name}"))
        }
        10 => {
            let from = one_of(dice, &own)?;
            let name = one_of(dice, &own).filter(|_| share < 0.3).cloned();
            let name = name.unwrap_or_else(|| format!("N{number}"));
            editor.put_element(&name, element("inverter").cord("in", from).set("note", "new"));
            Ok(format!("inverter {name}"))
        }
        11 => {
            let from = one_of(dice, &own)?;
            let (kind, name) = (format!("box-{number}"), format!("E{number}"));
            let inside = MacroBuilder::new()
                .input("in", "what is halved")
                .output("out", "P")
                .setting("part", "1", 0.5)
                .element("P", element("pot").cord("in", "in").set("setting", "part"));
            editor.put_macro(&kind, inside);
            editor.put_element(&name, element(&kind).cord("in", from).set("part", share));
            editor.put_element(&format!("R{number}"), element("inverter").cord("in", &format!("{name}.out")));
            Ok(format!("instance {name}"))
        }
        12 => {
            let (name, from) = (one_of(dice, &all)?, one_of(dice, &own)?);
            let cords: Vec<_> = patch.written_cords(name).map(|(jack, _)| jack.to_owned()).collect();
            let jack =
                one_of(dice, &cords).filter(|_| share < 0.5).cloned().unwrap_or_else(|| "x1".to_owned());
            editor.add_cord(name, &jack, from).map(|()| format!("cord from {from} to {jack} of {name}"))
        }
        _ => {
            let (name, to) = (one_of(dice, &all)?, one_of(dice, &own)?);
            let cords: Vec<_> = patch.written_cords(name).map(|(_, from)| from.to_owned()).collect();
            let from = one_of(dice, &cords)?;
            editor.replug(name, from, to).map(|()| format!("{to} in place of {from} at {name}"))
        }
    };
    Some(done)
}

/// Tries edits on a patch, each alone and some together; goes on with those that leave a patch that can be run.
fn try_edits(first: &Patch, seed: u64) {
    let mut dice = Dice(seed);
    let mut patch = first.clone();
    for number in 0..EDITS {
        let mut editor = patch.edit();
        let mut names = Vec::new();
        for part in 0..1 + number % 3 {
            let done = edit(&mut editor, &mut dice, 10 * number + part);
            names.extend(done.map(|done| done.unwrap_or_else(|error| error.to_string())));
        }
        let what = format!("{}: {}", first.file(), names.join(", "));
        let edited = editor.finish(first.file()).unwrap_or_else(|error| panic!("{what}: {error}"));
        check(&edited, &what);
        if described(&edited).is_ok() {
            patch = edited;
        }
    }
}

#[test]
fn an_edited_patch_is_what_its_text_gives() {
    let all = files::shipped().into_iter().chain(files::of_tests());
    for (number, file) in all.enumerate() {
        let first = patch_of(&file);
        if Circuit::new(&first, &[]).is_ok() {
            try_edits(&first, 7 + number as u64);
        }
    }
}

#[test]
fn a_patch_with_boxes_in_boxes_is_edited_too() {
    let inner = MacroBuilder::new()
        .input("in", "")
        .output("out", "P")
        .setting("share", "1", "0.5 * half")
        .element("P", element("pot").cord("in", "in").set("setting", "share"));
    let outer = MacroBuilder::new()
        .input("in", "")
        .output("first", "L")
        .output("second", "S")
        .element("L", element("inner").cord("in", "in"))
        .element("S", element("summer").cords("x1", ["L", "in"]));
    let first = volts("boxes")
        .parameter("half", 0.5, "1", [0.1, 1.0])
        .drive("u", "volt", element("step").set("height", 10))
        .define("inner", inner)
        .define("outer", outer)
        .element("A", element("integrator").cords("x1", ["W.second", "u"]).cords("x10", ["A"]))
        .element("W", element("outer").cord("in", "A"))
        .element("V", element("inner").cord("in", "W").set("share", 0.25))
        .signal("out", "V", "volt", 1.0)
        .record(["out", "W.second"])
        .build()
        .unwrap();
    for seed in 100..130 {
        try_edits(&first, seed);
    }
}

/// The errors of a report.
fn errors(report: &Report) -> Vec<String> {
    let errors = report.findings.iter().filter(|finding| finding.code.severity() == Severity::Error);
    errors.map(|finding| finding.message.clone()).collect()
}

fn decay() -> PatchBuilder {
    volts("decay")
        .parameter("T", 0.1, "s", [0.01, 1.0])
        .drive("u", "volt", element("step").set("height", 10))
        .element("A1", element("integrator").cords("x1", ["u"]).set("initial", 50))
        .element("P1", element("pot").cord("in", "A1").set("setting", 0.5))
        .element("S1", element("summer").cords("x1", ["P1"]))
}

#[test]
fn what_is_wrong_after_an_edit_is_reported_at_its_place_in_the_text() {
    let patch = decay().build().unwrap();
    let mut editor = patch.edit();
    editor.add_cord("S1", "x10", "A9").unwrap();
    let edited = editor.finish("wrong.json").unwrap();
    let report = Circuit::new(&edited, &[]).unwrap_err();
    assert_eq!(errors(&report), ["S1 is driven by A9, which is not in the patch"]);
    let span = report.findings[0].span.unwrap();
    assert_eq!(&report.text[span.start..span.end], "\"A9\"");
    assert_eq!((report.file.as_str(), report.text.as_str()), ("wrong.json", edited.text()));
    let mut editor = patch.edit();
    editor.set_setting("P1", "setting", 1.5).unwrap();
    let edited = editor.finish("wrong.json").unwrap();
    let report = Circuit::new(&edited, &[]).and_then(|circuit| Program::new(&circuit).map(drop)).unwrap_err();
    let span = report.findings.iter().find_map(|finding| finding.span).unwrap();
    assert_eq!(&report.text[span.start..span.end], "1.5");
}

#[test]
fn places_of_elements_are_those_of_the_text() {
    let patch = decay().build().unwrap();
    let mut editor = patch.edit();
    editor.put_element("N1", element("inverter").cord("in", "S1"));
    editor.set_title("a title\nof two lines");
    let edited = editor.finish("decay.json").unwrap();
    let read = Patch::parse("decay.json", edited.text()).unwrap();
    let [edited, read] = [edited, read].map(|patch| Circuit::new(&patch, &[]).unwrap());
    for name in ["u", "A1", "N1"] {
        assert_eq!(edited.place_of(name), read.place_of(name));
        assert!(edited.place_of(name).is_some(), "{name}");
    }
    assert_eq!(edited.place_of("+100"), None);
}

#[test]
fn typed_edits_and_edits_by_path_give_the_same_text() {
    let patch = decay().build().unwrap();
    let mut editor = patch.edit();
    editor.set_parameter("T", 0.5).unwrap();
    editor.put_parameter("k", ParameterBuilder::new(2, "N/m").range([0, 10]).description("stiffness"));
    editor.set_initial("A1", "10 * k / k").unwrap();
    editor.put_element("N1", element("inverter").cord("in", "S1"));
    editor.put_element("N2", element("inverter").cord("in", "N1"));
    editor.set_machine("unlimited");
    editor.set_note("noted");
    let typed = editor.finish("typed.json").unwrap();
    let parameter = json!({"value": 2, "unit": "N/m", "range": [0, 10], "description": "stiffness"});
    let by_path = patch.edited(
        "typed.json",
        &[
            Edit::new("parameters/T/value", 0.5),
            Edit::new("parameters/k", parameter),
            Edit::new("elements/A1/initial", "10 * k / k"),
            Edit::new("elements/N1", json!({"kind": "inverter", "in": "S1"})),
            Edit::new("elements/N2", json!({"kind": "inverter", "in": "N1"})),
            Edit::new("machine", "unlimited"),
            Edit::new("note", "noted"),
        ],
    );
    assert_eq!(typed.text(), by_path.unwrap().text());
}

#[test]
fn edits_of_one_batch_meet_in_one_place() {
    let patch = decay().build().unwrap();
    let mut editor = patch.edit();
    editor.put_macro(
        "half",
        MacroBuilder::new()
            .input("in", "")
            .output("out", "P")
            .element("P", element("pot").cord("in", "in").set("setting", 0.5)),
    );
    editor.put_element("H", element("half").cord("in", "S1"));
    editor.set_initial("A1", 5).unwrap();
    editor.add_cord("A1", "x1", "H").unwrap();
    editor.add_cord("A1", "brake_x1", "S1").unwrap();
    editor.set_setting("A1", "limit.lower", -20).unwrap();
    editor.set_setting("A1", "limit.upper", 20).unwrap();
    editor.replug("A1", "u", "S1").unwrap();
    editor.put_parameter("k", ParameterBuilder::new(1, "1"));
    editor.set_parameter("k", 3.0).unwrap();
    editor.set_range("k", [0.0, 4.0]).unwrap();
    let edited = editor.finish("decay.json").unwrap();
    let a1 = json!({
        "kind": "integrator", "in": {"x1": ["S1", "H"], "brake_x1": ["S1"]}, "initial": 5,
        "limit": {"lower": -20, "upper": 20},
    });
    assert_eq!(edited.value()["elements"]["A1"], a1);
    assert_eq!(edited.value()["parameters"]["k"], json!({"value": 3.0, "unit": "1", "range": [0.0, 4.0]}));
    assert!(edited.value()["macros"]["half"].is_object());
    check(&edited, "one batch");
}

#[test]
fn several_batches_are_rendered_one_after_the_other() {
    let patch = decay().build().unwrap();
    let step = |patch: &Patch, value: f64| {
        let mut editor = patch.edit();
        editor.set_parameter("T", value).unwrap();
        editor.put_parameter(&format!("k{}", 100.0 * value), ParameterBuilder::new(value, "1"));
        editor.finish("decay.json").unwrap()
    };
    let first = step(&patch, 0.25);
    let unseen = step(&first, 0.5);
    assert!(first.text().contains("k25"));
    let seen = step(&first, 0.5);
    assert_eq!(unseen.text(), seen.text());
    assert_eq!(seen.parameters.keys().collect::<Vec<_>>(), ["T", "k25", "k50"]);
    check(&step(&seen, 0.75), "three batches");
}

#[test]
fn what_is_not_there_cannot_be_edited() {
    let patch = decay().build().unwrap();
    let mut editor = patch.edit();
    let told = |result: Result<(), EditError>| result.unwrap_err().to_string();
    assert_eq!(told(editor.set_parameter("U", 1.0)), "there is no parameter U in the patch");
    assert_eq!(told(editor.set_parameter("T", f64::NAN)), "T must be a finite number");
    assert_eq!(told(editor.set_initial("A9", 1)), "there is no element A9 in the patch");
    assert_eq!(told(editor.set_initial("P1", 1)), "there is no setting initial in the patch");
    assert_eq!(told(editor.feed_drive("v", "linear")), "there is no drive v in the patch");
    assert_eq!(told(editor.add_cord("A9", "x1", "A1")), "there is no element A9 in the patch");
    editor.put(&["run", "nowhere", "key"], Value::from(1));
    assert_eq!(
        editor.finish("p.json").unwrap_err().to_string(),
        "there is no run/nowhere/key in the document"
    );
}

#[test]
fn a_value_at_a_path_is_read_with_the_text() {
    let mut editor = patch("delay-line").edit();
    editor.put(&["run", "for"], 0.125);
    editor.put(&["title"], "shorter");
    let edited = editor.finish("shorter.json").unwrap();
    assert_eq!(edited.run.duration.as_ref().unwrap().value, 0.125);
    assert_eq!(edited.title, "shorter");
    check(&edited, "put");
}
