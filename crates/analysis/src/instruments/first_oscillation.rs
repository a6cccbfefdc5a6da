//! First oscillation: the command at which a slideway begins to oscillate, during the rising and the falling ramp.

use super::profile::{
    MissingPointError, ProfileCriterion, ProfileError, ProfilePoint, RampDirection, velocity_profile,
};

/// Where oscillation first appears during each ramp.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstOscillation {
    /// Point 2 of the rising profile, the lower critical velocity.
    pub rising: Result<ProfilePoint, FirstOscillationError>,
    /// Point 5 of the falling profile, the falling critical velocity.
    pub falling: Result<ProfilePoint, FirstOscillationError>,
}

/// Why there is no first oscillation.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FirstOscillationError {
    /// The run has no readable velocity profile.
    #[error(transparent)]
    Unreadable(#[from] ProfileError),
    /// The profile has no such point.
    #[error(transparent)]
    Absent(#[from] MissingPointError),
}

/// Reads the command at which oscillation first appears. The rising ramp starts from rest or steady sliding, the
/// falling ramp from steady sliding.
///
/// The velocity oscillates if it varies by more than the threshold, peak to peak, within a window. This must last for
/// at least four windows without steady sliding for four windows in between. A single slip and its ringing are no
/// oscillation.
///
/// * Rising: the start of the first cycle, or breaking away if the oscillation starts there. This is point 2 of
///   [`velocity_profile`]. It is accurate to one cycle.
/// * Falling: the start of the first window that oscillates. No window may oscillate during the four windows before the
///   command falls. This is point 5 of the falling profile and the falling
///   [`critical_velocity`](super::critical_velocity()). It is accurate to one window.
///
/// An oscillation that grows from a small disturbance passes the threshold late, and the command changes meanwhile.
/// Read again with twice the threshold: the result moves by the change of the command while the swing doubles.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{Criterion, FirstOscillationError, ProfileCriterion, first_oscillation};
///
/// // The command rises by 0.5 per second to 3. The velocity oscillates at 50 Hz from t = 2 s to 4 s.
/// let time: Vec<f64> = (0..6001).map(|index| 1e-3 * f64::from(index)).collect();
/// let command: Vec<f64> = time.iter().map(|t| 0.5 * t).collect();
/// let swing = |t: f64| if (2.0..4.0).contains(&t) { 0.3 * (100.0 * std::f64::consts::PI * t).sin() } else { 0.0 };
/// let velocity: Vec<f64> = time.iter().map(|t| 0.5 * t + swing(*t)).collect();
///
/// let criterion = ProfileCriterion::usual(Criterion { threshold: 0.1, window: 0.04 });
/// let found = first_oscillation(&time, &command, &velocity, criterion);
/// assert!((found.rising?.command - 1.0).abs() < 0.02);
/// assert!(found.falling.is_err(), "the command never falls");
/// # Ok::<(), FirstOscillationError>(())
/// ```
pub fn first_oscillation(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: ProfileCriterion,
) -> FirstOscillation {
    let point = |direction: RampDirection, number: usize| -> Result<ProfilePoint, FirstOscillationError> {
        let profile = velocity_profile(time, command, velocity, criterion, direction)?;
        Ok(profile.points[number - 1]?)
    };
    FirstOscillation { rising: point(RampDirection::Rising, 2), falling: point(RampDirection::Falling, 5) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::instruments::{Criterion, CriticalVelocityError, critical_velocity, sampled};

    const CRITERION: ProfileCriterion = ProfileCriterion::usual(Criterion { threshold: 0.1, window: 0.04 });
    const FREQUENCY: f64 = 50.0;
    /// The time in which the swing grows by a factor of e, in seconds.
    const GROWTH_TIME: f64 = 0.2;
    /// The rate of the command per second. The command alone changes by 0.002 within a window.
    const RATE: f64 = 0.05;

    /// The command rises by 0.05 per second to 0.3 and falls back. The velocity swings by 0.001, peak to peak. From 1
    /// s and from 7 s on the swing grows by e every 0.2 s; after 1.6 s of growth it is 0.001 again. `sign` mirrors it
    /// all.
    fn run(sign: f64) -> [Vec<f64>; 3] {
        let ramp = |t: f64| RATE * t.min(12.0 - t);
        let (time, command) = sampled(24_001, 5e-4, |t| sign * ramp(t));
        let swing = |t: f64| {
            let grown =
                [1.0, 7.0].map(|begin| t - begin).into_iter().find(|since| (0.0..1.6).contains(since));
            1e-3 * grown.map_or(1.0, |since| (since / GROWTH_TIME).exp())
        };
        let (_, velocity) =
            sampled(24_001, 5e-4, |t| sign * (ramp(t) + 0.5 * swing(t) * (TAU * FREQUENCY * t).sin()));
        [time, command, velocity]
    }

    fn read([time, command, velocity]: &[Vec<f64>; 3], criterion: ProfileCriterion) -> [f64; 2] {
        let found = first_oscillation(time, command, velocity, criterion);
        [found.rising, found.falling].map(|point| point.unwrap().command)
    }

    /// The time in seconds in which the swing grows from 0.001 to the threshold.
    fn time_to_reach(threshold: f64) -> f64 {
        GROWTH_TIME * (threshold / 1e-3).ln()
    }

    #[test]
    fn a_growing_oscillation_is_detected_at_the_threshold() {
        for threshold in [0.05, 0.1, 0.2] {
            let criterion = ProfileCriterion::usual(Criterion { threshold, ..CRITERION.oscillation });
            let [rising, falling] = read(&run(1.0), criterion);
            let since = time_to_reach(threshold);
            let cycle = RATE / FREQUENCY;
            assert!((rising - RATE * (1.0 + since)).abs() < cycle, "{rising} {since}");
            // A window detects it before it has passed, by at most the length of the window.
            let early = falling - RATE * (5.0 - since);
            assert!((-cycle..RATE * 0.04 + cycle).contains(&early), "{falling} {since}");
        }
    }

    #[test]
    fn the_falling_result_is_the_falling_critical_velocity() {
        let [time, command, velocity] = run(1.0);
        let critical = critical_velocity(&time, &command, &velocity, CRITERION.oscillation);
        assert_eq!(Ok(read(&[time, command, velocity], CRITERION)[1]), critical.falling);
    }

    #[test]
    fn a_mirrored_run_gives_the_mirrored_result() {
        assert_eq!(read(&run(-1.0), CRITERION), read(&run(1.0), CRITERION).map(|command| -command));
    }

    #[test]
    fn a_single_slip_is_no_oscillation() {
        let [time, command, _] = run(1.0);
        let slips: Vec<f64> =
            time.iter().zip(&command).map(|(t, wanted)| if *t < 0.2 { 0.0 } else { *wanted }).collect();
        let found = first_oscillation(&time, &command, &slips, CRITERION);
        let none = Err(FirstOscillationError::Absent(MissingPointError::NoOscillation));
        assert_eq!([found.rising, found.falling], [none, none]);
        let error = first_oscillation(&time[..4000], &command[..4000], &slips[..4000], CRITERION).falling;
        let no_return = ProfileError::Unreadable(CriticalVelocityError::NeverBack);
        assert_eq!(error, Err(FirstOscillationError::Unreadable(no_return)));
    }
}
