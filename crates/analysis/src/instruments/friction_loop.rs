//! The dynamic friction characteristic: force against velocity over whole cycles of an oscillation.

use super::cut::{Point, cut};
use super::cycles::rises;
use super::is_signal;

/// The loop that force makes against velocity, with what it tells of a cycle. With N, m/s and seconds its area is in W and
/// its work in J.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionLoop {
    /// Velocity and force, from the beginning of the first cycle to the end of the last.
    pub points: Vec<(f64, f64)>,
    /// How many cycles it shows.
    pub cycles: usize,
    /// Whole cycles over the time that they take, in Hz.
    pub frequency: f64,
    /// Area inside of the loop, the mean of its cycles: the integral of force over velocity. Positive where it is run
    /// through clockwise, seen with velocity to the right and force upward; what is run through the other way counts against it.
    pub area: f64,
    /// Work that the force does in a cycle, the mean of its cycles: the integral of force x velocity over time. Where the
    /// force drives a mass in a steady oscillation, this is the energy that friction takes.
    pub work: f64,
    /// How the loop is run through.
    pub turning: Turning,
    /// Least and largest velocity.
    pub velocity: [f64; 2],
    /// Least and largest force.
    pub force: [f64; 2],
    /// How far its end is from its beginning, as a share of the width and the height of the loop, the larger of the two:
    /// small where the oscillation is steady.
    pub gap: f64,
}

/// How a loop is run through, seen with velocity to the right and force upward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turning {
    /// Force is larger while velocity rises than while it falls.
    Clockwise,
    /// Force is larger while velocity falls.
    Anticlockwise,
    /// It encloses next to nothing: a line, or a figure of eight.
    Neither,
}

/// Why there is no loop.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FrictionLoopError {
    /// Times and values do not make signals.
    #[error("signals have one finite value for each of their times, which rise")]
    NotASignal,
    /// The threshold is not above 0.
    #[error("a threshold lies above 0: {0} does not")]
    BadThreshold(f64),
    /// No cycle was asked for.
    #[error("a loop is made of one cycle at least")]
    NoCycle,
    /// It does not oscillate, or not so often.
    #[error("it oscillates for {0} whole cycles of {1}")]
    TooFewCycles(usize, usize),
    /// There are too few samples in a cycle.
    #[error("{0:.1} samples in a cycle: at least {FEWEST_SAMPLES} are needed")]
    TooCoarse(f64),
}

const FEWEST_SAMPLES: f64 = 8.0;
/// A loop that encloses a smaller share of width x height is a line.
const LINE: f64 = 1e-3;

/// Draws the loop of force against velocity over the last so many whole cycles of a run at an even command.
///
/// A cycle goes from one rise of the velocity through the middle between dip and peak to the next; it turns where it comes back by
/// more than the threshold, in the unit of the velocity. Between samples the loop is straight: with n of them in a cycle
/// the area of an ellipse comes out too small by 6.6 / n^2 of it (1.6 % of 20).
///
/// `time` in seconds, rising.
///
/// # Errors
/// When signals are none, the threshold is not above 0, no cycle is asked for, there are not as many whole cycles, or fewer
/// than eight samples in one.
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
    if samples < FEWEST_SAMPLES {
        return Err(FrictionLoopError::TooCoarse(samples));
    }
    Ok(drawn(&velocity, &force, cycles))
}

/// How many whole cycles a run with a threshold above 0 shows; none where its signals are none.
pub(super) fn whole_cycles(time: &[f64], velocity: &[f64], threshold: f64) -> usize {
    if is_signal(time, velocity) { rises(time, velocity, threshold).len().saturating_sub(1) } else { 0 }
}

