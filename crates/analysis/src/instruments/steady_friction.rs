//! The steady friction characteristic, traced by a command that creeps: friction against velocity.

use super::critical_velocity::Criterion;
use super::is_signal;
use super::steadiness::Steadiness;
use super::window::{WindowError, samples_in};

/// A point of the characteristic: means over a window in which nothing oscillates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyFriction {
    /// The middle of the window, in seconds.
    pub time: f64,
    /// Velocity, in the unit of its signal.
    pub velocity: f64,
    /// Friction: the force that drives less what accelerates the mass, in the unit of the force.
    pub friction: f64,
}

/// Why there is no characteristic.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SteadyFrictionError {
    /// Times and values do not make signals.
    #[error("signals have one finite value for each of their times, which rise")]
    NotASignal,
    /// The mass is below 0, or not a number.
    #[error("a mass of {0} is none")]
    BadMass(f64),
    /// Threshold and window do not go with the run.
    #[error(transparent)]
    Window(#[from] WindowError),
    /// It slides steadily in no window.
    #[error("it never slides along with the command without oscillating")]
    NeverSteady,
}

/// Reads friction against velocity off a run whose command creeps, window after window.
///
/// A window counts where the velocity slides steadily: less the command it swings by no more than the criterion's threshold,
/// peak to peak, and its mean lies within a tenth of the mean command. Friction is the mean of `force`, which drives the
/// mass, less `mass` x the slope of the velocity in that window (least squares). `mass` is 0 or more, in
/// unit of force x s / unit of velocity (kg, with N and m/s); with 0 the acceleration is left out. Points stand in the order
/// of time; where the command comes back there are two of one velocity.
///
/// What a ramp traces is the steady friction of a moment ago: friction that follows velocity late by Tc stands off the
/// curve by its slope x rate of the command x Tc. What still swings below the threshold weighs on a mean over
/// part of a cycle. Both shrink with the rate of the command and the threshold.
///
/// `time` is in seconds and evenly spaced, command and velocity are in one unit.
///
/// # Errors
/// When signals or the mass are none, the window has fewer than eight samples or is longer than the run, or no window is
/// steady.
pub fn steady_friction(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    force: &[f64],
    mass: f64,
    criterion: Criterion,
) -> Result<Vec<SteadyFriction>, SteadyFrictionError> {
    if time.len() < 2 || ![command, velocity, force].iter().all(|values| is_signal(time, values)) {
        return Err(SteadyFrictionError::NotASignal);
    }
    if !(mass >= 0.0 && mass.is_finite()) {
        return Err(SteadyFrictionError::BadMass(mass));
    }
    let span = samples_in(time, criterion)?;
    let steadiness = Steadiness::new(command, velocity, span, criterion.threshold);
    let windows = (0..time.len()).step_by(span).filter(|start| steadiness.is_steady(*start));
    let points: Vec<_> = windows
        .map(|start| {
            let window = start..start + span;
            point(&time[window.clone()], &velocity[window.clone()], &force[window], mass)
        })
        .collect();
    if points.is_empty() { Err(SteadyFrictionError::NeverSteady) } else { Ok(points) }
}

fn point(time: &[f64], velocity: &[f64], force: &[f64], mass: f64) -> SteadyFriction {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (middle, level) = (mean(time), mean(velocity));
    let off = || time.iter().map(|instant| instant - middle);
    let moment: f64 = off().zip(velocity).map(|(off, value)| off * (value - level)).sum();
    let slope = moment / off().map(|off| off * off).sum::<f64>();
    SteadyFriction { time: middle, velocity: level, friction: mean(force) - mass * slope }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::instruments::sampled;

    const CRITERION: Criterion = Criterion { threshold: 0.01, window: 0.05 };
    const MASS: f64 = 400.0;

    /// Friction that falls with the square of velocity to 0 at 2, and a viscous part.
    fn law(velocity: f64) -> f64 {
        700.0 * (1.0 - velocity / 2.0).max(0.0).powi(2) + 10.0 * velocity
    }

    /// Sticks until the command is at 0.3, slides along with it, and oscillates from 1.5 to 1.8.
    fn run() -> [Vec<f64>; 4] {
        let (time, command) = sampled(30_001, 1e-3, |t| 0.1 * t);
        let swing = |t: f64| if (15.0..18.0).contains(&t) { 0.2 * (TAU * 20.0 * t).sin() } else { 0.0 };
        let (_, velocity) = sampled(30_001, 1e-3, |t| if t < 3.0 { 0.0 } else { 0.1 * t + swing(t) });
        let (_, force) =
            sampled(30_001, 1e-3, |t| if t < 3.0 { 200.0 * t } else { law(0.1 * t) + MASS * 0.1 });
        [time, command, velocity, force]
    }

    fn read([time, command, velocity, force]: &[Vec<f64>; 4], mass: f64) -> Vec<SteadyFriction> {
        steady_friction(time, command, velocity, force, mass, CRITERION).unwrap()
    }

    #[test]
    fn the_law_is_traced_where_it_slides() {
        let points = read(&run(), MASS);
        for point in &points {
            assert!((point.velocity - 0.1 * point.time).abs() < 1e-12, "{point:?}");
            // The mean over a window of a curve is off it by its bend.
            assert!((point.friction - law(point.velocity)).abs() < 2e-3, "{point:?}");
        }
        let is_within = |range: std::ops::Range<f64>| {
            points.iter().filter(|point| range.contains(&point.velocity)).count()
        };
        assert_eq!((is_within(0.0..0.3), is_within(1.501..1.799)), (0, 0));
        assert_eq!((is_within(0.3..1.5), is_within(1.8..3.0)), (240, 240));
    }

    #[test]
    fn without_a_mass_acceleration_counts_as_friction() {
        let (with, without) = (read(&run(), MASS), read(&run(), 0.0));
        assert!(
            with.iter()
                .zip(&without)
                .all(|(with, without)| (without.friction - with.friction - 40.0).abs() < 1e-6)
        );
    }

    #[test]
    fn what_cannot_be_read_is_told() {
        use SteadyFrictionError::*;
        let [time, command, velocity, force] = run();
        let with = |velocity: &[f64], mass, criterion| {
            steady_friction(&time, &command, velocity, &force, mass, criterion)
        };
        assert_eq!(with(&vec![0.0; 30_001], 0.0, CRITERION), Err(NeverSteady));
        assert_eq!(with(&velocity, -1.0, CRITERION), Err(BadMass(-1.0)));
        assert!(matches!(with(&velocity, f64::NAN, CRITERION), Err(BadMass(_))));
        assert_eq!(with(&velocity[1..], 0.0, CRITERION), Err(NotASignal));
        assert_eq!(steady_friction(&[], &[], &[], &[], 0.0, CRITERION), Err(NotASignal));
        let coarse = Criterion { window: 0.005, ..CRITERION };
        assert_eq!(with(&velocity, 0.0, coarse), Err(Window(WindowError::TooCoarse(5))));
    }
}
