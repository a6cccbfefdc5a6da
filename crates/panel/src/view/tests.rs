use patchcord_core::ir::Program;
use patchcord_core::patch::TableAccess;
use serde_json::json;

use super::*;
use crate::command::{Command, CordEnd};
use crate::compiled::compile;
use crate::event::{JackView, SettingView};

/// The document of a shipped patch.
fn opened(name: &str) -> Document {
    let text = std::fs::read_to_string(format!("../../patches/{name}")).unwrap();
    Document::open(name, &text, &TableAccess::Below("../../patches/lessons".into())).unwrap()
}

/// The view of a shipped patch.
fn view(name: &str) -> PatchView {
    viewed(&opened(name))
}

/// The view of a document with what the checker reports about it.
fn viewed(document: &Document) -> PatchView {
    let (report, compiled) = compile(document.patch());
    patch_view(document, &report, compiled.is_some())
}

/// An element of a view.
fn element<'v>(view: &'v PatchView, name: &str) -> &'v ElementView {
    view.elements.iter().find(|element| element.name == name).unwrap()
}

/// A setting of an element.
fn setting<'v>(view: &'v PatchView, name: &str, setting: &str) -> &'v SettingView {
    element(view, name).settings.iter().find(|one| one.name == setting).unwrap()
}

/// The names of the jacks of an element.
fn jack_names(element: &ElementView) -> Vec<&str> {
    element.jacks.iter().map(|jack| jack.name.as_str()).collect()
}

/// A jack of an element.
fn jack<'v>(view: &'v PatchView, name: &str, jack: &str) -> &'v JackView {
    element(view, name).jacks.iter().find(|one| one.name == jack).unwrap()
}

/// Checks the signal, the unit and the value of one volt of an output.
fn assert_output(view: &PatchView, name: &str, signal: Option<&str>, unit: &str, per_volt: f64) {
    let output = view.outputs.iter().find(|output| output.name == name).unwrap();
    assert_eq!((output.signal.as_deref(), output.unit.as_str()), (signal, unit), "{name}");
    assert_near(Some(output.per_volt), per_volt);
}

/// Checks that two numbers agree to 1e-12 of their size.
fn assert_near(found: Option<f64>, expected: f64) {
    let found = found.expect("a value");
    assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{found} instead of {expected}");
}

#[test]
fn the_lesson_has_its_head_parameters_and_parts() {
    let view = view("lessons/mass-and-spring.json");
    assert_eq!((view.revision, view.machine.as_str(), view.time_scale), (1, "solartron-1451", 1.0));
    assert_eq!((view.duration, view.step, view.runs), (Some(3.0), Some(1e-3), true));
    let k = &view.parameters[1];
    assert_eq!((k.name.as_str(), k.value, k.unit.as_str(), k.range), ("k", 40.0, "N/m", Some([1.0, 100.0])));
    let used: Vec<_> = view.parts.iter().map(|part| (part.key.as_str(), part.used, part.available)).collect();
    let expected = [
        ("summers", 2, Some(16)),
        ("integrators", 2, Some(8)),
        ("fixed_pots", 3, Some(12)),
        ("free_pots", 0, Some(6)),
        ("diode_pairs", 0, Some(4)),
        ("multipliers", 2, Some(2)),
    ];
    assert_eq!(used, expected);
    assert_eq!((view.undo, view.redo), (None, None));
}

#[test]
fn the_outputs_of_the_lesson_stand_for_its_signals() {
    let view = view("lessons/mass-and-spring.json");
    let names: Vec<_> = view.outputs.iter().map(|output| output.name.as_str()).collect();
    let expected = ["+100", "-100", "ground", "A1", "A2", "B1", "P1", "M1", "M2", "P2", "P3", "B2"];
    assert_eq!(names, expected);
    assert_output(&view, "+100", None, "V", 1.0);
    assert_output(&view, "A2", None, "V", 1.0);
    assert_output(&view, "A1", Some("v"), "mm/s", 10.0);
    assert_output(&view, "P3", Some("kinetic"), "mJ", 50.0);
    assert_output(&view, "B2", Some("total"), "mJ", -5.0);
    let total = &view.signals[4];
    assert_eq!((total.name.as_str(), total.at.as_str()), ("total", "B2"));
    assert_near(Some(total.per_volt), -5.0);
}

#[test]
fn settings_have_values_and_the_parameters_behind_them() {
    let view = view("lessons/mass-and-spring.json");
    let pot = setting(&view, "P1", "setting");
    assert_near(pot.value, 0.4);
    assert_eq!(pot.text.as_deref(), Some("k / m * position / velocity / 10"));
    assert_eq!(
        (pot.parameters.as_slice(), pot.range),
        (&["m".to_owned(), "k".to_owned()][..], Some([0.0, 1.0]))
    );
    let initial = setting(&view, "A2", "initial");
    assert_near(initial.value, -80.0);
    assert_eq!((initial.unit.as_str(), initial.parameters.as_slice()), ("V", &["x0".to_owned()][..]));
    assert_near(setting(&view, "P2", "setting").value, 0.4);
    assert_near(setting(&view, "P3", "setting").value, 0.1);
    let default = setting(&view, "A1", "initial");
    assert_eq!((default.value, default.text.as_deref()), (Some(0.0), None));
    assert_eq!(setting(&view, "A1", "limit.upper").value, None);
    let mode = setting(&view, "M1", "mode");
    assert_eq!((mode.form, mode.value, mode.text.as_deref()), ("choice", Some(1.0), Some("product")));
    assert_eq!(mode.words, ["sum-of-squares", "product"]);
}

