//! The outputs that invert each other.

use patchcord_core::patch::{ElementEntry, Patch};

/// The output that an element inverts with gain 1. `None` if it does anything else.
fn inverted(entry: &ElementEntry) -> Option<&str> {
    let is_amplifier = ["inverter", "summer"].contains(&entry.kind.name);
    match entry.plugs.as_slice() {
        [plug]
            if is_amplifier
                && entry.settings.iter().all(Option::is_none)
                && ["in", "x1"].contains(&plug.jack.value.as_str()) =>
        {
            Some(plug.from.value.as_str())
        }
        _ => None,
    }
}

/// The outputs that invert an output, and the one that it inverts.
pub(crate) fn inverses<'p>(patch: &'p Patch, output: &str) -> Vec<&'p str> {
    let inverters = patch.elements.iter().filter(|(_, entry)| inverted(entry) == Some(output));
    let before = patch.elements.get(output).and_then(inverted);
    inverters.map(|(name, _)| name.as_str()).chain(before).collect()
}
