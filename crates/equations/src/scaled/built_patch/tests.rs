//! The faults of built patches at positions in the problem.

use patchcord_core::document::{Code, Diagnostic};
use patchcord_core::machines;
use patchcord_core::patch::Problem;

use super::super::{ScaleError, ScaleOptions, scale_problem};
use crate::findings::codes;

/// The text of a problem with the time constant T of 1 s and the force F.
fn problem(quantities: &str, equations: &str) -> String {
    format!(
        r#"{{"patchcord": 1,
            "parameters": {{"T": {{"value": 1, "unit": "s"}}, "w": {{"value": 0.01, "unit": "1"}}}},
            "quantities": {{{quantities}}}, "equations": [{equations}], "run": {{"for": 3, "step": 0.01}}}}"#
    )
}

/// The only fault of a problem on a machine, with the text at its position.
fn fault<'t>(text: &'t str, machine: &str) -> (Diagnostic, &'t str) {
    let problem = Problem::parse("p.json", text).unwrap_or_else(|report| panic!("{report}"));
    let machine = machines::find(machine).unwrap();
    let report = match scale_problem(&problem, &ScaleOptions { machine, ..ScaleOptions::default() }) {
        Err(ScaleError::Problem(report)) => report,
        outcome => panic!("{outcome:?}"),
    };
    assert_eq!((report.file.as_str(), report.findings.len()), ("p.json", 1), "{report}");
    let span = report.findings[0].span.unwrap();
    (report.findings[0].clone(), &text[span.start..span.end])
}

#[test]
fn a_part_that_the_machine_lacks_is_at_the_quantity_that_needs_it() {
    let quantities = r#""x": {"unit": "1", "initial": 0.5}, "y": {"unit": "1"}"#;
    let text = problem(quantities, r#""T x' = -x", "y = exp(x)""#);
    let (finding, position) = fault(&text, "solartron-1451");
    assert_eq!((finding.code, position), (Code::INVENTORY, "\"y\""));
    assert_eq!(finding.message, "the patch uses 1 function generator, and the solartron-1451 has none");
    assert!(finding.advice().starts_with("the patch is made from all equations: "), "{}", finding.advice());
}

#[test]
fn a_part_of_an_expression_is_at_the_quantity_that_depends_on_it() {
    let text = problem(r#""x": {"unit": "1", "initial": 0.5}"#, r#""T x' = -x - exp(x) / 4""#);
    let (finding, position) = fault(&text, "solartron-1451");
    assert_eq!((finding.code, position), (Code::INVENTORY, "\"x\""));
}

#[test]
fn a_sign_that_acts_on_itself_gets_advice_in_equations() {
    // x falls by 1 in each second and reaches 0 after 1 s, where sign(x) switches it back at once.
    let quantities = r#""x": {"unit": "1", "initial": 1}"#;
    let text = problem(quantities, r#""T x' = -sign(x)""#);
    let (finding, position) = fault(&text, "unlimited");
    assert_eq!((finding.code, position), (codes::NO_SOLUTION, "\"x\""));
    assert_eq!(finding.message, "sign(x) switches without end at t = 1 s");
    assert!(finding.advice().contains("limit(x / w, -1, 1) in place of sign(x)"), "{}", finding.advice());
    let advised = problem(quantities, r#""T x' = -limit(x / w, -1, 1)""#);
    let problem = Problem::parse("p.json", &advised).unwrap_or_else(|report| panic!("{report}"));
    let scaled = scale_problem(&problem, &ScaleOptions::default());
    assert!(scaled.unwrap_or_else(|error| panic!("{error}")).warnings.is_empty());
}
