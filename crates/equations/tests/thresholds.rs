//! Equations whose sides differ in a small part of the range only: within a pulse, or between two thresholds.

use patchcord_equations::Agreement;
use serde_json::{Value, json};

use crate::compare::agreements;

/// A first-order lag whose input is k in a short pulse of this height.
fn with_short_pulse(height: &str, period: Option<f64>, pulse: &str) -> Value {
    let mut drive = json!({"kind": "pulse", "begin": 3, "width": 0.001, "height": height, "scale": "x"});
    if let Some(period) = period {
        drive["period"] = json!(period);
    }
    json!({
        "patchcord": 1,
        "equations": [format!("x' = -x + k {pulse}")],
        "parameters": {"k": {"value": 0.4, "unit": "1"}},
        "scales": {"x": {"per_volt": 0.01, "unit": "1"}},
        "drives": {"D1": drive},
        "elements": {
            "B1": {"kind": "inverter", "in": "D1"},
            "A1": {"kind": "integrator", "in": {"x1": ["A1", "B1"]}, "initial": 50},
        },
        "signals": {"x": {"at": "A1", "scale": "x"}},
        "run": {"for": 10},
    })
}

#[test]
fn short_pulses_are_compared() {
    let once = "(step(t - 3) - step(t - 3.001))";
    let repeated = "step(t - 3) (1 - step((t - 3)/4 - floor((t - 3)/4) - 0.001/4))";
    for (period, pulse) in [(None, once), (Some(4.0), repeated)] {
        assert_eq!(agreements(&with_short_pulse("k", period, pulse)), [Agreement::Solved], "{pulse}");
        for height in ["k/2", "0*k", "-k"] {
            let wrong = agreements(&with_short_pulse(height, period, pulse));
            assert!(matches!(wrong[0], Agreement::Different { .. }), "{height}, {pulse}: {wrong:?}");
        }
    }
}

/// A lag whose input is 0.4 between two thresholds that are 0.01 V apart, with these voltages of the comparators.
fn with_narrow_window(high: f64, against: f64) -> Value {
    json!({
        "patchcord": 1,
        "equations": ["x' = -x + 0.4 (step(x - 0.3) - step(x - 0.3001))"],
        "scales": {"x": {"per_volt": 0.01, "unit": "1"}},
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["A1", "C1", "C2"]}, "initial": 50},
            "C1": {"kind": "comparator", "in": "A1", "threshold": 30, "high": -high, "low": 0},
            "C2": {"kind": "comparator", "in": "A1", "threshold": against, "high": high, "low": 0},
        },
        "signals": {"x": {"at": "A1", "scale": "x"}},
    })
}

#[test]
fn narrow_windows_are_compared() {
    assert_eq!(agreements(&with_narrow_window(40.0, 30.01)), [Agreement::Solved]);
    for (high, against) in [(20.0, 30.01), (-40.0, 30.01), (40.0, 30.02)] {
        let wrong = agreements(&with_narrow_window(high, against));
        assert!(matches!(wrong[0], Agreement::Different { .. }), "{high}, {against}: {wrong:?}");
    }
}

/// The agreement of an equation with an integrator that reads a comparator: x' = -step(x - threshold/100).
fn with_threshold(threshold: f64, equation: &str) -> Agreement {
    let patch = json!({
        "patchcord": 1,
        "equations": [equation],
        "parameters": {"a": {"value": 0.25, "unit": "1"}},
        "scales": {"x": {"per_volt": 0.01, "unit": "1"}},
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["C1"]}, "initial": 50},
            "C1": {"kind": "comparator", "in": "A1", "threshold": threshold, "low": 0},
        },
        "signals": {"x": {"at": "A1", "scale": "x"}},
    });
    agreements(&patch).remove(0)
}

