//! First oscillation: the command at which a slideway begins to oscillate, on the way up and on the way back.

use super::profile::{Absent, ProfileCriterion, ProfileError, ProfilePoint, Way, velocity_profile};

/// Where oscillation first appears while the command rises, and while it falls.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstOscillation {
    /// Point 2 of the profile, the lower critical velocity.
    pub rising: Result<ProfilePoint, NoFirstOscillation>,
    /// Point 5 of the profile on the way back, the falling critical velocity.
    pub falling: Result<ProfilePoint, NoFirstOscillation>,
}

/// Why there is no first oscillation.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoFirstOscillation {
    /// There is no profile to read.
    #[error(transparent)]
    Unreadable(#[from] ProfileError),
    /// The profile does not show where oscillation begins.
    #[error(transparent)]
    Absent(#[from] Absent),
}

/// Reads the command at which oscillation first appears: while the command rises, from rest or steady sliding, and while it falls, from
/// steady sliding.
///
/// It oscillates where the velocity swings by more than the threshold, peak to peak, within a window, for four windows at least and without
/// sliding steadily for four meanwhile: one slip, or what rings behind it, is no oscillation.
///
/// * Rising: the beginning of the first cycle, or the breaking away where it oscillates from there on. It is point 2 of
///   [`velocity_profile`], known to a cycle.
/// * Falling: the beginning of the first window that oscillates, nothing having oscillated for four windows before the command falls. It is
///   point 5 of the falling profile and the falling [`critical_velocity`](super::critical_velocity()), known to a window.
///
/// An oscillation that grows from little passes the threshold late: by what the command changes in the time that it grows in from the
/// disturbance that there was. Double the threshold, and what is read moves by what the command changes while the swing doubles.
pub fn first_oscillation(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: ProfileCriterion,
) -> FirstOscillation {
    let point = |way: Way, number: usize| -> Result<ProfilePoint, NoFirstOscillation> {
        let profile = velocity_profile(time, command, velocity, criterion, way)?;
        Ok(profile.points[number - 1]?)
    };
    FirstOscillation { rising: point(Way::Rising, 2), falling: point(Way::Falling, 5) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::instruments::{Criterion, NoCriticalVelocity, critical_velocity, sampled};

    const CRITERION: ProfileCriterion = ProfileCriterion::usual(Criterion { threshold: 0.1, window: 0.04 });
    const FREQUENCY: f64 = 50.0;
    /// The swing grows by e in this time.
    const GROWS_IN: f64 = 0.2;
    /// Of the command. It alone changes by 0.002 in a window.
    const RATE: f64 = 0.05;

    /// The command rises by 0.05 a second to 0.3 and comes back. It swings by 0.001, peak to peak, and by more behind 1 s: by e for every 0.2 s,
    /// up to 1 s later, when it is as little again at once; on the way back behind 7 s likewise.
    fn run(way: f64) -> [Vec<f64>; 3] {
        let ramp = |t: f64| RATE * t.min(12.0 - t);
        let (time, command) = sampled(24_001, 5e-4, |t| way * ramp(t));
        let swing = |t: f64| {
            let grown =
                [1.0, 7.0].map(|begin| t - begin).into_iter().find(|since| (0.0..1.6).contains(since));
            1e-3 * grown.map_or(1.0, |since| (since / GROWS_IN).exp())
        };
        let (_, velocity) =
            sampled(24_001, 5e-4, |t| way * (ramp(t) + 0.5 * swing(t) * (TAU * FREQUENCY * t).sin()));
        [time, command, velocity]
    }

    fn read([time, command, velocity]: &[Vec<f64>; 3], criterion: ProfileCriterion) -> [f64; 2] {
        let found = first_oscillation(time, command, velocity, criterion);
        [found.rising, found.falling].map(|point| point.unwrap().command)
    }

    /// When the swing of 0.001 has grown to the threshold, after so many seconds.
    fn grown(threshold: f64) -> f64 {
        GROWS_IN * (threshold / 1e-3).ln()
    }

    #[test]
    fn what_grows_from_little_is_seen_where_it_passes_the_threshold() {
        for threshold in [0.05, 0.1, 0.2] {
            let criterion = ProfileCriterion::usual(Criterion { threshold, ..CRITERION.oscillation });
            let [rising, falling] = read(&run(1.0), criterion);
            let since = grown(threshold);
            let cycle = RATE / FREQUENCY;
            assert!((rising - RATE * (1.0 + since)).abs() < cycle, "{rising} {since}");
            // A window shows it before it has passed, by its own length at most.
            let early = falling - RATE * (5.0 - since);
            assert!((-cycle..RATE * 0.04 + cycle).contains(&early), "{falling} {since}");
        }
    }

    #[test]
    fn falling_it_is_the_falling_critical_velocity() {
        let [time, command, velocity] = run(1.0);
        let critical = critical_velocity(&time, &command, &velocity, CRITERION.oscillation);
        assert_eq!(Ok(read(&[time, command, velocity], CRITERION)[1]), critical.falling);
    }

    #[test]
    fn backward_it_is_the_same_with_its_sign() {
        assert_eq!(read(&run(-1.0), CRITERION), read(&run(1.0), CRITERION).map(|command| -command));
    }

    #[test]
    fn one_slip_is_no_oscillation() {
        let [time, command, _] = run(1.0);
        let slips: Vec<f64> =
            time.iter().zip(&command).map(|(t, wanted)| if *t < 0.2 { 0.0 } else { *wanted }).collect();
        let found = first_oscillation(&time, &command, &slips, CRITERION);
        assert_eq!([found.rising, found.falling], [Err(NoFirstOscillation::Absent(Absent::Quiet)); 2]);
        let refused = first_oscillation(&time[..4000], &command[..4000], &slips[..4000], CRITERION).falling;
        let one_way = ProfileError::Unreadable(NoCriticalVelocity::NeverBack);
        assert_eq!(refused, Err(NoFirstOscillation::Unreadable(one_way)));
    }
}
