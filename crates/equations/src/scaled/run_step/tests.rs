//! Steps that are too long.

use patchcord_core::patch::Problem;

use super::{MAX_CHANGES, RunStep};
use crate::findings::codes;
use crate::scaled::{ScaleOptions, ScaledProblem, scale_problem};
use crate::synthesis::with_step;

/// A problem of pure numbers with a quantity x, from 1, and this run.
fn problem(equation: &str, run: &str) -> Problem {
    let text = format!(
        r#"{{"patchcord": 1, "quantities": {{"x": {{"unit": "1", "initial": 1}}, "x'": {{"unit": "1", "initial": 0}}}},
            "equations": ["{equation}"], "run": {run}}}"#
    );
    Problem::parse("p.json", &text).unwrap_or_else(|report| panic!("{report}"))
}

/// The problem, scaled.
fn scaled(equation: &str, run: &str) -> ScaledProblem {
    let scaled = scale_problem(&problem(equation, run), &ScaleOptions::default());
    scaled.unwrap_or_else(|error| panic!("{error}"))
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

#[test]
fn a_step_that_is_too_long_after_all_changes_is_named() {
    let equation = "x'' = -100 x - x'";
    let patch = scaled(equation, r#"{"for": 10, "step": 0.001, "every": 0.1}"#).patch;
    let stated = problem(equation, r#"{"for": 10, "step": 0.5}"#);
    let shortened = |step: f64| {
        let mut run = RunStep { shorter: Some(step), changes: MAX_CHANGES, is_still_too_long: false };
        assert!(!run.shorten(&with_step(&patch, step).unwrap()).unwrap());
        run.warning(&stated).unwrap()
    };
    // The solver is stable with a step of 0.1 s, and inaccurate.
    let warning = shortened(0.1);
    let message = "the step of 0.5 s is too long for these equations: the patch has a step of 0.1 s";
    assert_eq!(warning.message, format!("{message}, which is too long too"));
    assert_eq!(warning.hint.as_deref(), Some("state a shorter step, or a \"tolerance\" in its place"));
    let warning = shortened(0.001);
    assert!(warning.message.ends_with("the patch has a step of 0.001 s"), "{}", warning.message);
    assert_eq!(warning.hint.as_deref(), Some("state this step, or a \"tolerance\" in its place"));
}
