//! Tests of typed edits: an edited patch equals the patch that is read from its text.
//!
//! Random edits are applied to all shipped patches and to the patches of the tests. After each batch, the edited patch
//! is compared with the patch that its text gives: circuit, program, reports, warnings and cords.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::common::random::SplitMix64;
use crate::common::{element, files, patch, patch_of, volts};
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Report, Severity};
use patchcord_core::ir::Program;
use patchcord_core::patch::{
    Amount, Edit, EditError, MacroBuilder, ParameterBuilder, Patch, PatchBuilder, PatchEditor,
};

/// Number of batches of edits for each patch. With one to three edits per batch, each of the 14 entries of [`EDITS`] is
/// tried about twice.
const BATCHES_PER_PATCH: usize = 7;

/// A random item; `None` if there are no items.
fn random_item<'a, T>(random: &mut SplitMix64, items: &'a [T]) -> Option<&'a T> {
    items.get((random.uniform(0.0, items.len() as f64) as usize).min(items.len().saturating_sub(1)))
}

/// A debug text without the spans, which differ between an edited patch and one that was read.
fn without_spans(text: &str) -> String {
    let mut parts = text.split("Span { start: ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |all, part| all + "Span" + part.split_once('}').map_or("", |(_, rest)| rest))
}

/// Everything that follows from a patch, without spans: its fields, circuit and program. The error is the report.
fn description(patch: &Patch) -> Result<String, Box<Report>> {
    let circuit = Circuit::new(patch)?;
    let program = Program::new(&circuit)?;
    let mut text = String::new();
    let mut add = |part: String| writeln!(text, "{}", without_spans(&part)).unwrap();
    add(format!("{:?} {:?} {:?} {:?}", patch.title, patch.source, patch.note, patch.time_scale));
    add(format!("{:?} {:?}", patch.machine, circuit.machine().name));
    add(format!("{:?} {:?}", patch.parameters, patch.scales));
    add(format!("{:?} {:?} {:?}", patch.drives, patch.elements, patch.signals));
    add(format!("{:?} {:?}", patch.macros, patch.instances));
    add(format!("{:?} {:?}", patch.equations, circuit.auxiliary_quantities().collect::<Vec<_>>()));
    add(format!("{:?} {:?} {:?}", patch.run, patch.record, patch.pictures));
    for (index, element) in circuit.elements().into_iter().enumerate() {
        add(format!("{element:?} {:?}", circuit.cords(index)));
    }
    add(format!("{:?} {:?} {:?}", circuit.evaluation_order(), circuit.signals(), circuit.parts()));
    add(format!("{program:?}"));
    Ok(text)
}

/// Asserts that an edited patch equals the patch that is read from its text. `context` describes the edits.
fn assert_equals_its_text(edited: &Patch, context: &str) {
    let read = Patch::parse(edited.file(), edited.text()).unwrap_or_else(|report| panic!("{report}"));
    match (description(edited), description(&read)) {
        (Ok(actual), Ok(expected)) => {
            let difference =
                actual.lines().zip(expected.lines()).find(|(actual, expected)| actual != expected);
            assert!(actual == expected, "{context}: {difference:#?}\n{}", edited.text());
        }
        (Err(actual), Err(expected)) => assert_eq!(actual, expected, "{context}"),
        (actual, expected) => panic!("{context}: {actual:?}, but the text gives {expected:?}"),
    }
    let warnings = |patch: &Patch| Circuit::new(patch).map(|circuit| circuit.warnings());
    assert_eq!(warnings(edited).ok(), warnings(&read).ok(), "{context}");
    assert_eq!(edited.value(), read.value(), "{context}");
    let cords = |patch: &Patch| {
        let names = patch.value()["elements"].as_object().into_iter().flat_map(|all| all.keys());
        names
            .map(|name| format!("{name} {:?}", patch.written_cords(name).collect::<Vec<_>>()))
            .collect::<Vec<_>>()
    };
    assert_eq!(cords(edited), cords(&read), "{context}");
}

/// The description of an edit, or the error of the editor. `None` if the patch has no part of the kind that would be
/// edited.
type EditResult = Option<Result<String, EditError>>;

/// A patch before a random edit, and the random choices of the edit.
struct RandomEdit<'a> {
    editor: &'a mut PatchEditor,
    random: &'a mut SplitMix64,
    /// The patch before the edit.
    patch: Patch,
    parameters: Vec<String>,
    scales: Vec<String>,
    drives: Vec<String>,
    /// Names of the elements outside instances.
    elements: Vec<String>,
    /// The same names, then those of the instances outside other instances.
    elements_with_instances: Vec<String>,
    /// A random number, 0 ... 1.
    fraction: f64,
    /// This number makes the names of new parts unique.
    number: usize,
}

