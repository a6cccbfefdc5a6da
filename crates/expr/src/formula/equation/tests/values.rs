//! The values of both sides, and unknown names.

use super::{SCOPE, equation, fault};

#[test]
fn both_sides_have_values() {
    let values = |text: &str| equation(text).evaluate(&SCOPE);
    assert_eq!(values("m v = -k x + 2 sign(v)"), Ok([-8.0, -7.0]));
    assert_eq!(values("x = limit(3 x, 0, 1) step(v) + dead_zone(v, 0.5)"), Ok([0.5, -1.5]));
    let cases = [
        ("x = delay(x, T)", "delay(x, T)", "delay(x, T) has no value here"),
        ("F = friction(v)", "friction(v)", "friction(v) has no value here"),
        ("x = sign(ln(v))", "ln(v)", "ln(v) has no finite value: v is -2"),
        ("x = limit(F, 0, 1 / u / 0)", "0", "the denominator is 0"),
    ];
    for (text, part, message) in cases {
        let (found, reason, _) = fault(values(text), text);
        assert_eq!((found.as_str(), reason.as_str()), (part, message), "{text}");
    }
}

#[test]
fn unknown_names_get_a_hint() {
    let unknown = |text: &str, name: &str| equation(text).unknown_name(name, &SCOPE).unwrap();
    let error = unknown("x' = 2 vx'", "vx'");
    assert_eq!((error.range, error.message.as_str()), (7..10, "vx is not known here"));
    assert_eq!(unknown("x' = V", "V").hint.as_deref(), Some("did you mean v?"));
    let error = unknown("V'(0) = 0", "V'(0)");
    assert_eq!((error.range, error.message.as_str()), (0..5, "V is not known here"));
    assert_eq!(error.hint.as_deref(), Some("did you mean v?"));
    assert_eq!(unknown("x' = step", "step").hint.as_deref(), Some("step is a function: write step( ... )"));
    let number = unknown("x = e^u", "e").hint.unwrap();
    assert_eq!(number, "the number e is exp(1), and e to the power of x is exp(x)");
    assert_eq!(equation("x' = v").unknown_name("w", &SCOPE), None);
}
