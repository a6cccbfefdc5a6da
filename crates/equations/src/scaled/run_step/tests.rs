//! Steps that are too long.

use patchcord_core::patch::Problem;

use crate::findings::codes;
use crate::scaled::{ScaleOptions, ScaledProblem, scale_problem};

/// A scaled problem of pure numbers with a quantity x, from 1, and this run.
fn scaled(equation: &str, run: &str) -> ScaledProblem {
    let text = format!(
        r#"{{"patchcord": 1, "quantities": {{"x": {{"unit": "1", "initial": 1}}, "x'": {{"unit": "1", "initial": 0}}}},
            "equations": ["{equation}"], "run": {run}}}"#
    );
    let problem = Problem::parse("p.json", &text).unwrap_or_else(|report| panic!("{report}"));
    scale_problem(&problem, &ScaleOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_step_that_makes_the_solver_unstable_is_shortened() {
    // The frequency is 10 rad/s. The solver is unstable with the first step, and inaccurate with the second one.
    for step in [0.5, 0.1] {
        let scaled = scaled("x'' = -100 x - x'", &format!(r#"{{"for": 10, "step": {step}}}"#));
        let run = &scaled.patch.run;
        let (found, every) = (run.step.as_ref().unwrap().value, run.every.as_ref().unwrap().value);
        assert!(found < 0.05 && every == step, "{found} {every}");
        assert_eq!(scaled.warnings.findings.len(), 1);
        assert_eq!(scaled.warnings.findings[0].code, codes::SHORTENED_STEP);
        // The peak of x' is that of the closed solution: 10 exp(-d t) at tan(w t) = w / d, with d = 1/2.
        let peak = scaled.quantities.iter().find(|quantity| quantity.name == "x'").unwrap().maximum;
        let frequency = (100.0_f64 - 0.25).sqrt();
        let expected = 10.0 * (-0.5 * (2.0 * frequency).atan() / frequency).exp();
        // The peak is read at the ends of steps, so it lacks up to (w step / 2)^2 / 2 of itself.
        let lack = (0.5 * frequency * found).powi(2) / 2.0;
        assert!((1.0 - lack..1.001).contains(&(peak / expected)), "{peak} instead of {expected}");
    }
}

#[test]
fn a_short_step_and_a_tolerance_stay() {
    for times in [r#""step": 0.001"#, r#""tolerance": 1e-6"#] {
        let scaled = scaled("x'' = -100 x - x'", &format!(r#"{{"for": 10, {times}}}"#));
        assert!(scaled.warnings.findings.is_empty(), "{}", scaled.warnings);
    }
}