/// The kinds of edits. All entries are equally likely, so a kind that occurs twice is twice as likely.
const EDITS: [fn(&mut RandomEdit<'_>) -> EditResult; 14] = [
    set_parameter,
    widen_range,
    add_parameter,
    change_setting,
    change_setting,
    set_initial,
    set_texts,
    put_scale,
    put_drive,
    put_table_drive,
    put_inverter,
    put_instance,
    add_cord,
    replug_cord,
];

/// Makes one random edit. `number` makes the names of new parts unique.
fn random_edit(editor: &mut PatchEditor, random: &mut SplitMix64, number: usize) -> EditResult {
    let patch = editor.patch().clone();
    let elements: Vec<String> = patch.elements.keys().filter(|name| !name.contains('.')).cloned().collect();
    let instances = patch.instances.keys().filter(|name| !name.contains('.'));
    let elements_with_instances = elements.iter().chain(instances).cloned().collect();
    let fraction = random.uniform(0.0, 1.0);
    let make_edit = random_item(random, &EDITS)?;
    make_edit(&mut RandomEdit {
        editor,
        random,
        parameters: patch.parameters.keys().cloned().collect(),
        scales: patch.scales.keys().cloned().collect(),
        drives: patch.drives.keys().cloned().collect(),
        patch,
        elements,
        elements_with_instances,
        fraction,
        number,
    })
}

/// Sets a parameter to a value in its range.
fn set_parameter(edit: &mut RandomEdit<'_>) -> EditResult {
    let name = random_item(edit.random, &edit.parameters)?;
    let parameter = &edit.patch.parameters[name];
    let (low, high) = parameter.range.unwrap_or((0.5 * parameter.value, 1.5 * parameter.value));
    let result = edit.editor.set_parameter(name, low + edit.fraction * (high - low));
    Some(result.map(|()| format!("set {name}")))
}

/// Widens the range of a parameter.
fn widen_range(edit: &mut RandomEdit<'_>) -> EditResult {
    let name = random_item(edit.random, &edit.parameters)?;
    let (low, high) = edit.patch.parameters[name].range?;
    let result = edit.editor.set_range(name, [low - edit.fraction, high + edit.fraction]);
    Some(result.map(|()| format!("range of {name}")))
}

/// Adds a parameter.
fn add_parameter(edit: &mut RandomEdit<'_>) -> EditResult {
    let name = format!("extra_{}", edit.number);
    let parameter = ParameterBuilder::new(edit.fraction, "1").range([0, 1]).description("more");
    edit.editor.put_parameter(&name, parameter);
    Some(Ok(format!("put {name}")))
}

/// Replaces a formula of an element by a number, or by a formula with the same value.
fn change_setting(edit: &mut RandomEdit<'_>) -> EditResult {
    let name = random_item(edit.random, &edit.elements)?;
    let entry = &edit.patch.elements[name];
    let settings = entry.kind.settings.iter().zip(&entry.settings);
    let formulas = settings.filter_map(|(row, setting)| match setting.as_ref().map(|placed| &placed.value) {
        Some(Amount::Formula(formula)) => Some((row.name, formula.text().to_owned())),
        _ => None,
    });
    let formulas: Vec<_> = formulas.collect();
    let (setting, formula) = random_item(edit.random, &formulas)?;
    let fraction = edit.fraction;
    let value = if fraction < 0.3 { json!(fraction) } else { json!(format!("(1.0 * {formula})")) };
    let result = edit.editor.set_setting(name, setting, value);
    Some(result.map(|()| format!("{setting} of {name}")))
}

/// Sets the initial voltage of an element.
fn set_initial(edit: &mut RandomEdit<'_>) -> EditResult {
    let name = random_item(edit.random, &edit.elements)?;
    edit.patch.elements[name].kind.setting("initial")?;
    let result = edit.editor.set_initial(name, 10.0 * edit.fraction);
    Some(result.map(|()| format!("initial of {name}")))
}

/// Sets all texts of the patch, and its machine.
fn set_texts(edit: &mut RandomEdit<'_>) -> EditResult {
    edit.editor.set_title("another title");
    edit.editor.set_source("a test");
    edit.editor.set_note("edited");
    edit.editor.set_machine("unlimited");
    Some(Ok("texts".to_owned()))
}

/// Adds a scale, or changes one.
fn put_scale(edit: &mut RandomEdit<'_>) -> EditResult {
    let scale = random_item(edit.random, &edit.scales).filter(|_| edit.fraction < 0.5);
    let (name, unit) = match scale {
        Some(name) => (name.clone(), edit.patch.scales[name].unit.text().to_owned()),
        None => (format!("scale_{}", edit.number), "m".to_owned()),
    };
    edit.editor.put_scale(&name, 1.5, &unit);
    Some(Ok(format!("scale {name}")))
}

/// Adds a drive, or replaces one.
fn put_drive(edit: &mut RandomEdit<'_>) -> EditResult {
    let scale = random_item(edit.random, &edit.scales)?;
    let name = random_item(edit.random, &edit.drives).filter(|_| edit.fraction < 0.5).cloned();
    let name = name.unwrap_or_else(|| format!("drive-{}", edit.number));
    edit.editor.put_drive(&name, element("step").set("height", 0).set("scale", scale.as_str()));
    Some(Ok(format!("drive {name}")))
}

/// Replaces a drive by a table.
fn put_table_drive(edit: &mut RandomEdit<'_>) -> EditResult {
    let name = random_item(edit.random, &edit.drives)?;
    let hold = if edit.fraction < 0.5 { "linear" } else { "previous" };
    let result = edit.editor.put_table_drive(name, hold);
    Some(result.map(|()| format!("table drive {name}")))
}

/// Adds an inverter, or replaces an element by one.
fn put_inverter(edit: &mut RandomEdit<'_>) -> EditResult {
    let from = random_item(edit.random, &edit.elements)?;
    let name = random_item(edit.random, &edit.elements).filter(|_| edit.fraction < 0.3).cloned();
    let name = name.unwrap_or_else(|| format!("N{}", edit.number));
    edit.editor.put_element(&name, element("inverter").cord("in", from).set("note", "new"));
    Some(Ok(format!("inverter {name}")))
}

/// Adds a macro, an instance of it, and an inverter that reads the instance.
fn put_instance(edit: &mut RandomEdit<'_>) -> EditResult {
    let from = random_item(edit.random, &edit.elements)?;
    let (kind, name) = (format!("box-{}", edit.number), format!("E{}", edit.number));
    let inside = MacroBuilder::new()
        .input("in", "the input that is halved")
        .output("out", "P")
        .setting("part", "1", 0.5)
        .element("P", element("pot").cord("in", "in").set("setting", "part"));
    edit.editor.put_macro(&kind, inside);
    edit.editor.put_element(&name, element(&kind).cord("in", from).set("part", edit.fraction));
    let inverter = element("inverter").cord("in", &format!("{name}.out"));
    edit.editor.put_element(&format!("R{}", edit.number), inverter);
    Some(Ok(format!("instance {name}")))
}

/// Adds a cord to an element or an instance.
fn add_cord(edit: &mut RandomEdit<'_>) -> EditResult {
    let name = random_item(edit.random, &edit.elements_with_instances)?;
    let from = random_item(edit.random, &edit.elements)?;
    let cords: Vec<_> = edit.patch.written_cords(name).map(|(jack, _)| jack.to_owned()).collect();
    let jack = random_item(edit.random, &cords).filter(|_| edit.fraction < 0.5).cloned();
    let jack = jack.unwrap_or_else(|| "x1".to_owned());
    let result = edit.editor.add_cord(name, &jack, from);
    Some(result.map(|()| format!("cord from {from} to {jack} of {name}")))
}

/// Moves the beginning of a cord to another element.
fn replug_cord(edit: &mut RandomEdit<'_>) -> EditResult {
    let name = random_item(edit.random, &edit.elements_with_instances)?;
    let to = random_item(edit.random, &edit.elements)?;
    let cords: Vec<_> = edit.patch.written_cords(name).map(|(_, from)| from.to_owned()).collect();
    let from = random_item(edit.random, &cords)?;
    let result = edit.editor.replug(name, from, to);
    Some(result.map(|()| format!("{to} in place of {from} at {name}")))
}

/// Applies batches of one to three random edits to a patch and checks each result. The next batch continues with the
/// edited patch if it can be run, and otherwise with the patch before.
fn check_random_edits(first: &Patch, seed: u64) {
    let mut random = SplitMix64(seed);
    let mut patch = first.clone();
    for batch in 0..BATCHES_PER_PATCH {
        let mut editor = patch.edit();
        let mut descriptions = Vec::new();
        for index in 0..1 + batch % 3 {
            let result = random_edit(&mut editor, &mut random, 10 * batch + index);
            descriptions.extend(result.map(|result| result.unwrap_or_else(|error| error.to_string())));
        }
        let context = format!("{}: {}", first.file(), descriptions.join(", "));
        let edited = editor.finish(first.file()).unwrap_or_else(|error| panic!("{context}: {error}"));
        assert_equals_its_text(&edited, &context);
        if description(&edited).is_ok() {
            patch = edited;
        }
    }
}

#[test]
fn a_patch_after_random_edits_equals_the_patch_read_from_its_text() {
    let all = files::shipped_files().into_iter().chain(files::test_patch_files());
    for (number, file) in all.enumerate() {
        let first = patch_of(&file);
        if Circuit::new(&first).is_ok() {
            check_random_edits(&first, 7 + number as u64);
        }
    }
}

#[test]
fn a_patch_with_nested_macros_after_random_edits_equals_the_patch_read_from_its_text() {
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
        check_random_edits(&first, seed);
    }
}

