//! The velocity profile of a slideway: at which command oscillation ends while it rises, and begins while it falls.

use std::collections::VecDeque;

use super::is_signal;
use super::quantity::with_unit;
use super::window::{WindowError, samples_in};
use patchcord_core::document::told;
use patchcord_expr::{Dimension, Unit};

/// When a velocity counts as oscillating: a critical velocity means nothing without it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// It oscillates while it swings by more than this, peak to peak, within a window; in its unit, above 0. A lower
    /// one finds higher rising and higher falling critical velocities.
    pub threshold: f64,
    /// Length of a window in seconds. Half a period and more of the slowest oscillation belongs into it, and the
    /// command must change by less than the threshold in it.
    pub window: f64,
}

impl Criterion {
    /// The threshold in m/s, and the window in s, that `docs/compromise.md` measures with.
    pub const USUAL: Criterion = Criterion { threshold: 0.25e-3, window: 0.04 };

    /// The usual criterion with its threshold in another unit; nothing where that is no velocity.
    pub fn usual(unit: &str) -> Option<Criterion> {
        let velocity = Dimension::LENGTH.over(Dimension::TIME);
        let unit = Unit::parse(unit).ok().filter(|unit| unit.dimension() == velocity)?;
        Some(Criterion { threshold: unit.out_of_si(Self::USUAL.threshold), ..Self::USUAL })
    }
}

/// The critical velocities of a profile, in the unit of the command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalVelocity {
    /// The command at which the last window that oscillates begins, while the command rises.
    pub rising: Result<f64, NoCriticalVelocity>,
    /// The command at which the first window that oscillates begins, while the command falls. It depends on the
    /// disturbance that there is to grow from.
    pub falling: Result<f64, NoCriticalVelocity>,
}

/// Why there is no critical velocity.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoCriticalVelocity {
    /// Times and values do not make signals.
    #[error("signals have one finite value for each of their times, which rise")]
    NotASignal,
    /// Threshold and window do not go with the run.
    #[error(transparent)]
    Window(#[from] WindowError),
    /// The command alone passes the threshold.
    #[error("{}", too_fast(&told(*.0)))]
    CommandTooFast(f64),
    /// The command stays as it is.
    #[error("the command does not change")]
    Constant,
    /// The command is largest at the end.
    #[error("the command never comes back in this run")]
    NeverBack,
    /// The command does not rise all the way to its largest value.
    #[error("the command does not rise steadily")]
    NoRise,
    /// The command does not fall all the way from its largest value.
    #[error("the command does not fall steadily")]
    NoFall,
    /// It does not oscillate where it might, or for less than four windows in all as it breaks away.
    #[error("no oscillation")]
    Quiet,
    /// Oscillation goes on up to the end of the rise, or rested there for less than four windows.
    #[error("{}", not_ended(&told(*.0)))]
    NotEnded(f64),
    /// It oscillates before the command falls.
    #[error("it oscillates before the command falls")]
    NotBegun,
}

impl NoCriticalVelocity {
    /// Its text with velocities in this unit, as a person reads them.
    pub fn told_in(self, unit: &str) -> String {
        match self {
            NoCriticalVelocity::CommandTooFast(change) => too_fast(&with_unit(change, unit)),
            NoCriticalVelocity::NotEnded(top) => not_ended(&with_unit(top, unit)),
            error => error.to_string(),
        }
    }
}

fn too_fast(change: &str) -> String {
    format!("the command alone changes by {change} within a window, which is not below the threshold")
}

fn not_ended(top: &str) -> String {
    format!("oscillation has not ended at a command of {top}")
}

/// Oscillation that rests for so many windows has ended, and lasts for as many: slips at a low command lie so far apart.
pub const REST: usize = 4;
/// This share of the largest command is rounding.
const ROUNDING: f64 = 1e-9;

/// Reads the critical velocities off a velocity profile: the command goes from rest or a run up to its largest value
/// and may come back, in either direction; the velocity follows it. Samples are evenly spaced, `time` is in seconds.
/// What the velocity does once the command has changed its sign does not count.
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

/// The samples at which the command is a critical velocity, rising and falling.
pub(super) fn critical_samples(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: Criterion,
) -> Result<[Result<usize, NoCriticalVelocity>; 2], NoCriticalVelocity> {
    let profile = Profile::new(time, command, velocity, criterion)?;
    Ok([profile.rising(), profile.falling()])
}

struct Profile<'a> {
    command: &'a [f64],
    /// The command without its direction.
    speed: Vec<f64>,
    /// Index of the largest speed.
    turn: usize,
    /// Whether the window that begins at each sample oscillates.
    oscillates: Vec<bool>,
    /// Samples in a window.
    span: usize,
}

