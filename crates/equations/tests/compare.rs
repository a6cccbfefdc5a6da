//! Stated equations are compared with the wiring.

use std::fs;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_equations::{Agreement, compare_equations};
use serde_json::{Map, Value, json};

/// The agreement of every equation of a patch.
pub(crate) fn agreements(patch: &Value) -> Vec<Agreement> {
    let patch = Patch::from_value("patch.json", patch).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    compare_equations(&circuit, &program).into_iter().map(|compared| compared.agreement).collect()
}

/// A shipped patch with equations.
fn patch(file: &str, equations: &[&str]) -> Value {
    let text = fs::read_to_string(format!("../../patches/{file}.json")).unwrap();
    let mut patch: Value = serde_json::from_str(&text).unwrap();
    patch["equations"] = json!(equations);
    patch
}

/// The clauses of a difference and the equation of the wiring.
pub(crate) fn difference(agreement: &Agreement) -> (Vec<&str>, &str) {
    let Agreement::Different { differences, wired } = agreement else { panic!("{agreement:?}") };
    (differences.iter().map(String::as_str).collect(), wired)
}

#[test]
fn correct_equations_agree() {
    let cases: [(&str, &[&str]); 9] = [
        (
            "lessons/mass-and-spring",
            &["x' = v", "m x'' = -k x", "total = (k x^2 + m v^2)/2", "kinetic = m x'^2/2"],
        ),
        ("lessons/van-der-pol", &["x'' - mu (1 - x^2) x' + x = 0", "v = x'"]),
        ("lessons/lorenz", &["x' = sigma (y - x)", "y' = x (rho - z) - y", "z' = x y - beta z"]),
        ("lessons/driven-oscillator", &["m x'' = push - k x - d x'"]),
        ("lessons/square-root-and-division", &["w = sqrt(2 g h)", "A h' = -a w", "lasts = A h/(a w)"]),
        ("lessons/projectile", &["x'' = -(c/m) speed x'", "m y'' = -m g - c speed y'"]),
        ("lessons/mathieu", &["y'' + (a - 2 q pump) y = 0"]),
        (
            "thesis/fig-8-16",
            &[
                "x_error' = v_i + x_i' - v_o",
                "spring_force = K x_error",
                "M v_o' = dead_zone(spring_force, friction_level) - f v_o",
                "friction_level = Fs max(memory, 0)^2",
                "memory' = (max(1 - abs(v_o)/VcL, 0) - memory)/Tc",
                "Tc memory' + memory = 1 - min(abs(v_o)/VcL, 1)",
                "F = max(1 - abs(v_o)/VcL, 0)",
                "memory' + 0 F' = (F - memory)/Tc",
            ],
        ),
        ("thesis/fig-8-04", &["M x_o'' = K (x_i - x_o) - f (x_o' + v_i) - M v_i'", "net_force = M a_o"]),
    ];
    for (file, equations) in cases {
        for (equation, agreement) in equations.iter().zip(agreements(&patch(file, equations))) {
            assert_eq!(agreement, Agreement::Solved, "{file}: {equation}");
        }
    }
}

#[test]
fn the_wiring_of_every_shipped_patch_solves_its_equations() {
    let mut count = 0;
    for folder in ["lessons", "measured", "others", "problems", "thesis"] {
        for entry in fs::read_dir(format!("../../patches/{folder}")).unwrap() {
            let path = entry.unwrap().path();
            let Ok(patch) = Patch::read(&path) else { continue };
            let Ok(circuit) = Circuit::new(&patch) else { continue };
            let program = Program::new(&circuit).unwrap();
            for compared in compare_equations(&circuit, &program) {
                let text = circuit.equations()[compared.index].value.text();
                let is_solved = match &compared.agreement {
                    Agreement::Solved | Agreement::SolvedNumerically(_) => true,
                    Agreement::SolvedIf(conditions) => match circuit.patch().title.split(':').next() {
                        Some("Two tanks, one above the other, filled by a pump") => {
                            conditions.iter().all(|condition| condition.ends_with(">= 0.0001 V"))
                        }
                        _ => text.contains("speed") && conditions == &["x' >= 0"],
                    },
                    _ => false,
                };
                assert!(is_solved, "{}: {text}: {:?}", path.display(), compared.agreement);
                count += 1;
            }
        }
    }
    assert!(count > 100, "{count}");
}

