//! Systems with several highest derivatives in one equation, and implicit equations.

use super::{count, lines, node_of, operation, planned, planned_system};
use crate::graph::{Operation, Sum};

#[test]
fn coupled_pendulums_share_the_difference_of_the_sines() {
    let plan = planned_system("coupled-pendulums");
    assert_eq!(count(&plan, |operation| matches!(operation, Operation::Integral { .. })), 4);
    assert_eq!(count(&plan, |operation| matches!(operation, Operation::Function { .. })), 4);
    assert_eq!(count(&plan, |operation| matches!(operation, Operation::Product(_))), 2);
    assert_eq!(count(&plan, |operation| matches!(operation, Operation::Sum(_))), 1);
    assert_eq!(plan.nodes.len(), 12);
    let name = "sin(theta1) - sin(theta2)";
    assert!(matches!(operation(&plan, name), Operation::Sum(sum) if sum.terms.len() == 2));
}

#[test]
fn the_second_derivatives_of_a_double_pendulum_are_nodes() {
    let plan = planned_system("double-pendulum");
    for (rate, own) in [("a'", "a''"), ("b'", "b''")] {
        let node = plan.nodes.iter().position(|node| node.name == own).unwrap();
        let Operation::Integral { rate, .. } = operation(&plan, rate) else { panic!("{rate} is a state") };
        assert_eq!(*rate, Sum::node(plan.ids().nth(node).unwrap()));
        assert!(matches!(operation(&plan, own), Operation::Sum(_)));
    }
    // cos(a - b) is constant in neither equation, so each second derivative is a term of the other one.
    assert_eq!(count(&plan, |operation| matches!(operation, Operation::Quotient { .. })), 0);
    let products = ["cos(a - b) a''", "cos(a - b) b''"];
    assert!(products.iter().all(|name| matches!(operation(&plan, name), Operation::Product(_))));
    // The highest derivatives are not declared.
    let names: Vec<&str> = plan.quantities.iter().map(|planned| planned.name.as_str()).collect();
    assert_eq!(names, ["a", "a'", "b", "b'"]);
}

/// A problem with a varying factor of the unknown.
fn varying_factor(equation: &str) -> Vec<String> {
    lines(&planned(&format!(
        r#""quantities": {{"x": {{"unit": "1", "initial": 1}}, "y": {{"unit": "1"}}}},
        "equations": ["x' = -x", "{equation}"]"#
    )))
}

#[test]
fn a_varying_factor_of_the_unknown_is_a_divisor() {
    let expected =
        ["x = integral(-1 * x) from 1", "y = (3) over 1 + x^2", "x^2 = x times x", "1 + x^2 = 1 + x^2"];
    for equation in ["(1 + x^2) y = 3", "y + x^2 y = 3", "3 - y = y x^2"] {
        let mut found = varying_factor(equation);
        found[2..].sort();
        let mut expected = expected.map(str::to_owned);
        expected[2..].sort();
        assert_eq!(found, expected, "{equation}");
    }
}

/// The plan of h' = -0.1 h from 0.5 with an implicit equation for the angle arm.
fn implicit(equation: &str, initial: &str) -> Vec<String> {
    lines(&planned(&format!(
        r#""parameters": {{"L": {{"value": 2, "unit": "m"}}, "T": {{"value": 10, "unit": "s"}}}},
        "quantities": {{"h": {{"unit": "m", "initial": 1}}, "arm": {{"unit": "deg"{initial}}}}},
        "equations": ["T h' = -h", "{equation}"]"#
    )))
}

#[test]
fn the_sum_of_an_implicit_equation_rises_with_its_unknown() {
    let state = "h = integral(-1/T * h) from 1";
    let rising = [state, "arm = zero of -1 * h + L * sin(arm)", "sin(arm) = sin(arm)"];
    // The solution near 0 is 30 degrees, where the sine rises.
    assert_eq!(implicit("L sin(arm) = h", ""), rising);
    assert_eq!(implicit("h = L sin(arm)", ""), rising);
    assert_eq!(implicit("L sin(arm) = h", r#", "initial": 20"#), rising);
    // The solution near 140 degrees is 150 degrees, where the sine falls.
    let falling = [state, "arm = zero of h + -L * sin(arm)", "sin(arm) = sin(arm)"];
    assert_eq!(implicit("L sin(arm) = h", r#", "initial": 140"#), falling);
}

#[test]
fn an_implicit_highest_derivative_has_a_node() {
    let plan = planned(
        r#""quantities": {"x": {"unit": "1", "initial": 1}},
        "equations": ["x' + x'^3 = -x"]"#,
    );
    let expected = [
        "x = integral(x') from 1",
        "x' = zero of x + x' + x'^3",
        "x'^2 = x' times x'",
        "x'^3 = x' times x'^2",
    ];
    assert_eq!(lines(&plan), expected);
    assert!(plan.quantities.iter().all(|planned| planned.node == node_of(&plan, "x")));
}
