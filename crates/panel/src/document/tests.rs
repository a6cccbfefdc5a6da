mod cords;
mod elements;

use std::fs;

use serde_json::json;

use super::*;
use crate::command::CordName;

/// The lesson of a mass on a spring.
fn lesson() -> Document {
    shipped("lessons/mass-and-spring.json")
}

/// A shipped patch.
fn shipped(name: &str) -> Document {
    let text = fs::read_to_string(format!("../../patches/{name}")).unwrap();
    Document::open(name, &text, &TableAccess::Below("../../patches/lessons".into())).unwrap()
}

/// A command that plugs a cord in.
fn plug(element: &str, jack: &str, from: &str) -> Command {
    let [element, jack, from] = [element, jack, from].map(str::to_owned);
    Command::Plug { element, jack, from }
}

/// A command that pulls a cord out.
fn unplug(element: &str, jack: &str, from: &str) -> Command {
    let [element, jack, from] = [element, jack, from].map(str::to_owned);
    Command::Unplug { element, jack, from }
}

/// A command that moves an end of a cord.
fn move_cord([element, jack, from]: [&str; 3], to: CordEnd) -> Command {
    let [element, jack, from] = [element, jack, from].map(str::to_owned);
    Command::MoveCord { element, jack, from, to }
}

/// An input end.
fn input(element: &str, jack: &str) -> CordEnd {
    CordEnd::Input { element: element.to_owned(), jack: jack.to_owned() }
}

/// An output end.
fn output(name: &str) -> CordEnd {
    CordEnd::Output { output: name.to_owned() }
}

/// A command that sets a parameter.
fn turn(name: &str, value: f64) -> Command {
    Command::Parameter { name: name.to_owned(), value }
}

/// A command that sets a setting.
fn set(element: &str, setting: &str, value: Value) -> Command {
    Command::Setting { element: element.to_owned(), setting: setting.to_owned(), value }
}

/// A command that adds an element with the next free name.
fn add(kind: &str) -> Command {
    Command::AddElement { kind: kind.to_owned(), name: None }
}

/// A command that replaces the text.
fn replaced(text: &str) -> Command {
    Command::Replace { text: text.to_owned() }
}

/// A command that drops an end of a cord on the panel.
fn drop_end(end: CordEnd, replaces: Option<[&str; 3]>) -> Command {
    let replaces = replaces.map(|ends| {
        let [element, jack, from] = ends.map(str::to_owned);
        CordName { element, jack, from }
    });
    Command::LooseCord { end, at: [12.5, 40.0], replaces }
}

/// The message with which a command is refused. The document stays as it was.
fn refusal(document: &mut Document, command: &Command) -> Refusal {
    let (text, revision) = (document.patch().text().to_owned(), document.revision());
    let refusal = document.apply(command).unwrap_err();
    assert_eq!((document.patch().text(), document.revision()), (text.as_str(), revision));
    refusal
}

/// The cords of an element.
fn cords<'d>(document: &'d Document, element: &str) -> Vec<(&'d str, &'d str)> {
    document.patch().written_cords(element).collect()
}

