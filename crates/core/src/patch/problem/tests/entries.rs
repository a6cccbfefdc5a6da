//! Findings about single entries of a problem: keys, names, numbers and points.

use super::{assert_finding, assert_no_finding, changed, findings};
use crate::document::Code;

#[test]
fn unknown_keys_are_errors_with_a_hint() {
    let unknown = |from: &str, to: &str, of: &str, hint: &str| {
        let key = to.split(':').next().unwrap();
        let message = format!("{key} is not a key of {of}");
        assert_finding(&[(from, to)], Code::UNKNOWN_KEY, key, &message, hint);
    };
    let meaning = "did you mean \"maximum\", the largest magnitude that is expected?";
    unknown("\"maximum\": 100", "\"max\": 100", "the quantity x", meaning);
    let meaning = "did you mean \"initial\", the value at the start?";
    unknown("\"initial\": 0", "\"start\": 0", "the quantity x'", meaning);
    let meaning = "did you mean \"per_volt\", the value of one volt in the unit of the quantity?";
    unknown("\"per_volt\": 0.5", "\"scale\": 0.5", "the quantity x'", meaning);
    unknown("\"description\": \"p", "\"descripton\": \"p", "the quantity x", "did you mean \"description\"?");
    unknown("\"unit\": \"Hz\"", "\"units\": \"Hz\"", "the quantity f", "did you mean \"unit\"?");
    let meaning = "did you mean \"quantities\", the quantities of the equations with their units?";
    unknown("\"quantities\": {", "\"variables\": {", "the problem", meaning);
    let meaning = "did you mean \"drives\", the given functions of time?";
    unknown("\"drives\": {", "\"inputs\": {", "the problem", meaning);
    let hint = "choose the machine by `patchcord scale --machine NAME`";
    unknown("\"title\": \"A", "\"machine\": \"A", "the problem", hint);
    let meaning = "did you mean \"out\", the unit of the value?";
    unknown("\"out\": \"N\"", "\"output\": \"N\"", "the table spring", meaning);
}

#[test]
fn a_drive_has_a_unit_and_depends_on_parameters() {
    let message = "a drive of a problem has a \"unit\" in place of a \"scale\"";
    let hint = "write \"unit\", the unit of its settings: `patchcord scale` chooses the scale";
    let (from, to) = ("\"unit\": \"N\", \"amplitude\"", "\"scale\": \"N\", \"amplitude\"");
    assert_finding(&[(from, to)], Code::UNKNOWN_KEY, "\"scale\"", message, hint);

    let from = "\"amplitude\": \"F\"";
    for (name, noun) in [
        ("f", "a quantity"),
        ("push", "a drive"),
        ("t", "the time"),
        ("time_scale", "the time scale of a machine"),
    ] {
        let to = format!("\"amplitude\": \"2 * {name}\"");
        let message = "a setting of a drive is an expression of parameters";
        let hint = format!("{name} is {noun}: write a parameter in its place");
        assert_finding(&[(from, to.as_str())], Code::BAD_FORMULA, name, message, &hint);
    }
}

#[test]
fn hints_about_a_drive_name_its_unit_and_no_scale() {
    let from = "\"amplitude\": \"F\"";
    let number = |written: &str, unit: &str, hint: &str| {
        let to = format!("\"amplitude\": \"{written}\"");
        let message = format!("\"{written}\" has a unit, but the unit of \"amplitude\" is fixed");
        assert_finding(&[(from, to.as_str())], Code::BAD_FORMULA, unit, &message, hint);
    };
    number("5 V", "V", "write a number in N");
    number("5 mN", "mN", "write 0.005, a number in N");
    let message = "\"slope\" is not a key of the drive push";
    let hint = "known here: kind, note, amplitude, frequency, phase, offset, unit";
    let to = "\"amplitude\": \"F\", \"slope\": 1";
    assert_finding(&[(from, to)], Code::UNKNOWN_KEY, "\"slope\"", message, hint);

    let from = r#""kind": "sine", "unit": "N", "amplitude": "F", "frequency": 2"#;
    let to = r#""kind": "ramp", "unit": "N", "rate": "5 mm/s""#;
    let message = "\"5 mm/s\" has a unit, but the unit of \"rate\" is fixed";
    assert_finding(&[(from, to)], Code::BAD_FORMULA, "mm", message, "write a number in N/s");
}

