//! Values at the start: delays, drives and coupled implicit equations.

use super::{count, operation, planned};
use crate::graph::Operation;
use crate::symbolic::nearest;

/// The initial value of the only delay of a problem, which must be a number.
fn delay_start(quantities: &str, rest: &str, equations: &str) -> f64 {
    let plan = planned(&format!(
        r#""quantities": {{{quantities}, "past": {{"unit": "1"}}}}, {rest} "equations": [{equations}]"#
    ));
    assert_eq!(count(&plan, |operation| matches!(operation, Operation::Delay { .. })), 1);
    let Operation::Delay { initial, .. } = operation(&plan, "past") else { panic!("past is a delay") };
    nearest(&initial.as_rational().unwrap())
}

#[test]
fn a_delay_starts_with_the_value_of_its_input_at_the_start() {
    let x = r#""x": {"unit": "1", "initial": 0.5}"#;
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
    close(delay_start(x, "", r#""x' = -past", "past = delay(x, 2)""#), 0.5);
    close(delay_start(x, "", r#""x' = -past", "past = delay(3 x^2 - 1, 2)""#), -0.25);
    close(delay_start(x, "", r#""x' = -past", "past = delay(exp(x), 2)""#), 0.5f64.exp());
    let tanh = r#""x' = -past", "past = delay(tanh(2 x), 2)""#;
    close(delay_start(x, "", tanh), 1f64.tanh());
    let drive =
        r#""drives": {"u": {"kind": "sine", "unit": "1", "amplitude": 1, "frequency": 1, "offset": 4}},"#;
    close(delay_start(x, drive, r#""x' = -past", "past = delay(u + x, 2)""#), 4.5);
}

#[test]
fn a_delay_starts_with_the_solution_of_a_loop() {
    // a = 2 - b/2 and b = a/2: a = 8/5.
    let quantities = r#""x": {"unit": "1", "initial": 2}, "a": {"unit": "1"}, "b": {"unit": "1"}"#;
    let equations = r#""x' = -past", "a = x - b/2", "b = a/2", "past = delay(a, 1)""#;
    assert!((delay_start(quantities, "", equations) - 1.6).abs() < 1e-12);
    // y + y^3 = 10 at the start: y = 2.
    let quantities = r#""x": {"unit": "1", "initial": 10}, "y": {"unit": "1"}"#;
    let equations = r#""x' = -past", "y + y^3 = x", "past = delay(sin(y), 1)""#;
    assert!((delay_start(quantities, "", equations) - 2f64.sin()).abs() < 1e-12);
}

#[test]
fn a_delay_starts_with_the_angle_of_a_point() {
    let quantities = r#""x": {"unit": "1", "initial": -1}, "y": {"unit": "1", "initial": 1}"#;
    let equations = r#""x' = -past", "y' = -y", "past = delay(atan2(y, x), 1)""#;
    let expected = 0.75 * std::f64::consts::PI;
    assert!((delay_start(quantities, "", equations) - expected).abs() < 1e-12);
}

#[test]
fn the_value_before_a_delay_is_an_expression_of_parameters() {
    let start = |equation: &str| {
        let plan = planned(&format!(
            r#""parameters": {{"p": {{"value": 2, "unit": "1"}}, "x0": {{"value": 0.5, "unit": "1"}}}},
            "quantities": {{"x": {{"unit": "1", "initial": "x0"}}, "past": {{"unit": "1"}}}},
            "equations": ["x' = -past", "past = delay({equation}, 2)"]"#
        ));
        let Operation::Delay { initial, .. } = operation(&plan, "past") else { panic!("past is a delay") };
        let symbol = |name: &str| plan.symbols.find(name, 0).unwrap();
        (initial.clone(), initial.contains(&mut |own| own == symbol("x0")))
    };
    let is_parametric = |equation: &str| {
        let (initial, has_x0) = start(equation);
        has_x0 && initial.as_rational().is_none()
    };
    for equation in ["x", "exp(-x/p)", "sqrt(x)", "x/(p + x)", "tanh(x)", "max(x, p)", "abs(x - p)"] {
        assert!(is_parametric(equation), "{equation}");
    }
    for equation in ["dead_zone(x, 0.1 p)", "sin(x) + sign(x - 1) x", "limit(x - p, -p, p)"] {
        assert!(is_parametric(equation), "{equation}");
    }
    // An implicit quantity has no expression.
    assert!(!is_parametric("atan(x)"));
}
