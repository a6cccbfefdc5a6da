//! Fitted values as text and as JSON documents.
//!
//! All texts of reports take their numbers from here. Numbers have four significant digits. A value has more if its
//! interval is so narrow that its ends would otherwise be printed as the same number. Units follow the value after a
//! space, and dimensionless values have none.

use indexmap::IndexMap;
use serde::Serialize;

use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::FittedModel;
use crate::fit::parameter_values::ParameterValues;
use crate::fit::uncertainty::Uncertainty;
use crate::report::labels::candidate_label;
use crate::search::outcome::Outcome;
use patchcord_core::document::unit_suffix;

pub use patchcord_analysis::format::{QuantityFormat, format_pure_number, format_quantity};

/// A value followed by its unit, for example "0.12 N". A dimensionless value has none.
pub fn value_text(value: f64, unit: &str) -> String {
    format!("{}{}", format_pure_number(value), unit_suffix(unit))
}

/// A percentage, for example "32 %".
pub fn percent_text(percent: f64) -> String {
    format!("{} %", format_pure_number(percent))
}

/// The residuals of a model in the training and in the validation data, rms over the noise.
pub fn residual_texts(model: &FittedModel) -> [String; 2] {
    [&model.train, &model.validation].map(|fitted| format_pure_number(fitted.normalised_rms()))
}

/// A value with its unit, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ValueDocument {
    /// The value.
    pub value: f64,
    /// Its unit.
    pub unit: String,
}

/// Parameters with their values, by name.
pub fn value_documents(values: &ParameterValues) -> IndexMap<String, ValueDocument> {
    let values = values.0.iter();
    values
        .map(|(name, value, unit)| (name.clone(), ValueDocument { value: *value, unit: unit.clone() }))
        .collect()
}

/// Parameters with their values, for example "k = 500 N/m, c = 5 N s/m".
pub fn parameter_values_text(values: &ParameterValues) -> String {
    let assignments =
        values.0.iter().map(|(name, value, unit)| format!("{name} = {}", value_text(*value, unit)));
    assignments.collect::<Vec<_>>().join(", ")
}

/// The 95 % interval of a value, for example "1.5 ... 2.25", or "any value" if the data do not determine it.
pub fn interval_text(uncertainty: Uncertainty) -> String {
    let [low, high] = uncertainty.interval;
    match uncertainty.error.is_finite() {
        true => format!("{} ... {}", number_text(uncertainty, low), number_text(uncertainty, high)),
        false => "any value".to_owned(),
    }
}

/// A number in or near the interval of a value, with enough digits to distinguish the ends of the interval.
///
/// Example: an interval of 1.00012 ... 1.00018 has two ends that are equal to four digits. They are then printed with
/// two digits of their difference. Very small values use a power of ten.
pub fn number_text(uncertainty: Uncertainty, value: f64) -> String {
    let [low, high] = uncertainty.interval;
    let width = high - low;
    match format_pure_number(low) == format_pure_number(high) && width > 0.0 {
        true => {
            let decimals = 1.0 - width.log10().floor();
            let magnitude = value.abs().log10().floor();
            match magnitude < -5.0 && value != 0.0 {
                true => format!("{value:.*e}", (magnitude + decimals).clamp(0.0, 15.0) as usize),
                false => format!("{value:.*}", decimals.clamp(0.0, 15.0) as usize),
            }
        }
        false => format_pure_number(value),
    }
}

/// The value of the fitted parameter with this index, with as many digits as its interval requires.
pub fn estimate_text(model: &FittedModel, parameter_index: usize) -> String {
    number_text(model.uncertainty(parameter_index), model.train.estimate.parameters[parameter_index])
}

/// The value of the fitted parameter with this index, followed by its unit, for example "2 kg".
pub fn estimate_with_unit_text(model: &FittedModel, parameter_index: usize) -> String {
    format!("{}{}", estimate_text(model, parameter_index), unit_suffix(model.unit(parameter_index)))
}

/// The fitted parameter with this index and its value, for example "M = 2 kg".
pub fn assignment_text(model: &FittedModel, parameter_index: usize) -> String {
    let name = &model.variant.fit[parameter_index];
    format!("{name} = {}", estimate_with_unit_text(model, parameter_index))
}

/// The standard error of the fitted parameter with this index, or "unknown".
pub fn error_text(model: &FittedModel, parameter_index: usize) -> String {
    let error = model.uncertainty(parameter_index).error;
    if error.is_finite() { format_pure_number(error) } else { "unknown".to_owned() }
}

/// The parameters that the data do not determine, as a sentence. None if the data determine all.
pub fn undetermined_sentence(model: &FittedModel) -> Option<String> {
    let undetermined = model
        .variant
        .fit
        .iter()
        .enumerate()
        .filter(|(index, _)| !model.uncertainty(*index).error.is_finite());
    let names: Vec<&str> = undetermined.map(|(_, name)| name.as_str()).collect();
    let why = match names.as_slice() {
        [] => return None,
        [_] => "its value has no effect on the outputs, or other parameters can compensate for it",
        _ => "their values have no effect on the outputs, or can change together without one",
    };
    Some(format!("These data do not determine {}: {why}.", names.join(", ")))
}

/// The owner of a fitted parameter: an effect at its site, as in "leak at I2", or "the patch".
///
/// Parameters that an effect adds belong to it; all others belong to the patch.
pub fn owner(outcome: &Outcome, parameter: &str) -> String {
    let is_owner = |effect: &&Candidate| effect.graft.parameters.iter().any(|added| added.name == parameter);
    outcome.effects.iter().find(is_owner).map_or_else(|| "the patch".to_owned(), candidate_label)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_enough_digits_to_distinguish_the_ends_of_their_interval() {
        let known = |low, high, error| Uncertainty { error, interval: [low, high] };
        let text = |low, high, error| interval_text(known(low, high, error));
        assert_eq!(text(1.5, 2.25, 0.1), "1.5 ... 2.25");
        assert_eq!(text(14.9971, 15.0028, 0.001), "14.9971 ... 15.0028");
        assert_eq!(text(0.0, 0.0, 0.0), "0 ... 0");
        assert_eq!(text(0.0, 1.0, f64::INFINITY), "any value");
        // The printed value must be inside the printed interval.
        assert_eq!(number_text(known(14.9971, 15.0028, 0.001), 15.00249), "15.0025");
        assert_eq!(number_text(known(1.5, 2.25, 0.1), 1.87654), "1.877");
        assert_eq!(number_text(Uncertainty::UNDETERMINED, 1.87654), "1.877");
        assert_eq!(number_text(known(1.99997e-16, 2.00003e-16, 1e-21), 2.00001e-16), "2.000010e-16");
    }
}
