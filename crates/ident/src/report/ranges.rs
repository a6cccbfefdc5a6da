//! Parameter values outside their ranges, as text and as a JSON document.
//!
//! If a patch fits best at an end of a range, the search fits it again with a wider range. The value beyond the range
//! can be a rival of the named effects, or explain the data alone. The verdict or a doubt reports it.

use serde::Serialize;

use crate::fit::fitted_model::FittedModel;
use crate::report::values::{assignment_text, residual_texts};
use crate::search::range_extension::RangeExtension;

/// A patch fitted with wider ranges, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RangeExtensionDocument {
    /// The parameters whose values are outside their ranges.
    pub parameters: Vec<ExtendedParameterDocument>,
    /// The residual of the patch with these values.
    pub leaves: RemainingResidualSummary,
    /// Whether the data cannot distinguish it from the patch with what is named.
    pub is_rival: bool,
}

/// A parameter outside its range, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExtendedParameterDocument {
    /// Its name.
    pub name: String,
    /// Its fitted value.
    pub value: f64,
    /// Its unit.
    pub unit: String,
}

/// The residual of a fitted model in the training and validation data, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RemainingResidualSummary {
    /// In training, rms over the noise.
    pub train: f64,
    /// In the validation data, rms over the noise.
    #[serde(rename = "test")]
    pub validation: f64,
}

impl From<&FittedModel> for RemainingResidualSummary {
    fn from(model: &FittedModel) -> Self {
        RemainingResidualSummary {
            train: model.train.normalised_rms(),
            validation: model.validation.normalised_rms(),
        }
    }
}

impl From<&RangeExtension> for RangeExtensionDocument {
    /// `extension.outside` has indices of the fitted parameters; their names and units are those of the model.
    fn from(extension: &RangeExtension) -> Self {
        let model = &extension.model;
        let parameter = |index: &usize| ExtendedParameterDocument {
            name: model.variant.fit[*index].clone(),
            value: model.train.estimate.parameters[*index],
            unit: model.unit(*index).to_owned(),
        };
        RangeExtensionDocument {
            parameters: extension.outside.iter().map(parameter).collect(),
            leaves: RemainingResidualSummary::from(model),
            is_rival: extension.is_rival,
        }
    }
}

/// The values outside their ranges, for example "M = 2 kg, beyond its range".
pub fn extension_text(extension: &RangeExtension) -> String {
    let values = extension.outside.iter().map(|index| assignment_text(&extension.model, *index));
    let ranges = if extension.outside.len() == 1 { "its range" } else { "their ranges" };
    format!("{}, beyond {ranges}", values.collect::<Vec<_>>().join(" and "))
}

/// The values outside their ranges and the residual of the patch alone with these values, as a sentence.
pub fn extension_sentence(extension: &RangeExtension) -> String {
    let [train, validation] = residual_texts(&extension.model);
    format!(
        "The best fit of the original patch has {}: it leaves {train} times the noise in the training data and {validation} times in the validation data.",
        extension_text(extension)
    )
}
