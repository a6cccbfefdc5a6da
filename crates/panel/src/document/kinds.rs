//! The names and the settings that new elements get.

use patchcord_core::patch::ElementBuilder;
use serde_json::Value;

/// What a new element of a kind gets.
struct KindRow {
    /// Its kind.
    kind: &'static str,
    /// The letter in front of its number.
    prefix: &'static str,
    /// The settings that it must have, as JSON.
    settings: &'static [(&'static str, &'static str)],
}

/// A row of the table.
const fn row(
    kind: &'static str,
    prefix: &'static str,
    settings: &'static [(&'static str, &'static str)],
) -> KindRow {
    KindRow { kind, prefix, settings }
}

/// Every kind. Voltages of drives are about half of full scale, in the scale of 1 V per volt.
const ROWS: &[KindRow] = &[
    row("summer", "S", &[]),
    row("inverter", "S", &[]),
    row("open-amplifier", "S", &[]),
    row("integrator", "A", &[]),
    row("lag", "A", &[("time", "1")]),
    row("pot", "P", &[("setting", "0.5")]),
    row("free-pot", "P", &[("setting", "0.5")]),
    row("absolute", "D", &[]),
    row("dead-zone", "D", &[("lower", "-10"), ("upper", "10")]),
    row("diode-dead-zone", "D", &[("setting", "0.5")]),
    row("diode-lower-of", "D", &[]),
    row("diode-upper-of", "D", &[]),
    row("backlash", "D", &[("width", "10")]),
    row("multiplier", "M", &[("mode", "\"product\"")]),
    row("function-generator", "F", &[("points", "[[-100, -100], [100, 100]]")]),
    row("sin", "F", &[]),
    row("cos", "F", &[]),
    row("log", "F", &[]),
    row("exp", "F", &[]),
    row("comparator", "C", &[]),
    row("relay", "R", &[("pull_in", "10"), ("drop_out", "-10")]),
    row("key-switch", "K", &[]),
    row("track-hold", "T", &[]),
    row("delay", "L", &[("delay", "1")]),
    row("step", "E", &[("height", "50")]),
    row("ramp", "E", &[("rate", "10")]),
    row("pulse", "E", &[("height", "50"), ("width", "1")]),
    row("square", "E", &[("amplitude", "50"), ("frequency", "1")]),
    row("triangle", "E", &[("amplitude", "50"), ("frequency", "1")]),
    row("sine", "E", &[("amplitude", "50"), ("frequency", "1")]),
    row("chirp", "E", &[("amplitude", "50"), ("from", "0.1"), ("to", "10"), ("time", "10")]),
    row("noise", "E", &[("rms", "10"), ("every", "0.1"), ("seed", "1")]),
    row("table", "E", &[("points", "[[0, 0], [1, 50]]")]),
];

/// The row of a kind.
fn row_of(kind: &str) -> Option<&'static KindRow> {
    ROWS.iter().find(|row| row.kind == kind)
}

/// The first letters of the names of elements of a kind: "A" for integrators.
pub fn prefix(kind: &str) -> &'static str {
    row_of(kind).map_or("E", |row| row.prefix)
}

/// A new element of a kind with the settings that it must have. Only its cords are missing.
pub(super) fn new_element(kind: &str) -> ElementBuilder {
    let settings = row_of(kind).map_or(&[][..], |row| row.settings);
    settings.iter().fold(ElementBuilder::new(kind), |element, (name, json)| {
        element.set(name, serde_json::from_str::<Value>(json).unwrap_or_default())
    })
}

#[cfg(test)]
mod tests {
    use patchcord_core::elements::{REGISTRY, SettingDefault};

    use super::*;

    #[test]
    fn every_kind_has_a_row_with_its_required_settings() {
        assert_eq!(ROWS.len(), REGISTRY.len());
        for kind in REGISTRY {
            let row = row_of(kind.name).unwrap_or_else(|| panic!("{} has no row", kind.name));
            let required = kind.settings.iter().filter(|setting| setting.default == SettingDefault::Required);
            assert!(required.map(|setting| setting.name).eq(row.settings.iter().map(|(name, _)| *name)));
            assert!(row.settings.iter().all(|(_, json)| serde_json::from_str::<Value>(json).is_ok()));
        }
    }
}
