//! Stated equations of quantities without a formula are compared with the wiring at states of the machine.

use patchcord_equations::Agreement;
use serde_json::{Value, json};

use crate::compare::{agreements, difference};

/// An open amplifier with a sine in its feedback: 100 sin(arm) = -gain x, with x' = -x. Then z' = -cos(arm).
fn arcsine(gain: f64, equation: &str) -> Value {
    json!({
        "patchcord": 1,
        "parameters": {"X": {"value": 100, "unit": "1"}},
        "scales": {"turn": {"per_volt": 0.9, "unit": "deg"}, "length": {"per_volt": 1, "unit": "1"}},
        "equations": [equation],
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "P1": {"kind": "pot", "in": "A1", "setting": gain / 10.0},
            "A2": {"kind": "open-amplifier", "in": {"x10": ["P1"], "x1": ["F1"]}},
            "F1": {"kind": "sin", "in": "A2", "angle_per_volt": "turn"},
            "F2": {"kind": "cos", "in": "A2", "angle_per_volt": "turn"},
            "P2": {"kind": "pot", "in": "F2", "setting": 0.01},
            "A3": {"kind": "integrator", "in": {"x1": ["P2"]}},
        },
        "signals": {
            "arm": {"at": "A2", "scale": "turn"}, "x": {"at": "A1", "scale": "length"},
            "z": {"at": "A3", "scale": "length"},
        },
        "run": {"for": 1, "step": 1e-3},
    })
}

/// The agreement of an equation with the arcsine.
fn agreement(gain: f64, equation: &str) -> Agreement {
    agreements(&arcsine(gain, equation)).remove(0)
}

#[test]
fn an_equation_of_an_angle_is_compared_at_states() {
    for equation in ["arm = -atan2(x, sqrt(10000 - x^2))", "arm' = -tan(arm)", "z' = -sqrt(1 - x^2/10000)"] {
        assert_eq!(agreement(1.0, equation), Agreement::SolvedNumerically(24), "{equation}");
    }
    for equation in ["100 sin(arm) = -x", "z' = -cos(arm)"] {
        assert_eq!(agreement(1.0, equation), Agreement::Solved, "{equation}");
    }
}

#[test]
fn a_wrong_gain_in_front_of_the_loop_is_found() {
    // The arcsine of -1/4 is -0.2527, and that of -1/2 is -0.5236.
    let wrong = agreement(0.5, "arm = -atan2(x, sqrt(10000 - x^2))");
    let at_start = "at arm = -0.2527, x = 50, the left side is -0.2527 and the right side is -0.5236";
    assert_eq!(difference(&wrong), (vec![at_start], "200 sin(arm) = -x"));
    for equation in ["100 sin(arm) = -x", "arm' = -2 tan(arm)", "z' = -sqrt(1 - x^2/10000)"] {
        assert!(matches!(agreement(0.5, equation), Agreement::Different { .. }), "{equation}");
    }
    // With a gain of 10 the loop has no solution at the start.
    let large = agreement(10.0, "arm = -atan2(x, sqrt(10000 - x^2))");
    assert!(matches!(large, Agreement::Different { .. }), "{large:?}");
}

#[test]
fn a_difference_in_terms_that_the_equation_names_is_still_one_of_terms() {
    let wrong = agreement(1.0, "z' = -2 cos(arm)");
    assert_eq!(difference(&wrong), (vec!["the term -2 cos(arm) is 2 times too small"], "z' = -cos(arm)"));
}

#[test]
fn an_equation_that_holds_for_the_present_parameters_only_names_them() {
    let present = agreement(1.0, "arm = -atan2(x, sqrt(X^2 - x^2))");
    assert_eq!(present, Agreement::SolvedAt(vec!["X".to_owned()]));
}

#[test]
fn an_equation_without_values_or_with_a_rounded_setting_is_undecided() {
    let Agreement::Undecided(reason) = agreement(1.0, "arm = atan2(x, sqrt(-1 - x^2))") else {
        panic!("the root has no value")
    };
    assert!(reason.starts_with("arm is the solution of a loop without a formula"), "{reason}");
    let Agreement::Undecided(reason) = agreement(0.9998, "arm = -atan2(x, sqrt(10000 - x^2))") else {
        panic!("0.9998 is nearly 1")
    };
    // The arcsine of x/100 changes by 0.0002 tan(arm).
    assert!(reason.starts_with("its sides differ by at most 0.01"), "{reason}");
}

/// An open amplifier whose angle follows a drive.
fn driven(equation: &str, amplitude: f64, cords: &[&str]) -> Agreement {
    let patch = json!({
        "patchcord": 1,
        "parameters": {"U": {"value": amplitude, "unit": "1"}, "f": {"value": 0.5, "unit": "Hz"}},
        "scales": {"turn": {"per_volt": 0.9, "unit": "deg"}, "level": {"per_volt": 1, "unit": "1"}},
        "drives": {"u": {"kind": "sine", "scale": "level", "amplitude": "U", "frequency": "f"}},
        "equations": [equation],
        "elements": {
            "A2": {"kind": "open-amplifier", "in": {"x1": cords}},
            "F1": {"kind": "sin", "in": "A2", "angle_per_volt": "turn"},
        },
        "signals": {"arm": {"at": "A2", "scale": "turn"}},
        "run": {"for": 1, "step": 1e-3},
    });
    agreements(&patch).remove(0)
}

#[test]
fn an_angle_can_follow_a_drive_by_its_name_or_by_its_law() {
    let named = "arm = -atan2(u, sqrt(10000 - u^2))";
    let written = "sin(arm)^2 = (U sin(2 pi f t)/100)^2";
    for equation in [named, written] {
        assert_eq!(driven(equation, 50.0, &["u", "F1"]), Agreement::SolvedNumerically(24), "{equation}");
    }
    for equation in ["arm = -atan2(2 u, sqrt(10000 - u^2))", "sin(arm)^2 = (U sin(pi f t)/100)^2"] {
        let wrong = driven(equation, 50.0, &["u", "F1"]);
        assert!(matches!(wrong, Agreement::Different { .. }), "{equation}: {wrong:?}");
    }
    // The cord of the drive is missing. Its amplitude is 0 at present.
    let missing = driven(named, 0.0, &["F1"]);
    assert!(matches!(missing, Agreement::Different { .. }), "{missing:?}");
}
