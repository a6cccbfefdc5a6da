//! The changes that are tried, each with a cost: the mistakes that people make most often have the least.

mod cords;
mod gains;
mod scales;
mod settings;
mod starts;

use super::change::Change;
use super::panel::Panel;

/// A change with its place in the order of the search.
pub(super) struct Candidate {
    pub change: Change,
    /// How unusual the mistake is that the change corrects.
    pub cost: u32,
}

/// The costs of the kinds of changes.
mod cost {
    pub(super) const GAIN: u32 = 10;
    pub(super) const UNUSUAL_GAIN: u32 = 14;
    pub(super) const SIGN: u32 = 10;
    pub(super) const INITIAL: u32 = 10;
    pub(super) const UNUSED_CORD: u32 = 12;
    pub(super) const UNIT: u32 = 12;
    pub(super) const POT: u32 = 13;
    /// A power of ten that brings a pot from below 0.1 to between 0.1 and 1, where pots are set best.
    pub(super) const SMALL_POT: u32 = 4;
    pub(super) const FACTOR: u32 = 16;
    pub(super) const SCALE: u32 = 16;
    pub(super) const TIME_SCALE: u32 = 16;
    pub(super) const OTHER_NAME: u32 = 17;
    pub(super) const INVERTER: u32 = 20;
    pub(super) const REMOVED_CORD: u32 = 22;
    pub(super) const FOUND_FACTOR: u32 = 23;
    pub(super) const SIGNAL_SIGN: u32 = 24;
    pub(super) const MOVED_CORD: u32 = 26;
    pub(super) const EXCHANGED_CORDS: u32 = 28;
    pub(super) const SCALE_FACTOR: u32 = 29;
    pub(super) const ADDED_CORD: u32 = 30;
    /// A gain and a pot that do not fit each other make a change of one of them likelier.
    pub(super) const FITTING: u32 = 5;
    /// Each further power of ten makes a wrong factor less likely.
    pub(super) const DECADE: u32 = 3;
}

/// Powers of ten by which gains, settings and scales are often wrong.
const POWERS: [f64; 6] = [10.0, 0.1, 100.0, 0.01, 1000.0, 0.001];

/// The cost of further powers of ten than the first one in a factor.
fn decades(factor: f64) -> u32 {
    let decades = factor.log10().abs().round().min(9.0) as u32;
    cost::DECADE * decades.saturating_sub(1)
}

/// The changes so far.
struct Candidates<'p, 'a> {
    panel: &'p Panel<'a>,
    found: Vec<Candidate>,
}

impl Candidates<'_, '_> {
    /// Adds a change.
    fn push(&mut self, cost: u32, change: Change) {
        self.found.push(Candidate { change, cost });
    }
}

/// All changes in the order of their cost, and of the patch for equal costs. `factors` are the factors by which terms of
/// the equations are wrong.
pub(super) fn candidates(panel: &Panel<'_>, factors: &[f64]) -> Vec<Candidate> {
    let mut candidates = Candidates { panel, found: Vec::new() };
    candidates.gains();
    candidates.cords();
    candidates.settings(factors);
    candidates.starts();
    candidates.scales(factors);
    let mut found = candidates.found;
    found.sort_by_key(|candidate| candidate.cost);
    found
}
