//! Choices and conditions.

use super::{Fixture, Purity, check};
use crate::derive::{ModeLaw, TransitionLaw};
use crate::symbolic::{Fraction, SymbolKind};

#[test]
fn a_choice_is_written_as_cases() {
    check(&[
        ("step(x) y", "{y if x >= 0; 0 otherwise}"),
        ("step(x - w) y + (1 - step(x - w)) z", "{y if x >= w; z otherwise}"),
        ("2 step(x) - 1", "{1 if x >= 0; -1 otherwise}"),
        ("step(-x)", "{1 if x <= 0; 0 otherwise}"),
        ("k x step(w - x)", "{k x if x <= w; 0 otherwise}"),
        ("x + 2 step(y)", "{x + 2 if y >= 0; x otherwise}"),
        ("step(x)/(1 + step(x))", "{0.5 if x >= 0; 0 otherwise}"),
        ("sin(x + step(y))", "{sin(x + 1) if y >= 0; sin(x) otherwise}"),
        ("abs(step(x) - y)", "{abs(y - 1) if x >= 0; abs(y) otherwise}"),
        ("step(x) step(y)", "{1 if y >= 0 and x >= 0; 0 otherwise}"),
        ("step(x)^2 - step(x)", "0"),
    ]);
}

#[test]
fn opposite_steps_have_a_value_of_their_own_at_0() {
    check(&[
        ("step(x) - step(-x)", "{1 if x > 0; -1 if x < 0; 0 otherwise}"),
        ("step(x) + step(-x)", "{2 if x = 0; 1 otherwise}"),
        ("step(x) - step(x) step(-x)", "{1 if x > 0; 0 otherwise}"),
        ("step(x) + step(x) step(-x)", "{1 if x > 0; 0 if x < 0; 2 otherwise}"),
    ]);
}

#[test]
fn a_condition_decides_those_that_exclude_it() {
    check(&[("step(x - w) - step(-x - w)", "{1 if x >= w; -1 if x <= -w; 0 otherwise}")]);
}

#[test]
fn a_law_of_time_begins_with_the_earlier_values() {
    check(&[
        ("F step(t - 3)", "{0 if t < 3; F otherwise}"),
        ("x step(w - t) + y (1 - step(w - t))", "{x if t <= w; y otherwise}"),
    ]);
}

#[test]
fn the_fourth_condition_is_a_function() {
    let fixture = Fixture::new();
    let written = fixture.written(Purity::All, "step(x) + step(y) + step(z) + step(v)", "1");
    assert!(written.starts_with("{step(v) + 3 if x >= 0 and y >= 0 and z >= 0; "), "{written}");
    assert!(written.ends_with("; step(v) otherwise}"), "{written}");
}

#[test]
fn a_mode_is_a_condition_in_words() {
    check(&[
        ("relay F - k x", "{-k x if R is released; F - k x otherwise}"),
        ("relay step(y) x", "{0 if R is released; x if y >= 0; 0 otherwise}"),
        ("relay x - relay x + y", "y"),
        ("(1 - relay) (1 - relay/2) relay", "0"),
    ]);
}

/// A brake at an output. Its net rate and its level are in the quantities of the tests.
fn with_brake(output: &str, net: &str, level: &str) -> Fixture {
    let mut fixture = Fixture::new();
    let symbol = fixture.add("direction", "1", SymbolKind::Held, false);
    let change = |[from, to]: [f64; 2], guard: String| TransitionLaw {
        from,
        to,
        guard: fixture.read(&guard),
        is_strict: from == 0.0,
        reset: (to == 0.0).then(|| (symbol, Fraction::zero())),
    };
    let transitions = vec![
        change([0.0, 1.0], output.to_owned()),
        change([0.0, -1.0], format!("-({output})")),
        change([0.0, 1.0], format!("{net} - ({level})")),
        change([1.0, 0.0], format!("min(-({output}), {level} - ({net}))")),
        change([0.0, -1.0], format!("-({net}) - ({level})")),
        change([-1.0, 0.0], format!("min({output}, {level} + {net})")),
    ];
    let values = &[(0.0, "stuck"), (1.0, "slipping up"), (-1.0, "slipping down")];
    let (element, noun) = ("A".to_owned(), "brake");
    fixture.system.modes.push(ModeLaw { symbol, element, noun, values, initial: 0.0, transitions });
    fixture
}

#[test]
fn a_brake_holds_at_rest_and_opposes_motion() {
    let cases = [
        ("v", "-k x - c v", "F", "{0 if v = 0 and k abs(x) <= F; -k x - c v - F sign(v) otherwise}"),
        ("-v/2", "k x", "F", "{0 if v = 0 and k abs(x) <= F; k x + F sign(v) otherwise}"),
        (
            "v/w",
            "(y - k x)/(m w)",
            "max(u, 0)/(m w)",
            "{0 if v = 0 and abs(k x - y) <= max(u, 0); (y - max(u, 0) sign(v))/(m w) - (k/(m w)) x otherwise}",
        ),
        ("v", "-4 x", "20", "{0 if v = 0 and abs(x) <= 5; -4 x - 20 sign(v) otherwise}"),
        ("v - y", "k x", "F", "{0 if y - v = 0 and k abs(x) <= F; k x + F sign(y - v) otherwise}"),
        ("v", "-c v", "F", "{0 if v = 0; -c v - F sign(v) otherwise}"),
    ];
    for (output, net, level, expected) in cases {
        let fixture = with_brake(output, net, level);
        let slipping = format!("({net} - ({level}) direction) step(abs(direction) - 0.5)");
        assert_eq!(fixture.written(Purity::All, &slipping, "1"), expected, "{output}, {net}, {level}");
        let always = "x + direction (1 - abs(direction))";
        assert_eq!(fixture.written(Purity::All, always, "1"), "x");
    }
}

#[test]
fn conditions_have_variables_on_the_left() {
    let fixture = Fixture::new();
    let cases = [
        ("x - 0.1", "x >= 0.1 m", "x > 0.1 m"),
        ("0.1 - x", "x <= 0.1 m", "x < 0.1 m"),
        ("x - y", "x - y >= 0", "x - y > 0"),
        ("2 x - 2 w", "x >= w", "x > w"),
        ("F - k x", "k x <= F", "k x < F"),
        ("1 - x/w", "x <= w", "x < w"),
        ("-v", "v <= 0", "v < 0"),
        ("k x", "x >= 0", "x > 0"),
        ("x v", "x v >= 0", "x v > 0"),
        ("x^2 - 4", "x^2 >= 4 m2", "x^2 > 4 m2"),
        ("w - 0.5", "w - 0.5 m >= 0", "w - 0.5 m > 0"),
        ("b", "b >= 0", "b > 0"),
        ("share x", "share x >= 0", "share x > 0"),
        ("x v^2", "x v^2 >= 0", "x v^2 > 0"),
        ("x/share", "x >= 0", "x > 0"),
        ("x/(y + 1)", "x/(y + 1 m) >= 0", "x/(y + 1 m) > 0"),
        ("min(x - 0.1, v)", "x >= 0.1 m and v >= 0", "x > 0.1 m and v > 0"),
        ("-max(x, y)", "x <= 0 and y <= 0", "x < 0 and y < 0"),
        ("max(x, y)", "max(x, y) >= 0", "max(x, y) > 0"),
    ];
    for (guard, expected, strictly) in cases {
        let writer = fixture.writer(Purity::Physical);
        assert_eq!(writer.condition_text(&fixture.read(guard), false), expected, "{guard}");
        assert_eq!(writer.condition_text(&fixture.read(guard), true), strictly, "{guard}");
    }
}
