//! Fitted values in words.

use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::Stage;
use crate::search::outcome::Outcome;
use patchcord_analysis::instruments::number;
use patchcord_core::document::behind;

impl Stage {
    /// The value of what is fitted at a place, with as many digits as its interval asks for.
    pub fn number_told(&self, place: usize) -> String {
        self.known(place).number(self.train.point.knobs[place])
    }

    /// What is fitted at a place, and its value, in words.
    pub fn value_told(&self, place: usize) -> String {
        format!("{} = {}{}", self.version.fit[place], self.number_told(place), behind(self.unit(place)))
    }

    /// The standard error of what is fitted at a place, in words.
    pub fn error_told(&self, place: usize) -> String {
        let error = self.known(place).error;
        if error.is_finite() { number(error) } else { "not told".to_owned() }
    }

    /// Between which values what is fitted at a place lies in 95 of 100 cases, as it is told.
    pub fn interval_told(&self, place: usize) -> String {
        self.known(place).interval_told()
    }

    /// What the data do not tell of what is fitted, in a sentence; nothing where they tell of all.
    pub fn untold(&self) -> Option<String> {
        let untold =
            self.version.fit.iter().enumerate().filter(|(place, _)| !self.known(*place).error.is_finite());
        let names: Vec<&str> = untold.map(|(_, name)| name.as_str()).collect();
        let why = match names.as_slice() {
            [] => return None,
            [_] => "its value changes nothing, or what it changes others can make up for",
            _ => "their values change nothing, or can be changed together and leave the same",
        };
        Some(format!("These data do not tell {}: {why}.", names.join(", ")))
    }
}

impl Outcome {
    /// What a fitted parameter belongs to: the effect that brought it and where that acts, or the patch.
    pub fn owner(&self, parameter: &str) -> String {
        let brings = |own: &&Candidate| own.graft.parameters.iter().any(|brought| brought.name == parameter);
        self.effects.iter().find(brings).map_or_else(|| "the patch".to_owned(), Candidate::named)
    }
}
