//! The check of units.

use super::super::{Equation, FormulaDimension};
use super::{SCOPE, TestScope, equation, fault};
use crate::units::Dimension;

/// The fault of the check of units.
fn mismatch(text: &str) -> (String, String, String) {
    fault(equation(text).dimension_check(&SCOPE), text)
}

#[test]
fn sides_agree_in_dimension() {
    for text in [
        "m x'' = -k x - c x' + F",
        "x' = v",
        "v = x'",
        "0 = m v' + k x",
        "m v' + k x = 0",
        "u = 0.5",
        "F = k dead_zone(x, 0)",
        "F = k dead_zone(x, x)",
        "x = limit(x, 0, x / 2)",
        "u = limit(u, -1, 1)",
        "u = limit(0, -1, 1)",
        "u = sign(x') + step(t - T)",
        "x = delay(x, 2 T)",
        "x = delay(x, 0)",
        "F = friction(x') + friction(0)",
        "T x' + x = 0",
        "x(0) = T v",
        "x'(0) = v / 2",
        "x''(0) = 0",
    ] {
        assert_eq!(equation(text).dimension_check(&SCOPE), Ok(()), "{text}");
    }
}

#[test]
fn disagreeing_sides_are_errors_with_their_units() {
    let none = String::new();
    let cases = [
        ("m x'' = -k x'", "m x'' = -k x'", "m x'' is in N but -k x' is in N/s", ""),
        ("x = 5", "x = 5", "x is in m but 5 is a pure number", "declare 5 as a parameter in m"),
        ("x'(0) = x", "x'(0) = x", "x'(0) is in m/s but x is in m", ""),
        ("x(0) = 5", "x(0) = 5", "x(0) is in m but 5 is a pure number", "declare 5 as a parameter in m"),
        ("m v' = u", "m v' = u", "m v' is in N but u is a pure number", "multiply u by a parameter in N"),
        ("x' = v + F", "v + F", "v is in m/s but F is in N", ""),
        ("u = sin(x)", "x", "sin takes a pure number, but x is in m", "divide it by a parameter in m"),
        (
            "x = limit(x, 0, u)",
            "limit(x, 0, u)",
            "x is in m but u is a pure number",
            "multiply u by a parameter in m",
        ),
        ("x = dead_zone(x, v)", "dead_zone(x, v)", "x is in m but v is in m/s", ""),
        ("x = delay(x, v)", "v", "delay takes a time, but v is in m/s", ""),
        (
            "x = delay(x, 2)",
            "2",
            "delay takes a time, but 2 is a pure number",
            "declare 2 as a parameter in s",
        ),
        ("F = friction(x)", "x", "friction takes a quantity in m/s, but x is in m", ""),
        (
            "F = friction(2)",
            "2",
            "friction takes a quantity in m/s, but 2 is a pure number",
            "declare 2 as a parameter in m/s",
        ),
        ("x' = w", "w", "w is not known here", ""),
    ];
    for (text, part, message, hint) in cases {
        assert_eq!(mismatch(text), (part.to_owned(), message.to_owned(), hint.to_owned()), "{text}");
    }
    let unknown = Equation::parse("F = curve(x)", &["curve"]).unwrap().dimension_check(&SCOPE);
    let expected = ("curve(x)".to_owned(), "the table curve is not known here".to_owned(), none);
    assert_eq!(fault(unknown, "F = curve(x)"), expected);
}

#[test]
fn nested_calls_take_no_exponential_time() {
    let nested = format!("x = {}x{}", "limit(".repeat(100), ", 0, x)".repeat(100));
    assert_eq!(equation(&nested).dimension_check(&SCOPE), Ok(()));
    assert_eq!(equation(&nested).evaluate(&SCOPE), Ok([0.5, 0.5]));
}

#[test]
fn time_can_count_as_a_pure_number() {
    let scope = TestScope { time: Dimension::NONE };
    for text in ["x' = -x", "x'' = x", "x = delay(x, 2)"] {
        assert!(equation(text).dimension_check(&SCOPE).is_err(), "{text}");
        assert_eq!(equation(text).dimension_check(&scope), Ok(()), "{text}");
    }
    let error = equation("x = delay(x, T)").dimension_check(&scope).unwrap_err();
    assert_eq!(error.message, "delay takes a pure number, but T is in s");
}

#[test]
fn the_right_side_has_a_dimension() {
    let dimension = |text: &str| equation(text).right_dimension(&SCOPE);
    assert_eq!(dimension("y = k x"), Ok(FormulaDimension::Of(Dimension::FORCE)));
    assert_eq!(dimension("y = 2"), Ok(FormulaDimension::Literal));
    assert!(dimension("y = k + x").is_err());
}
