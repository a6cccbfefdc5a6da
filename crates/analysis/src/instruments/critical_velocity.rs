//! Critical velocities: the command at which oscillation ends while the command rises, and begins while it falls.
//!
//! Every window of the run is classified as oscillating or not by the peak-to-peak value of the velocity in it. The
//! last oscillating window of the rising ramp and the first one of the falling ramp give the two critical velocities.

use std::collections::VecDeque;

use super::window::{WindowError, samples_in};
use super::{NOT_A_SIGNAL, is_signal};
use crate::format::format_quantity;
use patchcord_core::document::format_number;
use patchcord_expr::{Dimension, Unit};

/// Defines when a velocity counts as oscillating. A critical velocity depends on it, so report both together.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::Criterion;
///
/// let usual = Criterion::usual("mm/s").ok_or("mm/s is a unit of velocity")?;
/// assert!((usual.threshold - 0.25).abs() < 1e-12);
/// assert_eq!(usual.window, Criterion::USUAL.window);
/// assert_eq!(Criterion::usual("kg"), None);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// The velocity oscillates in a window if its peak-to-peak value there exceeds this; positive, in the unit of the
    /// velocity. A lower threshold gives higher rising and higher falling critical velocities.
    pub threshold: f64,
    /// Length of a window in seconds. It must contain at least half a period of the slowest oscillation. The command
    /// must change by less than the threshold in it.
    pub window: f64,
}

impl Criterion {
    /// The default threshold of 0.25 mm/s and window of 0.04 s, which `docs/compromise.md` derives.
    pub const USUAL: Criterion = Criterion { threshold: 0.25e-3, window: 0.04 };

    /// The default criterion with its threshold in `unit`; None if `unit` is no unit of velocity.
    pub fn usual(unit: &str) -> Option<Criterion> {
        let velocity = Dimension::LENGTH.over(Dimension::TIME);
        let unit = Unit::parse(unit).ok().filter(|unit| unit.dimension() == velocity)?;
        Some(Criterion { threshold: unit.out_of_si(Self::USUAL.threshold), ..Self::USUAL })
    }
}

/// The critical velocities of a run, in the unit of the command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalVelocity {
    /// The command at the start of the last oscillating window of the rising ramp.
    pub rising: Result<f64, CriticalVelocityError>,
    /// The command at the start of the first oscillating window of the falling ramp. It depends on the disturbance from
    /// which the oscillation grows.
    pub falling: Result<f64, CriticalVelocityError>,
}

/// Why there is no critical velocity.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CriticalVelocityError {
    /// Times and values do not form signals.
    #[error("{NOT_A_SIGNAL}")]
    NotASignal,
    /// Threshold and window are unusable with this run.
    #[error(transparent)]
    Window(#[from] WindowError),
    /// The command alone changes by more than the threshold within a window. The field is this change.
    #[error("{}", too_fast(&format_number(*.0)))]
    CommandTooFast(f64),
    /// The command is constant.
    #[error("the command does not change")]
    Constant,
    /// The command is largest at the end of the run.
    #[error("the command never falls in this run")]
    NeverBack,
    /// The command does not rise monotonically to its largest value.
    #[error("the command does not rise steadily")]
    NoRise,
    /// The command does not fall monotonically from its largest value.
    #[error("the command does not fall steadily")]
    NoFall,
    /// No window oscillates, or only those within four windows after breaking away.
    #[error("no oscillation")]
    NoOscillation,
    /// The oscillation lasts to within four windows of the end of the rising ramp. The field is the command there.
    #[error("{}", not_ended(&format_number(*.0)))]
    NotEnded(f64),
    /// A window oscillates during the last four windows before the command falls.
    #[error("the velocity oscillates before the command falls")]
    NotBegun,
}

impl CriticalVelocityError {
    /// The message with velocities in `unit`, formatted for people.
    pub fn message_in(self, unit: &str) -> String {
        match self {
            CriticalVelocityError::CommandTooFast(change) => too_fast(&format_quantity(change, unit)),
            CriticalVelocityError::NotEnded(top) => not_ended(&format_quantity(top, unit)),
            error => error.to_string(),
        }
    }
}

