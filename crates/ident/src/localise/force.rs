//! The force that would close the gap at a junction.

use crate::localise::evidence::Likeness;
use patchcord_core::patch::Patch;

/// The force that would close the gap at a junction.
#[derive(Debug, Clone)]
pub struct Whereabouts {
    /// The integrator.
    pub junction: String,
    /// The unit of the force.
    pub unit: String,
    /// The share of the gap that it closes, in squares.
    pub explains: f64,
    /// Logarithm of its marginal likelihood, above that of no force: what junctions are compared by.
    pub evidence: f64,
    /// To how many free numbers it comes.
    pub effective: f64,
    /// Whether it is smooth or may jump.
    pub likeness: Likeness,
    /// The force, by record.
    pub forces: Vec<Force>,
    /// The same as a curve over what it may go with, in the order in which that was asked.
    pub curves: Vec<Curve>,
    /// Which of the curves it goes with best; with time alone where there is none.
    pub best: Option<usize>,
    /// The patch with the force, as a function generator or a table, and all parameters as fitted.
    pub recovered: Patch,
}

/// A force in a record.
#[derive(Debug, Clone)]
pub struct Force {
    /// The file of the record.
    pub data: String,
    /// Time in seconds by the clock of the record, force, its standard error, and that if all else were known.
    pub points: Vec<[f64; 4]>,
    /// From when to when it stands out of the latter.
    pub windows: Vec<[f64; 2]>,
}

/// A force over a quantity.
#[derive(Debug, Clone)]
pub struct Curve {
    /// The quantity.
    pub against: String,
    /// Its unit.
    pub unit: String,
    /// Value, force, standard error.
    pub points: Vec<[f64; 3]>,
    /// The same where the quantity rises and where it falls, if the data bear out that these differ.
    pub by_direction: Option<[Vec<[f64; 3]>; 2]>,
    /// The share of the gap that the curve closes, in squares, on the data that it is fitted to,
    pub explains: f64,
    /// and, wired in, on those that were held back.
    pub held_out: Option<f64>,
    /// Logarithm of its marginal likelihood, above that of no force.
    pub evidence: f64,
    /// Value and force at the knots of the force over time.
    pub scatter: Vec<[f64; 2]>,
}

/// Junctions whose evidence differs by less cannot be told apart.
const TOLD_APART: f64 = 10.0;

/// The evidence of the likeliest force; 0 where none is likelier than none.
pub(crate) fn likeliest(found: &[Whereabouts]) -> f64 {
    found.first().map_or(0.0, |best| best.evidence.max(0.0))
}

/// The junctions that explain the gap best and cannot be told apart, none where no force is likelier than none; `found` has the most
/// likely one first.
pub fn nearest(found: &[Whereabouts]) -> Vec<&str> {
    let Some(best) = found.first().filter(|best| best.evidence > TOLD_APART) else { return Vec::new() };
    let is_near = |own: &&Whereabouts| best.evidence - own.evidence < TOLD_APART;
    found.iter().filter(is_near).map(|own| own.junction.as_str()).collect()
}

impl Whereabouts {
    /// What the force goes with best: a signal or drive, or "time".
    pub fn best_against(&self) -> &str {
        self.best.map_or("time", |best| &self.curves[best].against)
    }

    /// The curve that the function generator of `recovered` has; nothing where that has a table over time, as what the force
    /// goes with is no voltage of the patch or needs more than 100 V.
    pub fn wired(&self) -> Option<&Curve> {
        self.best.map(|best| &self.curves[best]).filter(|curve| curve.held_out.is_some())
    }

    /// From when to when it acts, in all records.
    pub fn windows(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.forces.iter().flat_map(|force| force.windows.iter().copied())
    }
}
