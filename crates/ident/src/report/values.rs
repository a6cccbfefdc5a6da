//! Fitted values in words and as documents.

use indexmap::IndexMap;
use serde::Serialize;

use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::Stage;
use crate::fit::parameter_values::ParameterValues;
use crate::fit::uncertainty::Known;
use crate::search::outcome::Outcome;
use patchcord_analysis::instruments::number;
use patchcord_core::document::behind;

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
    let each = values.0.iter();
    each.map(|(name, value, unit)| (name.clone(), ValueDocument { value: *value, unit: unit.clone() }))
        .collect()
}

/// Parameters with their values, for example "k = 500 N/m, c = 5 N s/m".
pub fn parameter_values_text(values: &ParameterValues) -> String {
    let each =
        values.0.iter().map(|(name, value, unit)| format!("{name} = {}{}", number(*value), behind(unit)));
    each.collect::<Vec<_>>().join(", ")
}

/// The 95 % interval of a value: from where to where, or "anything".
pub fn interval_text(known: Known) -> String {
    let [low, high] = known.interval;
    match known.error.is_finite() {
        true => format!("{} ... {}", number_text(known, low), number_text(known, high)),
        false => "anything".to_owned(),
    }
}

/// A number in or about the interval of a value, with as many digits as distinguish the ends of that.
pub fn number_text(known: Known, value: f64) -> String {
    let [low, high] = known.interval;
    let width = high - low;
    match number(low) == number(high) && width > 0.0 {
        true => {
            let decimals = 1.0 - width.log10().floor();
            let magnitude = value.abs().log10().floor();
            match magnitude < -5.0 && value != 0.0 {
                true => format!("{value:.*e}", (magnitude + decimals).clamp(0.0, 15.0) as usize),
                false => format!("{value:.*}", decimals.clamp(0.0, 15.0) as usize),
            }
        }
        false => number(value),
    }
}

/// The value of the parameter at a place of the fit, with as many digits as its interval asks for.
pub fn estimate_text(stage: &Stage, place: usize) -> String {
    number_text(stage.known(place), stage.train.point.knobs[place])
}

/// The parameter at a place of the fit with its value, for example "M = 2 kg".
pub fn assignment_text(stage: &Stage, place: usize) -> String {
    format!("{} = {}{}", stage.version.fit[place], estimate_text(stage, place), behind(stage.unit(place)))
}

/// The standard error of the parameter at a place of the fit.
pub fn error_text(stage: &Stage, place: usize) -> String {
    let error = stage.known(place).error;
    if error.is_finite() { number(error) } else { "not told".to_owned() }
}

/// Which parameters the data do not determine, in a sentence; None if they determine all.
pub fn undetermined_sentence(stage: &Stage) -> Option<String> {
    let untold =
        stage.version.fit.iter().enumerate().filter(|(place, _)| !stage.known(*place).error.is_finite());
    let names: Vec<&str> = untold.map(|(_, name)| name.as_str()).collect();
    let why = match names.as_slice() {
        [] => return None,
        [_] => "its value changes nothing, or what it changes others can make up for",
        _ => "their values change nothing, or can be changed together and leave the same",
    };
    Some(format!("These data do not tell {}: {why}.", names.join(", ")))
}

/// What a fitted parameter belongs to: an effect at its place, as in "leak at I2", or the patch.
pub fn owner(outcome: &Outcome, parameter: &str) -> String {
    let brings = |own: &&Candidate| own.graft.parameters.iter().any(|brought| brought.name == parameter);
    outcome.effects.iter().find(brings).map_or_else(|| "the patch".to_owned(), Candidate::named)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_an_interval_are_told_apart() {
        let known = |low, high, error| Known { error, interval: [low, high] };
        let told = |low, high, error| interval_text(known(low, high, error));
        assert_eq!(told(1.5, 2.25, 0.1), "1.5 ... 2.25");
        assert_eq!(told(14.9971, 15.0028, 0.001), "14.9971 ... 15.0028");
        assert_eq!(told(0.0, 0.0, 0.0), "0 ... 0");
        assert_eq!(told(0.0, 1.0, f64::INFINITY), "anything");
        // A value is not to lie outside of its interval as that is told.
        assert_eq!(number_text(known(14.9971, 15.0028, 0.001), 15.00249), "15.0025");
        assert_eq!(number_text(known(1.5, 2.25, 0.1), 1.87654), "1.877");
        assert_eq!(number_text(Known::NOT, 1.87654), "1.877");
        assert_eq!(number_text(known(1.99997e-16, 2.00003e-16, 1e-21), 2.00001e-16), "2.000010e-16");
    }
}
