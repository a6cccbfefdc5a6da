//! Damage to the table of a sweep, and the rules for its continuation.

use super::csv_damage::damaged_csv;
use crate::common::random::SplitMix64;

/// The table of a sweep with damage.
pub(crate) struct DamagedTable {
    /// The table before the damage.
    whole: Vec<u8>,
    /// The table after it.
    pub damaged: Vec<u8>,
    /// Whether the table is only cut off, as by a killed sweep.
    is_cut: bool,
}

impl DamagedTable {
    /// Cuts a table off, or changes its cells and lines.
    pub(crate) fn new(whole: Vec<u8>, seed: u64) -> DamagedTable {
        let mut random = SplitMix64(seed);
        let is_cut = random.below(2) == 0;
        let damaged = match is_cut {
            true => whole[..random.below(whole.len() + 1)].to_vec(),
            false => damaged_csv(&whole, &mut random),
        };
        DamagedTable { whole, damaged, is_cut }
    }

    /// What is wrong with the table `found` after the sweep was continued. `is_accepted` says whether the sweep ended
    /// without an error.
    pub(crate) fn fault(&self, found: &[u8], is_accepted: bool) -> Option<&'static str> {
        match (self.is_cut, is_accepted) {
            (true, false) => Some("a sweep that was cut off is not continued"),
            (true, true) if found != self.whole => Some("a continued sweep has other rows"),
            (false, false) if found != self.damaged => Some("a refused table is changed"),
            (false, true) if !found.ends_with(b"\n") => Some("a continued table has an incomplete line"),
            _ => None,
        }
    }
}
