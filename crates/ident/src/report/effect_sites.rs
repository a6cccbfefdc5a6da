//! The sites of effects in a patch as sentences, and what cannot be tried.
//!
//! An effect needs a site with the right dimensions. An integrator whose output has no scale has no dimension, so
//! that no effect can be tried there. Both cases are reported, since a missing effect may be hidden by them.

use indexmap::IndexMap;

use crate::effects::effect_sites::EffectSites;

/// The effects that are tried at each site, a line per site in the order of the effects.
pub fn site_lines(sites: &EffectSites) -> Vec<String> {
    let mut effects_at: IndexMap<&str, Vec<&str>> = IndexMap::new();
    for (effect, elements) in &sites.effects {
        elements.iter().for_each(|element| effects_at.entry(element).or_default().push(effect));
    }
    let line = |(site, effects): (&str, Vec<&str>)| format!("to be tried at {site}: {}", effects.join(", "));
    effects_at.into_iter().map(line).collect()
}

/// The effects for which the patch has no site, as a sentence. None if it has a site for every effect.
pub fn inapplicable_effects_sentence(sites: &EffectSites) -> Option<String> {
    let inapplicable = sites.inapplicable_effects();
    (!inapplicable.is_empty()).then(|| format!("The patch has no place for {}.", inapplicable.join(", ")))
}

/// The integrators at which no effect is tried because their output is not a signal with a scale, a sentence each.
pub fn unscaled_integrator_sentences(sites: &EffectSites) -> impl Iterator<Item = String> + '_ {
    sites.unscaled_integrators.iter().map(|integrator| {
        format!("No effect is tried at {integrator}, because its output is not a signal with a scale: add it to \"signals\".")
    })
}
