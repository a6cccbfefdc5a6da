//! Cycles of an oscillation along a ramp: frequency and amplitude of each against the commanded velocity.

use std::ops::Range;

use super::critical_velocity::Criterion;
use super::cut::{cut, mean};
use super::is_signal;
use super::oscillation::extreme;
use super::steadiness::Steadiness;
use super::window::{WindowError, samples_in};

/// One cycle of a velocity: from one rise through the middle between dip and peak to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// When it begins, in seconds.
    pub begin: f64,
    /// When it ends, in seconds.
    pub end: f64,
    /// Mean of the command in it, in the unit of the command.
    pub command: f64,
    /// 1 / (end - begin), in Hz.
    pub frequency: f64,
    /// Half of the swing of the velocity less the command, peak to peak, in the unit of the velocity.
    pub amplitude: f64,
    /// The least velocity in it.
    pub least: f64,
    /// The largest velocity in it.
    pub most: f64,
}

/// Why there are no cycles to read.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CyclesError {
    /// Times and values do not make signals.
    #[error("signals have one finite value for each of their times, which rise")]
    NotASignal,
    /// Threshold and window do not go with the run.
    #[error(transparent)]
    Window(#[from] WindowError),
    /// There are too few samples in a cycle.
    #[error("{0} samples in the shortest cycle: at least {FEWEST_SAMPLES} are needed")]
    TooCoarse(usize),
    /// There is not one whole cycle.
    #[error("no whole cycle")]
    Quiet,
}

const FEWEST_SAMPLES: usize = 8;

/// Cuts a run into the cycles of its velocity, one after the other: frequency and amplitude against `command` are the
/// points of Fig 8.26 of the thesis.
///
/// What counts is the velocity less the command: it turns where it comes back from a dip or a peak by more than the
/// criterion's threshold, so that smaller ripple belongs to the cycle that it rides on. A cycle begins where it rises
/// through the middle between a dip and the peak behind it. Where the velocity rests within a cycle, following the
/// command for four windows, oscillation has ceased meanwhile, and it is left out. As the spring force rises by
/// stiffness x (command - velocity), a cycle lasts from one greatest spring force to the next: the thesis reads
/// frequencies off that force, and gets the same.
///
/// `time` is in seconds and evenly spaced, command and velocity are in one unit. Extremes are refined by a parabola or,
/// at a corner, by straight lines.
///
/// # Errors
/// When signals are none, the window has fewer than eight samples or is longer than the run, a cycle has fewer than eight
/// samples, or there is no whole cycle.
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
    let off: Vec<f64> = velocity.iter().zip(command).map(|(actual, wanted)| actual - wanted).collect();
    let signals = Signals { time, command, velocity, off: &off };
    let rises = rises(time, &off, criterion.threshold);
    let pairs = rises.windows(2).map(|pair| (signals.within(pair[0], pair[1]), [pair[0], pair[1]]));
    let oscillating = pairs.filter(|(within, _)| steadiness.first_rest(within.clone()).is_none());
    let found =
        oscillating.map(|(within, ends)| signals.cycle(within, ends)).collect::<Result<Vec<_>, _>>()?;
    if found.is_empty() { Err(CyclesError::Quiet) } else { Ok(found) }
}

/// What cycles are read off.
struct Signals<'a> {
    time: &'a [f64],
    command: &'a [f64],
    velocity: &'a [f64],
    /// The velocity less the command.
    off: &'a [f64],
}

