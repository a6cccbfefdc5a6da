//! Where effects cannot be tried, in words.

use crate::effects::places::Places;

/// For which effects the patch has no place, in a sentence; None if it has a place for all.
pub fn nowhere_sentence(places: &Places) -> Option<String> {
    let nowhere = places.nowhere();
    (!nowhere.is_empty()).then(|| format!("The patch has no place for {}.", nowhere.join(", ")))
}

/// At which integrators nothing is tried because they give no signal with a scale, a sentence each.
pub fn nameless_sentences(places: &Places) -> impl Iterator<Item = String> + '_ {
    places.nameless.iter().map(|own| {
        format!("{own} gives no signal with a scale, so that nothing is tried there: name what it gives under \"signals\".")
    })
}
