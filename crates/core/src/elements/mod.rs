//! The computing elements: each has its own file and one row in [`REGISTRY`].
//!
//! A row contains everything that other modules need to know about an element. The checker reads its inputs and
//! settings. The schema and the reference page are generated from it. Every backend runs the operations that its laws
//! emit.

mod absolute;
mod backlash;
mod chirp;
mod comparator;
mod cos;
mod dead_zone;
mod delay;
mod diode_dead_zone;
mod diode_lower_of;
mod diode_upper_of;
mod exp;
mod free_pot;
mod function_generator;
mod integrator;
mod inverter;
mod key_switch;
mod key_synonyms;
mod kind;
mod lag;
mod log;
mod multiplier;
mod noise;
mod open_amplifier;
mod page;
mod pot;
mod pulse;
mod ramp;
mod reference;
mod relay;
mod setting;
mod sin;
mod sine;
mod soft_limit;
mod square;
mod step;
mod summer;
mod synonyms;
mod table;
mod track_hold;
mod triangle;

pub(crate) use key_synonyms::{key_advice, misplaced_key_hint};
pub use kind::{Family, Input, Jacks, Kind, OutputStage, PartUse, Transfer};
pub(crate) use open_amplifier::AMPLIFICATION;
pub use page::markdown_table;
pub use page::{KindPage, reference_page};
pub use reference::{REFERENCE, REFERENCES};
pub use setting::{Setting, SettingDefault, SettingQuantity};
pub use synonyms::kind_advice;
pub(crate) use synonyms::{kind_hint, meant_word};

/// Every kind of element and drive, in the order of listings.
///
/// # Examples
///
/// ```
/// use patchcord_core::elements::REGISTRY;
///
/// assert_eq!(REGISTRY[0].name, "summer");
/// let pot = REGISTRY.iter().find(|kind| kind.name == "pot").expect("every machine has pots");
/// assert_eq!(pot.law, "out = setting x in");
/// ```
pub static REGISTRY: &[&Kind] = &[
    &summer::KIND,
    &inverter::KIND,
    &open_amplifier::KIND,
    &integrator::KIND,
    &lag::KIND,
    &pot::KIND,
    &free_pot::KIND,
    &absolute::KIND,
    &dead_zone::KIND,
    &diode_dead_zone::KIND,
    &diode_lower_of::KIND,
    &diode_upper_of::KIND,
    &backlash::KIND,
    &multiplier::KIND,
    &function_generator::KIND,
    &sin::KIND,
    &cos::KIND,
    &log::KIND,
    &exp::KIND,
    &comparator::KIND,
    &relay::KIND,
    &key_switch::KIND,
    &track_hold::KIND,
    &delay::KIND,
    &step::KIND,
    &ramp::KIND,
    &pulse::KIND,
    &square::KIND,
    &triangle::KIND,
    &sine::KIND,
    &chirp::KIND,
    &noise::KIND,
    &table::KIND,
];

/// The kind with this name in a family.
///
/// # Examples
///
/// ```
/// use patchcord_core::elements::{Family, find};
///
/// let integrator = find(Family::Computing, "integrator").expect("an element");
/// assert_eq!(integrator.settings[0].name, "initial");
/// assert!(find(Family::Drive, "integrator").is_none());
/// ```
pub fn find(family: Family, name: &str) -> Option<&'static Kind> {
    REGISTRY.iter().copied().find(|kind| kind.family == family && kind.name == name)
}

/// The names of a family's kinds, in the order of the registry.
///
/// # Examples
///
/// ```
/// use patchcord_core::elements::{Family, names};
///
/// let drives = names(Family::Drive);
/// assert_eq!(drives, ["step", "ramp", "pulse", "square", "triangle", "sine", "chirp", "noise", "table"]);
/// ```
pub fn names(family: Family) -> Vec<&'static str> {
    REGISTRY.iter().filter(|kind| kind.family == family).map(|kind| kind.name).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn names_are_distinct_and_rows_are_complete() {
        let names: HashSet<_> = REGISTRY.iter().map(|kind| kind.name).collect();
        assert_eq!(names.len(), REGISTRY.len());
        for kind in REGISTRY {
            let texts = [kind.summary, kind.law, kind.overload, kind.modes, kind.source, kind.symbol];
            assert!(texts.iter().all(|text| !text.is_empty()), "{}", kind.name);
        }
    }

    #[test]
    fn elements_whose_inputs_are_not_direct_have_memory() {
        for kind in REGISTRY {
            let has_delayed = kind.inputs.iter().any(|input| !input.direct);
            assert!(kind.memory_law.is_some() || !has_delayed, "{}", kind.name);
        }
    }
}