/// The loop of a velocity and a force at the same instants.
fn drawn(velocity: &[Point], force: &[Point], cycles: usize) -> FrictionLoop {
    let points: Vec<_> = velocity.iter().zip(force).map(|(velocity, force)| (velocity.1, force.1)).collect();
    let (count, lasts) = (cycles as f64, velocity[velocity.len() - 1].0 - velocity[0].0);
    let area = enclosed(&points) / count;
    let (across, up) = (reach(points.iter().map(|point| point.0)), reach(points.iter().map(|point| point.1)));
    let (width, height) = (across[1] - across[0], up[1] - up[0]);
    let share = |part: f64, whole: f64| if whole > 0.0 { part.abs() / whole } else { 0.0 };
    let (begin, end) = (points[0], points[points.len() - 1]);
    FrictionLoop {
        cycles,
        frequency: count / lasts,
        area,
        work: work(velocity, force) / count,
        turning: match area {
            area if area.abs() <= LINE * width * height => Turning::Neither,
            area if area > 0.0 => Turning::Clockwise,
            _ => Turning::Anticlockwise,
        },
        velocity: across,
        force: up,
        gap: share(end.0 - begin.0, width).max(share(end.1 - begin.1, height)),
        points,
    }
}

/// The integral of the second coordinate over the first, from the last point straight back to the first.
fn enclosed(points: &[Point]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(one, other)| 0.5 * (one.1 + other.1) * (other.0 - one.0)).sum()
}

/// The integral over time of force x velocity, both straight between instants.
fn work(velocity: &[Point], force: &[Point]) -> f64 {
    let stretches = velocity.windows(2).zip(force.windows(2));
    let stretch = |(velocity, force): (&[Point], &[Point])| {
        let ([v, w], [f, g]) = ([velocity[0].1, velocity[1].1], [force[0].1, force[1].1]);
        (velocity[1].0 - velocity[0].0) * (2.0 * (v * f + w * g) + v * g + w * f) / 6.0
    };
    stretches.map(stretch).sum()
}

fn reach(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::instruments::sampled;

    const FREQUENCY: f64 = 40.0;

    /// Velocity 3 + 2 sin, force 50 + 30 sin that leads by so much.
    fn read(lead: f64, cycles: usize) -> FrictionLoop {
        let (time, velocity) = sampled(5000, 1e-4, |t| 3.0 + 2.0 * (TAU * FREQUENCY * t).sin());
        let (_, force) = sampled(5000, 1e-4, |t| 50.0 + 30.0 * (TAU * FREQUENCY * t + lead).sin());
        friction_loop(&time, &velocity, &force, cycles, 0.5).unwrap()
    }

    #[test]
    fn area_and_work_of_an_ellipse() {
        for lead in [0.0, 0.3, PI / 2.0, -1.2] {
            for cycles in [1, 5] {
                let found = read(lead, cycles);
                let (area, power) =
                    (PI * 2.0 * 30.0 * lead.sin(), 3.0 * 50.0 + 0.5 * 2.0 * 30.0 * lead.cos());
                assert!((found.area - area).abs() < 2e-4 * PI * 60.0, "{lead}: {}", found.area);
                assert!((found.work * FREQUENCY / power - 1.0).abs() < 1e-4, "{lead}: {}", found.work);
                assert!((found.frequency / FREQUENCY - 1.0).abs() < 1e-5, "{lead}: {}", found.frequency);
                assert!(found.gap < 1e-3, "{lead}: {}", found.gap);
                let ends = [found.velocity, found.force].concat();
                let wanted = [1.0, 5.0, 20.0, 80.0];
                assert!(ends.iter().zip(wanted).all(|(got, wanted)| (got - wanted).abs() < 0.01), "{ends:?}");
            }
        }
    }

    #[test]
    fn where_a_run_begins_within_a_cycle_does_not_matter() {
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
    fn a_loop_is_turned_through_one_way_or_the_other() {
        assert_eq!(read(0.5, 2).turning, Turning::Clockwise);
        assert_eq!(read(-0.5, 2).turning, Turning::Anticlockwise);
        assert_eq!(read(0.0, 2).turning, Turning::Neither);
    }

    #[test]
    fn a_loop_that_drifts_does_not_close() {
        let (time, velocity) = sampled(5000, 1e-4, |t| (TAU * FREQUENCY * t).sin());
        let (_, force) = sampled(5000, 1e-4, |t| FREQUENCY * t + (TAU * FREQUENCY * t).cos());
        let found = friction_loop(&time, &velocity, &force, 1, 0.5).unwrap();
        assert!((0.35..0.45).contains(&found.gap), "{}", found.gap);
    }

    #[test]
    fn where_it_does_not_oscillate_there_is_no_loop() {
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
