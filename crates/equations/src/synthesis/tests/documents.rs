//! The documents of patches.

use serde_json::json;

use super::{Sketch, options};
use crate::graph::{FunctionKind, NodeId, Operation, Sum};
use crate::symbolic::Fraction;

/// A mass with a spring and a damper, released at x0.
fn mass_and_spring() -> Sketch {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "title": "Mass and spring", "source": "any first lesson", "note": "with a damper",
        "parameters": {"m": {"value": 1, "unit": "kg", "range": [1, 10]},
                       "k": {"value": 40, "unit": "N/m", "range": [1, 100]},
                       "c": {"value": 0.8, "unit": "N s/m"}, "x0": {"value": 80, "unit": "mm"}},
        "quantities": {"x": {"unit": "mm", "initial": "x0", "maximum": 100, "description": "position"},
                       "x'": {"unit": "mm/s", "initial": 0, "maximum": 1000}},
        "equations": ["m x'' = -k x - c x'"],
        "run": {"for": 3, "step": 1e-3, "every": 1e-2}}"#,
    );
    sketch.integral("x", "m", [0.08, 0.5], "x0", &[("1", 1)]);
    sketch.integral("x'", "m/s", [0.5, 3.2], "0", &[("-k/m", 0), ("-c/m", 1)]);
    sketch.with_quantities()
}

#[test]
fn a_mass_on_a_spring_is_patched_as_by_hand() {
    let patch = mass_and_spring().synthesis().patch;
    let document = patch.value();
    let elements = json!({
        "A1": {"kind": "integrator", "in": {"x10": ["B1"]}, "initial": "x0 / x", "note": "position"},
        "P1": {"kind": "pot", "in": "A1", "setting": "k / m * x / x_dot / 10", "note": "(k/m) x"},
        "P2": {"kind": "pot", "in": "A2", "setting": "c / m", "note": "(c/m) x'"},
        "A2": {"kind": "integrator", "in": {"x1": ["P2"], "x10": ["P1"]}, "note": "x'"},
        "B1": {"kind": "inverter", "in": "A2", "note": "- x'"}
    });
    assert_eq!(document["elements"], elements);
    let names: Vec<&String> = document["elements"].as_object().unwrap().keys().collect();
    assert_eq!(names, ["A1", "P1", "P2", "A2", "B1"]);
    assert_eq!(
        document["scales"],
        json!({"x": {"per_volt": 1, "unit": "mm", "description": "position"},
               "x_dot": {"per_volt": 10, "unit": "mm/s", "description": "x'"}})
    );
    assert_eq!(
        document["signals"],
        json!({"x": {"at": "A1", "scale": "x"}, "x_dot": {"at": "A2", "scale": "x_dot"}})
    );
    assert_eq!(document["record"], json!(["x", "x_dot"]));
    let pictures = json!([{"title": "x", "x": "t", "y": ["x"]}, {"title": "x'", "x": "t", "y": ["x_dot"]}]);
    assert_eq!(document["pictures"], pictures);
}

#[test]
fn the_texts_and_sections_of_the_problem_are_kept() {
    let sketch = mass_and_spring();
    let patch = sketch.synthesis().patch;
    let (made, stated) = (patch.value(), sketch.problem.patch.value());
    for key in ["title", "source", "note", "parameters", "run"] {
        assert_eq!(made[key], stated[key], "{key}");
    }
    let equations = json!(["m x'' = -k x - c x'", "x_dot = x'", "x(0) = x0", "x'(0) = 0"]);
    assert_eq!(made["equations"], equations);
    let keys: Vec<&String> = made.as_object().unwrap().keys().collect();
    let expected = [
        "patchcord",
        "title",
        "source",
        "note",
        "parameters",
        "scales",
        "equations",
        "elements",
        "signals",
        "run",
        "record",
        "pictures",
    ];
    assert_eq!(keys, expected);
    assert!(
        patch.text().contains("\n    \"B1\": {\"kind\": \"inverter\", \"in\": \"A2\", \"note\": \"- x'\"}\n")
    );
}

