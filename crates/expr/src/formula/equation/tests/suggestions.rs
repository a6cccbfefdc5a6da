//! What hints suggest in place of a fault: the text with the suggestion is an equation.

use super::super::Equation;
use super::TABLES;

/// The most suggestions that are applied to one text.
const MAX_STEPS: usize = 4;

/// The texts that a hint suggests: all after "write", up to a semicolon, separated by "or".
fn suggestions(hint: &str) -> Vec<&str> {
    let parts = hint.split("write ").skip(1).filter_map(|part| part.split(';').next());
    parts.flat_map(|part| part.split(" or ")).collect()
}

#[test]
fn every_way_to_write_an_ambiguous_product_is_an_equation() {
    let products = [
        "a / b c",
        "a/b c d / e f",
        "-40 N/m x",
        "9.81 m/s2 / L sin(phi)",
        "5 N / k x",
        "2 m/s2 k / L x / c",
        "a / -b c^2 * d / friction(v) (e + 1) x'",
        "a / b c * d e / f",
    ];
    for product in products {
        let error = Equation::parse(&format!("y = {product}"), &TABLES).unwrap_err();
        let hint = error.hint.unwrap();
        let suggested = suggestions(&hint);
        assert!(suggested.len() > 1, "{hint}");
        for text in suggested {
            let text = format!("y = {text}");
            assert!(Equation::parse(&text, &TABLES).is_ok(), "{text}");
        }
    }
    let long = format!("y = a / b {}", "long_name ".repeat(20));
    let hint = "put the quotient in parentheses, or its divisor with the factors that follow it";
    assert_eq!(Equation::parse(&long, &TABLES).unwrap_err().hint.as_deref(), Some(hint));
}

#[test]
fn a_number_with_a_unit_becomes_a_parameter() {
    let error = Equation::parse("y = 9.81 m/s2 / L sin(phi)", &TABLES).unwrap_err();
    let hint = error.hint.unwrap();
    let suggested = suggestions(&hint)[0];
    assert_eq!(suggested, "(p / L) sin(phi)");
    let equation = Equation::parse(&format!("y = {suggested}"), &TABLES).unwrap();
    assert_eq!(equation.names(), ["y", "p", "L", "phi"]);
}

#[test]
fn a_suggestion_for_a_sign_or_a_derivative_replaces_the_fault() {
    let cases = [
        ("ẋ = v", "x' = v"),
        ("mẍ + cẋ = F", "m x'' + c x' = F"),
        ("ẏ_1 = v", "y_1' = v"),
        ("2phi\u{308} = v", "2phi'' = v"),
        ("m x’’ = F", "m x'' = F"),
        ("y = a · b − c²", "y = a * b - c^2"),
        ("x' == v", "x' = v"),
        ("y = [a + b]", "y = (a + b)"),
        ("y = m dx_1 / dt", "y = m x_1'"),
        ("y = -dx/dt c", "y = -x' c"),
        ("m d^2x/dt^2 = F", "m x'' = F"),
        ("dx(0)/dt = v", "x'(0) = v"),
        ("y = x (0)", "y = x(0)"),
    ];
    for (text, expected) in cases {
        let mut text = text.to_owned();
        for _ in 0..MAX_STEPS {
            let Err(error) = Equation::parse(&text, &TABLES) else { break };
            let hint = error.hint.unwrap();
            let suggested = hint.strip_prefix("write ").unwrap_or_else(|| panic!("{text}: {hint}"));
            let end = [" instead", " for "].into_iter().find_map(|word| suggested.find(word));
            text.replace_range(error.range, &suggested[..end.unwrap_or(suggested.len())]);
        }
        assert_eq!(text, expected);
        assert!(Equation::parse(&text, &TABLES).is_ok(), "{text}");
    }
}
