//! The steady friction characteristic: friction against velocity, read during a slow ramp of the command.

use super::critical_velocity::Criterion;
use super::steadiness::Steadiness;
use super::window::{WindowError, samples_in};
use super::{NOT_A_SIGNAL, is_signal};

/// One point of the characteristic: means over a window without oscillation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyFriction {
    /// Mean time of the window, in seconds.
    pub time: f64,
    /// Mean velocity, in the unit of its signal.
    pub velocity: f64,
    /// Friction: the driving force minus mass x acceleration, in the unit of the force.
    pub friction: f64,
}

/// Why the characteristic cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SteadyFrictionError {
    /// Times and values do not form signals.
    #[error("{NOT_A_SIGNAL}")]
    NotASignal,
    /// The mass is negative or not finite.
    #[error("mass must be finite and at least 0, got {0}")]
    BadMass(f64),
    /// Threshold and window are unusable with this run.
    #[error(transparent)]
    Window(#[from] WindowError),
    /// No window shows steady sliding.
    #[error("the velocity never follows the command without oscillating")]
    NeverSteady,
}

/// Reads friction against velocity off a run with a slow ramp of the command, one window after the other.
///
/// A window counts if the velocity slides steadily in it. Velocity minus command then varies by at most the
/// criterion's threshold, peak to peak, and the mean velocity is within a tenth of the mean command. Friction is the
/// mean of `force`, which drives the mass, minus `mass` x the least-squares slope of the velocity in that window.
/// `mass` is at least 0, in unit of force x s / unit of velocity (kg for N and m/s); 0 ignores the acceleration.
/// Points are in order of time. If the command returns, there are two points for the same velocity.
///
/// A ramp shows friction with a delay. If friction follows velocity with the lag Tc, each point deviates from the
/// characteristic by its slope x rate of the command x Tc. Oscillation below the threshold disturbs the mean over a
/// fraction of a cycle. Both errors decrease with the rate of the command and with the threshold.
///
/// `time` is in seconds and evenly spaced; command and velocity have the same unit.
///
/// # Errors
/// If the slices do not form signals, or the mass is negative or not finite. Also if the window has fewer than eight
/// samples or is longer than the run, or if no window is steady.
///
/// # Examples
///
/// A mass of 400 kg slides with a friction of 100 N + 10 N s/m x velocity:
///
/// ```
/// use patchcord_analysis::instruments::{Criterion, SteadyFrictionError, steady_friction};
///
/// let time: Vec<f64> = (0..1000).map(|index| 1e-3 * f64::from(index)).collect();
/// let velocity: Vec<f64> = time.iter().map(|t| 0.1 + 0.1 * t).collect();
/// let force: Vec<f64> = velocity.iter().map(|v| 100.0 + 10.0 * v + 400.0 * 0.1).collect();
///
/// let criterion = Criterion { threshold: 0.01, window: 0.05 };
/// let points = steady_friction(&time, &velocity, &velocity, &force, 400.0, criterion)?;
/// assert_eq!(points.len(), 20);
/// assert!(points.iter().all(|point| (point.friction - 100.0 - 10.0 * point.velocity).abs() < 1e-6));
/// # Ok::<(), SteadyFrictionError>(())
/// ```
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

/// The point of one window.
fn point(time: &[f64], velocity: &[f64], force: &[f64], mass: f64) -> SteadyFriction {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (mean_time, mean_velocity) = (mean(time), mean(velocity));
    let off = || time.iter().map(|instant| instant - mean_time);
    let moment: f64 = off().zip(velocity).map(|(off, value)| off * (value - mean_velocity)).sum();
    let slope = moment / off().map(|off| off * off).sum::<f64>();
    SteadyFriction { time: mean_time, velocity: mean_velocity, friction: mean(force) - mass * slope }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::instruments::sampled;

    const CRITERION: Criterion = Criterion { threshold: 0.01, window: 0.05 };
    const MASS: f64 = 400.0;

    /// Friction that falls quadratically with velocity and is 0 at 2, plus a viscous term.
    fn law(velocity: f64) -> f64 {
        700.0 * (1.0 - velocity / 2.0).max(0.0).powi(2) + 10.0 * velocity
    }

    /// Sticks until the command is 0.3, then slides with it, and oscillates from 1.5 to 1.8.
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
    fn points_follow_the_friction_law_during_sliding() {
        let points = read(&run(), MASS);
        for point in &points {
            assert!((point.velocity - 0.1 * point.time).abs() < 1e-12, "{point:?}");
            // The mean over a window of a curved function deviates from the value at its middle.
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
    fn unusable_runs_return_errors() {
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
