//! Cycles of an oscillation during a ramp: frequency and amplitude of each cycle against the commanded velocity.

use std::ops::Range;

use super::critical_velocity::Criterion;
use super::cut::{cut, mean};
use super::oscillation::extreme;
use super::steadiness::Steadiness;
use super::window::{WindowError, samples_in};
use super::{NOT_A_SIGNAL, is_signal};

/// One cycle of a velocity, between two consecutive rises through the middle between a minimum and a maximum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Start time in seconds.
    pub begin: f64,
    /// End time in seconds.
    pub end: f64,
    /// Time average of the command during the cycle, in the unit of the command.
    pub command: f64,
    /// 1 / (end - begin), in Hz.
    pub frequency: f64,
    /// Half the peak-to-peak value of velocity minus command, in the unit of the velocity.
    pub amplitude: f64,
    /// Smallest velocity during the cycle.
    pub least: f64,
    /// Largest velocity during the cycle.
    pub most: f64,
}

/// Why no cycles can be read.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CyclesError {
    /// Times and values do not form signals.
    #[error("{NOT_A_SIGNAL}")]
    NotASignal,
    /// Threshold and window are unusable with this run.
    #[error(transparent)]
    Window(#[from] WindowError),
    /// A cycle has too few samples. The field is their number in the first such cycle.
    #[error("a cycle has only {0} samples, at least {MIN_SAMPLES} are needed")]
    TooCoarse(usize),
    /// The run has no whole cycle.
    #[error("the velocity completes no whole cycle")]
    NoOscillation,
}

/// The fewest samples per cycle that locate its extremes.
const MIN_SAMPLES: usize = 8;

/// Divides a run into the cycles of its velocity, in order of time. Frequency and amplitude plotted against `command`
/// give Fig 8.26 of the thesis.
///
/// The instrument uses the deviation, velocity minus command. An extreme of the deviation counts when the deviation has
/// moved back from it by more than the criterion's threshold, so smaller ripple belongs to the surrounding cycle. A
/// cycle starts where the deviation rises through the middle between a minimum and the next maximum. If the velocity
/// follows the command for four windows within a cycle, the oscillation has stopped there, and that cycle is omitted.
/// The spring force rises by stiffness x (command - velocity), so a cycle lasts from one maximum of the spring force to
/// the next. The thesis reads frequencies off that force and gets the same values.
///
/// `time` is in seconds and evenly spaced; command and velocity have the same unit. Extremes are refined by a parabola,
/// or by straight lines at a corner.
///
/// # Errors
/// If the slices do not form signals, or the window has fewer than eight samples or is longer than the run. Also if a
/// cycle has fewer than eight samples, or the run has no whole cycle.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{Criterion, CyclesError, cycles};
///
/// // The command rises by 1 per second, and the velocity swings by 2 about it at 20 Hz.
/// let time: Vec<f64> = (0..2001).map(|index| 1e-3 * f64::from(index)).collect();
/// let velocity: Vec<f64> = time.iter().map(|t| t + (40.0 * std::f64::consts::PI * t).sin()).collect();
///
/// let found = cycles(&time, &time, &velocity, Criterion { threshold: 0.2, window: 0.04 })?;
/// assert!(found.iter().all(|cycle| (cycle.frequency - 20.0).abs() < 0.01));
/// assert!(found.iter().all(|cycle| (cycle.amplitude - 1.0).abs() < 0.01));
/// # Ok::<(), CyclesError>(())
/// ```
pub fn cycles(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: Criterion,
) -> Result<Vec<Cycle>, CyclesError> {
    if time.len() < 2 || !is_signal(time, command) || !is_signal(time, velocity) {
        return Err(CyclesError::NotASignal);
    }
    let steadiness = Steadiness::new(command, velocity, samples_in(time, criterion)?, criterion.threshold);
    let deviation: Vec<f64> = velocity.iter().zip(command).map(|(actual, wanted)| actual - wanted).collect();
    let signals = Signals { time, command, velocity, deviation: &deviation };
    let rises = rises(time, &deviation, criterion.threshold);
    let pairs = rises.windows(2).map(|pair| (signals.within(pair[0], pair[1]), [pair[0], pair[1]]));
    let oscillating = pairs.filter(|(within, _)| steadiness.first_rest(within.clone()).is_none());
    let found =
        oscillating.map(|(within, ends)| signals.cycle(within, ends)).collect::<Result<Vec<_>, _>>()?;
    if found.is_empty() { Err(CyclesError::NoOscillation) } else { Ok(found) }
}

