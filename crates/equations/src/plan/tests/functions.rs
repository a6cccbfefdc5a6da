//! The elements of every function, and the faults of functions without elements.

use super::{faults, lines, planned};

/// A problem with a state x, an algebraic quantity y, and one equation for y.
fn sections(equation: &str) -> String {
    format!(
        r#""parameters": {{"p": {{"value": 2, "unit": "1"}}, "w": {{"value": 0.4, "unit": "1"}}}},
        "quantities": {{"x": {{"unit": "1", "initial": 0.3}}, "y": {{"unit": "1"}}}},
        "tables": {{"spring": {{"in": "1", "out": "1", "points": [[-1, -2], [0, 0], [2, 1]]}}}},
        "equations": ["x' = -x", "{equation}"]"#
    )
}

/// Asserts that an equation for y has these nodes, except x.
fn assert_nodes(equation: &str, expected: &[&str]) {
    let found = lines(&planned(&sections(equation)));
    assert_eq!(found[0], "x = integral(-1 * x) from 0.3");
    assert_eq!(&found[1..], expected, "{equation}");
}

/// Asserts that an equation for y has one fault, with this place in the text, message and hint.
fn assert_fault(equation: &str, place: &str, message: &str, hint: &str) {
    assert_eq!(faults(&sections(equation)), [[place, message, hint].map(str::to_owned)], "{equation}");
}

#[test]
fn trigonometric_functions() {
    assert_nodes("y = sin(p x)", &["y = sin(p * x)"]);
    assert_nodes("y = cos(x)", &["y = cos(x)"]);
    assert_nodes("y = tan(x)", &["y = (sin(x)) over cos(x)", "sin(x) = sin(x)", "cos(x) = cos(x)"]);
    // The functions of the opposite angle are shared.
    assert_nodes(
        "y = sin(x) sin(-x) + cos(x) cos(-x)",
        &[
            "y = -1 * sin(x)^2 + cos(x)^2",
            "sin(x) = sin(x)",
            "sin(x)^2 = sin(x) times sin(x)",
            "cos(x) = cos(x)",
            "cos(x)^2 = cos(x) times cos(x)",
        ],
    );
}

#[test]
fn angles_are_implicit() {
    let sine_and_cosine =
        ["sin(atan(x)) = sin(y)", "cos(atan(x)) = cos(y)", "x cos(atan(x)) = x times cos(atan(x))"];
    let zero = "y = zero of sin(atan(x)) + -1 * x cos(atan(x))";
    assert_nodes("y = atan(x)", &[&[zero], sine_and_cosine.as_slice()].concat());
    assert_nodes(
        "y = atan2(x, p)",
        &[
            "y = zero of p * sin(atan2(x, p)) + -1 * x cos(atan2(x, p))",
            "sin(atan2(x, p)) = sin(y)",
            "cos(atan2(x, p)) = cos(y)",
            "x cos(atan2(x, p)) = x times cos(atan2(x, p))",
        ],
    );
}

#[test]
fn exponential_functions() {
    assert_nodes("y = exp(-x)", &["y = exp(-1 * x)"]);
    assert_nodes("y = ln(p x)", &["y = ln(p * x)"]);
    assert_nodes("y = exp10(x)", &["y = exp(2.302585092994046 * x)"]);
    let size = "abs(x) = absolute(x)";
    let exponential = "exp(-2 abs(x)) = exp(-2 * abs(x))";
    let sum = "1 + exp(-2 abs(x)) = 1 + exp(-2 abs(x))";
    let quotient = "(1 - exp(-2 abs(x)))/(1 + exp(-2 abs(x)))";
    let of_size = format!("{quotient} = (1 + -1 * exp(-2 abs(x))) over 1 + exp(-2 abs(x))");
    let sign = "sign(x) = switch(x, 1, -1)";
    let product = format!("y = {quotient} times sign(x)");
    assert_nodes("y = tanh(x)", &[product.as_str(), size, exponential, sum, of_size.as_str(), sign]);
}

#[test]
fn powers() {
    assert_nodes("y = x^3", &["y = x times x^2", "x^2 = x times x"]);
    assert_nodes("y = power(x, 4)", &["y = x^2 times x^2", "x^2 = x times x"]);
    assert_nodes("y = (p x)^2", &["y = p^2 * x^2", "x^2 = x times x"]);
    assert_nodes("y = x^-2", &["y = (1) over x^2", "x^2 = x times x"]);
    assert_nodes("y = p x^-1", &["y = (p) over x"]);
    assert_nodes("y = x^0.5", &["y = root(x)"]);
    assert_nodes("y = sqrt(1 - p x)", &["y = root(1 + -p * x)"]);
    assert_nodes("y = x^1.5", &["y = x times sqrt(x)", "sqrt(x) = root(x)"]);
    assert_nodes("y = x^p", &["y = exp(p * ln(x))", "ln(x) = ln(x)"]);
    assert_nodes("y = p - x^p", &["y = p + -1 * x^p", "ln(x) = ln(x)", "x^p = exp(p * ln(x))"]);
}