/// The message of [`CriticalVelocityError::CommandTooFast`]; `change` is the formatted change of the command.
fn too_fast(change: &str) -> String {
    format!("the command alone changes by {change} within a window: it must stay below the threshold")
}

/// The message of [`CriticalVelocityError::NotEnded`]; `top` is the formatted largest command.
fn not_ended(top: &str) -> String {
    format!("oscillation has not ended at a command of {top}")
}

/// The number of calm windows that end an oscillation, and the fewest windows that an oscillation lasts. At a low
/// command the slips of one oscillation are up to this far apart.
pub const REST_WINDOWS: usize = 4;
/// Differences of the command below this fraction of its largest value are rounding errors.
const COMMAND_TOLERANCE: f64 = 1e-9;

/// Reads the critical velocities off a run with one rising and possibly one falling ramp.
///
/// The command rises from rest or from a constant value to its largest value, in either direction. It may then fall
/// back. Samples are evenly spaced; `time` is in seconds. Samples after a change of sign of the command are ignored.
///
/// # Examples
///
/// The velocity oscillates at 50 Hz until the command reaches 3:
///
/// ```
/// use patchcord_analysis::instruments::{Criterion, CriticalVelocityError, critical_velocity};
///
/// let time: Vec<f64> = (0..4001).map(|index| 1e-3 * f64::from(index)).collect();
/// let swing = |t: f64| if t < 3.0 { 0.5 * (100.0 * std::f64::consts::PI * t).sin() } else { 0.0 };
/// let velocity: Vec<f64> = time.iter().map(|t| t + swing(*t)).collect();
///
/// // The command rises by 1 per second, so it equals the time.
/// let criterion = Criterion { threshold: 0.2, window: 0.04 };
/// let found = critical_velocity(&time, &time, &velocity, criterion);
/// assert!((found.rising? - 3.0).abs() < 0.02);
/// assert_eq!(found.falling, Err(CriticalVelocityError::NeverBack));
/// # Ok::<(), CriticalVelocityError>(())
/// ```
pub fn critical_velocity(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: Criterion,
) -> CriticalVelocity {
    let found = critical_samples(time, command, velocity, criterion);
    let [rising, falling] = found.unwrap_or_else(|error| [Err(error); 2]);
    let at = |sample: Result<usize, _>| sample.map(|sample| command[sample]);
    CriticalVelocity { rising: at(rising), falling: at(falling) }
}

/// The samples at which the command equals a critical velocity, rising and falling.
pub(super) fn critical_samples(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: Criterion,
) -> Result<[Result<usize, CriticalVelocityError>; 2], CriticalVelocityError> {
    let profile = Profile::new(time, command, velocity, criterion)?;
    Ok([profile.rising(), profile.falling()])
}

/// A run with its windows classified.
struct Profile<'a> {
    /// The command as given, from which the results are taken.
    command: &'a [f64],
    /// The command, mirrored if its largest value is negative.
    speed: Vec<f64>,
    /// Index of the largest speed.
    turn: usize,
    /// For each sample: whether the window that starts there oscillates.
    oscillates: Vec<bool>,
    /// Samples per window.
    span: usize,
}

impl<'a> Profile<'a> {
    /// Checks the run and classifies its windows. Window n starts at sample n, so the last span - 1 samples start no
    /// window.
    fn new(
        time: &[f64],
        command: &'a [f64],
        velocity: &[f64],
        criterion: Criterion,
    ) -> Result<Self, CriticalVelocityError> {
        if time.len() < 2 || !is_signal(time, command) || !is_signal(time, velocity) {
            return Err(CriticalVelocityError::NotASignal);
        }
        let (span, threshold) = (samples_in(time, criterion)?, criterion.threshold);
        let fastest = swings(command, span).fold(0.0, f64::max);
        if fastest >= threshold {
            return Err(CriticalVelocityError::CommandTooFast(fastest));
        }
        let turn = first_largest(command);
        let speed = command.iter().map(|value| value * command[turn].signum()).collect();
        let oscillates = swings(velocity, span).map(|swing| swing > threshold).collect();
        Ok(Profile { command, speed, turn, oscillates, span })
    }

    /// Whether the command is constant up to rounding.
    fn is_constant(&self) -> bool {
        let least = self.speed.iter().copied().fold(f64::INFINITY, f64::min);
        self.speed[self.turn] - least <= COMMAND_TOLERANCE * self.speed[self.turn]
    }