#[test]
fn a_wrong_threshold_is_different_and_a_rounded_one_is_not() {
    assert_eq!(with_threshold(30.0, "x' = -step(x - 0.3)"), Agreement::Solved);
    assert_eq!(with_threshold(33.33, "x' = -step(x - 1/3)"), Agreement::Solved);
    assert_eq!(with_threshold(25.0, "x' = -step(x - a)"), Agreement::SolvedAt(vec!["a".to_owned()]));
    // Without a threshold, the output of the comparator and the sign of its input differ at 0 only.
    assert_eq!(with_threshold(0.0, "x' = -(1 + sign(x))/2"), Agreement::Solved);
    for threshold in [29.9, 30.2, 33.0, 27.0, 40.0] {
        let found = with_threshold(threshold, "x' = -step(x - 0.3)");
        assert!(matches!(found, Agreement::Different { .. }), "{threshold}: {found:?}");
    }
}

/// The agreement of an equation for the signal x with these elements.
fn agreement(equation: &str, elements: &Value, signal: &str) -> Agreement {
    let patch = json!({
        "patchcord": 1,
        "equations": [equation],
        "scales": {"x": {"per_volt": 0.01, "unit": "1"}},
        "elements": elements,
        "signals": {"x": {"at": signal, "scale": "x"}},
    });
    agreements(&patch).remove(0)
}

/// Asserts that the wiring solves the first equations and not the others.
fn assert_solves(elements: &Value, signal: &str, right: &[&str], wrong: &[&str]) {
    for equation in right {
        assert_eq!(agreement(equation, elements, signal), Agreement::Solved, "{equation}");
    }
    for equation in wrong {
        let found = agreement(equation, elements, signal);
        assert!(matches!(found, Agreement::Different { .. }), "{equation}: {found:?}");
    }
}

#[test]
fn a_limit_near_the_end_of_the_range_is_compared() {
    assert_solves(
        &json!({"A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50}}),
        "A1",
        &["x' = -x", "x' = -min(x, 1)", "x' = -max(x, -2)"],
        &["x' = -min(x, 0.99)", "x' = -max(x, -0.98)", "x' = -x step(0.99 - abs(x))"],
    );
}

#[test]
fn a_narrow_step_of_a_curve_is_compared() {
    let curve = |points: Value| {
        let patch = json!({
            "patchcord": 1,
            "equations": ["y = x"],
            "scales": {"x": {"per_volt": 0.01, "unit": "1"}},
            "elements": {
                "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
                "G1": {"kind": "function-generator", "in": "A1", "points": points},
            },
            "signals": {"x": {"at": "A1", "scale": "x"}, "y": {"at": "G1", "scale": "x"}},
        });
        agreements(&patch).remove(0)
    };
    assert_eq!(curve(json!([[-100, -100], [20, 20], [100, 100]])), Agreement::Solved);
    let bump = curve(json!([[-100, -100], [40.3, 40.3], [40.4, 41], [40.5, 40.5], [100, 100]]));
    assert!(matches!(bump, Agreement::Different { .. }), "{bump:?}");
}

/// At 100 V, x is 1 and x'' is 10 000.
#[test]
fn a_derivative_is_compared_in_its_own_range() {
    assert_solves(
        &json!({
            "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "A2": {"kind": "integrator", "in": {"x100": ["A1"]}},
            "A3": {"kind": "integrator", "in": {"x100": ["A2"]}},
        }),
        "A3",
        &["x''' = -x''", "x''' = -min(x'', 10000)"],
        &["x''' = -min(x'', 9900)", "x''' = -max(x'', -3000)", "x''' = -min(x'', 20)"],
    );
}

/// A value some time ago is not known at a point, so a step of it is not known either.
#[test]
fn a_threshold_of_a_delayed_value_is_compared() {
    let delayed = |threshold: &str| format!("x' = -step(delay(x, 2) - {threshold})");
    let [right, zero, other] = ["0.3", "0", "0.5"].map(delayed);
    assert_solves(
        &json!({
            "A1": {"kind": "integrator", "in": {"x1": ["C1"]}, "initial": 50},
            "D1": {"kind": "delay", "in": "A1", "delay": 2},
            "C1": {"kind": "comparator", "in": "D1", "threshold": 30, "low": 0},
        }),
        "A1",
        &[right.as_str()],
        &[zero.as_str(), other.as_str()],
    );
}
