//! Findings about parts of a problem that do not agree: derivatives, initial values, tables and equations.

use super::{assert_finding, assert_no_finding, changed, findings};
use crate::document::Code;

#[test]
fn a_derivative_has_the_unit_of_its_quantity_per_time() {
    let wrong = |replacement: (&str, &str), part: &str, message: &str, hint: &str| {
        assert_finding(&[replacement], Code::UNIT_MISMATCH, part, message, hint);
    };
    let message = "\"m\" cannot be the unit of x': x is in mm";
    wrong(("\"m/s\"", "\"m\""), "\"m\"", message, "write \"unit\": \"mm/s\"");
    let from = "\"f\": {\"unit\": \"Hz\"}";
    let second = "\"f\": {\"unit\": \"Hz\"}, \"x''\": {\"unit\": \"m/s\"}";
    let message = "\"m/s\" cannot be the unit of x'': x is in mm";
    let hint = "write \"unit\": \"mm/s2\"";
    wrong((from, second), "\"m/s\"", message, hint);
    // An angle per second is not a number of cycles per second.
    let angle = "\"f\": {\"unit\": \"Hz\"}, \"a\": {\"unit\": \"rad\"}, \"a'\": {\"unit\": \"kHz\"}";
    let message = "\"kHz\" cannot be the unit of a': a is in rad";
    wrong((from, angle), "\"kHz\"", message, "write \"unit\": \"rad/s\"");
    let right = angle.replace("kHz", "deg/s");
    assert_no_finding(&changed(&[(from, right.as_str())]));
}

#[test]
fn the_time_of_a_problem_in_pure_numbers_is_a_pure_number() {
    let problem = |unit: &str| {
        format!(
            r#"{{"patchcord": 1, "quantities": {{"x": {{"unit": "1"}}, "x'": {{"unit": "{unit}"}}}},
                "equations": ["x'' = -x"], "run": {{"for": 9, "step": 0.01}}}}"#
        )
    };
    assert_no_finding(&problem("1"));
    let reason = "no unit of a quantity, drive or parameter contains a time, so the time is a pure number";
    let hint = format!("write \"unit\": \"1\": {reason}");
    let message = "\"1/s\" cannot be the unit of x': x is a pure number".to_owned();
    let expected = (Code::UNIT_MISMATCH, "\"1/s\"".to_owned(), message, hint);
    assert_eq!(findings(&problem("1/s")), [expected]);
}

#[test]
fn an_unknown_name_of_an_equation_can_be_declared() {
    let to = "push - spring(x) - h x";
    let hint = "declare h as a parameter or a quantity; known here: x, f, push, m, x0, n, w, F, t";
    let message = "h is not known here";
    assert_finding(&[("push - spring(x)", to)], Code::UNKNOWN_NAME, "h", message, hint);
    let to = "push - spring(x) - 2 h x";
    let hint = "numbers have no units in equations: declare 2 h as a parameter, with \"value\": 2 and \"unit\": \"h\"; or \
                declare h, if it is a quantity";
    assert_finding(&[("push - spring(x)", to)], Code::UNKNOWN_NAME, "h", message, hint);
}

#[test]
fn a_derivative_belongs_to_a_quantity() {
    let (from, code) = ("\"f\": {\"unit\": \"Hz\"}", Code::UNKNOWN_NAME);
    let with = |name: &str| format!("{from}, \"{name}\": {{\"unit\": \"m\"}}");
    let message = "y' is the derivative of y, which is not a quantity";
    let hint = "declare y as well: \"y\": {\"unit\": ...}";
    assert_finding(&[(from, with("y'").as_str())], code, "\"y'\"", message, hint);
    let hint = "remove it: only quantities have derivatives here";
    for (name, noun) in [("push", "a drive"), ("m", "a parameter")] {
        let message = format!("{name}' is the derivative of {name}, which is {noun}");
        let derivative = format!("{name}'");
        let part = format!("\"{derivative}\"");
        assert_finding(&[(from, with(&derivative).as_str())], code, &part, &message, hint);
    }
}

