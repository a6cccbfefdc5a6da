//! The text of constant expressions.

use patchcord_core::circuit::Circuit;
use patchcord_expr::{Dimension, Formula};
use serde_json::json;

use super::super::expressions::Expressions;
use super::super::formula::{SettingFormula, json_number};
use super::Sketch;
use crate::symbolic::{Fraction, absolute, opaque, root};

/// A problem with some parameters.
fn sketch() -> Sketch {
    Sketch::new(
        r#"{"patchcord": 1, "parameters": {"m": {"value": 2, "unit": "kg", "range": [1, 4]},
            "k": {"value": 40, "unit": "N/m"}, "c": {"value": 0.8, "unit": "N s/m"},
            "r": {"value": 0.3, "unit": "1", "range": [-1, 0.5]}, "q": {"value": 1.7, "unit": "1"}},
        "quantities": {"x": {"unit": "m", "initial": 1}}, "equations": ["x' = 0"], "run": {"for": 1, "step": 1e-3}}"#,
    )
}

/// The text of an expression, with its value by the parser of formulas compared with the exact one.
fn text(expression: &str) -> String {
    let sketch = sketch();
    let expressions = Expressions::new(&sketch.plan.symbols, &sketch.circuit);
    let exact = sketch.read(expression);
    let text = SettingFormula::one().times(&exact, &expressions).text().unwrap();
    let parsed = Formula::parse(&text).unwrap_or_else(|error| panic!("{text}: {error:?}"));
    let found = parsed.evaluate(sketch.circuit.quantities()).unwrap();
    let expected = expressions.value(&exact);
    assert!((found - expected).abs() <= 1e-14 * expected.abs(), "{text}: {found} instead of {expected}");
    text
}

#[test]
fn expressions_are_written_with_all_operators() {
    let cases = [
        ("k/m", "k / m"),
        ("-k/m", "-k / m"),
        ("1/m", "1 / m"),
        ("k m^2", "m^2 * k"),
        ("c/(k m)", "c / m / k"),
        ("0.5 k/m", "0.5 * k / m"),
        ("k/10", "k / 10"),
        ("k/3", "k / 3"),
        ("2 k/3", "2 * k / 3"),
        ("0.015 r", "0.015 * r"),
        ("0", "0"),
        ("7", "7"),
        ("-1", "-1"),
        ("1/m^2", "1 / m^2"),
        ("1e9 k", "1e9 * k"),
        ("k/1e5", "k / 100000"),
        ("k/1e9", "k / 1e9"),
        ("1234 k/5677", "1234 * k / 5677"),
    ];
    for (expression, expected) in cases {
        assert_eq!(text(expression), expected, "{expression}");
    }
}

#[test]
fn a_number_that_is_not_exact_is_a_decimal() {
    // 20 / ln(10), with ln(10) as a decimal.
    let written = text("1e16 k/1151292546497023");
    assert!(written.starts_with("8.685889638065") && written.ends_with(" * k"), "{written}");
    assert!(text("k/12345678").starts_with("8.1000006642"), "{}", text("k/12345678"));
}

#[test]
fn sums_are_in_parentheses_if_they_are_factors() {
    let expressions = ["r - q", "(r - q)/(r + q)^2", "1 - r q - 3 q^2", "(k/m) (r - 1)", "0.3 - r/(1 + r)"];
    for expression in expressions {
        text(expression);
    }
    assert_eq!(text("1 + r"), "1 + r");
    assert_eq!(text("q - r"), "q - r");
    assert_eq!(text("k (1 + r)"), "k * (1 + r)");
    assert_eq!(text("k/(r + 1)"), "k / (1 + r)");
}

#[test]
fn sums_have_the_factors_that_all_terms_have() {
    assert_eq!(text("2 k (0.5 m^2 q + r)/m^2"), "k * (q + 2 * r / m^2)");
    assert_eq!(text("2 (0.5 m^2 q + r)/m^2"), "q + 2 * r / m^2");
    assert_eq!(text("(q + 2 r/m)/m"), "(q + 2 * r / m) / m");
    assert_eq!(text("3 q + 6 r"), "3 * (q + 2 * r)");
    assert_eq!(text("q/2 - r/3"), "0.5 * q - r / 3");
    assert_eq!(text("-k q - k r"), "-k * (q + r)");
    assert_eq!(text("1/(q + 2 r/m)"), "m / (2 * r + m * q)");
}

