//! Unit tests of the comparison at states.

use patchcord_core::patch::Patch;
use serde_json::{Value, json};

use super::*;

/// An open amplifier with a sine in its feedback: 100 sin(arm) = -gain x, with x' = -x from 50.
fn arcsine(gain: f64, equation: &str) -> Value {
    json!({
        "patchcord": 1,
        "scales": {"turn": {"per_volt": 0.9, "unit": "deg"}, "length": {"per_volt": 1, "unit": "1"}},
        "equations": [equation],
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "P1": {"kind": "pot", "in": "A1", "setting": gain / 10.0},
            "A2": {"kind": "open-amplifier", "in": {"x10": ["P1"], "x1": ["F1"]}},
            "F1": {"kind": "sin", "in": "A2", "angle_per_volt": "turn"},
        },
        "signals": {"arm": {"at": "A2", "scale": "turn"}, "x": {"at": "A1", "scale": "length"}},
        "run": {"for": 1, "step": 1e-3},
    })
}

/// Calls a function with a comparison and the first equation of a patch.
fn with<T>(patch: &Value, read: impl FnOnce(&mut Numerical<'_>, &Equation) -> T) -> T {
    let patch = Patch::from_value("patch.json", patch).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    read(&mut Numerical::new(&circuit, &program), &circuit.equations()[0].value)
}

/// The number of states at which an equation of the arcsine holds. `None` if it does not hold.
fn states(gain: f64, equation: &str) -> Option<usize> {
    with(&arcsine(gain, equation), |numerical, equation| match numerical.verdict(equation, false) {
        Verdict::Equal(states) => Some(states),
        _ => None,
    })
}

/// sin(arm) = -x/100, so cos(arm) arm' = x/100 and arm' = -tan(arm). With s = tan(arm), s' = -(1 + s^2) s.
#[test]
fn derivatives_of_an_angle_have_values() {
    let right = [
        "100 sin(arm) = -x",
        "arm = -atan2(x, sqrt(10000 - x^2))",
        "arm' = -tan(arm)",
        "arm'' = tan(arm) (1 + tan(arm)^2)",
        "arm''' = -tan(arm) (1 + 3 tan(arm)^2) (1 + tan(arm)^2)",
        "arm' + tan(arm) = 0 x",
    ];
    for equation in right {
        assert_eq!(states(1.0, equation), Some(24), "{equation}");
    }
    for equation in ["arm' = -arm", "arm'' = 2 tan(arm) (1 + tan(arm)^2)", "arm = atan2(x, 100)"] {
        assert_eq!(states(1.0, equation), None, "{equation}");
    }
}

#[test]
fn the_first_state_at_which_the_sides_differ_has_their_values() {
    // arm is the arcsine of -1/4 in place of -1/2.
    let patch = arcsine(0.5, "arm = -atan2(x, sqrt(10000 - x^2))");
    let Verdict::Different(difference) =
        with(&patch, |numerical, equation| numerical.verdict(equation, false))
    else {
        panic!("the gain is wrong")
    };
    let (quarter, half) = ((-0.25_f64).asin(), (-0.5_f64).asin());
    let is_near = |one: f64, other: f64| (one - other).abs() < 1e-9;
    assert!(is_near(difference.sides[0].0, quarter) && is_near(difference.sides[1].0, half));
    let [(first, arm), (second, x)] = &difference.quantities[..] else {
        panic!("{:?}", difference.quantities)
    };
    assert_eq!([first.as_str(), second.as_str()], ["arm", "x"]);
    assert!(is_near(*arm, quarter) && is_near(*x, 50.0));
}

#[test]
fn a_small_difference_is_neither_equal_nor_wrong() {
    let patch = arcsine(0.9998, "arm = -atan2(x, sqrt(10000 - x^2))");
    let Verdict::Near(share) = with(&patch, |numerical, equation| numerical.verdict(equation, false)) else {
        panic!("0.9998 is nearly 1")
    };
    assert!((1e-5..1e-3).contains(&share), "{share}");
}

/// With a gain of 10, the loop has a solution if x is between -10 and 10 only, and the run begins at 50.
#[test]
fn states_in_the_whole_range_are_compared_if_the_motion_overloads() {
    let patch = arcsine(10.0, "10 sin(arm) = -x");
    with(&patch, |numerical, equation| {
        assert!(matches!(numerical.verdict(equation, false), Verdict::Equal(_)));
        let free = &numerical.places[&TimeLaws::default()];
        assert!(free.len() >= MIN_PLACES);
        for place in free {
            assert_eq!(place.instant, None);
            assert!(place.point.states[0].abs() < 10.0, "{:?}", place.point.states);
        }
    });
    assert_eq!(states(10.0, "100 sin(arm) = -x"), None);
}

/// The arcsine of a ramp: 100 sin(arm) = -x, with x = 10 + 5 t.
fn ramp(equation: &str) -> Value {
    let mut patch = arcsine(1.0, equation);
    patch["elements"]["P2"] = json!({"kind": "pot", "in": "-100", "setting": 0.05});
    patch["elements"]["A1"] = json!({"kind": "integrator", "in": {"x1": ["P2"]}, "initial": 10});
    patch
}

/// cos(arm) arm' = -x'/100.
#[test]
fn ramps_follow_the_time_of_an_equation() {
    let verdict = |equation: &str, is_timed: bool| {
        with(&ramp(equation), |numerical, equation| numerical.verdict(equation, is_timed))
    };
    for equation in ["100 sin(arm) = -10 - 5 t", "x = 10 + 5 t", "arm' cos(arm) = -0.05 + 0 t"] {
        assert!(matches!(verdict(equation, true), Verdict::Equal(24)), "{equation}");
    }
    for equation in ["100 sin(arm) = -10 - 6 t", "x = 9 + 5 t", "arm' cos(arm) = 0.05 + 0 t"] {
        assert!(matches!(verdict(equation, true), Verdict::Different(_)), "{equation}");
    }
    // Any voltage of x is possible if the time does not matter.
    assert!(matches!(verdict("arm' cos(arm) = -0.05", false), Verdict::Equal(24)));
    assert!(matches!(verdict("x = 10 + 5 t", false), Verdict::Different(_)));
}

#[test]
fn sides_without_values_are_not_compared() {
    let patch = arcsine(1.0, "arm = atan2(x, sqrt(-1 - x^2))");
    with(&patch, |numerical, equation| {
        assert!(matches!(numerical.verdict(equation, false), Verdict::NoValues));
    });
}

#[test]
fn an_angle_jumps_by_a_turn() {
    assert!(has_jump(&[0.5, 3.1], &[0.6, -3.1]));
    assert!(!has_jump(&[0.5, 1.1], &[0.6, -1.1]));
}

/// The motion begins at x = 50 and is followed downward. A limit at 80 acts in another part of the range.
#[test]
fn a_limit_far_from_the_motion_is_found() {
    let limited = |limit: &str| {
        let x = format!("min(x, {limit})");
        states(1.0, &format!("arm = -atan2({x}, sqrt(10000 - {x}^2))"))
    };
    assert_eq!(limited("80"), None);
    assert_eq!(limited("200"), Some(24));
}