#[test]
fn every_command_is_reverted_to_the_identical_text_and_repeated() {
    let cases = [
        (turn("m", 2.0), "turn m"),
        (set("P1", "setting", json!(0.25)), "turn P1"),
        (set("A2", "initial", json!("x0 / position")), "set initial of A2"),
        (set("A1", "limit.upper", json!(50)), "set limit.upper of A1"),
        (set("A2", "initial", Value::Null), "set initial of A2"),
        (Command::TimeScale { value: 2.0 }, "set the time scale"),
        (plug("A1", "x1", "P2"), "plug P2 into A1.x1"),
        (unplug("P1", "in", "B1"), "pull B1 out of P1.in"),
        (move_cord(["P1", "in", "B1"], output("A2")), "move the cord from B1 in P1.in to A2"),
        (move_cord(["A1", "x10", "P1"], input("A1", "x1")), "move the cord from P1 in A1.x10 to A1.x1"),
        (drop_end(output("B1"), Some(["P1", "in", "B1"])), "drop an end of a cord"),
        (drop_end(output("B1"), None), "drop an end of a cord"),
        (Command::ClearCords, "remove all cords"),
        (replaced(r#"{"patchcord": 1, "elements": {}}"#), "replace the text of the patch"),
        (add("integrator"), "add A3"),
        (add("sine"), "add E1"),
        (Command::RemoveElement { name: "P3".to_owned() }, "remove P3"),
    ];
    for (command, label) in cases {
        let mut document = lesson();
        let before = document.state();
        document.apply(&command).unwrap_or_else(|refusal| panic!("{command:?}: {}", refusal.message));
        let after = document.state();
        assert_ne!(before, after, "{label}");
        assert_eq!((document.undo_label(), document.redo_label()), (Some(label), None));
        document.undo().unwrap();
        assert_eq!(document.state(), before, "{label}");
        assert_eq!((document.undo_label(), document.redo_label()), (None, Some(label)));
        assert_eq!(document.patch().text(), &*before.text);
        document.redo().unwrap();
        assert_eq!(document.state(), after, "{label}");
    }
    assert_eq!(lesson().undo().unwrap_err().message, "there is nothing to undo");
    assert_eq!(lesson().redo().unwrap_err().message, "there is nothing to redo");
}

#[test]
fn edits_change_only_their_place_in_the_text() {
    let mut document = lesson();
    let original = document.patch().text().to_owned();
    assert_eq!(document.apply(&set("P1", "setting", json!(0.25))), Ok(Change::Patch));
    let expected = original.replace("\"k / m * position / velocity / 10\"", "0.25");
    assert_eq!(document.patch().text(), expected);
    document.apply(&plug("A1", "x1", "P2")).unwrap();
    assert_eq!(cords(&document, "A1"), [("x10", "P1"), ("x1", "P2")]);
    document.apply(&unplug("A1", "x10", "P1")).unwrap();
    assert_eq!(cords(&document, "A1"), [("x1", "P2")]);
    document.apply(&move_cord(["P1", "in", "B1"], output("A2"))).unwrap();
    assert_eq!(cords(&document, "P1"), [("in", "A2")]);
    document.apply(&Command::TimeScale { value: 2.0 }).unwrap();
    assert_eq!(document.patch().time_scale, 2.0);
    document.apply(&Command::ClearCords).unwrap();
    let elements = document.patch().elements.keys();
    assert!(elements.clone().all(|name| cords(&document, name).is_empty()));
    assert_eq!(elements.len(), 9);
    for _ in 0..6 {
        document.undo().unwrap();
    }
    assert_eq!(document.patch().text(), original);
}

#[test]
fn a_parameter_is_set_without_compiling_also_by_undo() {
    let mut document = lesson();
    let change = |value| Ok(Change::Parameter { name: "m".to_owned(), value });
    // All turns of one knob are one step.
    for value in [2.0, 3.0, 4.0] {
        assert_eq!(document.apply(&turn("m", value)), change(value));
    }
    assert_eq!(document.patch().parameters["m"].value, 4.0);
    assert_eq!(document.undo(), change(1.0));
    assert_eq!(document.undo_label(), None);
    assert_eq!(document.redo(), change(4.0));
    document.apply(&turn("k", 50.0)).unwrap();
    document.apply(&turn("m", 5.0)).unwrap();
    assert_eq!(document.undo(), change(4.0));
    assert_eq!(document.undo_label(), Some("turn k"));
}

#[test]
fn a_parameter_outside_its_range_is_refused() {
    let mut document = lesson();
    let refused = refusal(&mut document, &turn("m", 20.0));
    assert_eq!(refused.message, "m = 20 kg is outside its range 1 ... 10 kg: choose a value within it");
    assert_eq!(refused.place.unwrap().parameter.as_deref(), Some("m"));
    let refused = refusal(&mut document, &turn("mass", 2.0));
    assert_eq!(refused.message, "there is no parameter mass: known here: m, k, x0");
    // A value inside the range that would turn a pot beyond its end.
    let text = r#"{"patchcord": 1, "parameters": {"a": {"value": 0.5, "unit": "1", "range": [0, 2]}},
        "elements": {"P1": {"kind": "pot", "in": "+100", "setting": "a"}}, "record": ["P1"]}"#;
    let mut document = Document::open("p.json", text, &TableAccess::None).unwrap();
    let refused = refusal(&mut document, &turn("a", 1.5));
    assert!(refused.message.starts_with("a cannot be 1.5: "), "{}", refused.message);
    assert!(document.apply(&turn("a", 1.0)).is_ok());
}

#[test]
fn a_fault_elsewhere_does_not_stop_a_parameter() {
    let mut document = lesson();
    document.apply(&unplug("P1", "in", "B1")).unwrap();
    assert!(document.apply(&turn("m", 2.0)).is_ok());
}

#[test]
fn wrong_settings_are_refused_with_what_to_write() {
    let mut document = lesson();
    let cases = [
        (
            "P1",
            "setting",
            json!(1.5),
            "setting of P1 is 1.5, outside 0 ... 1: choose a value within the range",
        ),
        ("P1", "setting", json!(true), "setting of P1 is a number or a formula"),
        ("P1", "setting", Value::Null, "setting of P1 cannot be removed: set it to another value"),
        ("P1", "initial", json!(1), "initial of P1 does not exist: known here: setting"),
        ("M1", "mode", json!("sum"), "mode of M1 is one of these words: sum-of-squares, product"),
        (
            "A1",
            "initial",
            json!(120),
            "initial of A1 is 120, outside -100 ... 100 V: choose a value within the range",
        ),
        (
            "resistor",
            "initial",
            json!(0),
            "there is no element resistor: known here: A1, A2, B1, P1, M1, M2, P2, P3, B2",
        ),
    ];
    for (element, setting, value, expected) in cases {
        let refused = refusal(&mut document, &set(element, setting, value));
        assert_eq!(refused.message, expected);
    }
    let refused = refusal(&mut document, &set("P1", "setting", json!("k *")));
    assert!(refused.message.starts_with("setting of P1 is not a formula: "), "{}", refused.message);
    assert_eq!(refused.place.unwrap().setting.as_deref(), Some("setting"));
    // A wrong unit is a finding of the checker. A text that is a number becomes a number.
    assert!(document.apply(&set("P1", "setting", json!("k"))).is_ok());
    document.apply(&set("P1", "setting", json!(" 0.25"))).unwrap();
    assert_eq!(document.patch().value()["elements"]["P1"]["setting"], json!(0.25));
    document.apply(&set("M1", "mode", json!("sum-of-squares"))).unwrap();
    for value in [0.0, f64::NAN, -1.0] {
        refusal(&mut document, &Command::TimeScale { value });
    }
}

#[test]
fn settings_of_drives_and_instances_are_edited() {
    let mut document = shipped("thesis/fig-8-16.json");
    document.apply(&set("v_i", "rate", json!(2e-3))).unwrap();
    document.apply(&set("v_i", "turn", Value::Null)).unwrap();
    let drive = &document.patch().value()["drives"]["v_i"];
    let expected = json!({"kind": "ramp", "scale": "velocity", "start": "v_start", "rate": 0.002});
    assert_eq!(drive, &expected);
    let mut document = shipped("thesis/fig-4-07.json");
    let (name, _) =
        document.patch().instances.iter().find(|(_, instance)| instance.parent.is_none()).unwrap();
    let name = name.clone();
    document.apply(&set(&name, "static", json!(500))).unwrap();
    assert_eq!(document.patch().value()["elements"][&name]["static"], json!(500));
}

#[test]
fn another_text_keeps_the_loose_cords_that_have_their_jacks() {
    let mut document = lesson();
    document.apply(&drop_end(output("B1"), None)).unwrap();
    document.apply(&drop_end(input("A1", "x1"), None)).unwrap();
    let text = r#"{"patchcord": 1, "elements": {"A1": {"kind": "integrator", "in": {"x1": ["+100"]}}}}"#;
    assert_eq!(document.apply(&replaced(text)), Ok(Change::Patch));
    assert_eq!((document.patch().text(), document.patch().file()), (text, "lessons/mass-and-spring.json"));
    assert_eq!(document.loose().iter().map(|cord| cord.id).collect::<Vec<_>>(), [2]);
    document.undo().unwrap();
    assert_eq!(document.loose().len(), 2);
    document.redo().unwrap();
    let mut restored = Document::restore(&document.snapshot(), &TableAccess::None).unwrap();
    assert_eq!((restored.patch().text(), restored.loose().len()), (text, 1));
    for _ in 0..3 {
        restored.undo().unwrap();
    }
    assert_eq!((restored.patch().text(), restored.loose().len()), (lesson().patch().text(), 0));
    // The same text is no step.
    let revision = document.revision();
    document.apply(&replaced(text)).unwrap();
    assert_eq!(document.revision(), revision);
}

#[test]
fn changes_of_the_mode_are_steps() {
    let mut document = lesson();
    document.record_mode(Mode::InitialCondition, Mode::Operate);
    document.record_mode(Mode::Operate, Mode::Operate);
    assert_eq!(document.undo_label(), Some("change to operate"));
    let revision = document.revision();
    assert_eq!(document.undo(), Ok(Change::Mode(Mode::InitialCondition)));
    assert_eq!(document.redo(), Ok(Change::Mode(Mode::Operate)));
    assert_eq!(document.revision(), revision);
}

#[test]
fn a_snapshot_keeps_the_patch_the_loose_cords_and_the_history() {
    let mut document = lesson();
    let original = document.patch().text().to_owned();
    document.apply(&turn("m", 2.0)).unwrap();
    document.apply(&drop_end(output("B1"), Some(["P1", "in", "B1"]))).unwrap();
    document.record_mode(Mode::Hold, Mode::Operate);
    document.apply(&add("pot")).unwrap();
    document.undo().unwrap();
    let mut restored =
        Document::restore(&document.snapshot(), &TableAccess::Below("../../patches/lessons".into())).unwrap();
    assert_eq!((restored.state(), restored.patch().file()), (document.state(), document.patch().file()));
    assert_eq!((restored.undo_label(), restored.redo_label()), (Some("change to operate"), Some("add P4")));
    assert_eq!(restored.snapshot(), document.snapshot());
    restored.redo().unwrap();
    for _ in 0..4 {
        restored.undo().unwrap();
    }
    assert_eq!((restored.patch().text(), restored.loose().len()), (original.as_str(), 0));
    // A new loose cord gets a number that no cord of the history has.
    restored.apply(&drop_end(output("B1"), None)).unwrap();
    assert_eq!(restored.loose()[0].id, 2);
}

#[test]
fn data_that_are_no_snapshot_are_refused() {
    let refuse = |snapshot: &Value| Document::restore(snapshot, &TableAccess::None).unwrap_err().message;
    assert!(refuse(&json!({"file": "p.json"})).starts_with("the saved session cannot be read"));
    let mut snapshot = lesson().snapshot();
    snapshot["present"]["text"] = json!(5);
    let message = "the saved session cannot be read: a text is missing; open its patch instead";
    assert_eq!(refuse(&snapshot), message);
    let mut snapshot = lesson().snapshot();
    snapshot["texts"][0] = json!("[]");
    assert!(refuse(&snapshot).contains("the patch must be an object"));
}

#[test]
fn a_text_that_is_not_a_patch_is_refused_with_the_report() {
    let refused = Document::open("p.json", "{\"patchcord\": 1,}", &TableAccess::None).unwrap_err();
    let (message, place) = refused.message.split_once('\n').unwrap();
    assert!(message.starts_with("error[syntax]: "), "{message}");
    assert_eq!(place, " --> p.json:1:16\n  = help: remove the last comma");
    let mut document = lesson();
    let refused = refusal(&mut document, &replaced("{\"patchcord\": 1,}"));
    assert!(refused.message.contains("remove the last comma"), "{}", refused.message);
    // Other faults are findings.
    assert_eq!(document.apply(&replaced(r#"{"patchcord": 1, "elements": 5}"#)), Ok(Change::Patch));
    assert!(Document::open("p.json", r#"{"patchcord": 1, "elements": 5}"#, &TableAccess::None).is_ok());
}