#[test]
fn jacks_have_gains_of_the_machine_and_cords() {
    let mut view = view("lessons/mass-and-spring.json");
    // The machine has no brakes, stops and mode relays.
    assert_eq!(jack_names(element(&view, "A1")), ["x1", "x10", "x100", "x1000"]);
    let x10 = jack(&view, "A1", "x10");
    assert_eq!((x10.label.as_str(), x10.required, x10.most), ("10", true, None));
    assert_eq!(x10.cords, ["P1"]);
    let x1 = jack(&view, "A1", "x1");
    assert_eq!((x1.required, x1.cords.len()), (false, 0));
    assert_eq!(jack_names(element(&view, "B2")), ["x1", "x10"]);
    let inverter = jack(&view, "B1", "in");
    assert_eq!((inverter.label.as_str(), inverter.most, inverter.required), ("1", Some(1), true));
    view.elements.retain(|element| element.lamp);
    let lamps: Vec<_> = view.elements.iter().map(|element| element.name.as_str()).collect();
    assert_eq!(lamps, ["A1", "A2", "B1", "M1", "M2", "B2"]);
}

#[test]
fn an_unlimited_machine_shows_the_gains_in_use_and_the_usual_ones() {
    let text = r#"{"patchcord": 1, "elements": {
        "A1": {"kind": "integrator", "in": {"x2.5": ["A1", "A1"]}},
        "P1": {"kind": "pot", "in": {"x1": ["A1"]}, "setting": 0.5}}}"#;
    let document = Document::open("p.json", text, &TableAccess::None).unwrap();
    let view = viewed(&document);
    let names = jack_names(element(&view, "A1"));
    assert_eq!(names, ["x1", "x2.5", "x10", "brake_x1", "brake_x10", "gap", "reset"]);
    assert_eq!(jack(&view, "A1", "x2.5").cords, ["A1", "A1"]);
    assert_eq!(jack(&view, "A1", "brake_x10").label, "brake 10");
    // A jack that a pot does not have is shown, so that its cord can be pulled.
    assert_eq!(jack_names(element(&view, "P1")), ["in", "x1"]);
    assert!(!view.runs);
    assert_eq!(setting(&view, "P1", "setting").value, Some(0.5));
}

#[test]
fn the_final_circuit_of_the_thesis_has_the_right_values() {
    let view = view("thesis/fig-8-16.json");
    let wiper = setting(&view, "DZ", "setting");
    assert_near(wiper.value, 771.0 / (771.0 + 50.0 * 45.36));
    assert_eq!(wiper.parameters, ["Fs"]);
    let names: Vec<_> = element(&view, "DZ").jacks.iter().map(|jack| jack.label.as_str()).collect();
    assert_eq!(names, ["in", "+VB", "−VB"]);
    let parts = &element(&view, "DZ").parts;
    assert_eq!(parts[0], ("free_pots".to_owned(), vec!["PB1".to_owned(), "PB2".to_owned()]));
    assert_eq!(parts[1], ("diode_pairs".to_owned(), vec!["D1D2".to_owned()]));
    assert_near(setting(&view, "PC2", "setting").value, 0.254e-3 / 2.54e-3);
    assert_eq!(setting(&view, "B2", "limit.upper").value, Some(10.0));
    let rate = setting(&view, "v_i", "rate");
    assert_near(rate.value, 1.2e-3);
    assert_eq!((rate.unit.as_str(), element(&view, "v_i").family), ("m/s2", "drive"));
    let closed = setting(&view, "KS1", "closed");
    assert_eq!((closed.form, closed.value, closed.text.as_deref()), ("flag", Some(1.0), Some("true")));
    assert_eq!(jack(&view, "U", "in").cords, ["A3", "B3"]);
    assert_eq!(jack(&view, "U", "in").most, Some(2));
    assert_output(&view, "M1", Some("friction_level"), "N", 771.0 / 50.0);
    assert_output(&view, "v_i", Some("v_i"), "m/s", 0.254e-3);
}

#[test]
fn a_parameter_behind_a_scale_is_found() {
    let text = r#"{"patchcord": 1, "parameters": {"F": {"value": 10, "unit": "N"}, "q": {"value": 1, "unit": "1"}},
        "scales": {"half": {"per_volt": "force / 2", "unit": "N"}, "force": {"per_volt": "F / 5", "unit": "N"}},
        "elements": {"A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": "3 / half"}}}"#;
    let document = Document::open("p.json", text, &TableAccess::None).unwrap();
    let view = viewed(&document);
    assert_eq!(setting(&view, "A1", "initial").parameters, ["F"]);
}

