//! The quality of a fit, as sentences and as JSON documents: fits from other starts, steps of the solver, overloads.
//!
//! These texts answer three questions on a fit. Is the optimum reproducible from other starts? Is the error of the
//! solver small compared with the noise? Do all amplifiers stay in their range with the drives of the records?

use indexmap::IndexMap;
use patchcord_analysis::instruments::overload_demand;
use patchcord_core::document::plural;
use serde::Serialize;

use crate::fit::overload::RecordOverload;
use crate::fit::starts::StartAgreement;
use crate::fit::step_size::StepRefinement;
use crate::report::values::{ValueDocument, format_pure_number, parameter_values_text, value_documents};

/// Fits from other starts as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StartsDocument {
    /// Whether one of them reaches the same optimum.
    pub same: bool,
    /// Whether one of them leaves less than the fit.
    pub better: bool,
    /// The values at the better fit, by parameter; empty if there is none.
    pub values: IndexMap<String, ValueDocument>,
    /// Number of starts that were fitted.
    pub tried: usize,
    /// Residual of the best of them, rms over the noise; null if the patch can be run from none.
    pub left: Option<f64>,
    /// Whether they are fits of the pieces of the records.
    pub in_pieces: bool,
}

impl From<&StartAgreement> for StartsDocument {
    /// An infinite residual, for a patch that cannot be run from any other start, becomes null.
    fn from(agreement: &StartAgreement) -> Self {
        StartsDocument {
            same: agreement.is_reproduced,
            better: agreement.is_better,
            values: value_documents(&agreement.values),
            tried: agreement.tried,
            left: agreement.normalised_rms.is_finite().then_some(agreement.normalised_rms),
            in_pieces: agreement.uses_pieces,
        }
    }
}

/// The steps of the solver and their error as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepsDocument {
    /// Steps from sample to sample.
    pub steps: u32,
    /// The error of the solver, rms over the noise; null if it is not known.
    pub error: f64,
    /// Maximum desirable error, rms over the noise.
    pub wanted: f64,
}

impl From<&StepRefinement> for StepsDocument {
    /// An infinite error, for a patch that cannot be run with twice as many steps, becomes null in the text.
    fn from(refinement: &StepRefinement) -> Self {
        StepsDocument { steps: refinement.steps, error: refinement.error, wanted: refinement.limit }
    }
}

/// Whether fits from other starts reach the same optimum, as a sentence without a full stop.
///
/// A better optimum is the most important case: the values are listed, so that the reader can put them into the patch.
pub fn starts_sentence(agreement: &StartAgreement) -> String {
    let data = if agreement.uses_pieces { " in the pieces that are fitted first" } else { "" };
    let residual = format!("{} times the noise{data}", format_pure_number(agreement.normalised_rms));
    match (agreement.is_reproduced, agreement.tried) {
        (true, 1) => "a fit from another start reaches the same optimum".to_owned(),
        (true, tried) => format!("one of {tried} fits from other starts reaches the same optimum"),
        _ if agreement.is_better => format!(
            "a fit from another start leaves less, {residual}, with {}: the reported fit is not the best one; set these values in the patch and search again",
            parameter_values_text(&agreement.values)
        ),
        (false, tried) if agreement.normalised_rms.is_finite() => format!(
            "none of {tried} fits from other starts reaches the same optimum (the best leaves {residual}): there may be better fits; narrower ranges help to find them"
        ),
        (false, tried) => format!("the patch can be run from none of {tried} other starts"),
    }
}

/// The number of steps of the solver and their error, in a sentence or two.
pub fn steps_sentence(refinement: &StepRefinement) -> String {
    let steps = plural(refinement.steps as usize, "step");
    let takes = format!("The solver takes {steps} from sample to sample.");
    if refinement.error.is_infinite() {
        return format!(
            "{takes} Its error is unknown, because the patch cannot be run with twice as many steps."
        );
    }
    let error = format!("{takes} Its error is {} times the noise, rms", format_pure_number(refinement.error));
    match refinement.is_sufficient() {
        true => format!("{error}."),
        false => format!("{error}; it should be below {}.", format_pure_number(refinement.limit)),
    }
}

/// Which amplifier overloads first, when, and what to do, as sentences.
pub fn overload_sentence(overload: &RecordOverload) -> String {
    let RecordOverload { record, overload } = overload;
    let demand = match overload.peak() {
        Some(peak) => format!("with a demanded output of {} V", format_pure_number(peak)),
        None => overload_demand(overload),
    };
    format!(
        "With {record}, the amplifier {} overloads at {} s, {demand}: beyond 100 V the patch does not represent the real system. Change its scale so that one volt represents more, and search again.",
        overload.element,
        format_pure_number(overload.time)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::parameter_values::ParameterValues;

    #[test]
    fn the_sentence_has_the_values_of_a_better_fit() {
        let values = ParameterValues(vec![("rate".to_owned(), 2.0, "1".to_owned())]);
        let better = StartAgreement {
            tried: 1,
            normalised_rms: 1.0,
            is_reproduced: false,
            is_better: true,
            values,
            uses_pieces: false,
        };
        let sentence = starts_sentence(&better);
        assert!(sentence.contains("with rate = 2: "), "{sentence}");
    }

    #[test]
    fn the_sentence_says_if_the_error_of_the_solver_is_too_large_or_unknown() {
        let sentence = |error| steps_sentence(&StepRefinement { steps: 4, error, limit: 0.1 });
        assert_eq!(
            sentence(0.05),
            "The solver takes 4 steps from sample to sample. Its error is 0.05 times the noise, rms."
        );
        assert!(sentence(0.5).ends_with("; it should be below 0.1."), "{}", sentence(0.5));
        assert_eq!(
            steps_sentence(&StepRefinement { steps: 1, error: f64::INFINITY, limit: 0.1 }),
            "The solver takes 1 step from sample to sample. Its error is unknown, because the patch cannot be run with twice as many steps."
        );
    }
}