#[test]
fn hints_about_units_that_differ_name_no_scale() {
    let hint = "multiply or divide by parameters until both sides have the same unit";
    let mismatch = |from: &str, to: &str, part: &str, message: &str, hint: &str| {
        assert_finding(&[(from, to)], Code::UNIT_MISMATCH, part, message, hint);
    };
    let (from, to) = ("push - spring(x)", "push - spring(x) + x");
    mismatch(from, to, "push - spring(x) + x", "push - spring(x) is in N but x is in mm", hint);
    let message = "m is in kg, but N is expected here";
    let from = "\"amplitude\": \"F\"";
    mismatch(from, "\"amplitude\": \"m\"", "\"m\"", message, hint);
    let (message, hint) = ("5 is a pure number but F is in N", "declare 5 as a parameter in N");
    mismatch(from, "\"amplitude\": \"5 + F\"", "5 + F", message, hint);
    let (message, hint) = ("sin takes a pure number, but F is in N", "divide it by a parameter in N");
    mismatch(from, "\"amplitude\": \"F * sin(F)\"", "F", message, hint);
    let message = "F is in N, but a pure number is expected here";
    let hint = "divide it by a quantity in N, made of parameters";
    mismatch("\"frequency\": 2", "\"frequency\": 2, \"phase\": \"F\"", "\"F\"", message, hint);
}

#[test]
fn a_maximum_is_a_positive_number() {
    let from = "\"maximum\": 100";
    let message = "\"maximum\" must be above 0, not -5";
    assert_finding(&[(from, "\"maximum\": -5")], Code::BAD_NUMBER, "-5", message, "");
    assert_finding(
        &[(from, "\"maximum\": 0")],
        Code::BAD_NUMBER,
        "0",
        "\"maximum\" must be above 0, not 0",
        "",
    );
    assert_finding(
        &[(from, "\"maximum\": \"100 mm\"")],
        Code::WRONG_TYPE,
        "\"100 mm\"",
        "\"maximum\" must be a number, not a text",
        "write the number alone without quotes: the key \"unit\" gives the unit of \"maximum\"",
    );
    let message = "\"maximum\" must be a number, not a text";
    let hint = "write 0.5 without quotes";
    assert_finding(&[(from, "\"maximum\": \"0,5\"")], Code::WRONG_TYPE, "\"0,5\"", message, hint);
    let to = [("\"unit\": \"m/s\"", "\"unit\": \"km/s\""), ("\"per_volt\": 0.5", "\"per_volt\": 1e306")];
    let message = "\"per_volt\" is too large or too small in SI units";
    assert_finding(&to, Code::NOT_FINITE, "1e306", message, "");
}

#[test]
fn a_table_has_at_least_two_points_in_rising_order() {
    let from = "[[-1, -2], [1, 2]]";
    let message = "a table needs at least two points, and \"points\" has 1";
    let hint = "its segments connect neighbouring points, and the outermost segments continue";
    assert_finding(&[(from, "[[1, 2]]")], Code::BAD_NUMBER, "[[1, 2]]", message, hint);
    let message = "the inputs of a table must rise from point to point";
    let hint = "sort the points by their first number, and keep only one of those with the same first number";
    for second in ["[1, 3]", "[-2, 3]"] {
        let to = format!("[[1, 2], {second}]");
        assert_finding(&[(from, to.as_str())], Code::BAD_NUMBER, second, message, hint);
    }
    let message = "\"points\" must be a list of points, not a text";
    let hint = "write the points themselves: [[0, 0], [1, 2]]";
    assert_finding(&[(from, "\"s.csv\"")], Code::WRONG_TYPE, "\"s.csv\"", message, hint);
    let message = "a point is a list of two numbers";
    assert_finding(
        &[(from, "[[1, 2], [3]]")],
        Code::WRONG_TYPE,
        "[3]",
        message,
        "docs/problem-format.md describes every key",
    );
    let large = [(from, "[[1, 2], [3, 1e306]]"), ("\"out\": \"N\"", "\"out\": \"MN\"")];
    let message = "the points are too large in SI units, or too near to each other";
    assert_finding(&large, Code::NOT_FINITE, "[[1, 2], [3, 1e306]]", message, "");
}