/// Summers in series, each of which adds the signal before it twice, through two pots: 2 to the power of 40 paths.
#[test]
fn long_chains_of_signals_that_are_read_twice_are_compared() {
    let (mut elements, mut signals) = (Map::new(), Map::new());
    elements.insert("S0".into(), json!({"kind": "integrator", "in": {"x1": ["S40"]}, "initial": 50}));
    for index in 1..=40 {
        let before = format!("S{}", index - 1);
        let pots = ["P", "Q"].map(|letter| format!("{letter}{index}"));
        elements.insert(format!("S{index}"), json!({"kind": "summer", "in": {"x1": pots}}));
        for pot in pots {
            signals.insert(format!("half_{pot}"), json!({"at": pot, "scale": "x"}));
            elements.insert(pot, json!({"kind": "pot", "in": before, "setting": 0.5}));
        }
        signals.insert(format!("s{index}"), json!({"at": format!("S{index}"), "scale": "x"}));
    }
    signals.insert("x".into(), json!({"at": "S0", "scale": "x"}));
    let patch = json!({
        "patchcord": 1,
        "equations": ["x' = -x", "s39 = -x", "s40 = -half_P40 - half_Q40"],
        "scales": {"x": {"per_volt": 1, "unit": "1"}},
        "elements": elements,
        "signals": signals,
    });
    assert_eq!(agreements(&patch), [Agreement::Solved, Agreement::Solved, Agreement::Solved]);
}

/// At a limit, the rate is not that of the equation.
#[test]
fn an_equation_of_a_limited_integrator_holds_within_its_limits() {
    let limited = |conditions: &[&str]| {
        Agreement::SolvedIf(conditions.iter().map(|condition| (*condition).to_owned()).collect())
    };
    let saturated = agreements(&patch("problems/saturated-integrator", &["x' = -u", "x(0) = 0", "2 x' = u"]));
    assert_eq!(saturated[..2], [limited(&["x > -60", "x < 10"]), Agreement::Solved]);
    assert!(matches!(saturated[2], Agreement::Different { .. }), "{:?}", saturated[2]);
    let oscillator = json!({
        "patchcord": 1,
        "equations": ["y'' = -y", "y' = -w", "w' = y"],
        "scales": {"x": {"per_volt": 1, "unit": "1"}},
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["B2"]}, "initial": 5, "limit": {"upper": 10}},
            "A2": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50},
            "B2": {"kind": "inverter", "in": "A2"},
        },
        "signals": {"y": {"at": "A2", "scale": "x"}, "w": {"at": "A1", "scale": "x"}},
    });
    let within = limited(&["w < 10"]);
    assert_eq!(agreements(&oscillator), [within.clone(), Agreement::Solved, within]);
}

#[test]
fn a_wrong_sign_is_named() {
    let mut spring = patch("lessons/driven-oscillator", &["m v' = push - k x + d v"]);
    let agreement = agreements(&spring);
    assert_eq!(
        difference(&agreement[0]),
        (vec!["the sign of (d/m) v is wrong"], "v' = push/m - (k/m) x - (d/m) v")
    );
    spring["equations"] = json!(["x' = -v"]);
    assert_eq!(difference(&agreements(&spring)[0]), (vec!["the sign of v is wrong"], "x' = v"));
}

#[test]
fn factors_of_terms_are_named() {
    let lorenz = patch(
        "lessons/lorenz",
        &["y' = x (rho - 10 z) - y", "x' = 2 sigma y - sigma x", "z' = x y - beta z + x"],
    );
    let found = agreements(&lorenz);
    assert_eq!(difference(&found[0]).0, ["the term -10 x z is 10 times too small"]);
    assert_eq!(difference(&found[1]).0, ["the term 2 sigma y is 2 times too small"]);
    assert_eq!(difference(&found[2]).0, ["the term x is missing"]);
    let extra = agreements(&patch("lessons/lorenz", &["x' = sigma y"]));
    assert_eq!(difference(&extra[0]).0, ["the term -sigma x is not in the equation"]);
}

#[test]
fn a_time_scale_that_no_pot_contains_is_named() {
    let mut spring = patch("lessons/mass-and-spring", &["m x'' = -k x", "v = x'"]);
    spring["time_scale"] = json!(10);
    let found = agreements(&spring);
    let acceleration = ["the term -(k/m) x is 100 times too large, by the time scale"];
    assert_eq!(difference(&found[0]).0, acceleration);
    assert_eq!(difference(&found[1]).0, ["the term v is 10 times too large, by the time scale"]);
}

