use super::*;
use patchcord_core::patch::Patch;
use serde_json::{Value, json};

/// A driven mass on a spring, ten times slower on the machine: m x'' = F - k x - c x' with m = 2 kg, k = 50 N/m and
/// c = 3 N s/m. 1 V is 1 mm, 5 mm/s and 0.1 N.
fn oscillator() -> Value {
    json!({
        "patchcord": 1,
        "time_scale": 10,
        "parameters": {
            "m": {"value": 2, "unit": "kg"}, "k": {"value": 50, "unit": "N/m"},
            "c": {"value": 3, "unit": "N s/m"},
        },
        "scales": {
            "position": {"per_volt": 1, "unit": "mm"},
            "velocity": {"per_volt": 5, "unit": "mm/s"},
            "force": {"per_volt": 0.1, "unit": "N"},
        },
        "drives": {"F": {"kind": "step", "scale": "force", "height": 1}},
        "equations": ["m x'' = F - k x - c x'", "v = x'"],
        "elements": {
            "PF": {"kind": "pot", "in": "F", "setting": "force / m / velocity / 10 / time_scale"},
            "PK": {"kind": "pot", "in": "B1", "setting": "k / m * position / velocity / time_scale"},
            "PC": {"kind": "pot", "in": "A1", "setting": "c / m / time_scale"},
            "A1": {"kind": "integrator", "in": {"x10": ["PF"], "x1": ["PK", "PC"]}, "note": "- velocity"},
            "B1": {"kind": "inverter", "in": "A2"},
            "PV": {"kind": "pot", "in": "A1", "setting": "velocity / position / 10 / time_scale"},
            "A2": {"kind": "integrator", "in": {"x10": ["PV"]}, "note": "position"},
        },
        "signals": {
            "x": {"at": "A2", "scale": "position"},
            "v": {"at": "A1", "scale": "velocity", "factor": -1},
        },
    })
}

/// The audit of a patch.
fn audit(patch: &Value) -> Vec<AuditedGain> {
    let patch = Patch::from_value("patch.json", patch).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    audit_scaling(&circuit, &Program::new(&circuit).unwrap_or_else(|report| panic!("{report}")))
}

/// The gain between two signals.
fn gain(gains: &[AuditedGain], input: &str, output: &str) -> AuditedGain {
    let mut found =
        gains.iter().filter(|gain| (&gain.row.input[..], &gain.row.output[..]) == (input, output));
    found.next().unwrap_or_else(|| panic!("no gain from {input} to {output}: {gains:?}")).clone()
}

fn assert_error(gain: &AuditedGain, expected: f64) {
    let error = gain.relative_error().unwrap_or_else(|| panic!("{gain:?}"));
    assert!((error - expected).abs() < 1e-9, "{gain:?}");
    assert_eq!(gain.is_wrong(), expected != 0.0, "{gain:?}");
}

#[test]
fn the_equations_decide_about_every_gain_of_a_correct_patch() {
    let gains = audit(&oscillator());
    // Block gains in SI times the scales, over the time scale: 1/m, -k/m, -c/m and 1. The signal of A1 is -5 mm/s per V.
    let cases = [("F", "v", -1.0), ("x", "v", 0.5), ("v", "v", -0.15), ("v", "x", -0.5)];
    assert_eq!(gains.len(), cases.len(), "{gains:?}");
    for (input, output, required) in cases {
        let gain = gain(&gains, input, output);
        assert!((gain.required_gain().unwrap() - required).abs() < 1e-12, "{gain:?}");
        assert!(matches!(gain.decision, GainDecision::Equation { .. }), "{gain:?}");
        assert_error(&gain, 0.0);
    }
}

#[test]
fn signs_and_factors_of_ten_are_wrong() {
    let mut patch = oscillator();
    patch["elements"]["B2"] = json!({"kind": "inverter", "in": "A1"});
    patch["elements"]["PC"]["in"] = json!("B2");
    assert_error(&gain(&audit(&patch), "v", "v"), -2.0);
    patch["elements"]["A1"]["in"] = json!({"x1": ["PF", "PK", "PC"]});
    assert_error(&gain(&audit(&patch), "F", "v"), -0.9);
    patch["elements"]["PV"]["setting"] = json!("velocity / position / 100 / time_scale");
    assert_error(&gain(&audit(&patch), "v", "x"), -0.9);
}

#[test]
fn without_equations_only_integrals_are_decided() {
    let mut patch = oscillator();
    patch["equations"] = json!([]);
    let gains = audit(&patch);
    let undecided = GainDecision::Undecided("the patch states no equations".to_owned());
    for input in ["F", "x", "v"] {
        let gain = gain(&gains, input, "v");
        assert_eq!(gain.decision, undecided);
        assert!(!gain.is_wrong());
    }
    let integral = gain(&gains, "v", "x");
    assert!(matches!(integral.decision, GainDecision::Integral { .. }), "{integral:?}");
    assert_error(&integral, 0.0);
    // The value of a parameter identifies a gain, but does not prove it.
    assert_eq!(gain(&gains, "F", "v").row.block.as_deref(), Some("1 / m"));
}