#[test]
fn functions_of_parameters_are_written() {
    let sketch = sketch();
    let expressions = Expressions::new(&sketch.plan.symbols, &sketch.circuit);
    let written = |expression: &Fraction| SettingFormula::one().times(expression, &expressions).text();
    assert_eq!(written(&root(&sketch.read("k q"))).as_deref(), Some("sqrt(k * q)"));
    let difference = sketch.read("r - q");
    assert!(written(&absolute(&difference)).unwrap().starts_with("abs("));
    // Formulas have no table.
    assert_eq!(written(&opaque(crate::symbolic::Operation::Table(0), vec![difference])), None);
}

#[test]
fn signs_and_steps_of_parameters_are_written() {
    assert_eq!(text("step(r + q)"), "1");
    assert_eq!(text("step(r - q)"), "(1 + floor(atan2(min(r - q, 0), abs(r - q))))");
    for expression in ["step(r - 0.2)", "step(0.2 - r)", "k step(c - 2 m k)", "sign(q - r)", "sign(-r - 1)"] {
        text(expression);
    }
    let patch = sketch().problem.patch;
    let cases = [
        ("step(r - q)", 0.3, 1.0),
        ("step(r - q)", 0.300_000_000_000_000_04, 0.0),
        ("step(r - q)", 1e300, 0.0),
        ("step(r - q)", 0.2, 1.0),
        ("step(-q)", 0.0, 1.0),
        ("step(-q)", 3e-300, 0.0),
        ("sign(r - q)", 0.3, 0.0),
    ];
    for (expression, q, expected) in cases {
        let circuit =
            Circuit::with_parameters(&patch, [("q", q)]).unwrap_or_else(|report| panic!("{report}"));
        let formula = Formula::parse(&text(expression)).unwrap();
        assert_eq!(formula.evaluate(circuit.quantities()), Ok(expected), "{expression} at q = {q}");
    }
}

#[test]
fn a_setting_without_a_text_is_a_number() {
    let sketch = sketch();
    let expressions = Expressions::new(&sketch.plan.symbols, &sketch.circuit);
    let without_text = opaque(crate::symbolic::Operation::Table(0), vec![sketch.read("r")]);
    assert_eq!(SettingFormula::one().times(&without_text, &expressions).setting(0.25), json!(0.25));
    assert_eq!(SettingFormula::one().over_number(3.0).setting(1.0 / 3.0), json!(0.333333333333333));
    assert_eq!(SettingFormula::one().times(&sketch.read("k"), &expressions).setting(40.0), json!("k"));
}

#[test]
fn equal_factors_cancel_and_the_time_scale_is_last() {
    let sketch = sketch();
    let mut expressions = Expressions::new(&sketch.plan.symbols, &sketch.circuit);
    let [x, y] = ["x", "y"].map(|name| expressions.add_scale(name, Dimension::LENGTH, 0.5));
    let product = SettingFormula::one().times(&sketch.read("k/m"), &expressions);
    let same = product.clone().times(&x, &expressions).over(&x, &expressions).over_number(10.0);
    assert_eq!(same.text().unwrap(), "k / m / 10");
    let other = product.times(&x, &expressions).over(&y, &expressions).over_number(10.0).times_time_scale(-1);
    assert_eq!(other.text().unwrap(), "k / m * x / y / 10 / time_scale");
    let reciprocal = SettingFormula::one().times(&sketch.read("1/m"), &expressions).times(&x, &expressions);
    assert_eq!(reciprocal.text().unwrap(), "x / m");
}

#[test]
fn the_largest_value_is_at_a_bound_of_the_ranges() {
    let sketch = sketch();
    let expressions = Expressions::new(&sketch.plan.symbols, &sketch.circuit);
    let largest = |text: &str| expressions.largest(&sketch.read(text));
    assert_eq!(largest("k/m"), 40.0);
    assert_eq!(largest("r"), 1.0);
    assert_eq!(largest("k"), 40.0);
    assert!(
        expressions.has_parameters(&sketch.read("2 k")) && !expressions.has_parameters(&sketch.read("2"))
    );
}

#[test]
fn numbers_of_documents_have_no_rounding() {
    assert_eq!(json_number(0.1 + 0.2).to_string(), "0.3");
    assert_eq!(json_number(30.000000000000004).to_string(), "30");
    assert_eq!(json_number(-0.0).to_string(), "0");
    assert_eq!(json_number(2.5e-7).to_string(), "2.5e-7");
}