    /// The sample that gives the rising critical velocity.
    fn rising(&self) -> Result<usize, CriticalVelocityError> {
        if self.is_constant() {
            return Err(CriticalVelocityError::Constant);
        }
        if self.turn == 0 || !is_rising(self.speed[..=self.turn].iter()) {
            return Err(CriticalVelocityError::NoRise);
        }
        let windows = &self.oscillates[..self.turn.min(self.oscillates.len())];
        let first =
            windows.iter().position(|oscillates| *oscillates).ok_or(CriticalVelocityError::NoOscillation)?;
        let last = windows.iter().rposition(|oscillates| *oscillates).unwrap_or(first);
        if windows.len() - 1 - last < REST_WINDOWS * self.span {
            return Err(CriticalVelocityError::NotEnded(self.command[self.turn]));
        }
        // A single slip and its ringing are no oscillation.
        if last - first < REST_WINDOWS * self.span {
            Err(CriticalVelocityError::NoOscillation)
        } else {
            Ok(last)
        }
    }

    /// The sample that gives the falling critical velocity.
    fn falling(&self) -> Result<usize, CriticalVelocityError> {
        if self.is_constant() {
            return Err(CriticalVelocityError::Constant);
        }
        if self.turn + 1 == self.speed.len() {
            return Err(CriticalVelocityError::NeverBack);
        }
        let forward = self.speed[self.turn..].iter().take_while(|speed| **speed >= 0.0).count();
        let end = (self.turn + forward).min(self.oscillates.len());
        let is_falling = is_rising(self.speed[self.turn..self.turn + forward].iter().rev());
        if end <= self.turn || forward < 2 || !is_falling {
            return Err(CriticalVelocityError::NoFall);
        }
        let rest = self.turn.saturating_sub(REST_WINDOWS * self.span)..=self.turn;
        if self.oscillates[rest].contains(&true) {
            return Err(CriticalVelocityError::NotBegun);
        }
        let first = self.oscillates[self.turn..end].iter().position(|oscillates| *oscillates);
        first.map(|after| self.turn + after).ok_or(CriticalVelocityError::NoOscillation)
    }
}

/// The largest absolute value.
pub(super) fn largest_of(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// The index of the first value with the largest absolute value; 0 for an empty slice.
pub(super) fn first_largest(values: &[f64]) -> usize {
    let largest = largest_of(values);
    values.iter().position(|value| value.abs() == largest).unwrap_or(0)
}

/// Whether values never fall, up to rounding, and the last one is larger than the first.
fn is_rising<'a>(values: impl DoubleEndedIterator<Item = &'a f64> + Clone) -> bool {
    let (Some(first), Some(last)) = (values.clone().next(), values.clone().next_back()) else { return false };
    let rounding = COMMAND_TOLERANCE * last.abs();
    let is_monotonic = values.clone().zip(values.skip(1)).all(|(before, after)| *after >= before - rounding);
    is_monotonic && last - first > rounding
}

/// The peak-to-peak value of every window of `span` consecutive values, in linear time.
pub(super) fn swings(values: &[f64], span: usize) -> impl Iterator<Item = f64> + '_ {
    let (mut largest, mut least) = (VecDeque::new(), VecDeque::new());
    (0..values.len()).filter_map(move |index| {
        push_candidate(&mut largest, index, span, |earlier| values[earlier] <= values[index]);
        push_candidate(&mut least, index, span, |earlier| values[earlier] >= values[index]);
        (index + 1 >= span).then(|| values[largest[0]] - values[least[0]])
    })
}

/// Appends an index to the candidates for the extreme of a window. Removes those outside the window and those that
/// `is_worse` than the new value.
fn push_candidate(
    candidates: &mut VecDeque<usize>,
    index: usize,
    span: usize,
    is_worse: impl Fn(usize) -> bool,
) {
    while candidates.back().is_some_and(|earlier| is_worse(*earlier)) {
        candidates.pop_back();
    }
    candidates.push_back(index);
    if candidates[0] + span <= index {
        candidates.pop_front();
    }
}

#[cfg(test)]
mod tests;
