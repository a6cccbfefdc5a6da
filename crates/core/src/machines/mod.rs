//! The machines for which patches can be made: their parts, gains and reference voltage.
//!
//! Each machine has its own file and one entry in [`ALL`]. The checker compares a patch with its machine; the engine
//! itself computes the same for every machine.

mod solartron_1451;
mod unlimited;

/// A kind of part that a machine has a limited number of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Part {
    /// A summing amplifier.
    Summer,
    /// An integrating amplifier.
    Integrator,
    /// A potentiometer with one end grounded.
    FixedPot,
    /// A potentiometer with both ends free.
    FreePot,
    /// Two diodes.
    DiodePair,
    /// A quarter-squares multiplier with its output amplifier.
    Multiplier,
    /// A function generator, fixed or set by hand, with its output amplifier.
    FunctionGenerator,
    /// A comparator with its relay.
    Relay,
    /// A track-and-hold amplifier.
    TrackHold,
    /// A delay line.
    DelayLine,
    /// A rebound stop at an integrator.
    Rebound,
    /// A brake at an integrator.
    Brake,
    /// A relay that puts a single integrator into initial condition.
    ModeRelay,
}

impl Part {
    /// Every part, in the order in which listings show them.
    pub const ALL: &[Part] = &[
        Part::Summer,
        Part::Integrator,
        Part::FixedPot,
        Part::FreePot,
        Part::DiodePair,
        Part::Multiplier,
        Part::FunctionGenerator,
        Part::Relay,
        Part::TrackHold,
        Part::DelayLine,
        Part::Rebound,
        Part::Brake,
        Part::ModeRelay,
    ];

    /// The key of the part in documents and listings, in the plural.
    pub fn key(self) -> &'static str {
        match self {
            Part::Summer => "summers",
            Part::Integrator => "integrators",
            Part::FixedPot => "fixed_pots",
            Part::FreePot => "free_pots",
            Part::DiodePair => "diode_pairs",
            Part::Multiplier => "multipliers",
            Part::FunctionGenerator => "function_generators",
            Part::Relay => "relays",
            Part::TrackHold => "track_holds",
            Part::DelayLine => "delay_lines",
            Part::Rebound => "rebounds",
            Part::Brake => "brakes",
            Part::ModeRelay => "mode_relays",
        }
    }

    /// The name of the part in messages, in the plural.
    pub fn noun(self) -> String {
        self.key().replace('_', " ")
    }

    /// A number of this part in words: "no relays", "1 relay", "5 diode pairs".
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::machines::Part;
    ///
    /// assert_eq!(Part::FixedPot.counted(1), "1 fixed pot");
    /// assert_eq!(Part::Relay.counted(0), "no relays");
    /// assert_eq!((Part::DiodePair.key(), Part::DiodePair.noun().as_str()), ("diode_pairs", "diode pairs"));
    /// ```
    pub fn counted(self, count: usize) -> String {
        match count {
            0 => format!("no {}", self.noun()),
            1 => format!("1 {}", self.noun().trim_end_matches('s')),
            _ => format!("{count} {}", self.noun()),
        }
    }
}

/// The description of a machine for which patches can be made. [`solve::Machine`](crate::solve::Machine) is a running
/// machine.
#[derive(Debug)]
pub struct MachineModel {
    /// Its name in documents.
    pub name: &'static str,
    /// A description in one line.
    pub title: &'static str,
    /// The source of these data.
    pub source: &'static str,
    /// The number of each part; a part that is not listed does not exist. `None` if parts are unlimited.
    pub inventory: Option<&'static [(Part, usize)]>,
    /// Permitted input gains of summing amplifiers; empty if every gain is permitted.
    pub summer_gains: &'static [f64],
    /// Permitted input gains of integrating amplifiers, per machine second; empty if every gain is permitted.
    pub integrator_gains: &'static [f64],
}

/// The reference voltage in volts. It also is the largest output of an amplifier. All machines here have the same one.
pub const REFERENCE: f64 = 100.0;
/// The smallest and the largest peak with which an amplifier uses its range, in volts. A larger one leaves no reserve.
pub const GOOD_VOLTS: [f64; 2] = [50.0, 95.0];

/// Every machine, in the order of listings.
///
/// # Examples
///
/// ```
/// use patchcord_core::machines::{ALL, DEFAULT_MACHINE};
///
/// let names: Vec<&str> = ALL.iter().map(|machine| machine.name).collect();
/// assert_eq!(names, ["solartron-1451", "unlimited"]);
/// assert_eq!(DEFAULT_MACHINE.name, "unlimited");
/// ```
pub static ALL: &[&MachineModel] = &[&solartron_1451::MACHINE, &unlimited::MACHINE];

/// The machine of a patch that names none.
pub static DEFAULT_MACHINE: &MachineModel = &unlimited::MACHINE;

/// The machine with this name.
///
/// # Examples
///
/// ```
/// use patchcord_core::machines::find;
///
/// let machine = find("solartron-1451").expect("a machine");
/// assert_eq!(machine.summer_gains, [1.0, 10.0]);
/// assert!(find("lucidac").is_none());
/// ```
pub fn find(name: &str) -> Option<&'static MachineModel> {
    ALL.iter().copied().find(|machine| machine.name == name)
}

impl MachineModel {
    /// How many of a part the machine has. `None` if the number is unlimited.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::machines::{Part, find};
    ///
    /// let machine = find("solartron-1451").expect("a machine");
    /// assert_eq!((machine.count(Part::Integrator), machine.count(Part::Relay)), (Some(8), Some(0)));
    /// let unlimited = find("unlimited").expect("a machine");
    /// assert_eq!(unlimited.count(Part::Integrator), None);
    /// ```
    pub fn count(&self, part: Part) -> Option<usize> {
        let inventory = self.inventory?;
        Some(inventory.iter().find(|(listed, _)| *listed == part).map_or(0, |(_, count)| *count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_1451_has_the_parts_of_the_text() {
        let machine = find("solartron-1451").unwrap();
        let counts = Part::ALL.iter().map(|part| machine.count(*part));
        let expected = [16, 8, 12, 6, 4, 2, 0, 0, 0, 0, 0, 0, 0].map(Some);
        assert!(counts.eq(expected));
    }

    #[test]
    fn one_part_is_named_in_the_singular() {
        let cases = [(0, "no summers"), (1, "1 summer"), (2, "2 summers")];
        assert!(cases.iter().all(|(count, text)| Part::Summer.counted(*count) == *text));
        assert_eq!(Part::FixedPot.counted(1), "1 fixed pot");
    }

    #[test]
    fn the_unlimited_machine_has_no_limits() {
        let machine = find("unlimited").unwrap();
        assert!(Part::ALL.iter().all(|part| machine.count(*part).is_none()));
    }
}