impl Signals<'_> {
    /// The samples from one instant on and before another.
    fn within(&self, begin: f64, end: f64) -> Range<usize> {
        let first_from = |begin: f64| self.time.partition_point(|instant| *instant < begin);
        first_from(begin)..first_from(end)
    }

    /// The cycle between two instants, which has these samples.
    fn cycle(&self, samples: Range<usize>, [begin, end]: [f64; 2]) -> Result<Cycle, CyclesError> {
        if samples.len() < FEWEST_SAMPLES {
            return Err(CyclesError::TooCoarse(samples.len()));
        }
        let extremes = |values: &[f64]| extremes(&self.time[samples.clone()], &values[samples.clone()]);
        let ([lowest, highest], [least, most]) = (extremes(self.off), extremes(self.velocity));
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

fn extremes(time: &[f64], values: &[f64]) -> [f64; 2] {
    [(-1.0, f64::NEG_INFINITY), (1.0, f64::INFINITY)].map(|(sign, limit)| extreme(time, values, sign, limit))
}

/// When a signal rises through the middle between a dip and the peak behind it, both of which it leaves by more than the
/// threshold. What begins on its way up has no dip there.
pub(super) fn rises(time: &[f64], values: &[f64], threshold: f64) -> Vec<f64> {
    let turns = turns(values, threshold);
    let swings = turns.windows(2).filter(|pair| pair[0] > 0 && values[pair[0]] < values[pair[1]]);
    let found = swings.filter_map(|pair| {
        let middle = 0.5 * (values[pair[0]] + values[pair[1]]);
        let after = (pair[0] + 1..=pair[1]).rev().find(|index| values[index - 1] < middle)?;
        let share = (middle - values[after - 1]) / (values[after] - values[after - 1]);
        Some(time[after - 1] + share * (time[after] - time[after - 1]))
    });
    found.collect()
}

/// Where a signal turns, dips and peaks by turns, leaving each by more than the threshold; first what it leaves.
fn turns(values: &[f64], threshold: f64) -> Vec<usize> {
    let (mut found, mut least, mut most) = (Vec::new(), 0, 0);
    let mut goes_up = None;
    for (index, value) in values.iter().enumerate() {
        if *value < values[least] {
            least = index;
        }
        if *value > values[most] {
            most = index;
        }
        let up = goes_up != Some(true) && value - values[least] > threshold;
        let down = goes_up != Some(false) && values[most] - value > threshold;
        if up || down {
            found.push(if up { least } else { most });
            goes_up = Some(up);
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

    /// A command that rises by 1 a second, and a velocity that is off it by so much.
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
            // The ramp takes part in how far the velocity goes.
            let rise = 0.5 / cycle.frequency;
            assert!((cycle.least - least).abs() < rise && (cycle.most - most).abs() < rise, "{cycle:?}");
        }
        assert!(found.windows(2).all(|pair| pair[0].end == pair[1].begin));
    }

    #[test]
    fn a_rest_between_two_oscillations_is_no_cycle() {
        let run = ramp(|t| if (2.0..3.0).contains(&t) { 0.0 } else { (TAU * 20.0 * t).sin() });
        let found = read(&run).unwrap();
        assert!(found.iter().all(|cycle| cycle.end < 2.1 || cycle.begin > 2.9), "{found:?}");
        assert!(found.iter().all(|cycle| (cycle.frequency - 20.0).abs() < 0.01), "{found:?}");
        assert_eq!(found.len(), 77);
    }

    #[test]
    fn standstill_between_two_slips_is_part_of_a_cycle() {
        // Stands still for 0.9 of every half second and slips in the rest.
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
        assert_eq!(read(&ramp(|t| 0.09 * (TAU * 60.0 * t).sin())), Err(CyclesError::Quiet));
    }

    #[test]
    fn what_cannot_be_read_is_told() {
        assert_eq!(read(&ramp(|_| 0.0)), Err(CyclesError::Quiet));
        assert!(matches!(read(&ramp(|t| (TAU * 150.0 * t).sin())), Err(CyclesError::TooCoarse(6 | 7))));
        let [time, command, velocity] = ramp(|t| t.sin());
        let with = |criterion| cycles(&time, &command, &velocity, criterion);
        let short = Criterion { window: 0.005, ..CRITERION };
        assert_eq!(with(short), Err(CyclesError::Window(WindowError::TooCoarse(5))));
        assert_eq!(cycles(&time, &command[1..], &velocity, CRITERION), Err(CyclesError::NotASignal));
        assert_eq!(cycles(&[], &[], &[], CRITERION), Err(CyclesError::NotASignal));
    }
}
