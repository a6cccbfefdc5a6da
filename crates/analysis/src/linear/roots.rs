//! Characteristic roots: the natural modes of small motions about an operating point.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::LinearError;
use super::eigenvalues::{blocks, eigenvalues};
use patchcord_core::ir::{StateSpace, StateTerm};

/// A real characteristic root, or a conjugate pair of roots.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::linear::{Root, Stability};
///
/// // A pair at -3 +- 4j
/// let pair = Root { real: -3.0, imaginary: 4.0, multiplicity: 1 };
/// assert_eq!((pair.natural_frequency(), pair.damping()), (5.0, Some(0.6)));
/// assert_eq!((pair.time_constant(), pair.stability()), (None, Stability::Stable));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// Real part, in 1/s: the rate of growth.
    pub real: f64,
    /// Imaginary part, in rad/s, not negative. A positive value represents a conjugate pair.
    pub imaginary: f64,
    /// Multiplicity of the root or of the pair.
    pub multiplicity: usize,
}

/// How a free motion in one mode develops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    /// The motion decays.
    Stable,
    /// The motion neither grows nor decays, up to rounding.
    Neutral,
    /// The motion grows.
    Unstable,
}

impl Root {
    /// Undamped natural frequency |root|, in rad/s; 0 for a real root at 0.
    pub fn natural_frequency(&self) -> f64 {
        self.real.hypot(self.imaginary)
    }

    /// The undamped natural frequency in Hz.
    pub fn hertz(&self) -> f64 {
        self.natural_frequency() / TAU
    }

    /// Damping ratio -real / natural frequency; negative if the motion grows. None for a real root.
    pub fn damping(&self) -> Option<f64> {
        // 0.0 - x avoids the result -0.
        (self.imaginary > 0.0).then(|| 0.0 - self.real / self.natural_frequency())
    }

    /// Time in seconds in which the motion of a real root changes by a factor of e. None for a pair and for a root at
    /// 0.
    pub fn time_constant(&self) -> Option<f64> {
        (self.imaginary == 0.0 && self.real != 0.0).then(|| 1.0 / self.real.abs())
    }

    /// Whether the motion decays. A multiple root at 0 or on the imaginary axis also counts as neutral, although its
    /// motion may grow as a power of time.
    pub fn stability(&self) -> Stability {
        match self.real {
            real if real < 0.0 => Stability::Stable,
            real if real > 0.0 => Stability::Unstable,
            _ => Stability::Neutral,
        }
    }
}

/// The characteristic roots, slowest first: the eigenvalues of the state matrix without states in hold.
/// Roots that differ only by rounding are merged into one multiple root.
///
/// # Errors
/// If a derivative is not finite or too large, the iteration does not converge, or a delay line is part of a loop.
///
/// # Examples
///
/// A mass of 1 kg on a spring of 40 N/m with a damping of 2 N s/m:
///
/// ```
/// use patchcord_analysis::linear::{Stability, roots};
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::Patch;
/// use patchcord_core::solve::Machine;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let patch = Patch::read("../../patches/lessons/driven-oscillator.json")?;
/// let program = Program::new(&Circuit::new(&patch)?)?;
/// let model = Machine::new(&program, 1e-3)?.state_space();
///
/// let roots = roots(&model)?;
/// assert_eq!(roots.len(), 1, "one conjugate pair");
/// assert!((roots[0].natural_frequency() - 40f64.sqrt()).abs() < 1e-9);
/// assert!(roots[0].damping().is_some_and(|zeta| (zeta - 1.0 / 40f64.sqrt()).abs() < 1e-9));
/// assert_eq!(roots[0].stability(), Stability::Stable);
/// # Ok(())
/// # }
/// ```
pub fn roots(model: &StateSpace) -> Result<Vec<Root>, LinearError> {
    check_derivatives(model)?;
    let delays = delays_in_loops(model);
    if !delays.is_empty() {
        return Err(LinearError::DelayInLoop(delays));
    }
    let free: Vec<usize> =
        (0..model.states.len()).filter(|state| model.states[*state].hold.is_none()).collect();
    let matrix =
        DMatrix::from_fn(free.len(), free.len(), |row, column| model.matrix[free[row]][free[column]]);
    let found = eigenvalues(&matrix).map_err(|block| {
        let states: Vec<_> = block.iter().map(|index| model.states[free[*index]].name.as_str()).collect();
        LinearError::NoEigenvalues { states: states.join(", ") }
    })?;
    let upper = found.into_iter().filter(|(root, _)| root.im >= 0.0);
    let mut roots: Vec<Root> =
        upper.map(|(root, multiplicity)| Root { real: root.re, imaginary: root.im, multiplicity }).collect();
    roots.sort_by(|one, other| order(one).partial_cmp(&order(other)).unwrap_or(std::cmp::Ordering::Equal));
    roots.dedup_by(|next, previous| {
        let is_same = (next.real, next.imaginary) == (previous.real, previous.imaginary);
        previous.multiplicity += if is_same { next.multiplicity } else { 0 };
        is_same
    });
    Ok(roots)
}

