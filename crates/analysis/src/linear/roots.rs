//! Characteristic roots: the natural modes of small motions.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::LinearError;
use super::eigenvalues::{blocks, eigenvalues};
use patchcord_core::ir::{StateSpace, StateTerm};

/// A characteristic root, or a conjugate pair of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// Real part, in 1 per second: growth.
    pub real: f64,
    /// Imaginary part, in rad/s, 0 or above: above 0 it stands for a pair.
    pub imaginary: f64,
    /// How often the root, or the pair, is there.
    pub times: usize,
}

/// What becomes of a motion that is left to itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    /// It dies away.
    Stable,
    /// It stays: neither grows nor dies away, as far as rounding can tell.
    Neutral,
    /// It grows.
    Unstable,
}

impl Root {
    /// Undamped natural frequency |root|, in rad/s; 0 for a real root at 0.
    pub fn natural_frequency(&self) -> f64 {
        self.real.hypot(self.imaginary)
    }

    /// The same in Hz.
    pub fn hertz(&self) -> f64 {
        self.natural_frequency() / TAU
    }

    /// -real / natural frequency of a pair; below 0 where it grows. A real root has none.
    pub fn damping(&self) -> Option<f64> {
        // Rounding must not leave a minus before 0.
        (self.imaginary > 0.0).then(|| 0.0 - self.real / self.natural_frequency())
    }

    /// The time, in seconds, within which a real root shrinks (or grows) a motion to (from) its e-th part; a pair
    /// and a root at 0 have none.
    pub fn time_constant(&self) -> Option<f64> {
        (self.imaginary == 0.0 && self.real != 0.0).then(|| 1.0 / self.real.abs())
    }

    /// Whether it dies away. A root at 0 or on the imaginary axis that is there several times may grow all the
    /// same, as time and not as an exponential: that is neutral too.
    pub fn stability(&self) -> Stability {
        match self.real {
            real if real < 0.0 => Stability::Stable,
            real if real > 0.0 => Stability::Unstable,
            _ => Stability::Neutral,
        }
    }
}

/// The characteristic roots, slowest first: eigenvalues of the state matrix, without the states that a mode holds.
/// Those that rounding alone tells apart are one root, there several times.
///
/// # Errors
/// When a derivative is not a number, the iteration does not end, or a delay line stands in a loop.
pub fn roots(model: &StateSpace) -> Result<Vec<Root>, LinearError> {
    check(model)?;
    let delays = delays_in_loops(model);
    if !delays.is_empty() {
        return Err(LinearError::DelayInLoop(delays));
    }
    let free: Vec<usize> =
        (0..model.states.len()).filter(|state| model.states[*state].hold.is_none()).collect();
    let matrix =
        DMatrix::from_fn(free.len(), free.len(), |row, column| model.matrix[(free[row], free[column])]);
    let found = eigenvalues(&matrix).map_err(|block| {
        let states: Vec<_> = block.iter().map(|index| model.states[free[*index]].name.as_str()).collect();
        LinearError::NoEigenvalues { states: states.join(", ") }
    })?;
    let upper = found.into_iter().filter(|(root, _)| root.im >= 0.0);
    let mut roots: Vec<Root> =
        upper.map(|(root, times)| Root { real: root.re, imaginary: root.im, times }).collect();
    roots.sort_by(|one, other| order(one).partial_cmp(&order(other)).unwrap_or(std::cmp::Ordering::Equal));
    roots.dedup_by(|next, kept| {
        let is_same = (next.real, next.imaginary) == (kept.real, kept.imaginary);
        kept.times += if is_same { next.times } else { 0 };
        is_same
    });
    Ok(roots)
}

/// The free state that moves fastest, where the point is no equilibrium: where a rate is above what 1e-9 V in every
/// state make of it.
pub fn fastest(model: &StateSpace) -> Option<&StateTerm> {
    let is_moving = |(row, state): &(usize, &StateTerm)| {
        let slopes = model
            .matrix
            .row(*row)
            .columns(0, model.states.len())
            .iter()
            .map(|slope| slope.abs())
            .sum::<f64>();
        state.rate.abs() > EQUILIBRIUM * slopes
    };
    let moving = model.states.iter().enumerate().filter(is_moving).map(|(_, state)| state);
    moving.max_by(|one, other| one.rate.abs().total_cmp(&other.rate.abs()))
}

/// Volts by which rounding may miss an equilibrium.
const EQUILIBRIUM: f64 = 1e-9;

fn order(root: &Root) -> (f64, f64, f64) {
    (root.natural_frequency(), root.real, root.imaginary)
}

/// That every derivative is a number.
pub(super) fn check(model: &StateSpace) -> Result<(), LinearError> {
    let bad = model.matrix.row_iter().position(|row| row.iter().any(|slope| !slope.is_finite()));
    let Some(row) = bad else { return Ok(()) };
    let states = model.states.iter().map(|state| &state.name);
    let delays = model.delays.iter().map(|delay| &delay.name);
    let mut names = states.chain(delays).chain(model.outputs.iter().map(|port| &port.name));
    Err(LinearError::NoDerivative { element: names.nth(row).cloned().unwrap_or_default() })
}

/// Names of the delay lines whose output comes back to their input.
fn delays_in_loops(model: &StateSpace) -> Vec<String> {
    let (states, all) = (model.states.len(), model.states.len() + model.delays.len());
    let loops = model.matrix.view((0, 0), (all, all)).into_owned();
    let mut found = Vec::new();
    for block in blocks(&loops) {
        let is_loop = block.len() > 1 || loops[(block[0], block[0])] != 0.0;
        found.extend(block.into_iter().filter(|index| is_loop && *index >= states));
    }
    found.sort_unstable();
    found.into_iter().map(|index| model.delays[index - states].name.clone()).collect()
}