#[test]
fn limits() {
    assert_nodes("y = max(x, 0)", &["y = limited(x, 0, none)"]);
    assert_nodes("y = min(w, x - p)", &["y = limited(-p + x, none, w)"]);
    assert_nodes("y = limit(x, -w, w)", &["y = limited(x, -w, w)"]);
    assert_nodes("y = min(max(x, -w), w)", &["y = limited(x, -w, w)"]);
    // A limiter needs a lower bound below the upper one.
    let nested = ["y = limited(max(x, p), none, w)", "max(x, p) = limited(x, p, none)"];
    assert_nodes("y = min(max(x, p), w)", &nested);
    let equal = ["y = limited(max(x, w), none, w)", "max(x, w) = limited(x, w, none)"];
    assert_nodes("y = limit(x, w, w)", &equal);
    assert_nodes("y = max(x, x^2)", &["y = higher(x, x^2)", "x^2 = x times x"]);
    assert_nodes("y = min(-x, x^2)", &["y = lower(x^2, -x)", "x^2 = x times x", "-x = -1 * x"]);
    let bounds = ["x^2 = x times x", "max(x, -1) = limited(x, -1, none)"];
    assert_nodes("y = limit(x, -1, x^2)", &["y = lower(x^2, max(x, -1))", bounds[0], bounds[1]]);
}

#[test]
fn switches_and_zones() {
    assert_nodes("y = abs(p x)", &["y = p * abs(x)", "abs(x) = absolute(x)"]);
    assert_nodes("y = sign(p x)", &["y = switch(x, 1, -1)"]);
    // This argument can stay at 0.
    let steps = [
        "y = step(dead_zone(x, w)) + -1 * step(-dead_zone(x, w))",
        "dead_zone(x, w) = dead zone(x, w)",
        "-dead_zone(x, w) = -1 * dead_zone(x, w)",
        "step(dead_zone(x, w)) = switch(dead_zone(x, w), 1, 0)",
        "step(-dead_zone(x, w)) = switch(-dead_zone(x, w), 1, 0)",
    ];
    assert_nodes("y = sign(dead_zone(x, w))", &steps);
    assert_nodes("y = step(-x)", &["y = switch(-x, 1, 0)", "-x = -1 * x"]);
    assert_nodes("y = dead_zone(x, w)", &["y = dead zone(x, w)"]);
    assert_nodes(
        "y = dead_zone(2 x, w)",
        &["y = 2 * dead_zone(x, 0.5 w)", "dead_zone(x, 0.5 w) = dead zone(x, 0.5 w)"],
    );
}

#[test]
fn delays_tables_and_time() {
    assert_nodes("y = delay(p x, w)", &["y = p * delay(x, w)", "delay(x, w) = delay(x, w) from 0.3"]);
    assert_nodes("y = spring(2 x)", &["y = curve spring(2 * x)"]);
    assert_nodes("y = spring(p x)", &["y = curve spring(p x)", "p x = p * x"]);
    assert_nodes("y = sin(p t)", &["y = sin(p * t)", "t = integral(1) from 0"]);
}

#[test]
fn functions_without_elements_are_faults() {
    let hint = "use another function, or a table, in place of floor";
    assert_fault("y = 3 floor(x)", "floor(x)", "no element computes floor", hint);
    let message = "the exponent (x + 1) varies, and no element computes such a power";
    assert_fault("y = p^(x + 1)", "(x + 1)", message, "write exp((x + 1) * ln(p))");
    let hint = "the largest exponent is 64: scale the equation";
    assert_fault("y = x^65", "65", "the exponent 65 is too large", hint);
}

#[test]
fn arguments_outside_the_range_of_an_element_are_faults() {
    let hint = "choose parameters for which it is not 0, or multiply the equation by it";
    assert_fault("y = x / (p - 2)", "(p - 2)", "the divisor (p - 2) is 0", hint);
    let message = "the half width of a dead zone must be positive, and -w is not";
    assert_fault("y = dead_zone(x, -w)", "-w", message, "choose a positive value");
    assert_fault("y = delay(x, x)", "x", "the time of a delay must be constant", "write a parameter here");
    let message = "the time of a delay must be positive, and w - 1 is not";
    assert_fault("y = delay(x, w - 1)", "w - 1", message, "choose a positive value");
    let message = "the lower limit in limit(x, p, w) exceeds the upper one";
    assert_fault("y = limit(x, p, w)", "limit(x, p, w)", message, "exchange the limits");
    let message = "spring(p) does not vary";
    assert_fault("y = spring(p)", "spring(p)", message, "write its value as a parameter");
}

#[test]
fn functions_of_constants_are_constant() {
    let cases = [
        ("sin(x - x) + 2 x", "y = 2 * x"),
        ("cos(0 x) + x", "y = 1 + x"),
        ("2 exp(-abs(0 x)) x", "y = 2 * x"),
        ("max(x - x, p) x", "y = p * x"),
        ("sign(x - x + 3) + step(x - x) + x", "y = 2 + x"),
        ("2 limit(x - x, 1, 3) x", "y = 2 * x"),
        ("dead_zone(x - x + 3, 1) + x", "y = 2 + x"),
        ("delay(x - x, w) + 2 x", "y = 2 * x"),
        ("delay(sqrt(p), w) x", "y = sqrt(p) * x"),
        ("x^(x - x + 2)", "y = x times x"),
    ];
    for (value, expected) in cases {
        assert_nodes(&format!("y = {value}"), &[expected]);
    }
}
