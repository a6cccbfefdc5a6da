//! The dynamic friction characteristic: force against velocity over whole cycles of an oscillation.
//!
//! The velocity is first divided into whole cycles. The last few of them form a closed curve in the plane of velocity
//! and force. Its area, the work per cycle and its sense of rotation describe how friction depends on velocity.

use super::cut::{Point, cut};
use super::cycles::rises;
use super::{NOT_A_SIGNAL, is_signal};
use patchcord_core::document::plural;

/// The loop of force against velocity. In N, m/s and s, `area` is in W and `work` is in J.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionLoop {
    /// Velocity and force of every sample, from the start of the first cycle to the end of the last.
    pub points: Vec<(f64, f64)>,
    /// The number of cycles in `points`.
    pub cycles: usize,
    /// Number of whole cycles divided by their duration, in Hz.
    pub frequency: f64,
    /// Mean area inside the loop per cycle: the integral of force over velocity. It is positive for a clockwise loop,
    /// with velocity to the right and force upward. Anticlockwise parts count as negative.
    pub area: f64,
    /// Mean work of the force per cycle: the integral of force x velocity over time. If the force drives a mass in a
    /// steady oscillation, this is the energy that friction dissipates.
    pub work: f64,
    /// The sense of rotation.
    pub sense: LoopSense,
    /// Smallest and largest velocity.
    pub velocity: [f64; 2],
    /// Smallest and largest force.
    pub force: [f64; 2],
    /// Distance between the two ends of the loop as a fraction of its width or of its height, the larger of the two.
    /// Small if the oscillation is steady.
    pub closure_error: f64,
}

/// The sense of rotation of a loop, with velocity to the right and force upward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoopSense {
    /// Force is larger while velocity rises than while it falls.
    Clockwise,
    /// Force is larger while velocity falls.
    Anticlockwise,
    /// The enclosed area is negligible: the loop is a line or a figure of eight.
    Neither,
}

/// Why there is no loop.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrictionLoopError {
    /// Times and values do not form signals.
    #[error("{NOT_A_SIGNAL}")]
    NotASignal,
    /// The threshold is not positive.
    #[error("threshold must be positive, got {0}")]
    BadThreshold(f64),
    /// Zero cycles were requested.
    #[error("number of cycles must be at least 1")]
    NoCycle,
    /// The run has fewer whole cycles than requested. The fields are the number found and the number requested.
    #[error("the velocity completes {} of {} requested", plural(*.0, "whole cycle"), .1)]
    TooFewCycles(usize, usize),
    /// The first cycles have too few samples. The field is the mean number of samples per cycle.
    #[error("{0:.1} samples per cycle, at least {MIN_SAMPLES} are needed")]
    TooCoarse(f64),
}

/// The fewest samples per cycle that show the shape of a loop.
const MIN_SAMPLES: f64 = 8.0;
/// A loop whose area is below this fraction of width x height counts as a line.
const LINE_AREA: f64 = 1e-3;

/// Computes the loop of force against velocity over the last `cycles` whole cycles of a run at constant command.
///
/// A cycle starts where the velocity rises through the middle between a minimum and the next maximum. An extreme
/// counts when the velocity has moved back from it by more than `threshold`, in the unit of the velocity. Samples are
/// joined by straight lines. With n samples per cycle this underestimates the area of an ellipse by the fraction 6.6
/// / n^2 (1.6 % for n = 20).
///
/// `time` is in seconds and strictly increasing.
///
/// # Errors
/// If the slices do not form signals, the threshold is not positive, or `cycles` is 0. Also if the run has fewer whole
/// cycles than requested, or fewer than eight samples per cycle.
///
/// # Examples
///
/// A force that leads the velocity by a quarter of a period makes an ellipse:
///
/// ```
/// use patchcord_analysis::instruments::{FrictionLoopError, LoopSense, friction_loop};
/// use std::f64::consts::{PI, TAU};
///
/// let time: Vec<f64> = (0..5000).map(|index| 1e-4 * f64::from(index)).collect();
/// let velocity: Vec<f64> = time.iter().map(|t| 3.0 + 2.0 * (TAU * 40.0 * t).sin()).collect();
/// let force: Vec<f64> = time.iter().map(|t| 50.0 + 30.0 * (TAU * 40.0 * t).cos()).collect();
///
/// let found = friction_loop(&time, &velocity, &force, 5, 0.5)?;
/// assert!((found.area - PI * 2.0 * 30.0).abs() < 0.1);
/// assert!((found.frequency - 40.0).abs() < 0.01);
/// assert_eq!(found.sense, LoopSense::Clockwise);
/// # Ok::<(), FrictionLoopError>(())
/// ```
pub fn friction_loop(
    time: &[f64],
    velocity: &[f64],
    force: &[f64],
    cycles: usize,
    threshold: f64,
) -> Result<FrictionLoop, FrictionLoopError> {
    if time.len() < 2 || !is_signal(time, velocity) || !is_signal(time, force) {
        return Err(FrictionLoopError::NotASignal);
    }
    if !(threshold > 0.0 && threshold.is_finite()) {
        return Err(FrictionLoopError::BadThreshold(threshold));
    }
    if cycles == 0 {
        return Err(FrictionLoopError::NoCycle);
    }
    let rises = rises(time, velocity, threshold);
    let whole = rises.len().saturating_sub(1);
    let first = whole.checked_sub(cycles).ok_or(FrictionLoopError::TooFewCycles(whole, cycles))?;
    let [begin, end] = [rises[first], rises[rises.len() - 1]];
    let (velocity, force) = (cut(time, velocity, [begin, end]), cut(time, force, [begin, end]));
    let samples = velocity.len().saturating_sub(2) as f64 / cycles as f64;
    if samples < MIN_SAMPLES {
        return Err(FrictionLoopError::TooCoarse(samples));
    }
    Ok(build_loop(&velocity, &force, cycles))
}

