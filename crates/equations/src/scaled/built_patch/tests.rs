//! The faults of built patches at positions in the problem.

use patchcord_core::document::Diagnostic;
use patchcord_core::patch::Problem;

use super::super::{ScaleError, ScaleOptions, scale_problem};
use crate::findings::codes;

/// The text of a problem with the time constant T of 1 s and the small number w.
fn problem(quantities: &str, equations: &str) -> String {
    format!(
        r#"{{"patchcord": 1,
            "parameters": {{"T": {{"value": 1, "unit": "s"}}, "w": {{"value": 0.01, "unit": "1"}}}},
            "quantities": {{{quantities}}}, "equations": [{equations}], "run": {{"for": 3, "step": 0.01}}}}"#
    )
}

/// The only fault of a problem, with the text at its position.
fn fault(text: &str) -> (Diagnostic, &str) {
    let problem = Problem::parse("p.json", text).unwrap_or_else(|report| panic!("{report}"));
    let report = match scale_problem(&problem, &ScaleOptions::default()) {
        Err(ScaleError::Problem(report)) => report,
        outcome => panic!("{outcome:?}"),
    };
    assert_eq!((report.file.as_str(), report.findings.len()), ("p.json", 1), "{report}");
    let span = report.findings[0].span.unwrap();
    (report.findings[0].clone(), &text[span.start..span.end])
}

#[test]
fn a_step_that_acts_on_itself_gets_advice_in_equations() {
    // x falls by 1/2 in each second and reaches 0 after 2 s, where step(x) switches it back at once.
    let quantities = r#""x": {"unit": "1", "initial": 1}"#;
    let text = problem(quantities, r#""T x' = 0.5 - step(x)""#);
    let (finding, position) = fault(&text);
    assert_eq!((finding.code, position), (codes::NO_SOLUTION, "\"x\""));
    assert_eq!(finding.message, "step(x) switches without end at t = 2 s");
    assert!(finding.advice().contains("limit(x / w, 0, 1) in place of step(x)"), "{}", finding.advice());
    let advised = problem(quantities, r#""T x' = 0.5 - limit(x / w, 0, 1)""#);
    let problem = Problem::parse("p.json", &advised).unwrap_or_else(|report| panic!("{report}"));
    let scaled = scale_problem(&problem, &ScaleOptions::default());
    let warnings = scaled.unwrap_or_else(|error| panic!("{error}")).warnings;
    assert!(warnings.findings.is_empty(), "{warnings}");
}
