//! The scale sets of the thesis: the computer gains of Fig 8.4 (set A) and of Fig 8.7 on (set B).

use patchcord_expr::Unit;

use super::Sketch;
use crate::graph::{NodeId, Operation};

/// The slideway of Fig 8.4 with maxima of position, force, acceleration and velocity, in mm, kN, m/s2 and mm/s.
fn slideway(parameters: &str, [position, force, acceleration, velocity]: [f64; 4]) -> Sketch {
    let text = format!(
        r#"{{"patchcord": 1, "title": "Slideway", "parameters": {{{parameters}}},
        "quantities": {{
            "x_o": {{"unit": "mm", "initial": 0, "maximum": {position}}},
            "x_error": {{"unit": "mm", "maximum": {position}}},
            "spring": {{"unit": "kN", "maximum": {force}}},
            "net": {{"unit": "kN", "maximum": {force}}},
            "a_o": {{"unit": "m/s2", "maximum": {acceleration}}},
            "v_o": {{"unit": "mm/s", "initial": 0, "maximum": {velocity}}}}},
        "drives": {{"x_i": {{"kind": "step", "unit": "mm", "height": 0.127}}}},
        "equations": ["x_error = x_i - x_o", "x_o' = v_o", "spring = K x_error", "net = spring - f v_o",
                      "a_o = net / M", "v_o' = a_o"],
        "run": {{"for": 0.25, "step": 2e-5, "every": 2e-4}}}}"#
    );
    let mut sketch = Sketch::new(&text);
    let around = |peak: f64| [-peak, peak];
    sketch.node("x_i", "m", [0.0, 0.127e-3], 0.0, Operation::Drive("x_i".to_owned()));
    sketch.integral("x_o", "m", [0.25e-3, 0.02], "0", &[("1", 5)]);
    let error = Operation::Sum(sketch.sum(&[("1", 0), ("-1", 1)]));
    sketch.node("x_error", "m", around(0.13e-3), 0.0, error);
    let spring = Operation::Sum(sketch.sum(&[("K", 2)]));
    sketch.node("spring", "N", around(2300.0), 0.0, spring);
    let net = Operation::Sum(sketch.sum(&[("1", 3), ("-f", 5)]));
    sketch.node("net", "N", around(2300.0), 0.0, net);
    sketch.integral("v_o", "m/s", [0.02, 5.0], "0", &[("1", 6)]);
    let acceleration = Operation::Sum(sketch.sum(&[("1/M", 4)]));
    sketch.node("a_o", "m/s2", around(5.0), 0.0, acceleration);
    sketch.with_quantities()
}

/// The computer gain from one quantity to another.
fn gain(sketch: &Sketch, output: &str, input: &str) -> f64 {
    let steps = sketch.synthesis().steps;
    let step = steps.iter().find(|step| step.output == output && step.input == input);
    step.unwrap_or_else(|| panic!("{input} is no input of {output}")).computer_gain
}

/// The setting of a pot with the text of its formula.
fn setting(sketch: &Sketch, output: &str, input: &str) -> (f64, String) {
    let made = sketch.synthesis();
    let step = made.steps.iter().find(|step| step.output == output && step.input == input).unwrap();
    let jacks = &made.patch.elements[&step.element].plugs;
    let pot = jacks.iter().map(|plug| plug.from.value.as_str()).find(|from| from.starts_with('P'));
    let pot = if step.element.starts_with('P') { Some(step.element.as_str()) } else { pot };
    let text = made.patch.value()["elements"][pot.unwrap()]["setting"].as_str().unwrap().to_owned();
    (step.setting.unwrap(), text)
}

const SET_A: &str = r#""M": {"value": 454, "unit": "kg"}, "K": {"value": 17.86e6, "unit": "N/m"},
    "f": {"value": 17.86e3, "unit": "N s/m"}"#;
const SET_B: &str = r#""M": {"value": 433, "unit": "kg"}, "K": {"value": 45e6, "unit": "N/m"},
    "f": {"value": 10.7e3, "unit": "N s/m"}"#;

#[test]
fn set_a_has_the_computer_gains_of_the_thesis() {
    let sketch = slideway(SET_A, [2.54, 45.36, 254.0, 254.0]);
    let scales = sketch.scales();
    let per_volt = |node: usize, unit: &str| Unit::parse(unit).unwrap().out_of_si(scales.per_volt[node]);
    let found = [per_volt(1, "mm"), per_volt(3, "N"), per_volt(6, "m/s2"), per_volt(5, "mm/s")];
    for (found, expected) in found.into_iter().zip([0.0254, 453.6, 2.54, 2.54]) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} instead of {expected}");
    }
    assert_eq!(scales.time_scale, 1.0);
    // The text rounds 1.0001, 0.3933 and 0.10001.
    let cases =
        [("spring", "x_error", 1.0), ("a_o", "net", 0.39), ("v_o", "a_o", 1000.0), ("x_o", "v_o", 100.0)];
    for (output, input, expected) in cases.into_iter().chain([("net", "v_o", 0.1)]) {
        let found = gain(&sketch, output, input);
        assert!((found / expected - 1.0).abs() < 0.01, "{input} -> {output}: {found}");
    }
    let (value, text) = setting(&sketch, "a_o", "net");
    assert_eq!(text, "net / a_o / M");
    assert!((value - 453.6 / 2.54 / 454.0).abs() < 1e-12, "{value}");
}

#[test]
fn set_b_has_the_computer_gains_of_the_thesis() {
    let sketch = slideway(SET_B, [2.54, 4.536, 25.4, 25.4]);
    let cases = [
        ("spring", "x_error", 45e6 * 0.0254e-3 / 45.36),
        ("a_o", "net", 45.36 / 0.254 / 433.0),
        ("v_o", "a_o", 1000.0),
        ("x_o", "v_o", 10.0),
        ("net", "v_o", 10.7e3 * 0.254e-3 / 45.36),
    ];
    for (output, input, expected) in cases {
        let found = gain(&sketch, output, input);
        assert!((found / expected - 1.0).abs() < 1e-12, "{input} -> {output}: {found}");
    }
    // 25.2 is 3 cords with a gain of 10 and a pot of 0.84.
    let (value, text) = setting(&sketch, "spring", "x_error");
    assert_eq!(text, "K * x_error / spring / 30");
    assert!((value - 0.84).abs() < 1e-3, "{value}");
}

#[test]
fn gains_without_parameters_need_no_pot() {
    let sketch = slideway(SET_B, [2.54, 4.536, 25.4, 25.4]);
    let made = sketch.synthesis();
    let jack_into = |node: u32| {
        let (_, element) = made.outputs.iter().find(|(id, _)| *id == NodeId(node)).unwrap();
        let plug = &made.patch.elements[element].plugs[0];
        (plug.jack.value.clone(), plug.from.value.clone())
    };
    let (_, acceleration) = made.outputs.iter().find(|(id, _)| *id == NodeId(6)).unwrap();
    assert_eq!(jack_into(5), ("x1000".to_owned(), acceleration.clone()));
    assert_eq!(jack_into(1).0, "x10");
}