/// The signals from which cycles are read, all of the same length.
struct Signals<'a> {
    time: &'a [f64],
    command: &'a [f64],
    velocity: &'a [f64],
    /// Velocity minus command.
    deviation: &'a [f64],
}

impl Signals<'_> {
    /// The samples from `begin` on, up to but excluding `end`.
    fn within(&self, begin: f64, end: f64) -> Range<usize> {
        let first_from = |begin: f64| self.time.partition_point(|instant| *instant < begin);
        first_from(begin)..first_from(end)
    }

    /// The cycle between two times, which contains these samples.
    fn cycle(&self, samples: Range<usize>, [begin, end]: [f64; 2]) -> Result<Cycle, CyclesError> {
        if samples.len() < MIN_SAMPLES {
            return Err(CyclesError::TooCoarse(samples.len()));
        }
        let extremes = |values: &[f64]| extremes(&self.time[samples.clone()], &values[samples.clone()]);
        let ([lowest, highest], [least, most]) = (extremes(self.deviation), extremes(self.velocity));
        Ok(Cycle {
            begin,
            end,
            command: mean(&cut(self.time, self.command, [begin, end])),
            frequency: 1.0 / (end - begin),
            amplitude: 0.5 * (highest - lowest),
            least,
            most,
        })
    }
}

/// Smallest and largest value, refined between samples.
fn extremes(time: &[f64], values: &[f64]) -> [f64; 2] {
    [(-1.0, f64::NEG_INFINITY), (1.0, f64::INFINITY)].map(|(sign, limit)| extreme(time, values, sign, limit))
}

/// The times at which a signal rises through the middle between a minimum and the next maximum. The signal moves away
/// from both extremes by more than the threshold. A signal that starts with a rise has no minimum there.
pub(super) fn rises(time: &[f64], values: &[f64], threshold: f64) -> Vec<f64> {
    let turning_points = turning_points(values, threshold);
    let swings = turning_points.windows(2).filter(|pair| pair[0] > 0 && values[pair[0]] < values[pair[1]]);
    let found = swings.filter_map(|pair| {
        let middle = 0.5 * (values[pair[0]] + values[pair[1]]);
        let after = (pair[0] + 1..=pair[1]).rev().find(|index| values[index - 1] < middle)?;
        let share = (middle - values[after - 1]) / (values[after] - values[after - 1]);
        Some(time[after - 1] + share * (time[after] - time[after - 1]))
    });
    found.collect()
}

