//! What a machine has: parts, gains, reference. One file a machine, one row in [`ALL`].

mod solartron_1451;
mod unlimited;

/// A part that a machine has a number of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
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
    /// A quarter-squares multiplier.
    Multiplier,
    /// A function generator, fixed or set by hand, with its output amplifier.
    FunctionGenerator,
    /// A comparator with its relay.
    Relay,
    /// A track-and-hold amplifier.
    TrackHold,
    /// A delay line.
    DelayLine,
    /// A rebound stop on an integrator.
    Rebound,
    /// A brake on an integrator.
    Brake,
}

impl Part {
    /// Every part, in the order of listings.
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
    ];

    /// Key of the part in documents and listings (plural).
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
        }
    }

    /// The part as messages call it (plural).
    pub fn noun(self) -> String {
        self.key().replace('_', " ")
    }

    /// So many of the part, in words: "no relays", "1 relay", "5 diode pairs".
    pub fn counted(self, count: usize) -> String {
        match count {
            0 => format!("no {}", self.noun()),
            1 => format!("1 {}", self.noun().trim_end_matches('s')),
            _ => format!("{count} {}", self.noun()),
        }
    }
}

/// A machine that patches can be made for.
#[derive(Debug)]
pub struct Machine {
    /// Name in documents.
    pub name: &'static str,
    /// What it is, in one line.
    pub title: &'static str,
    /// Where its data come from.
    pub source: &'static str,
    /// Parts and how many of each; a part that is not listed is not there. `None`: no limit at all.
    pub inventory: Option<&'static [(Part, usize)]>,
    /// Input gains of summing amplifiers; empty: any.
    pub summer_gains: &'static [f64],
    /// Input gains of integrating amplifiers, per machine second; empty: any.
    pub integrator_gains: &'static [f64],
}

/// The reference voltage of every machine here, and where its amplifiers stop, in volts.
pub const REFERENCE: f64 = 100.0;

/// Every machine.
pub static ALL: &[&Machine] = &[&solartron_1451::MACHINE, &unlimited::MACHINE];

/// The machine of patches that name none.
pub static UNNAMED: &Machine = &unlimited::MACHINE;

/// The machine of this name.
pub fn find(name: &str) -> Option<&'static Machine> {
    ALL.iter().copied().find(|machine| machine.name == name)
}

impl Machine {
    /// How many of a part it has; `None`: as many as one likes.
    pub fn count(&self, part: Part) -> Option<usize> {
        let inventory = self.inventory?;
        Some(inventory.iter().find(|(owned, _)| *owned == part).map_or(0, |(_, count)| *count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_1451_is_the_one_of_the_text() {
        let machine = find("solartron-1451").unwrap();
        let counts = Part::ALL.iter().map(|part| machine.count(*part));
        let expected = [16, 8, 12, 6, 4, 2, 0, 0, 0, 0, 0, 0].map(Some);
        assert!(counts.eq(expected));
    }

    #[test]
    fn one_part_is_told_in_the_singular() {
        let told = [(0, "no summers"), (1, "1 summer"), (2, "2 summers")];
        assert!(told.iter().all(|(count, text)| Part::Summer.counted(*count) == *text));
        assert_eq!(Part::FixedPot.counted(1), "1 fixed pot");
    }

    #[test]
    fn the_roomy_machine_has_no_limits() {
        let machine = find("unlimited").unwrap();
        assert!(Part::ALL.iter().all(|part| machine.count(*part).is_none()));
    }
}
