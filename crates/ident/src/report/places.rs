//! Places where effects cannot be tried, as sentences.
//!
//! An effect needs a site with the right dimensions. An integrator whose output has no scale has no dimension, so
//! that no effect can be tried there. Both cases are reported, since a missing effect may be hidden by them.

use crate::effects::effect_sites::EffectSites;

/// The effects for which the patch has no place, as a sentence. None if it has a place for every effect.
pub fn nowhere_sentence(places: &EffectSites) -> Option<String> {
    let nowhere = places.inapplicable_effects();
    (!nowhere.is_empty()).then(|| format!("The patch has no place for {}.", nowhere.join(", ")))
}

/// The integrators at which no effect is tried because their output is not a signal with a scale, a sentence each.
pub fn nameless_sentences(places: &EffectSites) -> impl Iterator<Item = String> + '_ {
    places.unscaled_integrators.iter().map(|integrator| {
        format!("No effect is tried at {integrator}, because its output is not a signal with a scale: add it to \"signals\".")
    })
}