/// The messages of the errors of a report, without warnings.
fn error_messages(report: &Report) -> Vec<String> {
    let errors = report.findings.iter().filter(|finding| finding.code.severity() == Severity::Error);
    errors.map(|finding| finding.message.clone()).collect()
}

/// A patch with an integrator, a pot and a summer, without a loop.
fn decay() -> PatchBuilder {
    volts("decay")
        .parameter("T", 0.1, "s", [0.01, 1.0])
        .drive("u", "volt", element("step").set("height", 10))
        .element("A1", element("integrator").cords("x1", ["u"]).set("initial", 50))
        .element("P1", element("pot").cord("in", "A1").set("setting", 0.5))
        .element("S1", element("summer").cords("x1", ["P1"]))
}

#[test]
fn a_fault_after_an_edit_is_reported_at_its_position_in_the_edited_text() {
    let patch = decay().build().unwrap();
    let mut editor = patch.edit();
    editor.add_cord("S1", "x10", "A9").unwrap();
    let edited = editor.finish("wrong.json").unwrap();
    let report = Circuit::new(&edited).unwrap_err();
    assert_eq!(error_messages(&report), ["S1 is driven by A9, which is not in the patch"]);
    let span = report.findings[0].span.unwrap();
    assert_eq!(&report.text[span.start..span.end], "\"A9\"");
    assert_eq!((report.file.as_str(), report.text.as_str()), ("wrong.json", edited.text()));
    let mut editor = patch.edit();
    editor.set_setting("P1", "setting", 1.5).unwrap();
    let edited = editor.finish("wrong.json").unwrap();
    let report = Circuit::new(&edited).and_then(|circuit| Program::new(&circuit).map(drop)).unwrap_err();
    let span = report.findings.iter().find_map(|finding| finding.span).unwrap();
    assert_eq!(&report.text[span.start..span.end], "1.5");
}

