//! Unit tests of the comparison.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use serde_json::json;

use super::{Agreement, EquationComparer, compare_equations};

#[test]
fn signals_with_the_name_of_a_parameter_or_of_pi_vary() {
    let patch = json!({
        "patchcord": 1,
        "parameters": {"m": {"value": 0.5, "unit": "1"}},
        "elements": {
            "P1": {"kind": "pot", "in": "A1", "setting": "m"},
            "P2": {"kind": "pot", "in": "+100", "setting": "m"},
            "A1": {"kind": "integrator", "in": {"x1": ["P1"]}, "initial": 50},
        },
        "signals": {"m": {"at": "A1"}, "pi": {"at": "P1"}, "constant": {"at": "P2"}},
    });
    let patch = Patch::from_value("patch.json", &patch).unwrap();
    let circuit = Circuit::new(&patch).unwrap();
    let program = Program::new(&circuit).unwrap();
    let mut comparer = EquationComparer::new(&circuit, &program);
    assert_eq!(comparer.varying_signals(), [true, true, false]);
}

/// A thermostat: P = limit(K (Ts - T), 0, Pm) is between its limits while T is between 291.25 K and 295 K only.
/// `factors` are the gains of K Ts and K T.
fn thermostat([fixed, varying]: [f64; 2]) -> Agreement {
    let patch = json!({
        "patchcord": 1,
        "parameters": {
            "C": {"value": 20, "unit": "kJ/K"}, "Ts": {"value": 295, "unit": "K"},
            "K": {"value": 400, "unit": "W/K"}, "Pm": {"value": 1500, "unit": "W"},
        },
        "scales": {"T": {"per_volt": 5, "unit": "K"}, "P": {"per_volt": 50, "unit": "W"}},
        "equations": ["P = limit(K (Ts - T), 0, Pm)"],
        "elements": {
            "P1": {"kind": "pot", "in": "-100", "setting": "Ts * K / P / 3000"},
            "P2": {"kind": "pot", "in": "A1", "setting": "K * T / P / 50"},
            "B1": {
                "kind": "summer",
                "in": {"x1": ["P1", "P2"], "x29": ["P1"], "x49": ["P2"]},
                "limit": {"lower": 0, "upper": "Pm / P"},
            },
            "P3": {"kind": "pot", "in": "B1", "setting": "P / T / C"},
            "A1": {"kind": "integrator", "in": {"x1": ["P3"]}, "initial": 56.6},
        },
        "signals": {"T": {"at": "A1", "scale": "T"}, "P": {"at": "B1", "scale": "P"}},
        "run": {"for": 1500, "step": 0.1},
    });
    let text = patch.to_string().replace("x29", &format!("x{fixed}")).replace("x49", &format!("x{varying}"));
    let patch = Patch::parse("patch.json", &text).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    compare_equations(&circuit, &program).remove(0).agreement
}

/// Far from 295 K, a limiter with wrong gains has the same limits.
#[test]
fn characteristics_are_compared_between_their_corners() {
    assert_eq!(thermostat([29.0, 49.0]), Agreement::Solved);
    for gains in [[20.0, 39.0], [29.0, 39.0], [29.0, 52.0]] {
        let found = thermostat(gains);
        assert!(matches!(found, Agreement::Different { .. }), "{gains:?}: {found:?}");
    }
}

/// A coupling c that is 0 at present. The pot of k/m = 1/3 is set to three digits.
#[test]
fn an_equation_is_not_solved_for_a_quantity_whose_factor_is_0() {
    let patch = json!({
        "patchcord": 1,
        "parameters": {
            "m": {"value": 3, "unit": "kg"}, "c": {"value": 0, "unit": "kg"},
            "k": {"value": 1, "unit": "kg/s"},
        },
        "scales": {"length": {"per_volt": 1, "unit": "mm"}},
        "equations": ["c x' + m y' = -k y"],
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "P1": {"kind": "pot", "in": "A2", "setting": 0.333},
            "A2": {"kind": "integrator", "in": {"x1": ["P1"]}, "initial": 50},
        },
        "signals": {"x": {"at": "A1", "scale": "length"}, "y": {"at": "A2", "scale": "length"}},
        "run": {"for": 5, "step": 0.01},
    });
    let patch = Patch::from_value("patch.json", &patch).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let found = compare_equations(&circuit, &program).remove(0).agreement;
    assert!(matches!(found, Agreement::SolvedAt(_)), "{found:?}");
}

/// How s = 100 sin(0.01 x) agrees with a pot of this setting in front of the sine. 0.5 is right.
fn sine(setting: f64) -> Agreement {
    let patch = json!({
        "patchcord": 1,
        "scales": {"number": {"per_volt": 1, "unit": "1"}},
        "equations": ["s = 100 sin(0.01 x)"],
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "P1": {"kind": "pot", "in": "A1", "setting": setting},
            "F1": {"kind": "sin", "in": "P1", "angle_per_volt": 0.02},
        },
        "signals": {"x": {"at": "A1", "scale": "number"}, "s": {"at": "F1", "scale": "number"}},
        "run": {"for": 5, "step": 0.01},
    });
    let patch = Patch::from_value("patch.json", &patch).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    compare_equations(&circuit, &program).remove(0).agreement
}

#[test]
fn settings_in_front_of_functions_may_be_rounded() {
    assert_eq!(sine(0.5), Agreement::Solved);
    assert_eq!(sine(0.4998), Agreement::Solved);
    for setting in [0.49, 0.05] {
        assert!(matches!(sine(setting), Agreement::Different { .. }), "{setting}");
    }
}
