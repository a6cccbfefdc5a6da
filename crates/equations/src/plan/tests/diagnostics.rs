//! The faults of problems whose equations do not determine their quantities.

use super::faults;

/// Asserts that a problem with the parameter p = 2 and these quantities and equations has one fault, with this place in
/// the text, message and hint.
fn assert_fault(quantities: &str, equations: &str, [place, message, hint]: [&str; 3]) {
    assert_eq!(found(quantities, equations), [[place, message, hint].map(str::to_owned)], "{equations}");
}

/// The faults of a problem with the parameter p = 2 and the step u.
fn found(quantities: &str, equations: &str) -> Vec<[String; 3]> {
    found_with(r#""kind": "step", "height": 1"#, quantities, equations)
}

/// The faults of a problem with the parameter p = 2 and the drive u with these settings.
fn found_with(drive: &str, quantities: &str, equations: &str) -> Vec<[String; 3]> {
    faults(&format!(
        r#""parameters": {{"p": {{"value": 2, "unit": "1"}}}},
        "drives": {{"u": {{"unit": "1", {drive}}}}},
        "quantities": {{{quantities}}}, "equations": [{equations}]"#
    ))
}

/// The quantity x with an initial value.
const X: &str = r#""x": {"unit": "1", "initial": 1}"#;

#[test]
fn states_need_initial_values() {
    let fault = ["\"x\"", "x needs \"initial\"", "add \"initial\": 0, or the value of x at the start"];
    assert_fault(r#""x": {"unit": "1"}"#, r#""x' = -x""#, fault);
    let hint = "add \"x'\": {\"unit\": \"1\", \"initial\": 0} to the quantities, with its value at the start";
    assert_fault(X, r#""x'' = -x""#, ["x''", "x' needs an initial value", hint]);
}

#[test]
fn other_quantities_have_no_initial_values() {
    let quantities = format!(r#"{X}, "y": {{"unit": "1", "initial": 5}}"#);
    let message = "an equation determines y, so it has no initial value";
    let hint = "remove \"initial\": only quantities whose derivative is in an equation have one";
    assert_fault(&quantities, r#""x' = -y", "y = p x""#, ["5", message, hint]);
    let message = "an equation determines x', so it has no initial value";
    let hint = "remove this equation: another one determines x'";
    assert_fault(X, r#""x' = -x", "x'(0) = 1""#, ["\"x'(0) = 1\"", message, hint]);
}

#[test]
fn the_initial_value_of_an_equation_is_finite() {
    let quantities = r#""x": {"unit": "1"}"#;
    let message = "the initial value is not a finite number";
    let hint = "look for a division by 0 or a wrong power of ten";
    assert_fault(quantities, r#""x' = -x", "x(0) = 1 / (p - 2)""#, ["1 / (p - 2)", message, hint]);
}

#[test]
fn there_are_as_many_equations_as_unknowns() {
    let message = "other equations determine x' already";
    assert_fault(X, r#""x' = -x", "2 x' = u""#, ["\"2 x' = u\"", message, "remove one of these equations"]);
    let message = "this equation contains neither a highest derivative nor an algebraic quantity";
    let hint = "remove it, or add the quantity that it determines";
    assert_fault(X, r#""x' = -x", "p x = u""#, ["\"p x = u\"", message, hint]);
    let quantities = format!(r#"{X}, "y": {{"unit": "1"}}"#);
    let hint = "add an equation such as y = ..., or remove y";
    assert_fault(&quantities, r#""x' = -x""#, ["\"y\"", "no equation determines y", hint]);
    let quantities = format!(r#"{X}, "y": {{"unit": "1", "initial": 0}}"#);
    let hint = "add an equation that contains y'";
    assert_fault(&quantities, r#""x' = -x - y'""#, ["y'", "no equation determines y'", hint]);
}

#[test]
fn derivatives_belong_to_states() {
    let quantities = format!(r#"{X}, "F": {{"unit": "1"}}"#);
    let message = "F' is the derivative of a quantity that another equation defines";
    let hint = "in place of F', write the derivative of F = p x";
    assert_fault(&quantities, r#""F = p x", "x' = -F - p F'""#, ["F'", message, hint]);
    let message = "u' is the derivative of the drive u, which no element computes";
    assert_fault(X, r#""x' = u' - x""#, ["u'", message, "add a drive for u', and write its name here"]);
    let quantities = format!(r#"{X}, "x'": {{"unit": "1"}}, "x''": {{"unit": "1"}}"#);
    let hint = "remove x'', or write an equation that contains it";
    assert_fault(&quantities, r#""x' = -x""#, ["\"x''\"", "no equation contains x''", hint]);
}

#[test]
fn the_derivatives_of_sines_and_ramps_are_known() {
    let hint = |drive: &str, equation: &str| found_with(drive, X, equation).remove(0)[2].clone();
    let sine = r#""kind": "sine", "amplitude": 1, "frequency": 2"#;
    let expected = "add a drive of the kind sine for u', and write its name here: its amplitude is that of u times \
                    2 pi frequency, its frequency is the same, its phase is larger by pi/2, and its offset is 0";
    assert_eq!(hint(sine, r#""x' = u' - x""#), expected);
    assert_eq!(hint(sine, r#""x' = u'' - x""#), "add a drive for u'', and write its name here");
    let ramp = r#""kind": "ramp", "rate": 3"#;
    let expected = "add a parameter with the \"rate\" of u, and write its name here";
    assert_eq!(hint(ramp, r#""x' = u' - x""#), expected);
    let reversing = format!(r#"{ramp}, "turn": 1"#);
    assert_eq!(hint(&reversing, r#""x' = u' - x""#), "add a drive for u', and write its name here");
}

#[test]
fn an_equation_determines_its_unknown() {
    let message = "the factor of x' is 0, so this equation does not determine it";
    let hint = "choose parameters for which the factor is not 0, or remove x'";
    assert_fault(X, r#""(p - 2) x' = -x""#, ["x'", message, hint]);
    assert_fault(X, r#""x' = x' - x""#, ["x'", message, hint]);
    let quantities = format!(r#"{X}, "a": {{"unit": "1"}}, "b": {{"unit": "1"}}"#);
    let message = "no equation determines b: they only set quantities equal to each other";
    let hint = "write an equation of b and other quantities";
    assert_fault(&quantities, r#""x' = -x", "a = b", "b = a""#, ["b", message, hint]);
    let quantities = format!(r#"{X}, "y": {{"unit": "1"}}"#);
    let message = "both sides have the same value for every y";
    let hint = "write an equation that determines y";
    assert_fault(&quantities, r#""x' = -x", "sin(y) + x = x + sin(y)""#, ["y", message, hint]);
}

#[test]
fn equations_that_share_their_unknowns_determine_all_of_them() {
    let quantities = format!(r#"{X}, "y": {{"unit": "1", "initial": 2}}"#);
    let message = "2 equations do not determine x', y'";
    let hint =
        "the same combination of these is in several of the equations: change one of them, or a parameter";
    for equations in [r#""x' + y' = -x", "p x' + p y' = y""#, r#""x' + y' = -x", "x' + (p - 1) y' = y""#] {
        assert_fault(&quantities, equations, ["x'", message, hint]);
    }
}

#[test]
fn an_implicit_equation_has_a_solution_at_the_start() {
    let quantities = format!(r#"{X}, "y": {{"unit": "1"}}"#);
    let message = "no value of y at the start is found that satisfies this equation";
    let hint = "give y an \"initial\" near its value at the start";
    for equation in ["p sin(y) = 3 x", "exp(y) = -x"] {
        let equations = format!(r#""x' = -x", "{equation}""#);
        assert_fault(&quantities, &equations, ["y", message, hint]);
    }
    let message = "the value of ln(x) at the start is not finite, and a delay needs it";
    let hint = "choose initial values for which ln(x) has a value";
    let quantities = r#""x": {"unit": "1", "initial": -1}, "y": {"unit": "1"}"#;
    assert_fault(quantities, r#""x' = -x", "y = delay(ln(x), 1)""#, ["", message, hint]);
}