/// Indices of the alternating minima and maxima from which the signal moves away by more than the threshold. The first
/// one is the extreme from which the signal starts.
fn turning_points(values: &[f64], threshold: f64) -> Vec<usize> {
    let (mut found, mut least, mut most) = (Vec::new(), 0, 0);
    let mut is_rising = None;
    for (index, value) in values.iter().enumerate() {
        if *value < values[least] {
            least = index;
        }
        if *value > values[most] {
            most = index;
        }
        let up = is_rising != Some(true) && value - values[least] > threshold;
        let down = is_rising != Some(false) && values[most] - value > threshold;
        if up || down {
            found.push(if up { least } else { most });
            is_rising = Some(up);
            (least, most) = (index, index);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::window::WindowError;
    use super::*;
    use crate::instruments::sampled;

    const CRITERION: Criterion = Criterion { threshold: 0.2, window: 0.04 };

    /// A command that rises by 1 per second, and a velocity that deviates from it by `off(t)`.
    fn ramp(off: impl Fn(f64) -> f64) -> [Vec<f64>; 3] {
        let (time, command) = sampled(5001, 1e-3, |t| t);
        let (_, velocity) = sampled(5001, 1e-3, |t| t + off(t));
        [time, command, velocity]
    }

    fn read([time, command, velocity]: &[Vec<f64>; 3]) -> Result<Vec<Cycle>, CyclesError> {
        cycles(time, command, velocity, CRITERION)
    }

    #[test]
    fn frequency_and_amplitude_follow_the_command() {
        // The frequency rises from 10 Hz by 4 Hz a second, the amplitude falls from 1 by 0.1 a second.
        let run = ramp(|t| (1.0 - 0.1 * t) * (TAU * (10.0 * t + 2.0 * t * t)).sin());
        let found = read(&run).unwrap();
        assert!((95..=100).contains(&found.len()), "{}", found.len());
        for cycle in &found {
            assert!((cycle.command - 0.5 * (cycle.begin + cycle.end)).abs() < 1e-12, "{cycle:?}");
            assert!((cycle.frequency / (10.0 + 4.0 * cycle.command) - 1.0).abs() < 0.01, "{cycle:?}");
            assert!((cycle.amplitude - (1.0 - 0.1 * cycle.command)).abs() < 0.005, "{cycle:?}");
            let [least, most] = [cycle.command - cycle.amplitude, cycle.command + cycle.amplitude];
            // The ramp itself contributes to the range of the velocity.
            let rise = 0.5 / cycle.frequency;
            assert!((cycle.least - least).abs() < rise && (cycle.most - most).abs() < rise, "{cycle:?}");
        }
        assert!(found.windows(2).all(|pair| pair[0].end == pair[1].begin));
    }

    #[test]
    fn sliding_between_two_oscillations_is_no_cycle() {
        let run = ramp(|t| if (2.0..3.0).contains(&t) { 0.0 } else { (TAU * 20.0 * t).sin() });
        let found = read(&run).unwrap();
        assert!(found.iter().all(|cycle| cycle.end < 2.1 || cycle.begin > 2.9), "{found:?}");
        assert!(found.iter().all(|cycle| (cycle.frequency - 20.0).abs() < 0.01), "{found:?}");
        assert_eq!(found.len(), 77);
    }

    #[test]
    fn standstill_between_two_slips_is_part_of_a_cycle() {
        // Sticks for 0.9 of every half second and slips during the rest.
        let slip = |t: f64| if (2.0 * t).fract() < 0.9 { 0.0 } else { 10.0 };
        let run = ramp(|t| slip(t) - t);
        let found = read(&run).unwrap();
        assert_eq!(found.len(), 9);
        assert!(found.iter().all(|cycle| (cycle.frequency - 2.0).abs() < 0.01), "{found:?}");
        assert!(found.iter().all(|cycle| cycle.least == 0.0 && cycle.most == 10.0), "{found:?}");
    }

    #[test]
    fn ripple_below_the_threshold_makes_no_cycles() {
        let run = ramp(|t| (TAU * 5.0 * t).sin() + 0.09 * (TAU * 60.0 * t).sin());
        assert!((23..=25).contains(&read(&run).unwrap().len()));
        assert_eq!(read(&ramp(|t| 0.09 * (TAU * 60.0 * t).sin())), Err(CyclesError::NoOscillation));
    }

    #[test]
    fn unusable_runs_return_errors() {
        assert_eq!(read(&ramp(|_| 0.0)), Err(CyclesError::NoOscillation));
        assert!(matches!(read(&ramp(|t| (TAU * 150.0 * t).sin())), Err(CyclesError::TooCoarse(6 | 7))));
        let [time, command, velocity] = ramp(|t| t.sin());
        let with = |criterion| cycles(&time, &command, &velocity, criterion);
        let short = Criterion { window: 0.005, ..CRITERION };
        assert_eq!(with(short), Err(CyclesError::Window(WindowError::TooCoarse(5))));
        assert_eq!(cycles(&time, &command[1..], &velocity, CRITERION), Err(CyclesError::NotASignal));
        assert_eq!(cycles(&[], &[], &[], CRITERION), Err(CyclesError::NotASignal));
    }
}
