//! Formats the warning about equal steps that are too long, as text and as JSON.

use patchcord::document::format_number;
use patchcord::expr::format_significant;
use patchcord::trace::{StepCause, StepWarning};
use serde::Serialize;

/// The warning about a run, in two lines.
pub(super) fn step_warning_text(warning: &StepWarning) -> String {
    warning_text("", ", --step auto or --tol 1e-6", warning)
}

/// The warning about a row of a sweep, in two lines. `row` is its parameters, such as "K = 3e7 N/m".
pub(super) fn row_step_warning_text(row: &str, warning: &StepWarning) -> String {
    warning_text(&format!("at {row} "), " or --tol 1e-6; other rows may need a shorter step", warning)
}

/// The warning in two lines. `place` is the beginning of the sentence, and `advice` follows the recommended step.
fn warning_text(place: &str, advice: &str, warning: &StepWarning) -> String {
    let StepWarning { signal, error, unit, time, cause, step, compared_step, recommended } = warning;
    let comparison = if *compared_step == 0.5 * step {
        "half the step".to_owned()
    } else {
        format!("a step of {} s", format_significant(*compared_step, 2))
    };
    let [step, recommended] = [*step, *recommended].map(format_number);
    let [error, time] = [*error, *time].map(|value| format_significant(value, 2));
    let error = if unit == "1" { error } else { format!("{error} {unit}") };
    let cause = match cause {
        StepCause::Inaccurate => "the solver is inaccurate".to_owned(),
        StepCause::Unstable(element) => format!("the solver is unstable at {element}"),
        StepCause::Fast(element) => format!("{element} oscillates faster than it shows"),
    };
    format!(
        "warning: {place}the step of {step} s is too long: {cause}. With {comparison}, {signal} differs by up to \
         {error}, from {time} s on\n  = help: try --step {recommended}{advice}\n"
    )
}

/// The warning for `--json`: times in seconds, the error in its unit.
#[derive(Serialize)]
pub(super) struct StepWarningDocument<'a> {
    signal: &'a str,
    error: f64,
    unit: &'a str,
    #[serde(rename = "t")]
    time: f64,
    unstable: Option<&'a str>,
    fast: Option<&'a str>,
    step: f64,
    compared_step: f64,
    recommended: f64,
}

impl<'a> StepWarningDocument<'a> {
    /// The document of a warning.
    pub(super) fn of(warning: &'a StepWarning) -> Self {
        let (unstable, fast) = match &warning.cause {
            StepCause::Inaccurate => (None, None),
            StepCause::Unstable(element) => (Some(element.as_str()), None),
            StepCause::Fast(element) => (None, Some(element.as_str())),
        };
        StepWarningDocument {
            signal: &warning.signal,
            error: warning.error,
            unit: &warning.unit,
            time: warning.time,
            unstable,
            fast,
            step: warning.step,
            compared_step: warning.compared_step,
            recommended: warning.recommended,
        }
    }
}
