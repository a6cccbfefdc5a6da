//! Effects at their sites as text, for example "leak at I2".
//!
//! All texts that name an effect use these labels. Documents and logs hold a [`PlacedEffect`].

use crate::effects::PlacedEffect;
use crate::effects::candidate::Candidate;

/// An effect at its site, for example "leak at I2". `site` is the name of the element on which the effect acts.
pub fn label(effect: &str, site: &str) -> String {
    format!("{effect} at {site}")
}

/// The label of an effect at its site.
pub fn effect_label(placed: &PlacedEffect) -> String {
    label(&placed.effect, &placed.site)
}

/// The label of an effect that is wired into a patch.
pub fn candidate_label(candidate: &Candidate) -> String {
    effect_label(&candidate.placed_effect())
}

/// The labels of effects, in their order.
pub fn effect_labels(placed: &[PlacedEffect]) -> Vec<String> {
    placed.iter().map(effect_label).collect()
}
