//! Values beyond their ranges, in words and as a document.

use serde::Serialize;

use crate::report::values::assignment_text;
use crate::search::range_extension::Beyond;
use patchcord_analysis::instruments::number;

/// A patch fitted with wider ranges, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RangeExtensionDocument {
    /// The parameters whose values are beyond their ranges.
    pub parameters: Vec<ExtendedParameterDocument>,
    /// What the patch leaves with these values.
    pub leaves: LeftOverDocument,
    /// Whether the data cannot distinguish it from the patch with what is named.
    pub is_rival: bool,
}

/// A parameter beyond its range, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExtendedParameterDocument {
    /// Its name.
    pub name: String,
    /// Its fitted value.
    pub value: f64,
    /// Its unit.
    pub unit: String,
}

/// What a fitted model leaves of the training records and of those held back, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOverDocument {
    /// In training, rms over the noise.
    pub train: f64,
    /// On the data held back, rms over the noise.
    pub test: f64,
}

impl From<&Beyond> for RangeExtensionDocument {
    fn from(beyond: &Beyond) -> Self {
        let stage = &beyond.stage;
        let parameter = |place: &usize| ExtendedParameterDocument {
            name: stage.version.fit[*place].clone(),
            value: stage.train.point.knobs[*place],
            unit: stage.unit(*place).to_owned(),
        };
        RangeExtensionDocument {
            parameters: beyond.places.iter().map(parameter).collect(),
            leaves: LeftOverDocument { train: stage.train.over_noise(), test: stage.test.over_noise() },
            is_rival: beyond.is_rival,
        }
    }
}

/// Which values are beyond their ranges, in words.
pub fn extension_text(beyond: &Beyond) -> String {
    let told = beyond.places.iter().map(|place| assignment_text(&beyond.stage, *place));
    format!("{}, beyond {}", told.collect::<Vec<_>>().join(" and "), ranges(beyond))
}

/// What the patch alone leaves with these values, in a sentence.
pub fn extension_sentence(beyond: &Beyond) -> String {
    let [train, test] = [&beyond.stage.train, &beyond.stage.test].map(|own| number(own.over_noise()));
    format!(
        "The patch as it was asks for {}; so it alone would leave {train} times the noise in training and {test} in the test.",
        extension_text(beyond)
    )
}

fn ranges(beyond: &Beyond) -> &'static str {
    if beyond.places.len() == 1 { "its range" } else { "their ranges" }
}