#[test]
fn equations_that_say_nothing_about_a_path_are_named() {
    let mut patch = oscillator();
    patch["equations"] = json!(["v = x'", "m v' = F - k abs(x) - c v"]);
    let gains = audit(&patch);
    let reason = |input: &str, output: &str| match gain(&gains, input, output).decision {
        GainDecision::Undecided(reason) => reason,
        decision => panic!("{decision:?}"),
    };
    assert_eq!(reason("x", "v"), "the factor of x in v' is not constant");
    patch["equations"] = json!("v = x'");
    let gains = audit(&patch);
    let undecided = gain(&gains, "x", "v").decision;
    let reason = "no stated equation gives v' as a function of x".to_owned();
    assert_eq!(undecided, GainDecision::Undecided(reason));
}

/// The wiring has the drive itself, and the equation has its derivative.
#[test]
fn an_equation_with_the_derivative_of_a_drive_decides() {
    let text = std::fs::read_to_string("../../patches/thesis/fig-8-16.json").unwrap();
    let gains = audit(&serde_json::from_str(&text).unwrap());
    let direct = gain(&gains, "x_i", "x_error");
    assert!(matches!(direct.decision, GainDecision::Equation { .. }), "{direct:?}");
    assert!(gains.iter().all(|gain| !gain.is_wrong()), "{gains:?}");
    let spring = gain(&gains, "x_error", "spring_force");
    let GainDecision::Equation { block, .. } = spring.decision else { panic!("spring_force = K x_error") };
    assert_eq!(block, "K");
}

/// Two equations with both unknowns: u = e - a y and e = w - b u, so u = (w - a y)/(1 + b) and e = (w + a b y)/(1 + b).
/// Also T y' = u - y. The wiring has the solutions.
fn simultaneous() -> Value {
    json!({
        "patchcord": 1,
        "parameters": {
            "a": {"value": 0.5, "unit": "1"}, "b": {"value": 0.25, "unit": "1"},
            "T": {"value": 1, "unit": "s"},
        },
        "scales": {
            "u": {"per_volt": 0.05, "unit": "V"}, "e": {"per_volt": 0.04, "unit": "V"},
            "y": {"per_volt": 0.025, "unit": "V"}, "w": {"per_volt": 0.05, "unit": "V"},
        },
        "drives": {"w": {"kind": "step", "scale": "w", "height": 4}},
        "equations": ["u = e - a y", "e = w - b u", "T y' = u - y"],
        "elements": {
            "P1": {"kind": "pot", "in": "w", "setting": "w / u / (1 + b)"},
            "P2": {"kind": "pot", "in": "A1", "setting": "a / (1 + b) * y / u"},
            "B1": {"kind": "summer", "in": {"x1": ["P1", "P2"]}, "note": "- u"},
            "P3": {"kind": "pot", "in": "w", "setting": "w / e / (1 + b)"},
            "P4": {"kind": "pot", "in": "B3", "setting": "a * b / (1 + b) * y / e"},
            "B2": {"kind": "summer", "in": {"x1": ["P3", "P4"]}, "note": "- e"},
            "B3": {"kind": "inverter", "in": "A1", "note": "y"},
            "P5": {"kind": "pot", "in": "B4", "setting": "u / y / T / 10"},
            "B4": {"kind": "inverter", "in": "B1", "note": "u"},
            "P6": {"kind": "pot", "in": "A1", "setting": "1 / T"},
            "A1": {"kind": "integrator", "in": {"x10": ["P5"], "x1": ["P6"]}, "note": "- y"},
        },
        "signals": {
            "u": {"at": "B1", "scale": "u", "factor": -1}, "e": {"at": "B2", "scale": "e", "factor": -1},
            "y": {"at": "A1", "scale": "y", "factor": -1},
        },
    })
}

#[test]
fn unknowns_of_simultaneous_equations_are_eliminated() {
    let gains = audit(&simultaneous());
    for (input, output) in [("w", "u"), ("y", "u"), ("w", "e"), ("y", "e"), ("u", "y"), ("y", "y")] {
        let gain = gain(&gains, input, output);
        assert!(matches!(gain.decision, GainDecision::Equation { .. }), "{gain:?}");
        assert_error(&gain, 0.0);
    }
    let mut patch = simultaneous();
    patch["elements"]["P4"]["in"] = json!("A1");
    assert_error(&gain(&audit(&patch), "y", "e"), -2.0);
}