#[test]
fn differences_from_the_law_of_a_drive_are_named() {
    let agreement = |equation: &str| agreements(&patch("lessons/driven-oscillator", &[equation])).remove(0);
    let wrong = agreement("m x'' = 2 F sin(2 pi f t) - k x - d x'");
    let (differences, wired) = difference(&wrong);
    assert_eq!(differences, ["the term (2 F/m) sin(2 pi f t) is 2 times too small"]);
    assert!(wired.contains("(F/m) sin(2 pi f t)"), "{wired}");
    let wrong = agreement("push = 2 F sin(2 pi f t)");
    let sides = "in the wiring, the left side is push and the right side is 2 F sin(2 pi f t)";
    assert_eq!(difference(&wrong).0, [sides]);
}

/// The frequencies of the traps are in rad/s and in rpm. A drive converts both to cycles per second.
#[test]
fn a_drive_has_the_angular_frequency_of_its_parameter() {
    for trap in ["a2", "a4"] {
        let text = fs::read_to_string(format!("tests/patches/traps/{trap}.json")).unwrap();
        let mut driven: Value = serde_json::from_str(&text).unwrap();
        let mut agreement = |equation: &str| {
            driven["equations"] = json!([equation]);
            agreements(&driven).remove(0)
        };
        for right in ["push = F sin(w t)", "m x'' = F sin(w t) - k x - c x'"] {
            assert_eq!(agreement(right), Agreement::Solved, "{trap}: {right}");
        }
        for wrong in ["push = F sin(2 pi w t)", "m x'' = F sin(2 pi w t) - k x - c x'"] {
            assert!(matches!(agreement(wrong), Agreement::Different { .. }), "{trap}: {wrong}");
        }
    }
}

/// u is the output of a comparator: F if x < 0, otherwise -F.
#[test]
fn signs_and_steps_agree_with_comparators() {
    let mut switch = json!({
        "patchcord": 1,
        "parameters": {"F": {"value": 3, "unit": "1"}},
        "scales": {"x": {"per_volt": 0.1, "unit": "1"}, "force": {"per_volt": 0.1, "unit": "1"}},
        "elements": {
            "P1": {"kind": "pot", "in": "C1", "setting": "F / force / 100"},
            "C1": {"kind": "comparator", "in": "S1"},
            "S1": {"kind": "summer", "in": {"x1": ["A1"]}},
            "A1": {"kind": "integrator", "in": {"x1": ["P1"]}, "initial": 50},
        },
        "signals": {"x": {"at": "A1", "scale": "x"}, "u": {"at": "P1", "scale": "force"}},
    });
    let mut agreement = |equation: &str| {
        switch["equations"] = json!([equation]);
        agreements(&switch).remove(0)
    };
    let right = [
        "u = -F sign(x)",
        "u = F (step(-x) - step(x))",
        "u = F (1 - 2 step(x))",
        "u = F (2 step(-x) - 1)",
        "x' = F sign(x)",
        "x' = F (2 step(x) - 1)",
    ];
    for equation in right {
        assert_eq!(agreement(equation), Agreement::Solved, "{equation}");
    }
    let wrong =
        ["u = F sign(x)", "u = F step(-x)", "u = F sign(x + 1)", "x' = F (step(x) - 1)", "u = -2 F sign(x)"];
    for equation in wrong {
        assert!(matches!(agreement(equation), Agreement::Different { .. }), "{equation}");
    }
}

#[test]
fn a_delay_by_a_number_agrees_for_the_present_time() {
    let mut line = json!({
        "patchcord": 1,
        "parameters": {"tau": {"value": 2, "unit": "1"}},
        "scales": {"x": {"per_volt": 1, "unit": "1"}},
        "elements": {
            "A1": {"kind": "integrator", "in": {"x1": ["D1"]}, "initial": 50},
            "D1": {"kind": "delay", "in": "A1", "delay": 2},
        },
        "signals": {"x": {"at": "A1", "scale": "x"}, "past": {"at": "D1", "scale": "x"}},
    });
    let mut agreement = |equation: &str| {
        line["equations"] = json!([equation]);
        agreements(&line).remove(0)
    };
    for equation in ["past = delay(x, tau)", "x' = -delay(x, tau)", "0 = past - delay(x, 1 + tau/2)"] {
        assert_eq!(agreement(equation), Agreement::SolvedAt(vec!["tau".to_owned()]), "{equation}");
    }
    assert_eq!(agreement("past = delay(x, 2)"), Agreement::Solved);
    for equation in ["past = delay(x, 2 tau)", "past = 2 delay(x, tau)", "x' = delay(x, tau)"] {
        assert!(matches!(agreement(equation), Agreement::Different { .. }), "{equation}");
    }
}