/// The state with the largest rate of change if the operating point is no equilibrium. None at an equilibrium: every
/// rate is then at most the rate that 1e-9 V in every state causes.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::linear::fastest_state;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::Machine;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // dx/dt = -x, from x = 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("Decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let program = Program::new(&Circuit::new(&patch)?)?;
///
/// let model = Machine::new(&program, 1e-3)?.state_space();
/// let state = fastest_state(&model).ok_or("50 V is no equilibrium")?;
/// assert_eq!(state.name, "A1");
/// assert!((state.rate + 50.0).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
pub fn fastest_state(model: &StateSpace) -> Option<&StateTerm> {
    let is_moving = |(row, state): &(usize, &StateTerm)| {
        let slopes = model.matrix[*row][..model.states.len()].iter().map(|slope| slope.abs()).sum::<f64>();
        state.rate.abs() > EQUILIBRIUM_TOLERANCE * slopes
    };
    let moving = model.states.iter().enumerate().filter(is_moving).map(|(_, state)| state);
    moving.max_by(|one, other| one.rate.abs().total_cmp(&other.rate.abs()))
}

/// Deviation of a state from equilibrium, in volts, that counts as rounding.
const EQUILIBRIUM_TOLERANCE: f64 = 1e-9;

/// The sort key of a root.
fn order(root: &Root) -> (f64, f64, f64) {
    (root.natural_frequency(), root.real, root.imaginary)
}

/// Largest derivative that is analysed. The square of a derivative must be finite: balancing a matrix would otherwise
/// never end.
const MAX_DERIVATIVE: f64 = 1e100;

/// An error if a derivative is not finite or too large.
pub(super) fn check_derivatives(model: &StateSpace) -> Result<(), LinearError> {
    let is_bad = |slope: &f64| !slope.is_finite() || slope.abs() > MAX_DERIVATIVE;
    let bad = model.matrix.iter().position(|row| row.iter().any(is_bad));
    let Some(row) = bad else { return Ok(()) };
    let states = model.states.iter().map(|state| &state.name);
    let delays = model.delays.iter().map(|delay| &delay.name);
    let mut names = states.chain(delays).chain(model.outputs.iter().map(|port| &port.name));
    let element = names.nth(row).cloned().unwrap_or_default();
    match model.matrix[row].iter().all(|slope| slope.is_finite()) {
        true => Err(LinearError::DerivativeTooLarge { element }),
        false => Err(LinearError::NoDerivative { element }),
    }
}

/// Names of the delay lines whose output is fed back to their input.
fn delays_in_loops(model: &StateSpace) -> Vec<String> {
    let (states, all) = (model.states.len(), model.states.len() + model.delays.len());
    let loops = DMatrix::from_fn(all, all, |row, column| model.matrix[row][column]);
    let mut found = Vec::new();
    for block in blocks(&loops) {
        let is_loop = block.len() > 1 || loops[(block[0], block[0])] != 0.0;
        found.extend(block.into_iter().filter(|index| is_loop && *index >= states));
    }
    found.sort_unstable();
    found.into_iter().map(|index| model.delays[index - states].name.clone()).collect()
}