#[test]
fn an_initial_value_is_an_expression_of_parameters() {
    let from = "\"2 * x0\"";
    let wrong = |to: &str, code: Code, part: &str, message: &str, hint: &str| {
        let to = format!("\"{to}\"");
        assert_finding(&[(from, to.as_str())], code, part, message, hint);
    };
    let hint = "multiply or divide by parameters until it is in mm";
    let message = "the initial value of x is in kg, but x is in mm";
    wrong("2 * m", Code::UNIT_MISMATCH, "\"2 * m\"", message, hint);
    let message = "the initial value of x is a pure number, but x is in mm";
    wrong("n", Code::UNIT_MISMATCH, "\"n\"", message, hint);
    wrong("2 * xx0", Code::UNKNOWN_NAME, "xx0", "xx0 is not known here", "did you mean x0?");
    let message = "x0 is in mm but 1 is a pure number";
    wrong("x0 + 1", Code::UNIT_MISMATCH, "x0 + 1", message, "declare numbers with units as parameters");
    wrong("x0 / n", Code::BAD_FORMULA, "n", "the denominator n is 0", "");
    let message = "an initial value is an expression of parameters";
    for (name, noun) in [("f", "a quantity"), ("push", "a drive"), ("spring", "a table"), ("t", "the time")] {
        let hint = format!("{name} is {noun}: write a parameter in its place");
        wrong(&format!("x0 * {name}"), Code::BAD_FORMULA, name, message, &hint);
    }
    let message = "\"20 mm\" has a unit, but the unit of \"initial\" is fixed";
    let hint = "write 20, a number in mm";
    wrong("20 mm", Code::BAD_FORMULA, "mm", message, hint);

    let frequency = ("\"f\": {\"unit\": \"Hz\"}", "\"f\": {\"unit\": \"Hz\", \"initial\": \"w\"}");
    let message = "w is an angular frequency, but Hz is expected here";
    assert_finding(&[frequency], Code::UNIT_MISMATCH, "\"w\"", message, "divide it by (2 * pi)");
}

#[test]
fn an_initial_value_is_stated_once() {
    let equation = ("\"f = w\"", "\"f = w\", \"x(0) = x0\"");
    let message = "x has two initial values: this equation and its key \"initial\"";
    assert_finding(&[equation], Code::EXCLUDING_KEYS, "\"x(0) = x0\"", message, "");
    assert_no_finding(&changed(&[equation, ("\"initial\": \"2 * x0\", ", "")]));
}

#[test]
fn a_table_is_applied_to_an_argument_in_its_unit() {
    let from = "spring(x)";
    let (message, hint) = ("spring is a table", "write spring( ... ) with its argument in the parentheses");
    assert_finding(&[(from, "spring")], Code::BAD_FORMULA, "spring", message, hint);
    let message = "spring takes a quantity in m, but f is in Hz";
    let hint = "multiply or divide by parameters until both sides have the same unit";
    assert_finding(&[(from, "spring(f)")], Code::UNIT_MISMATCH, "f", message, hint);
    let number = ("\"out\": \"N\"", "\"out\": \"1\"");
    let message = "push is in N but spring(x) is a pure number";
    let hint = "multiply spring(x) by a parameter in N";
    assert_finding(&[number], Code::UNIT_MISMATCH, "push - spring(x)", message, hint);
}

#[test]
fn unused_drives_and_tables_get_a_warning() {
    let hint = "use it in an equation, or remove it";
    let message = "no equation contains the drive push";
    assert_finding(&[("push - ", "-")], Code::UNUSED_ELEMENT, "\"push\"", message, hint);
    let message = "no equation contains the table spring";
    assert_finding(&[(" - spring(x)", "")], Code::UNUSED_ELEMENT, "\"spring\"", message, hint);
}

#[test]
fn messages_about_equations_name_quantities() {
    let unknown = ("\"f = w\"", "\"f = w\", \"x' = v\"");
    let hint = "add v to the quantities, or write x'";
    assert_finding(&[unknown], Code::UNKNOWN_NAME, "v", "v is not known here", hint);
    let derivative = ("\"f = w\"", "\"f = w\", \"x' = x0'\"");
    let message = "x0 is a parameter and has no derivative";
    let hint = "primes follow the names of quantities, drives and auxiliary quantities";
    assert_finding(&[derivative], Code::BAD_FORMULA, "x0'", message, hint);
    let initial = ("\"f = w\"", "\"f = w\", \"push(0) = F\"");
    let message = "push is a drive and has no initial value";
    let hint = "only quantities have initial values, such as x(0)";
    assert_finding(&[initial], Code::BAD_FORMULA, "push(0)", message, hint);
    let circular = ("\"f = w\"", "\"f = w\", \"a = 2 a\"");
    let message = "the auxiliary quantity a depends on itself";
    let hint = "add a to the quantities, or define a by other quantities";
    assert_finding(&[circular], Code::BAD_FORMULA, "a", message, hint);
}