#[test]
fn equations_can_be_set() {
    let patch = decay().equation("u = 0").build().unwrap();
    let edited = |equations: &[&str]| {
        let mut editor = patch.edit();
        editor.set_equations(equations);
        editor.finish("decay.json").unwrap()
    };
    let right = edited(&["q = u / T", "u' = -q"]);
    let texts: Vec<_> = right.equations.iter().map(|placed| placed.value.text()).collect();
    assert_eq!(texts, ["q = u / T", "u' = -q"]);
    assert_equals_its_text(&right, "equations");
    assert_equals_its_text(&edited(&[]), "no equations");
    for (wrong, part) in [("u = T'", "T'"), ("u = 2 +", ""), ("u' = u / T / T", "u' = u / T / T")] {
        let edited = edited(&["q = u", wrong]);
        let report = Circuit::new(&edited).unwrap_err();
        let span = report.findings[0].span.unwrap();
        assert_eq!(&report.text[span.start..span.end], part, "{report}");
        assert_equals_its_text(&edited, wrong);
    }
}

#[test]
fn elements_of_an_edited_patch_have_their_positions_in_the_edited_text() {
    let patch = decay().build().unwrap();
    let mut editor = patch.edit();
    editor.put_element("N1", element("inverter").cord("in", "S1"));
    editor.set_title("a title\nof two lines");
    let edited = editor.finish("decay.json").unwrap();
    let read = Patch::parse("decay.json", edited.text()).unwrap();
    let [edited, read] = [edited, read].map(|patch| Circuit::new(&patch).unwrap());
    for name in ["u", "A1", "N1"] {
        assert_eq!(edited.position_of(name), read.position_of(name));
        assert!(edited.position_of(name).is_some(), "{name}");
    }
    assert_eq!(edited.position_of("+100"), None);
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
    let by_path = patch.with_edits(
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
fn edits_of_one_batch_at_the_same_place_are_merged() {
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
    assert_equals_its_text(&edited, "one batch");
}

#[test]
fn several_batches_are_rendered_in_order_whether_or_not_the_text_is_read_between_them() {
    let patch = decay().build().unwrap();
    let add_batch = |patch: &Patch, value: f64| {
        let mut editor = patch.edit();
        editor.set_parameter("T", value).unwrap();
        editor.put_parameter(&format!("k{}", 100.0 * value), ParameterBuilder::new(value, "1"));
        editor.finish("decay.json").unwrap()
    };
    let first = add_batch(&patch, 0.25);
    let before_rendering = add_batch(&first, 0.5);
    assert!(first.text().contains("k25"));
    let after_rendering = add_batch(&first, 0.5);
    assert_eq!(before_rendering.text(), after_rendering.text());
    assert_eq!(after_rendering.parameters.keys().collect::<Vec<_>>(), ["T", "k25", "k50"]);
    assert_equals_its_text(&add_batch(&after_rendering, 0.75), "three batches");
}

#[test]
fn an_edit_of_a_missing_part_is_an_error() {
    let patch = decay().build().unwrap();
    let mut editor = patch.edit();
    let message = |result: Result<(), EditError>| result.unwrap_err().to_string();
    assert_eq!(message(editor.set_parameter("U", 1.0)), "there is no parameter U in the patch");
    assert_eq!(message(editor.set_parameter("T", f64::NAN)), "T must be a finite number");
    assert_eq!(message(editor.set_initial("A9", 1)), "there is no element A9 in the patch");
    assert_eq!(message(editor.set_initial("P1", 1)), "there is no setting initial in the patch");
    assert_eq!(message(editor.put_table_drive("v", "linear")), "there is no drive v in the patch");
    assert_eq!(message(editor.add_cord("A9", "x1", "A1")), "there is no element A9 in the patch");
    editor.put(["run", "nowhere", "key"], Value::from(1));
    assert_eq!(
        editor.finish("p.json").unwrap_err().to_string(),
        "there is no run/nowhere/key in the document"
    );
}

#[test]
fn a_value_put_at_a_path_is_in_the_fields_of_the_edited_patch() {
    let mut editor = patch("delay-line").edit();
    editor.put(["run", "for"], 0.125);
    editor.put(["title"], "shorter");
    let edited = editor.finish("shorter.json").unwrap();
    assert_eq!(edited.run.duration.as_ref().unwrap().value, 0.125);
    assert_eq!(edited.title, "shorter");
    assert_equals_its_text(&edited, "put");
}