/// The number of whole cycles in a run, for a positive threshold; 0 if the slices do not form a signal.
pub(super) fn whole_cycles(time: &[f64], velocity: &[f64], threshold: f64) -> usize {
    if is_signal(time, velocity) { rises(time, velocity, threshold).len().saturating_sub(1) } else { 0 }
}

/// The loop of a velocity and a force sampled at the same times.
fn build_loop(velocity: &[Point], force: &[Point], cycles: usize) -> FrictionLoop {
    let points: Vec<_> = velocity.iter().zip(force).map(|(velocity, force)| (velocity.1, force.1)).collect();
    let (count, duration) = (cycles as f64, velocity[velocity.len() - 1].0 - velocity[0].0);
    let area = enclosed_area(&points) / count;
    let velocity_range = range_of(points.iter().map(|point| point.0));
    let force_range = range_of(points.iter().map(|point| point.1));
    let (width, height) = (velocity_range[1] - velocity_range[0], force_range[1] - force_range[0]);
    let share = |part: f64, whole: f64| if whole > 0.0 { part.abs() / whole } else { 0.0 };
    let (begin, end) = (points[0], points[points.len() - 1]);
    FrictionLoop {
        cycles,
        frequency: count / duration,
        area,
        work: work(velocity, force) / count,
        sense: match area {
            area if area.abs() <= LINE_AREA * width * height => LoopSense::Neither,
            area if area > 0.0 => LoopSense::Clockwise,
            _ => LoopSense::Anticlockwise,
        },
        velocity: velocity_range,
        force: force_range,
        closure_error: share(end.0 - begin.0, width).max(share(end.1 - begin.1, height)),
        points,
    }
}

/// The integral of the second coordinate over the first. A straight line closes the curve.
fn enclosed_area(points: &[Point]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(one, other)| 0.5 * (one.1 + other.1) * (other.0 - one.0)).sum()
}

/// The integral of force x velocity over time. Both are linear between samples, so the integral is exact.
fn work(velocity: &[Point], force: &[Point]) -> f64 {
    let intervals = velocity.windows(2).zip(force.windows(2));
    let interval = |(velocity, force): (&[Point], &[Point])| {
        let ([v, w], [f, g]) = ([velocity[0].1, velocity[1].1], [force[0].1, force[1].1]);
        (velocity[1].0 - velocity[0].0) * (2.0 * (v * f + w * g) + v * g + w * f) / 6.0
    };
    intervals.map(interval).sum()
}