#[test]
fn the_machine_and_the_time_scale_are_written_if_they_differ_from_the_usual_ones() {
    let sketch = mass_and_spring();
    let mut scales = sketch.scales();
    scales.time_scale = 10.0;
    let machine = patchcord_core::machines::find("solartron-1451").unwrap();
    let patch = sketch.synthesis_with(&scales, &super::ScaleOptions { machine, ..options() }).patch;
    let document = patch.value();
    assert_eq!((&document["machine"], &document["time_scale"]), (&json!("solartron-1451"), &json!(10)));
    assert_eq!(document["elements"]["A1"]["in"], json!({"x1": ["B1"]}));
    // 40 x 0.001 / 0.01 / 10 = 0.4
    assert_eq!(document["elements"]["P1"]["setting"], "k / m * x / x_dot / time_scale");
    assert_eq!(document["elements"]["P2"]["setting"], "c / m / time_scale");
}

#[test]
fn the_steps_state_the_gain_rule_in_numbers() {
    let steps: Vec<String> = mass_and_spring().synthesis().steps.iter().map(|step| step.text()).collect();
    let expected = [
        "A1, x': 1 * 0.01 / 0.001 = 10 = 10",
        "A2, - (k/m) x: 40 * 0.001 / 0.01 = 4 = 10 * 0.4",
        "A2, - (c/m) x': 0.8 * 0.01 / 0.01 = 0.8 = 1 * 0.8",
    ];
    assert_eq!(steps, expected);
}

#[test]
fn two_syntheses_are_equal() {
    let sketch = mass_and_spring();
    let (one, other) = (sketch.synthesis(), sketch.synthesis());
    assert_eq!(one.patch.text(), other.patch.text());
    assert_eq!(one.outputs, other.outputs);
}

#[test]
fn names_differ_from_those_of_the_problem() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "parameters": {"A1": {"value": 2, "unit": "1/s"}, "P1": {"value": 1, "unit": "1"},
                                           "B1_dot": {"value": 1, "unit": "1/s2"}},
        "quantities": {"B1": {"unit": "1", "initial": 1}, "B1'": {"unit": "1/s"}},
        "equations": ["B1'' = -A1 B1' - B1_dot P1 B1"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.integral("B1", "1", [1.0, 1.0], "1", &[("1", 1)]);
    sketch.integral("B1'", "1/s", [1.0, 1.0], "0", &[("-B1_dot * P1", 0), ("-A1", 1)]);
    let patch = sketch.with_quantities().synthesis().patch;
    let scales: Vec<&String> = patch.scales.keys().collect();
    assert_eq!(scales, ["B1", "B1_dot_2"]);
    let elements: Vec<&String> = patch.elements.keys().collect();
    assert_eq!(elements, ["A2", "P2", "P3", "A3", "B2"]);
}

#[test]
fn a_quantity_without_terms_is_read_at_ground() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "quantities": {"x": {"unit": "m", "initial": 1}, "level": {"unit": "N"}},
        "equations": ["x' = 0", "level = 0"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.node(
        "x",
        "m",
        [1.0, 1.0],
        0.0,
        Operation::Integral { initial: Fraction::whole(1), rate: Sum::default() },
    );
    sketch.node("level", "N", [0.0, 0.0], 0.0, Operation::Sum(Sum::default()));
    let made = sketch.with_quantities().synthesis();
    assert_eq!(made.patch.signals["level"].element.value, "ground");
    assert_eq!(made.patch.value()["elements"]["A1"]["in"], json!({"x1": ["ground"]}));
    assert_eq!(made.outputs.len(), 1);
}

#[test]
fn a_drive_keeps_its_settings_and_gets_a_scale_for_its_peak() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "parameters": {"F": {"value": 30, "unit": "N"}},
        "quantities": {"p": {"unit": "N s", "initial": 0}},
        "drives": {"push": {"kind": "sine", "unit": "kN", "amplitude": "F", "frequency": 2, "offset": 0.01}},
        "equations": ["p' = -push"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.node("push", "N", [-20.0, 40.0], 0.0, Operation::Drive("push".to_owned()));
    sketch.integral("p", "N s", [10.0, 40.0], "0", &[("-1", 0)]);
    let patch = sketch.with_quantities().synthesis().patch;
    let expected = json!({"kind": "sine", "scale": "push", "amplitude": "F", "frequency": 2, "offset": 0.01});
    assert_eq!(patch.value()["drives"]["push"], expected);
    // 40 N are 80 V.
    assert_eq!(patch.value()["scales"]["push"], json!({"per_volt": 0.0005, "unit": "kN"}));
    assert_eq!(patch.value()["record"], json!(["p", "push"]));
    let pictures = json!([{"title": "p", "x": "t", "y": ["p"]}, {"title": "push", "x": "t", "y": ["push"]}]);
    assert_eq!(patch.value()["pictures"], pictures);
}