#[test]
fn names_are_unique_and_not_reserved() {
    let renamed = |from: &str, name: &str| (format!("\"{from}\": {{"), format!("\"{name}\": {{"));
    let fault = |(from, to): (String, String), code: Code, message: &str, hint: &str| {
        let part = to.split(": ").next().unwrap().to_owned();
        let replacements = [(from.as_str(), to.as_str()), ("push - spring(x)", "2 * F")];
        assert_finding(&replacements, code, &part, message, hint);
    };
    let rename = "rename one of them";
    let message = "the drive x has the name of a quantity";
    fault(renamed("push", "x"), Code::DUPLICATE_NAME, message, rename);
    let message = "the quantity n has the name of a parameter";
    fault(
        (r#""f": {"unit""#.to_owned(), r#""n": {"unit""#.to_owned()),
        Code::DUPLICATE_NAME,
        message,
        rename,
    );
    let message = "the table x has the name of a quantity";
    fault(renamed("spring", "x"), Code::DUPLICATE_NAME, message, rename);
    let message = "the table push has the name of a drive";
    fault(renamed("spring", "push"), Code::DUPLICATE_NAME, message, rename);
    let hint = "t is the time in equations";
    fault(renamed("n", "t"), Code::BAD_NAME, "\"t\" cannot name a parameter", hint);
    fault(renamed("spring", "t"), Code::BAD_NAME, "\"t\" cannot name a table", hint);
    let hint = "the name is reserved in formulas";
    fault(renamed("spring", "sin"), Code::BAD_NAME, "\"sin\" cannot name a table", hint);
    fault(renamed("push", "floor"), Code::BAD_NAME, "\"floor\" cannot name a drive", hint);
    let hint = "it is the name of a function";
    fault(renamed("spring", "sign"), Code::BAD_NAME, "\"sign\" cannot name a table", hint);
    fault(renamed("f", "step"), Code::BAD_NAME, "\"step\" cannot name a quantity", hint);
    fault(renamed("push", "delay"), Code::BAD_NAME, "\"delay\" cannot name a drive", hint);
    fault(renamed("n", "limit"), Code::BAD_NAME, "\"limit\" cannot name a parameter", hint);
    fault(renamed("push", "run"), Code::BAD_NAME, "\"run\" cannot name a drive", "the name is reserved");
}

#[test]
fn initial_values_and_many_primes_are_no_quantities() {
    let from = "\"f\": {\"unit\": \"Hz\"}";
    let with = |name: &str| format!("{from}, \"{name}\": {{\"unit\": \"m\"}}");
    let message = "an initial value is not a quantity of its own";
    let hint = "write \"initial\" in the quantity: \"x\": {\"unit\": \"mm\", \"initial\": 50}";
    assert_finding(&[(from, with("x(0)").as_str())], Code::BAD_NAME, "\"x(0)\"", message, hint);
    let name = format!("x{}", "'".repeat(10));
    let hint = "declare a lower derivative as a quantity of its own";
    let part = format!("\"{name}\"");
    let message = "a name has at most 9 primes";
    assert_finding(&[(from, with(&name).as_str())], Code::BAD_NAME, &part, message, hint);
}

#[test]
fn a_short_form_gets_the_full_form() {
    let from = "\"f\": {\"unit\": \"Hz\"}";
    let message = "the quantity f must be an object, not a text";
    let hint = "write \"f\": {\"unit\": \"Hz\"}";
    assert_finding(&[(from, "\"f\": \"Hz\"")], Code::WRONG_TYPE, "\"Hz\"", message, hint);
    let message = "the quantity f must be an object, not a number";
    let hint = "write \"f\": {\"unit\": \"1\", \"initial\": 5}, with its unit in place of \"1\"";
    assert_finding(&[(from, "\"f\": 5")], Code::WRONG_TYPE, "5", message, hint);
}

#[test]
fn a_run_has_a_length_a_step_and_no_phases() {
    let from = "\"for\": 3, \"step\"";
    let hint = "the length of the run in s";
    assert_finding(&[(from, "\"step\"")], Code::MISSING_KEY, "{", "\"run\" needs \"for\"", hint);
    let hint = "write \"step\": 0.003, in s, or \"tolerance\": 1e-6 for steps that adapt";
    let message = "\"run\" needs \"step\" or \"tolerance\"";
    assert_finding(&[("\"for\": 3, \"step\": 0.001", "\"for\": 3")], Code::MISSING_KEY, "{", message, hint);
    assert_no_finding(&changed(&[("\"step\": 0.001", "\"tolerance\": 1e-6")]));
    let to = "\"phases\": [{\"operate\": 3}], \"step\"";
    let message = "the run of a problem has no phases";
    let hint = "write \"for\", the length of the run; add phases to the patch that `patchcord scale` makes";
    assert_finding(&[(from, to)], Code::UNKNOWN_KEY, "[{\"operate\": 3}]", message, hint);
    let hint = "the length of the run in s: \"run\": {\"for\": 10, \"step\": 0.01}";
    let message = "the problem needs \"run\"";
    let removed = ("],\n  \"run\": {\"for\": 3, \"step\": 0.001}", "]");
    assert_finding(&[removed], Code::MISSING_KEY, "{", message, hint);
}

#[test]
fn a_problem_has_quantities_and_equations() {
    let run = r#""run": {"for": 1, "step": 0.01}"#;
    let empty = format!(r#"{{"patchcord": 1, "quantities": {{}}, "equations": [], {run}}}"#);
    let found = findings(&empty);
    let messages: Vec<&str> = found.iter().map(|(_, _, message, _)| message.as_str()).collect();
    assert_eq!(messages, ["the problem has no quantities", "the problem has no equations"]);
    assert!(found.iter().all(|(code, ..)| *code == Code::MISSING_KEY));
    // Names that the missing section could declare are not reported as well.
    let missing = format!(r#"{{"patchcord": 1, "equations": ["x' = -x"], {run}}}"#);
    let message = "the problem needs \"quantities\"".to_owned();
    let hint = "the unknowns with their units: \"quantities\": {\"x\": {\"unit\": \"mm\", \"initial\": 50}}"
        .to_owned();
    assert_eq!(findings(&missing), [(Code::MISSING_KEY, "{".to_owned(), message, hint)]);
}
