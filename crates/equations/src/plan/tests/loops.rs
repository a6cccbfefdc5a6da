//! Systems with several highest derivatives in one equation, and implicit equations.

use super::{count, lines, node_of, operation, planned, planned_system};
use crate::graph::{Operation, Plan, Sum};
use crate::symbolic::Fraction;

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

/// The plan of two coupled masses with these equations.
fn masses(equations: &str) -> Plan {
    planned(&format!(
        r#""parameters": {{"m": {{"value": 1, "unit": "1"}}}},
        "quantities": {{"x": {{"unit": "1", "initial": 1}}, "x'": {{"unit": "1", "initial": 0}},
                        "y": {{"unit": "1", "initial": 1}}, "y'": {{"unit": "1", "initial": 0}}}},
        "equations": [{equations}]"#
    ))
}

/// Asserts that a node is a sum of these numbers times x and y.
fn assert_sum(plan: &Plan, name: &str, [x, y]: [f64; 2]) {
    let mut expected = Sum::term(&Fraction::number(x), node_of(plan, "x"));
    expected.add(&Fraction::number(y), node_of(plan, "y"));
    assert_eq!(*operation(plan, name), Operation::Sum(expected), "{name}");
}

#[test]
fn a_constant_mass_matrix_is_inverted() {
    let plan = masses(r#""x'' + 3 y'' = -y", "2 x'' + y'' = -x""#);
    assert_sum(&plan, "x''", [-0.6, 0.2]);
    assert_sum(&plan, "y''", [0.2, -0.4]);
    // The determinant 1 - 6 m contains the parameter.
    let plan = masses(r#""m (x'' + 3 y'') = -y", "2 x'' + y''/m = -x""#);
    let Operation::Sum(sum) = operation(&plan, "x''") else { panic!("x'' is a sum") };
    assert!(sum.terms.keys().all(|node| [node_of(&plan, "x"), node_of(&plan, "y")].contains(node)));
    assert!(sum.terms.values().all(|factor| factor.contains(&mut |symbol| symbol.is_constant)));
}

#[test]
fn a_mass_matrix_that_varies_stays_a_loop() {
    let plan = masses(r#""x'' + sin(x) y'' = -y", "2 x'' + y'' = -x""#);
    let Operation::Sum(sum) = operation(&plan, "y''") else { panic!("y'' is a sum") };
    assert_eq!(sum.terms.len(), 2);
}

#[test]
fn an_equation_that_is_rational_in_its_unknown_has_no_loop() {
    let state = "h = integral(-1/T * h) from 1";
    let arm = |equation: &str, initial: &str| {
        let mut found = implicit(equation, initial);
        assert_eq!(found.remove(0), state);
        found
    };
    let square = "h^2 = h times h";
    let positive = arm("h^2 + (L arm)^2 = L^2", "");
    assert!(positive[0].starts_with("arm = root("), "{positive:?}");
    assert!(positive.contains(&square.to_owned()), "{positive:?}");
    let negative = arm("h^2 + (L arm)^2 = L^2", r#", "initial": -30"#);
    assert!(negative[0].starts_with("arm = -1 * sqrt("), "{negative:?}");
    assert_eq!(arm("1/arm = 1 + h/L", "")[0], "arm = (1) over 1 + h/L");
}

#[test]
fn a_cube_is_solved_from_several_starts() {
    // The derivative of the cube is 0 at 0.
    let found = implicit("L arm^3 = h", "");
    assert_eq!(found[1], "arm = zero of -1 * h + L * arm^3");
}