#[test]
fn elements_follow_the_signals_and_are_numbered_in_this_order() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "parameters": {"k": {"value": 0.5, "unit": "1/s"}, "q": {"value": 0.4, "unit": "1"}},
        "quantities": {"x": {"unit": "1", "initial": 0.1}, "share": {"unit": "1"}},
        "equations": ["x' = -k sin(x) x", "share = q x"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.integral("x", "1", [0.1, 0.01], "0.1", &[("-k", 2)]);
    let share = Operation::Sum(sketch.sum(&[("q", 0)]));
    sketch.node("share", "1", [0.0, 0.04], 0.0, share);
    sketch.node("sin(x) x", "1", [0.0, 0.01], 0.0, Operation::Product([NodeId(0), NodeId(3)]));
    let sine = Operation::Function { kind: FunctionKind::Sin, argument: sketch.term("1", 0) };
    sketch.node("sin(x)", "1", [0.0, 0.1], 0.0, sine);
    let patch = sketch.with_quantities().synthesis().patch;
    let names: Vec<&str> =
        patch.elements.keys().map(String::as_str).filter(|name| !name.starts_with('B')).collect();
    assert_eq!(names, ["F1", "M1", "P1", "A1", "P2"]);
    assert_eq!(
        patch.value()["elements"]["A1"]["initial"].as_str().map(|text| text.trim_start_matches('-')),
        Some("0.1 / x")
    );
    assert_eq!(patch.value()["scales"]["sin_x"]["description"], "sin(x)");
    assert_eq!(patch.signals["share"].element.value, "P2");
}

#[test]
fn a_number_in_degrees_becomes_volts() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "quantities": {"angle": {"unit": "deg", "initial": 40, "per_volt": 0.5}},
        "equations": ["angle' = 0"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    let initial = Fraction::number(40_f64.to_radians());
    let operation = Operation::Integral { initial, rate: Sum::default() };
    sketch.node("angle", "1", [0.7, 0.7], 0.0, operation);
    let patch = sketch.with_quantities().synthesis().patch;
    let initial = patch.value()["elements"]["A1"]["initial"].as_f64().unwrap();
    assert!((initial.abs() - 80.0).abs() < 1e-12, "{initial}");
}

/// The number 20 has the unit mm, which an equation cannot state.
#[test]
fn initial_values_with_a_unit_are_stated_if_a_parameter_has_it() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "parameters": {"b0": {"value": 3, "unit": "mm"}},
        "quantities": {"a": {"unit": "mm", "initial": 20}, "b": {"unit": "mm", "initial": "2 * b0"},
                       "c": {"unit": "1", "initial": 0.5}, "d": {"unit": "mm", "initial": 0}},
        "equations": ["a' = 0", "b' = 0", "c' = 0", "d' = 0"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.integral("a", "m", [0.02, 0.0], "0.02", &[]);
    sketch.integral("b", "m", [0.006, 0.0], "2 * b0", &[]);
    sketch.integral("c", "1", [0.5, 0.0], "0.5", &[]);
    sketch.integral("d", "m", [0.01, 0.0], "0", &[]);
    let patch = sketch.with_quantities().synthesis().patch;
    let stated = &patch.value()["equations"].as_array().unwrap()[4..];
    assert_eq!(stated, [json!("b(0) = 2 * b0"), json!("c(0) = 0.5"), json!("d(0) = 0")]);
}

#[test]
fn an_equation_with_a_table_is_not_stated_in_the_patch() {
    let mut sketch = Sketch::new(
        r#"{"patchcord": 1, "quantities": {"x": {"unit": "mm", "initial": 20}, "force": {"unit": "N"}},
        "tables": {"spring": {"in": "mm", "out": "N", "points": [[-50, -20], [0, 0], [50, 40]]}},
        "equations": ["x' = 0", "force = spring(x)"], "run": {"for": 1, "step": 1e-3}}"#,
    );
    sketch.node(
        "x",
        "m",
        [0.02, 0.02],
        0.0,
        Operation::Integral { initial: Fraction::number(0.02), rate: Sum::default() },
    );
    let curve = Operation::Curve { table: "spring".to_owned(), input: sketch.term("1", 0) };
    sketch.node("force", "N", [16.0, 16.0], 0.0, curve);
    let patch = sketch.with_quantities().synthesis().patch;
    assert_eq!(patch.value()["equations"], json!(["x' = 0"]));
    assert_eq!(patch.value()["elements"]["F1"]["kind"], "function-generator");
}