impl<'a> Profile<'a> {
    fn new(
        time: &[f64],
        command: &'a [f64],
        velocity: &[f64],
        criterion: Criterion,
    ) -> Result<Self, NoCriticalVelocity> {
        if time.len() < 2 || !is_signal(time, command) || !is_signal(time, velocity) {
            return Err(NoCriticalVelocity::NotASignal);
        }
        let (span, threshold) = (samples_in(time, criterion)?, criterion.threshold);
        let fastest = swings(command, span).fold(0.0, f64::max);
        if fastest >= threshold {
            return Err(NoCriticalVelocity::CommandTooFast(fastest));
        }
        let turn = first_largest(command);
        let speed = command.iter().map(|value| value * command[turn].signum()).collect();
        let oscillates = swings(velocity, span).map(|swing| swing > threshold).collect();
        Ok(Profile { command, speed, turn, oscillates, span })
    }

    /// Whether the command stays as it is, but for rounding.
    fn is_constant(&self) -> bool {
        let least = self.speed.iter().copied().fold(f64::INFINITY, f64::min);
        self.speed[self.turn] - least <= ROUNDING * self.speed[self.turn]
    }

    fn rising(&self) -> Result<usize, NoCriticalVelocity> {
        if self.is_constant() {
            return Err(NoCriticalVelocity::Constant);
        }
        if self.turn == 0 || !rises(self.speed[..=self.turn].iter()) {
            return Err(NoCriticalVelocity::NoRise);
        }
        let windows = &self.oscillates[..self.turn.min(self.oscillates.len())];
        let first = windows.iter().position(|oscillates| *oscillates).ok_or(NoCriticalVelocity::Quiet)?;
        let last = windows.iter().rposition(|oscillates| *oscillates).unwrap_or(first);
        if windows.len() - 1 - last < REST * self.span {
            return Err(NoCriticalVelocity::NotEnded(self.command[self.turn]));
        }
        // Breaking away once, and what rings behind it, is no oscillation.
        if last - first < REST * self.span { Err(NoCriticalVelocity::Quiet) } else { Ok(last) }
    }

    fn falling(&self) -> Result<usize, NoCriticalVelocity> {
        if self.is_constant() {
            return Err(NoCriticalVelocity::Constant);
        }
        if self.turn + 1 == self.speed.len() {
            return Err(NoCriticalVelocity::NeverBack);
        }
        let forward = self.speed[self.turn..].iter().take_while(|speed| **speed >= 0.0).count();
        let end = (self.turn + forward).min(self.oscillates.len());
        let falls = rises(self.speed[self.turn..self.turn + forward].iter().rev());
        if end <= self.turn || forward < 2 || !falls {
            return Err(NoCriticalVelocity::NoFall);
        }
        let rest = self.turn.saturating_sub(REST * self.span)..=self.turn;
        if self.oscillates[rest].contains(&true) {
            return Err(NoCriticalVelocity::NotBegun);
        }
        let first = self.oscillates[self.turn..end].iter().position(|oscillates| *oscillates);
        first.map(|after| self.turn + after).ok_or(NoCriticalVelocity::Quiet)
    }
}

/// The largest of values, without sign.
pub(super) fn largest_of(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// Where the largest value without sign stands first.
pub(super) fn first_largest(values: &[f64]) -> usize {
    let largest = largest_of(values);
    values.iter().position(|value| value.abs() == largest).unwrap_or(0)
}

/// Whether values rise, or stay, but for rounding, and do not stay all the way.
fn rises<'a>(values: impl DoubleEndedIterator<Item = &'a f64> + Clone) -> bool {
    let (Some(first), Some(last)) = (values.clone().next(), values.clone().next_back()) else { return false };
    let rounding = ROUNDING * last.abs();
    let steady = values.clone().zip(values.skip(1)).all(|(before, after)| *after >= before - rounding);
    steady && last - first > rounding
}

/// Largest less least value of every so many values in a row.
pub(super) fn swings(values: &[f64], span: usize) -> impl Iterator<Item = f64> + '_ {
    let (mut largest, mut least) = (VecDeque::new(), VecDeque::new());
    (0..values.len()).filter_map(move |index| {
        keep(&mut largest, index, span, |kept| values[kept] <= values[index]);
        keep(&mut least, index, span, |kept| values[kept] >= values[index]);
        (index + 1 >= span).then(|| values[largest[0]] - values[least[0]])
    })
}

