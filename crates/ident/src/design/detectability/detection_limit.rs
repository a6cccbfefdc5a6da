//! The weakest effect of a kind, at a place, that data would have shown.

use crate::fit::extended_model::LeftOut;
use crate::fit::parameter_values::ParameterValues;

/// The weakest effect of a kind, at a place, that data would have shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// Name of the effect.
    pub effect: String,
    /// The element that it acts on.
    pub junction: String,
    /// What it reads beside it, where there is a choice.
    pub reads: Vec<String>,
    /// The parameter that says how strong it is.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Its value from which on the effect would have been seen; nothing where none in its range would.
    pub value: Option<f64>,
    /// The same as a share of the way from no effect to the end of the range: what limits are compared by.
    pub share: f64,
    /// What other parameters were taken to be there.
    pub beside: ParameterValues,
}

/// What data could show beside a patch, before anything is sought in them.
#[derive(Debug, Clone)]
pub struct Visible {
    /// What the patch as fitted leaves, rms over the noise.
    pub leaves: f64,
    /// The weakest effects that would show if it left but noise, those that show best first.
    pub limits: Vec<Limit>,
    /// What cannot be tried.
    pub left_out: Vec<LeftOut>,
}

impl Limit {
    /// Whether both are of the same effect, place and parameter.
    pub(crate) fn is_of(&self, other: &Limit) -> bool {
        let is_there = self.junction == other.junction && self.reads == other.reads;
        is_there && self.effect == other.effect && self.parameter == other.parameter
    }

    /// The effect and where it acts.
    pub fn named(&self) -> String {
        format!("{} at {}", self.effect, self.junction)
    }

    /// Whether the data could show the effect at all.
    pub fn is_seen(&self) -> bool {
        self.value.is_some()
    }
}

/// The best place of every effect, those that show best first.
pub fn best_places(limits: &[Limit]) -> Vec<&Limit> {
    let mut best: Vec<&Limit> = Vec::new();
    for limit in limits {
        if best.iter().all(|own| own.effect != limit.effect) {
            best.push(limit);
        }
    }
    best
}
