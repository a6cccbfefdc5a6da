//! How good a fit is, in words and as documents: fits from other points, steps of the solver, overloads.

use indexmap::IndexMap;
use serde::Serialize;

use crate::fit::overload::RecordOverload;
use crate::fit::starts::Agreement;
use crate::fit::step_size::Fineness;
use crate::report::values::{ValueDocument, parameter_values_text, value_documents};
use patchcord_analysis::instruments::number;

/// Fits from other points as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StartsDocument {
    /// Whether one of them reproduces the fit.
    pub same: bool,
    /// Whether one of them leaves less than the fit.
    pub better: bool,
    /// The values at the better fit, by parameter; empty if there is none.
    pub values: IndexMap<String, ValueDocument>,
    /// How many points were fitted from.
    pub tried: usize,
    /// What the best of them leaves, rms over the noise; null if the patch can be run from none.
    pub left: Option<f64>,
    /// Whether they are fits of the pieces of the records.
    pub in_pieces: bool,
}

impl From<&Agreement> for StartsDocument {
    fn from(agreement: &Agreement) -> Self {
        StartsDocument {
            same: agreement.is_same,
            better: agreement.is_better,
            values: value_documents(&agreement.values),
            tried: agreement.tried,
            left: agreement.left.is_finite().then_some(agreement.left),
            in_pieces: agreement.in_pieces,
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
    /// What the error should stay below, rms over the noise.
    pub wanted: f64,
}

impl From<&Fineness> for StepsDocument {
    fn from(fineness: &Fineness) -> Self {
        StepsDocument { steps: fineness.steps, error: fineness.error, wanted: fineness.wanted }
    }
}

/// Whether fits from other points reproduce the fit, in words.
pub fn starts_sentence(agreement: &Agreement) -> String {
    let of = if agreement.in_pieces { " of the pieces that are fitted first" } else { "" };
    let left = format!("{} times the noise{of}", number(agreement.left));
    match (agreement.is_same, agreement.tried) {
        (true, 1) => "a fit from another point comes to the same".to_owned(),
        (true, tried) => format!("of {tried} fits from other points one comes to the same"),
        _ if agreement.is_better => format!(
            "a fit from another point leaves less, {left}, with {}: it found what the patch was not fitted to; let the parameters of the patch begin there",
            parameter_values_text(&agreement.values)
        ),
        (false, tried) if agreement.left.is_finite() => format!(
            "of {tried} fits from other points none comes to the same (the best leaves {left}): there may be better ones than this; narrower ranges help to find them"
        ),
        (false, tried) => format!("from none of {tried} other points the patch can be run"),
    }
}

/// How many steps the solver takes and how large its error is, in a sentence.
pub fn steps_sentence(fineness: &Fineness) -> String {
    let steps = if fineness.steps == 1 { "1 step".to_owned() } else { format!("{} steps", fineness.steps) };
    let takes = format!("The solver takes {steps} from sample to sample");
    if fineness.error.is_infinite() {
        return format!(
            "{takes}; what it errs by is not known, as the patch cannot be run with twice as many."
        );
    }
    let errs = format!("{takes} and errs by {} times the noise, rms", number(fineness.error));
    match fineness.is_enough() {
        true => format!("{errs}."),
        false => format!("{errs}; it should keep below {}.", number(fineness.wanted)),
    }
}

/// Which amplifier is overloaded, when, and what to do, in a sentence.
pub fn overload_sentence(overload: &RecordOverload) -> String {
    let RecordOverload { record, element, time, peak } = overload;
    format!(
        "Beside {record} the amplifier {element} is overloaded at {} s, asked for {} V: beyond 100 V the patch is not what it stands for. Let a volt of its scale stand for more, and search again.",
        number(*time),
        number(*peak)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::parameter_values::ParameterValues;

    #[test]
    fn the_values_of_a_better_fit_are_reported() {
        let values = ParameterValues(vec![("rate".to_owned(), 2.0, "1".to_owned())]);
        let better =
            Agreement { tried: 1, left: 1.0, is_same: false, is_better: true, values, in_pieces: false };
        let sentence = starts_sentence(&better);
        assert!(sentence.contains("with rate = 2: "), "{sentence}");
    }

    #[test]
    fn a_solver_that_errs_by_more_than_it_may_is_told() {
        let sentence = |error| steps_sentence(&Fineness { steps: 4, error, wanted: 0.1 });
        assert_eq!(
            sentence(0.05),
            "The solver takes 4 steps from sample to sample and errs by 0.05 times the noise, rms."
        );
        assert!(sentence(0.5).ends_with("; it should keep below 0.1."), "{}", sentence(0.5));
        assert_eq!(
            steps_sentence(&Fineness { steps: 1, error: f64::INFINITY, wanted: 0.1 }),
            "The solver takes 1 step from sample to sample; what it errs by is not known, as the patch cannot be run with twice as many."
        );
    }
}