/// Smallest and largest value.
fn range_of(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::instruments::sampled;

    const FREQUENCY: f64 = 40.0;

    /// The loop of velocity 3 + 2 sin(w t) and force 50 + 30 sin(w t + lead).
    fn sine_loop(lead: f64, cycles: usize) -> FrictionLoop {
        let (time, velocity) = sampled(5000, 1e-4, |t| 3.0 + 2.0 * (TAU * FREQUENCY * t).sin());
        let (_, force) = sampled(5000, 1e-4, |t| 50.0 + 30.0 * (TAU * FREQUENCY * t + lead).sin());
        friction_loop(&time, &velocity, &force, cycles, 0.5).unwrap()
    }

    #[test]
    fn area_and_work_of_an_ellipse() {
        for lead in [0.0, 0.3, PI / 2.0, -1.2] {
            for cycles in [1, 5] {
                let found = sine_loop(lead, cycles);
                let (area, power) =
                    (PI * 2.0 * 30.0 * lead.sin(), 3.0 * 50.0 + 0.5 * 2.0 * 30.0 * lead.cos());
                assert!((found.area - area).abs() < 2e-4 * PI * 60.0, "{lead}: {}", found.area);
                assert!((found.work * FREQUENCY / power - 1.0).abs() < 1e-4, "{lead}: {}", found.work);
                assert!((found.frequency / FREQUENCY - 1.0).abs() < 1e-5, "{lead}: {}", found.frequency);
                assert!(found.closure_error < 1e-3, "{lead}: {}", found.closure_error);
                let ends = [found.velocity, found.force].concat();
                let wanted = [1.0, 5.0, 20.0, 80.0];
                assert!(ends.iter().zip(wanted).all(|(got, wanted)| (got - wanted).abs() < 0.01), "{ends:?}");
            }
        }
    }

    #[test]
    fn the_phase_at_the_start_of_a_run_does_not_matter() {
        for begin in [0.0, 0.003, 0.009, 0.016] {
            let wave = |t: f64| 3.0 + (TAU * FREQUENCY * (t + begin)).sin();
            let (time, velocity) = sampled(1200, 1e-4, wave);
            let cycles = whole_cycles(&time, &velocity, 0.5);
            let found = friction_loop(&time, &velocity, &vec![2.0; 1200], cycles, 0.5).unwrap();
            assert!((found.frequency / FREQUENCY - 1.0).abs() < 1e-6, "{begin}: {found:?}");
            assert!((found.work * FREQUENCY / 6.0 - 1.0).abs() < 1e-6, "{begin}: {}", found.work);
        }
    }

    #[test]
    fn the_sense_follows_the_phase_of_the_force() {
        assert_eq!(sine_loop(0.5, 2).sense, LoopSense::Clockwise);
        assert_eq!(sine_loop(-0.5, 2).sense, LoopSense::Anticlockwise);
        assert_eq!(sine_loop(0.0, 2).sense, LoopSense::Neither);
    }

    #[test]
    fn a_drifting_loop_has_a_closure_error() {
        let (time, velocity) = sampled(5000, 1e-4, |t| (TAU * FREQUENCY * t).sin());
        let (_, force) = sampled(5000, 1e-4, |t| FREQUENCY * t + (TAU * FREQUENCY * t).cos());
        let found = friction_loop(&time, &velocity, &force, 1, 0.5).unwrap();
        assert!((0.35..0.45).contains(&found.closure_error), "{}", found.closure_error);
    }

    #[test]
    fn runs_without_whole_cycles_return_errors() {
        use FrictionLoopError::*;
        let (time, wave) = sampled(1000, 1e-3, |t| (TAU * 5.0 * t).sin());
        let with =
            |velocity: &[f64], cycles, threshold| friction_loop(&time, velocity, &wave, cycles, threshold);
        assert_eq!(with(&[1.0; 1000], 1, 0.1), Err(TooFewCycles(0, 1)));
        assert_eq!(with(&time, 1, 0.1), Err(TooFewCycles(0, 1)));
        assert_eq!(with(&wave, 9, 0.1), Err(TooFewCycles(3, 9)));
        assert_eq!(with(&wave, usize::MAX, 0.1), Err(TooFewCycles(3, usize::MAX)));
        assert_eq!(with(&wave, 1, 3.0), Err(TooFewCycles(0, 1)));
        assert_eq!(with(&wave, 0, 0.1), Err(NoCycle));
        assert_eq!(with(&wave, 1, 0.0), Err(BadThreshold(0.0)));
        assert_eq!(with(&wave[1..], 1, 0.1), Err(NotASignal));
        assert_eq!(friction_loop(&[], &[], &[], 1, 0.1), Err(NotASignal));
        let (time, fast) = sampled(1000, 1e-3, |t| (TAU * 180.0 * t).sin());
        assert!(matches!(friction_loop(&time, &fast, &fast, 3, 0.5), Err(TooCoarse(_))));
    }
}
