//! Exponentials whose values are far from 1.

use serde_json::json;

use super::{Reading, Sketch};
use crate::graph::{FunctionKind, Operation};

/// The problem y = exp(coefficient a) with a constant a and the value of the exponent. `scale` is a part of the
/// quantity y.
fn exponential(scale: &str, coefficient: &str, a: f64, exponent: f64) -> Sketch {
    let mut sketch = Sketch::new(&format!(
        r#"{{"patchcord": 1, "parameters": {{"p": {{"value": 2.5, "unit": "1", "range": [2, 3]}}}},
        "quantities": {{"a": {{"unit": "1", "initial": 1}}, "y": {{"unit": "1"{scale}}}}},
        "equations": ["a' = 0", "y = exp({coefficient} a)"], "run": {{"for": 1, "step": 1e-3}}}}"#
    ));
    sketch.constant("a", a);
    let argument = sketch.term(coefficient, 0);
    let operation = Operation::Function { kind: FunctionKind::Exp, argument };
    sketch.node("y", "1", [0.0, exponent.exp()], 0.0, operation);
    sketch.with_quantities()
}

/// The voltage of y, and its value as a share of the expected one.
fn voltage_and_share(sketch: &Sketch, exponent: f64) -> (f64, f64) {
    let reading = Reading::of(&sketch.synthesis());
    let index = reading.circuit.patch().signals.get_index_of("y").unwrap();
    (reading.volts[index], reading.value("y") / exponent.exp())
}

#[test]
fn exponentials_far_from_1_use_the_range_of_their_amplifier() {
    let cases = [
        ("-p", 9.0, -22.5),
        ("-p", 12.0, -30.0),
        ("p", -0.4, -1.0),
        ("-20", 6.5, -130.0),
        ("7", 3.0, 21.0),
        ("-8", -3.0, 24.0),
    ];
    for (coefficient, a, exponent) in cases {
        let (volts, share) = voltage_and_share(&exponential("", coefficient, a, exponent), exponent);
        assert!((50.0..=95.0).contains(&volts), "exp({exponent}): {volts} V");
        assert!((share - 1.0).abs() < 1e-9, "exp({exponent}): {share}");
    }
}

#[test]
fn the_reference_of_an_exponential_contains_its_offset() {
    let settings = |exponent: f64, a: f64| {
        let made = exponential("", "-p", a, exponent).synthesis();
        made.patch.value()["elements"]["F1"]["reference"].clone()
    };
    assert_eq!(settings(-22.5, 9.0), json!("exp(-23) / y"));
    assert_eq!(settings(-0.25, 0.1), json!("1 / y"));
}

#[test]
fn a_prescribed_scale_of_an_exponential_is_kept() {
    let sketch = exponential(r#", "per_volt": 1e-11"#, "-p", 9.0, -22.5);
    let (volts, share) = voltage_and_share(&sketch, -22.5);
    assert!((volts / (1e11 * f64::exp(-22.5)) - 1.0).abs() < 1e-9, "{volts} V");
    assert!((share - 1.0).abs() < 1e-9, "{share}");
}