/// Keeps the indices that may still be the extreme of a window: those within it that no later value outdoes.
fn keep(candidates: &mut VecDeque<usize>, index: usize, span: usize, outdone: impl Fn(usize) -> bool) {
    while candidates.back().is_some_and(|kept| outdone(*kept)) {
        candidates.pop_back();
    }
    candidates.push_back(index);
    if candidates[0] + span <= index {
        candidates.pop_front();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::sampled;

    const CRITERION: Criterion = Criterion { threshold: 0.2, window: 0.04 };

    /// Rises by 1 a second up to a turn and falls from there; swings by 1 at 50 Hz up to one command while it rises,
    /// and from another on while it falls.
    fn profile(turn: f64, until: f64, from: f64) -> [Vec<f64>; 3] {
        let ramp = move |t: f64| t.min(2.0 * turn - t);
        let (time, command) = sampled(8001, 1e-3, ramp);
        let swinging = |t: f64| if t < turn { ramp(t) < until } else { ramp(t) < from };
        let (_, velocity) = sampled(8001, 1e-3, |t| {
            ramp(t) + if swinging(t) { 0.5 * (100.0 * std::f64::consts::PI * t).sin() } else { 0.0 }
        });
        [time, command, velocity]
    }

    fn read([time, command, velocity]: &[Vec<f64>; 3]) -> CriticalVelocity {
        critical_velocity(time, command, velocity, CRITERION)
    }

    #[test]
    fn oscillation_ends_rising_and_begins_falling() {
        let found = read(&profile(4.0, 3.0, 1.0));
        assert!((found.rising.unwrap() - 3.0).abs() < 0.011, "{found:?}");
        // The window that shows it first begins up to its own length before it.
        assert!((0.99..1.041).contains(&found.falling.unwrap()), "{found:?}");
    }

    #[test]
    fn a_profile_backward_gives_the_same_with_its_sign() {
        let [time, command, velocity] = profile(4.0, 3.0, 1.0);
        let negative = |values: &[f64]| values.iter().map(|value| -value).collect::<Vec<_>>();
        let forward = critical_velocity(&time, &command, &velocity, CRITERION);
        let backward = critical_velocity(&time, &negative(&command), &negative(&velocity), CRITERION);
        assert_eq!(backward.rising.unwrap(), -forward.rising.unwrap());
        assert_eq!(backward.falling.unwrap(), -forward.falling.unwrap());
    }

    #[test]
    fn swings_of_windows_are_those_of_their_samples() {
        let (_, values) = sampled(300, 1.0, |t| (t * t).sin() * t);
        for span in [1, 2, 7, 300] {
            let plain = values.windows(span).map(|window| {
                let most = window.iter().copied().fold(f64::MIN, f64::max);
                most - window.iter().copied().fold(f64::MAX, f64::min)
            });
            assert!(swings(&values, span).eq(plain), "{span}");
        }
    }

    #[test]
    fn what_has_no_critical_velocity_is_told() {
        use NoCriticalVelocity::*;
        let both = |found: CriticalVelocity| (found.rising.unwrap_err(), found.falling.unwrap_err());
        assert_eq!(both(read(&profile(4.0, 0.0, 0.0))), (Quiet, Quiet));
        assert_eq!(read(&profile(4.0, 0.15, 0.0)).rising, Err(Quiet), "it breaks away");
        let still_on = read(&profile(4.0, 3.9, 1.0));
        assert_eq!(both(still_on), (NotEnded(4.0), NotBegun));
        assert_eq!(read(&profile(9.0, 3.0, 1.0)).falling, Err(NeverBack));
        let [time, command, velocity] = profile(4.0, 3.0, 1.0);
        let with = |criterion| both(critical_velocity(&time, &command, &velocity, criterion)).0;
        let window = |window| Criterion { window, ..CRITERION };
        assert_eq!(with(window(0.005)), Window(WindowError::TooCoarse(5)));
        assert_eq!(with(window(9.0)), Window(WindowError::TooLong { window: 9.0, run: 8.0 }));
        assert_eq!(with(Criterion { threshold: 0.0, ..CRITERION }), Window(WindowError::BadCriterion));
        assert!(matches!(with(Criterion { threshold: 0.03, ..CRITERION }), CommandTooFast(_)));
        let told = "the command alone changes by 1.95 mm/s within a window, which is not below the threshold";
        assert_eq!(CommandTooFast(1.95e-3).told_in("m/s"), told);
        assert_eq!(NotEnded(0.02).told_in("m/s"), "oscillation has not ended at a command of 20 mm/s");
        assert_eq!(NoRise.told_in("m/s"), NoRise.to_string());
        let (time, wave) = sampled(8001, 1e-3, |t| (t.sin() + 0.3 * (9.0 * t).sin()) * (1.0 - t / 8.0));
        assert_eq!(both(critical_velocity(&time, &wave, &velocity, CRITERION)), (NoRise, NoFall));
        let even = vec![1.0; 8001];
        assert_eq!(both(critical_velocity(&time, &even, &velocity, CRITERION)), (Constant, Constant));
        assert_eq!(both(critical_velocity(&time, &even[1..], &velocity, CRITERION)).0, NotASignal);
        assert_eq!(both(critical_velocity(&[], &[], &[], CRITERION)).0, NotASignal);
    }
}