#[test]
fn a_fault_leaves_the_values_that_do_not_depend_on_it() {
    let mut document = opened("lessons/mass-and-spring.json");
    // B1 and B2 drive each other, so the loop with the multiplier M1 has two solutions.
    for command in [
        json!({"command": "unplug", "element": "B1", "jack": "in", "from": "A2"}),
        json!({"command": "plug", "element": "B1", "jack": "in", "from": "B2"}),
        json!({"command": "plug", "element": "B2", "jack": "x1", "from": "B1"}),
    ] {
        document.apply(&serde_json::from_value(command).unwrap()).unwrap();
    }
    let looped = viewed(&document);
    assert!(!looped.runs);
    assert_near(setting(&looped, "P1", "setting").value, 0.4);
    assert_near(setting(&looped, "A2", "initial").value, -80.0);
    assert_output(&looped, "P3", Some("kinetic"), "mJ", 50.0);
    // A formula in a wrong unit has no value.
    let mut document = opened("lessons/mass-and-spring.json");
    let command = json!({"command": "setting", "element": "P1", "setting": "setting", "value": "k / m"});
    document.apply(&serde_json::from_value(command).unwrap()).unwrap();
    let mismatched = viewed(&document);
    assert!(!mismatched.runs);
    assert_eq!(setting(&mismatched, "P1", "setting").value, None);
    assert_near(setting(&mismatched, "A2", "initial").value, -80.0);
    assert_near(setting(&mismatched, "P2", "setting").value, 0.4);
}

#[test]
fn an_instance_shows_its_ports() {
    let view = view("lessons/heat-rod.json");
    let cell = element(&view, "C1");
    assert_eq!((cell.family, cell.kind.as_str(), cell.lamp), ("instance", "cell", true));
    assert_eq!(cell.outputs, ["C1.flow", "C1.u"]);
    assert_eq!(jack_names(cell), ["left", "right"]);
    assert_eq!(jack(&view, "C1", "right").cords, ["C2.flow"]);
    assert_eq!(jack(&view, "C1", "left").most, Some(1));
    let parts: Vec<_> = cell.parts.iter().map(|(key, _)| key.as_str()).collect();
    assert_eq!(parts, ["integrators", "fixed_pots"]);
    assert_output(&view, "C1.u", Some("T1"), "K", -1.0);
    assert_output(&view, "hot", Some("hot"), "K", 1.0);
    assert_eq!(view.signals[0].at, "C1.u");
    assert!(view.elements.iter().all(|element| element.name != "C1.A"));
}

#[test]
fn settings_of_instances_have_the_units_of_the_macro() {
    let view = view("thesis/fig-4-07.json");
    let instance = view.elements.iter().find(|element| element.kind == "slideway").unwrap();
    let limit = instance.settings.iter().find(|setting| setting.name == "limit").unwrap();
    assert_eq!((limit.unit.as_str(), limit.form), ("m/s", "number"));
    assert!(limit.value.is_some_and(|value| value > 0.0));
}

#[test]
fn loose_cords_and_labels_of_steps_are_shown() {
    let mut document = opened("lessons/mass-and-spring.json");
    let end = CordEnd::Output { output: "B1".to_owned() };
    let command = Command::LooseCord { end: end.clone(), at: [3.0, 4.0], replaces: None };
    document.apply(&command).unwrap();
    let view = viewed(&document);
    assert_eq!(view.loose, [LooseView { id: 1, end, at: [3.0, 4.0] }]);
    assert_eq!((view.revision, view.undo.as_deref()), (2, Some("drop an end of a cord")));
}

#[test]
fn the_greeting_lists_kinds_and_machines() {
    let Event::Hello { protocol, kinds, machines } = hello() else { panic!("another event") };
    assert_eq!((protocol, kinds.len()), (PROTOCOL_VERSION, REGISTRY.len()));
    let integrator = kinds.iter().find(|kind| kind.name == "integrator").unwrap();
    assert_eq!(
        (integrator.prefix.as_str(), integrator.parts.as_slice()),
        ("A", &["integrators".to_owned()][..])
    );
    assert_eq!(machines[0].summer_gains, [1.0, 10.0]);
    assert_eq!(machines[0].parts.as_ref().map(Vec::len), Some(6));
    assert_eq!(machines[1].parts, None);
}

#[test]
fn equations_name_what_can_be_turned_and_watched() {
    let circuit = Circuit::new(opened("lessons/lorenz.json").patch()).unwrap();
    let program = Program::new(&circuit).unwrap();
    let view = equations(&circuit, &program);
    let texts: Vec<_> = view.equations.iter().map(|equation| equation.text.as_str()).collect();
    assert_eq!(texts, ["x' = sigma (y - x)", "y' = rho x - y - x z", "z' = x y - beta z"]);
    assert_eq!(view.equations[0].names, ["sigma", "x", "y"]);
    assert!(view.more.starts_with("at t = 0:") && view.latex.contains("align"));
    assert_eq!((view.stated.len(), view.message), (circuit.patch().equations.len(), None));
}
