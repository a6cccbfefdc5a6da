use proptest::prelude::*;

use super::scope::NoNames;
use super::*;
use crate::units::{Dimension, Unit};

/// A scope from a list of names with their values and units.
struct TestScope(Vec<(&'static str, Option<f64>, &'static str)>);

impl Scope for TestScope {
    fn value(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|entry| entry.0 == name)?.1
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        let entry = self.0.iter().find(|entry| entry.0 == name)?;
        Some(Unit::parse(entry.2).ok()?.dimension())
    }

    fn names(&self) -> Vec<&str> {
        self.0.iter().map(|entry| entry.0).collect()
    }
}

fn scope() -> TestScope {
    TestScope(vec![
        ("K", Some(2e6), "N/m"),
        ("position", Some(1e-3), "m"),
        ("velocity", Some(0.5), "m/s"),
        ("force", Some(100.0), "N"),
        ("Fs", Some(20.0), "N"),
        ("f", Some(4.0), "N s/m"),
        ("Tc", Some(0.0), "s"),
        ("slip", Some(0.25), "1"),
        ("later", None, "m"),
    ])
}

fn formula(text: &str) -> Formula {
    Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn value(text: &str) -> f64 {
    let found = formula(text).evaluate(&scope());
    found.unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn unit(text: &str) -> String {
    match formula(text).dimension(&scope()) {
        Ok(FormulaDimension::Literal) => "free".to_owned(),
        Ok(FormulaDimension::Of(dimension)) => dimension.to_string(),
        Err(error) => panic!("{text}: {error}"),
    }
}

fn fault(result: Result<impl std::fmt::Debug, FormulaError>, text: &str) -> (String, String) {
    let error = result.expect_err(text);
    (text[error.range].to_owned(), error.message)
}

#[test]
fn computes() {
    let cases = [
        ("1", 1.0),
        (".5", 0.5),
        ("1.5e-3", 1.5e-3),
        ("2E+2", 200.0),
        ("1 - 2 - 3", -4.0),
        ("8 / 4 / 2", 1.0),
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^-1", 0.5),
        ("2^3^2", 512.0),
        ("2 * -3", -6.0),
        ("--3", 3.0),
        ("2^0.5 - sqrt(2)", 0.0),
        ("min(1, slip / 2)", 0.125),
        ("max(1, -abs(-2))", 1.0),
        ("atan2(0, -1) - pi", 0.0),
        ("power(2, 3)", 8.0),
        ("K * position / force / 100", 0.2),
        ("0.1 * (Fs + 50 * force) / (50 * force)", 0.1004),
    ];
    for (text, expected) in cases {
        assert!((value(text) - expected).abs() < 1e-12, "{text}: {}", value(text));
    }
}

#[test]
fn rejects_invalid_formulas() {
    let cases = [
        ("", "", "the formula is empty"),
        ("  ", "  ", "the formula is empty"),
        ("1 +", "", "a number, a name or a parenthesis is missing here"),
        ("2 ** 3", "*", "a number, a name or a parenthesis is missing here"),
        ("2 x", "x", "an operator is missing before x"),
        ("2x", "x", "an operator is missing before x"),
        ("2e", "e", "an operator is missing before e"),
        ("1,5", ",", "a comma is not allowed here"),
        ("1.2.3", "1.2.3", "1.2.3 is not a number"),
        ("1e999", "1e999", "1e999 is too large"),
        ("(1", "(", "this parenthesis is not closed"),
        ("(1 2)", "2", "an operator is missing before 2"),
        ("1)", ")", "this parenthesis has no opening parenthesis"),
        ("2 × 3", "×", "× is not allowed in a formula"),
        ("sqr(2)", "sqr", "sqr is not a function"),
        ("sqrt()", "sqrt()", "sqrt takes 1 argument, not 0"),
        ("1 + min(2)", "min(2)", "min takes 2 arguments, not 1"),
    ];
    for (text, part, message) in cases {
        let expected = (part.to_owned(), message.to_owned());
        assert_eq!(fault(Formula::parse(text), text), expected, "{text}");
    }
}

#[test]
fn rejects_excessive_depth_and_length() {
    let deep = [
        "(".repeat(500) + "1" + &")".repeat(500),
        "-".repeat(500) + "1",
        "2^".repeat(500) + "1",
        "abs(".repeat(300) + "1" + &")".repeat(300),
    ];
    for text in deep {
        let message = fault(Formula::parse(&text), &text).1;
        assert_eq!(message, "the formula is nested too deeply");
    }
    assert!(Formula::parse(&"1+".repeat(2000)).is_err());
}

#[test]
fn long_flat_formulas_are_accepted() {
    let text = "1+".repeat(999) + "1";
    assert_eq!(value(&text), 1000.0);
    assert_eq!(unit(&text), "free");
}

#[test]
fn explains_why_there_is_no_value() {
    let cases = [
        ("1 / Tc", "Tc", "the denominator Tc is 0"),
        ("1 / 0", "0", "the denominator is 0"),
        (
            "1 / (force - 5 * Fs)",
            "(force - 5 * Fs)",
            "the denominator (force - 5 * Fs) is 0: force is 100 and Fs is 20",
        ),
        ("1 + sqrt(slip - 1)", "sqrt(slip - 1)", "sqrt(slip - 1) has no finite value: slip - 1 is -0.75"),
        ("ln(Tc)", "ln(Tc)", "ln(Tc) has no finite value: Tc is 0"),
        ("(-slip)^0.5", "(-slip)^0.5", "(-slip)^0.5 has no finite value: (-slip) is -0.25"),
        ("1e300 * K^2", "1e300 * K^2", "1e300 * K^2 is too large for a number: K^2 is 4e12"),
        ("exp(1e3)", "exp(1e3)", "exp(1e3) is too large for a number"),
        ("K^99", "K^99", "K^99 is too large for a number: K is 2000000"),
        ("Tc^-1", "Tc^-1", "Tc^-1 has no finite value: Tc is 0"),
        ("2 * later", "later", "later has no value here"),
        ("2 * forse", "forse", "forse is not known here"),
    ];
    for (text, part, message) in cases {
        let expected = (part.to_owned(), message.to_owned());
        assert_eq!(fault(formula(text).evaluate(&scope()), text), expected, "{text}");
    }
}

#[test]
fn suggests_the_intended_name() {
    let hint = |text: &str| formula(text).evaluate(&scope()).unwrap_err().hint;
    assert_eq!(hint("forse").as_deref(), Some("did you mean force?"));
    assert_eq!(hint("2 * sqrt").as_deref(), Some("sqrt is a function: write sqrt( ... )"));
    assert_eq!(hint("sqrt(-1)").as_deref(), Some("sqrt needs 0 or more"));
    assert_eq!(hint("unheard_of"), None);
}

#[test]
fn the_number_e_is_written_with_exp() {
    let cases = [
        ("e^slip", "write exp(slip)"),
        ("2 * e^-slip", "write exp(-slip)"),
        ("1 - e^(-slip / (2 * 3))", "write exp(-slip / (2 * 3))"),
        ("e^((slip) / (2))", "write exp((slip) / (2))"),
        ("ln(e)", "the number e is exp(1), and e to the power of x is exp(x)"),
        ("(1 + e)^slip", "the number e is exp(1), and e to the power of x is exp(x)"),
    ];
    for (text, expected) in cases {
        let errors =
            [formula(text).evaluate(&scope()).unwrap_err(), formula(text).dimension(&scope()).unwrap_err()];
        for error in errors {
            let found = (error.message.as_str(), error.hint.as_deref());
            assert_eq!(found, ("e is not known here", Some(expected)), "{text}");
        }
    }
    // A known name of one letter is meant by its other case.
    let named = TestScope(vec![("E", Some(1.0), "1")]);
    assert_eq!(formula("e^2").evaluate(&named).unwrap_err().hint.as_deref(), Some("did you mean E?"));
}

#[test]
fn functions_and_signs_of_other_notations_get_a_hint() {
    let hint = |text: &str| Formula::parse(text).unwrap_err().hint.unwrap();
    let cases = [
        ("pow(2, 3)", "a power is written with ^, such as x^2"),
        ("ASIN(0.5)", "the arc sine of x is atan(x / sqrt(1 - x^2))"),
        ("squrt(2)", "did you mean sqrt?"),
        ("spring(2)", "a product is written spring * ( ... )"),
        ("lg(2)", "did you mean log10?"),
        ("tg(2)", "did you mean tan?"),
        ("ctg(2)", "the cotangent of x is 1 / tan(x)"),
        ("arctg(2)", "did you mean atan?"),
        ("arcctg(2)", "the arc cotangent of x is pi / 2 - atan(x)"),
        ("int(2)", "without its decimals, a positive x is floor(x), and a negative one -floor(-x)"),
        ("Trunc(2)", "without its decimals, a positive x is floor(x), and a negative one -floor(-x)"),
        ("2 (3)", "a product is written with *"),
        ("1 + 2 spring", "a product is written with *"),
        ("1 + 2 mm", "numbers have no units in formulas; a product is written with *"),
        ("(2mm)", "numbers have no units in formulas; a product is written with *"),
        ("slip mm", "a product is written with *"),
        ("2 × 3", "write * instead"),
        ("2 * µ", "names consist of the letters a to z and A to Z, digits and _"),
    ];
    for (text, expected) in cases {
        assert_eq!(hint(text), expected, "{text}");
    }
}

#[test]
fn derives_units() {
    let cases = [
        ("2 * 3 + 1", "free"),
        ("sqrt(0.5)", "free"),
        ("2^0.5", "free"),
        ("K * position / force / 100", "a pure number"),
        ("0.1 * (Fs + 50 * force) / (50 * force)", "a pure number"),
        ("f * velocity / force", "a pure number"),
        ("-force / velocity", "N s/m"),
        ("1 / velocity", "s/m"),
        ("velocity^2", "m2/s2"),
        ("velocity^(4 / 2) / velocity", "m/s"),
        ("sqrt(velocity^2)", "m/s"),
        ("force + 0", "N"),
        ("max(0, force)", "N"),
        ("slip + 1", "a pure number"),
        ("1 - slip", "a pure number"),
        ("exp(-slip)", "a pure number"),
        ("sin(1)", "free"),
        ("slip^slip", "a pure number"),
        ("2^slip", "a pure number"),
        ("atan2(force, Fs)", "a pure number"),
        ("abs(-velocity)", "m/s"),
        ("later", "m"),
    ];
    for (text, expected) in cases {
        assert_eq!(unit(text), expected, "{text}");
    }
}

#[test]
fn rejects_mismatched_units() {
    let cases = [
        ("Fs + velocity", "Fs + velocity", "Fs is in N but velocity is in m/s"),
        ("50 + Fs", "50 + Fs", "50 is a pure number but Fs is in N"),
        ("Fs - slip", "Fs - slip", "Fs is in N but slip is a pure number"),
        ("min(Fs, position)", "min(Fs, position)", "Fs is in N but position is in m"),
        ("2^Fs", "Fs", "the exponent Fs is in N"),
        ("Fs^slip", "slip", "Fs is in N, so its exponent must be a number, and slip is not"),
        ("Fs^99", "99", "Fs is in N, so its exponent can be at most 12, not 99"),
        ("sin(position)", "position", "sin takes a pure number, but position is in m"),
        ("forse", "forse", "forse is not known here"),
    ];
    for (text, part, message) in cases {
        let expected = (part.to_owned(), message.to_owned());
        assert_eq!(fault(formula(text).dimension(&scope()), text), expected, "{text}");
    }
    let hint = formula("50 + Fs").dimension(&scope()).unwrap_err().hint;
    assert_eq!(
        hint.as_deref(),
        Some("declare 50 as a parameter in N, or write its volts times a scale in N")
    );
}

#[test]
fn lists_names_once_in_order() {
    assert_eq!(formula("b * a + sqrt(b) - pi * c^a").names(), ["b", "a", "c"]);
}

#[test]
fn constants_are_formulas() {
    assert_eq!(Formula::constant(0.25).text(), "0.25");
    assert_eq!(Formula::constant(1e-12).text(), "1e-12");
    assert_eq!(Formula::constant(-3.0).evaluate(&NoNames), Ok(-3.0));
    assert!(Formula::constant(f64::NAN).evaluate(&NoNames).is_err());
}

proptest! {
    #[test]
    fn nothing_panics_on_any_text(text in "\\PC*") {
        if let Err(error) = Formula::parse(&text) {
            prop_assert!(text.get(error.range).is_some());
        }
    }

    #[test]
    fn nothing_panics_on_formula_like_text(
        text in "((force|Tc|slip|[0-9.]{1,3}|sqrt\\(|min\\(|\\(|pi)[-+*/^,) ]{0,2}){0,12}\\)?"
    ) {
        if let Ok(formula) = Formula::parse(&text) {
            let faults = [
                formula.evaluate(&scope()).err(),
                formula.dimension(&scope()).err(),
            ];
            for error in faults.into_iter().flatten() {
                prop_assert!(text.get(error.range).is_some());
            }
        }
    }

    #[test]
    fn constants_keep_their_value(number in prop::num::f64::NORMAL) {
        let constant = Formula::constant(number);
        prop_assert_eq!(constant.evaluate(&NoNames), Ok(number));
        prop_assert_eq!(formula(constant.text()).evaluate(&NoNames), Ok(number));
    }

    #[test]
    fn multiplying_and_dividing_keeps_the_dimension(
        a in "(force|velocity|f|slip|3)", b in "(K|position|Fs|slip|7)"
    ) {
        let there_and_back = formula(&format!("({a} * {b}) / {b}"));
        let found = there_and_back.dimension(&scope()).unwrap();
        let alone = formula(&a).dimension(&scope()).unwrap();
        prop_assert_eq!(found.or_dimensionless(), alone.or_dimensionless());
    }
}
