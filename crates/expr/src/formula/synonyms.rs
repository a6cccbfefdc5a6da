//! Functions that other languages have, and how a formula or an equation computes the same.

/// Names of functions that formulas do not have, and what to write instead.
const SYNONYMS: [(&[&str], &str); 22] = [
    (&["asin", "arcsin"], "the arc sine of x is atan(x / sqrt(1 - x^2))"),
    (&["acos", "arccos"], "the arc cosine of x is pi / 2 - atan(x / sqrt(1 - x^2))"),
    (&["arctan", "arctg", "artg", "atn"], "did you mean atan?"),
    (&["arctan2"], "did you mean atan2?"),
    (&["tg"], "did you mean tan?"),
    (&["ctg", "cotg", "cot"], "the cotangent of x is 1 / tan(x)"),
    (&["arcctg", "arccot", "acot"], "the arc cotangent of x is pi / 2 - atan(x)"),
    (&["pow"], "a power is written with ^, such as x^2"),
    (&["sqr", "square"], "a square is written x^2, and the square root sqrt(x)"),
    (&["cbrt"], "the cube root of a positive x is x^(1 / 3)"),
    (&["hypot"], "write sqrt(a^2 + b^2)"),
    (&["sign", "sgn", "signum"], "the sign of x is x / abs(x), if x is not 0"),
    (&["log"], "ln is the natural logarithm, and log10 the logarithm to base 10"),
    (&["lg"], "did you mean log10?"),
    (&["log2", "lb", "ld"], "the logarithm of x to base 2 is ln(x) / ln(2)"),
    (&["sinh"], "the hyperbolic sine of x is (exp(x) - exp(-x)) / 2"),
    (&["cosh"], "the hyperbolic cosine of x is (exp(x) + exp(-x)) / 2"),
    (&["ceil", "ceiling"], "the smallest whole number from x on is -floor(-x)"),
    (&["round"], "the whole number nearest to x is floor(x + 0.5)"),
    (
        &["int", "trunc", "truncate", "fix"],
        "without its decimals, a positive x is floor(x), and a negative one -floor(-x)",
    ),
    (&["mod", "fmod"], "the remainder of a / b is a - b * floor(a / b)"),
    (&["if", "where", "step", "heaviside"], "formulas have no conditions: use min, max and floor"),
];

/// Names of functions that equations do not have but can express, and what to write instead. They precede
/// [`SYNONYMS`].
const EQUATION_SYNONYMS: [(&[&str], &str); 8] = [
    (&["sgn", "signum"], "did you mean sign?"),
    (&["heaviside", "unit_step", "unitstep"], "did you mean step?"),
    (&["deadzone", "dead_band", "deadband"], "did you mean dead_zone?"),
    (&["sat", "saturate", "saturation", "clamp", "clip", "limiter"], "did you mean limit?"),
    (&["dead_time", "deadtime", "transport_delay", "delayed"], "did you mean delay?"),
    (&["der", "ddt", "diff", "derivative"], "the derivative of x is written x'"),
    (&["int", "integral", "integrate"], "the integral of x is a quantity y with the equation y' = x"),
    (&["if", "where", "piecewise"], "equations have no conditions: use step, limit, min and max"),
];

/// Returns what to write instead of a function that formulas do not have; `None` if the name is not in the
/// table.
pub(super) fn advice(name: &str) -> Option<&'static str> {
    find(&SYNONYMS, name)
}

/// Returns what an equation has instead of a function that it does not have; `None` if the name is not in
/// the table of equations.
pub(super) fn equation_advice(name: &str) -> Option<&'static str> {
    find(&EQUATION_SYNONYMS, name)
}

/// Returns the advice of the row with a name. Capitals do not count.
fn find(table: &[(&[&str], &'static str)], name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let found = table.iter().find(|(names, _)| names.contains(&name.as_str()));
    found.map(|(_, advice)| *advice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::scope::NoNames;
    use crate::formula::{Callee, EquationFunction, Formula};

    #[test]
    fn no_synonym_is_a_function() {
        for name in SYNONYMS.iter().flat_map(|(names, _)| *names) {
            assert!(Callee::from_name(name).is_none(), "{name}");
            assert_eq!(advice(name), advice(&name.to_uppercase()));
        }
        assert_eq!(advice("cosine_of_it"), None);
    }

    #[test]
    fn synonyms_of_equations_are_no_functions_and_advise_existing_ones() {
        for (names, text) in EQUATION_SYNONYMS {
            for name in names {
                assert!(Callee::from_name(name).is_none(), "{name}");
                assert!(EquationFunction::from_name(name).is_none(), "{name}");
                assert_eq!(equation_advice(&name.to_uppercase()), Some(text));
            }
            if let Some(advised) = text.strip_prefix("did you mean ") {
                assert!(EquationFunction::from_name(advised.trim_end_matches('?')).is_some(), "{text}");
            }
        }
        assert_eq!(equation_advice("pow"), None);
    }

    #[test]
    fn advised_formulas_have_the_right_value() {
        let cases = [
            ("atan(0.5 / sqrt(1 - 0.5^2))", 0.5f64.asin()),
            ("pi / 2 - atan(-0.5 / sqrt(1 - 0.5^2))", (-0.5f64).acos()),
            ("8^(1 / 3)", 2.0),
            ("-0.3 / abs(-0.3)", -1.0),
            ("ln(8) / ln(2)", 3.0),
            ("(exp(0.7) - exp(-0.7)) / 2", 0.7f64.sinh()),
            ("(exp(0.7) + exp(-0.7)) / 2", 0.7f64.cosh()),
            ("-floor(-2.3)", 3.0),
            ("floor(2.6 + 0.5)", 3.0),
            ("7 - 3 * floor(7 / 3)", 1.0),
            ("1 / tan(0.7)", 1.0 / 0.7f64.tan()),
            ("pi / 2 - atan(1)", std::f64::consts::FRAC_PI_4),
            ("floor(2.7)", 2.7f64.trunc()),
            ("-floor(--2.7)", (-2.7f64).trunc()),
        ];
        for (text, expected) in cases {
            let value = Formula::parse(text).unwrap().evaluate(&NoNames).unwrap();
            assert!((value - expected).abs() < 1e-12, "{text}: {value}");
        }
    }
}
