//! The velocity profile of a slideway explained: points 1 to 5 and sections A to D of the thesis (4.5, Fig 4.8).

mod absent;
mod points;
mod ramp;
mod sections;
mod way;

pub use absent::Absent;
pub use way::Way;

use super::critical_velocity::{Criterion, NoCriticalVelocity};
use super::cycles::CyclesError;
use super::quantity::with_unit;
use patchcord_core::document::told;
use ramp::Ramp;

/// What a velocity profile shows, while the command rises or while it falls.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityProfile {
    /// The way that the command goes.
    pub way: Way,
    /// Along the command from rest. 1: it breaks away, and the velocity jumps; falling, it comes to rest. 2: oscillation begins or, falling,
    /// ends: the lower critical velocity. 3 and 4: between them there is stick-slip. 5: oscillation ends or, falling, begins: the upper
    /// critical velocity.
    pub points: [Result<ProfilePoint, Absent>; 5],
    /// Between the points. A: smooth sliding behind the jump. B: oscillation that grows or, falling, dies away. C: stick-slip. D: oscillation
    /// that dies away or, falling, grows.
    pub sections: [Result<Section, Absent>; 4],
    /// The velocity to which it jumps at point 1; falling, that of the last slip.
    pub jump: Option<f64>,
}

impl VelocityProfile {
    /// What the sections are called.
    pub const LETTERS: [char; 4] = ['A', 'B', 'C', 'D'];
}

/// A point of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// In seconds.
    pub time: f64,
    /// In the unit of the command.
    pub command: f64,
    /// The point before it, 1 to 4, with which it coincides.
    pub coincides: Option<usize>,
}

/// A section of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// When it begins and ends, in seconds.
    pub time: [f64; 2],
    /// From which command to which.
    pub command: [f64; 2],
    /// How many cycles lie in it.
    pub cycles: usize,
    /// The largest swing of a cycle, of the velocity less the command, peak to peak.
    pub swing: Option<f64>,
    /// The frequencies of its first and its last cycle, in Hz.
    pub frequency: Option<[f64; 2]>,
}

/// When a velocity oscillates, and when it stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileCriterion {
    /// When it oscillates; see [`Criterion`].
    pub oscillation: Criterion,
    /// A velocity up to this, in the unit of the velocity and above 0, is standstill: a cycle that comes down to it, or goes backward, is
    /// stick-slip.
    pub standstill: f64,
}

impl ProfileCriterion {
    /// Standstill up to half of the threshold: as little as what does not count as oscillation.
    pub const fn usual(oscillation: Criterion) -> Self {
        ProfileCriterion { oscillation, standstill: 0.5 * oscillation.threshold }
    }
}

/// Why no profile can be read.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// The run is no profile, or the criterion does not go with it.
    #[error(transparent)]
    Unreadable(#[from] NoCriticalVelocity),
    /// Samples lie too far apart.
    #[error(transparent)]
    Cycles(#[from] CyclesError),
    /// The standstill is not above 0.
    #[error("a standstill lies above 0: {0} does not")]
    BadStandstill(f64),
    /// Command and velocity stay below the standstill.
    #[error("{}", all_stands_still(&told(*.reached), &told(*.standstill)))]
    StandsStill {
        /// A velocity up to this is standstill.
        standstill: f64,
        /// The largest command or velocity, without sign.
        reached: f64,
    },
}

impl ProfileError {
    /// Its text with velocities in this unit, as a person reads them.
    pub fn told_in(self, unit: &str) -> String {
        match self {
            ProfileError::Unreadable(why) => why.told_in(unit),
            ProfileError::StandsStill { standstill, reached } => {
                all_stands_still(&with_unit(reached, unit), &with_unit(standstill, unit))
            }
            error => error.to_string(),
        }
    }
}

fn all_stands_still(reached: &str, standstill: &str) -> String {
    format!("all that the run reaches, {reached}, counts as standstill, which goes up to {standstill}")
}

/// Finds the points and sections of a velocity profile. Rising, the command goes from rest, or a run, up to its largest value, in either
/// direction; falling, from there back, as far as it does not change its sign. What comes before and after it is left out.
///
/// * Point 1: the velocity first passes standstill, and is above the command by more than the threshold within a window of that.
/// * Section A: from there to point 2. Where cycles behind the jump shrink, each to less than 0.9 of the one before, until the
///   velocity follows the command for four windows, they are the transient of the jump and belong to A; so do cycles that do not last
///   for four windows before it follows the command again.
/// * Point 2: the first cycle of the oscillation begins. It coincides with point 1 where no such rest comes between.
/// * Point 3: the first three cycles in a row begin that come down to standstill; point 4: the last three end.
/// * Point 5: the rising critical velocity, as [`critical_velocity`](super::critical_velocity()) reads it.
/// * Section B ends and section D begins, where there is no stick-slip, in the middle of the cycle with the largest swing.
///
/// Falling, all of this is read backward in time: point 5, the falling critical velocity, comes first, and at point 1 it comes to rest
/// from a last slip, which belongs to the oscillation unless it slid smoothly before. There is no transient then.
///
/// # Errors
/// When signals are none, threshold, window or standstill do not go with the run, a cycle has fewer than eight samples, or the
/// command does not go that way.
pub fn velocity_profile(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: ProfileCriterion,
    way: Way,
) -> Result<VelocityProfile, ProfileError> {
    let standstill = criterion.standstill;
    if !(standstill > 0.0 && standstill.is_finite()) {
        return Err(ProfileError::BadStandstill(standstill));
    }
    Ok(Ramp::new(time, command, velocity, criterion, way)?.profile())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::instruments::sampled;

    const CRITERION: ProfileCriterion = ProfileCriterion::usual(Criterion { threshold: 0.1, window: 0.04 });

    /// The command rises by 0.5 a second, to 3. It sticks up to 0.1, jumps to 0.6 and rings about the command; on top of that it
    /// swings at 50 Hz by a height that follows the command.
    fn read(way: f64, height: impl Fn(f64) -> f64) -> Result<VelocityProfile, ProfileError> {
        let (time, command) = sampled(12_001, 5e-4, |t| way * 0.5 * t);
        let (_, velocity) = sampled(12_001, 5e-4, |t| way * velocity(t, &height));
        velocity_profile(&time, &command, &velocity, CRITERION, Way::Rising)
    }

    fn velocity(t: f64, height: impl Fn(f64) -> f64) -> f64 {
        let rings = |t: f64| 0.5 * (-30.0 * t).exp() * (TAU * 50.0 * t).cos();
        let swing = height(0.5 * t) * (TAU * 50.0 * t).sin();
        if t < 0.2 { 0.0 } else { 0.5 * t + rings(t - 0.2) + swing }
    }

    /// The same backward in time, behind 6 s of which nothing is to be seen.
    fn read_back(way: f64, height: impl Fn(f64) -> f64) -> VelocityProfile {
        let back = |t: f64| (12.0 - t).min(6.0);
        let (time, command) = sampled(24_001, 5e-4, |t| way * 0.5 * t.min(back(t)));
        let (_, velocity) =
            sampled(24_001, 5e-4, |t| way * if t < 6.0 { 0.5 * t } else { velocity(back(t), &height) });
        velocity_profile(&time, &command, &velocity, CRITERION, Way::Falling).unwrap()
    }

    /// Grows from 0.5 on, beyond the command between 0.9 and 1.6, and is gone at 2.
    fn whole(command: f64) -> f64 {
        match command {
            ..0.5 => 0.0,
            ..0.9 => 1.0 * (command - 0.5) / 0.4,
            ..1.6 => command + 0.2,
            _ => 1.5 * (1.0 - (command - 1.6) / 0.4).max(0.0),
        }
    }

    fn commands(profile: &VelocityProfile) -> [f64; 5] {
        profile.points.map(|point| point.unwrap().command)
    }

    fn near(got: impl IntoIterator<Item = f64>, wanted: &[f64], within: f64) {
        let got: Vec<f64> = got.into_iter().collect();
        assert!(
            got.iter().zip(wanted).all(|(got, wanted)| (got - wanted).abs() < within),
            "{got:?} {wanted:?}"
        );
        assert_eq!(got.len(), wanted.len());
    }

    #[test]
    fn a_whole_profile_has_all_points_and_sections() {
        let profile = read(1.0, whole).unwrap();
        near(commands(&profile), &[0.1, 0.51, 0.8, 1.6, 1.99], 0.02);
        assert!(profile.points.iter().all(|point| point.unwrap().coincides.is_none()), "{profile:?}");
        near(profile.jump, &[0.6], 0.01);
        let sections = profile.sections.map(|section| section.unwrap());
        for (section, [begin, end]) in sections.iter().zip([[0, 1], [1, 2], [2, 3], [3, 4]]) {
            near(section.command, &[commands(&profile)[begin], commands(&profile)[end]], 1e-12);
        }
        assert!(
            sections[0].cycles < 6 && sections[1..].iter().all(|section| section.cycles > 20),
            "{sections:?}"
        );
        near(sections[2].swing, &[3.6], 0.02);
        near(sections[2].frequency.unwrap(), &[50.0, 50.0], 1.0);
    }

    #[test]
    fn backward_it_is_the_same_with_its_sign() {
        let [forward, backward] = [1.0, -1.0].map(|way| read(way, whole).unwrap());
        near(commands(&backward), &commands(&forward).map(|command| -command), 1e-9);
        assert_eq!(backward.jump, forward.jump.map(|jump| -jump));
    }

    #[test]
    fn a_command_may_begin_on_the_other_side() {
        let (time, command) = sampled(8001, 1e-3, |t| 0.5 * t - 1.0);
        let (_, velocity) =
            sampled(8001, 1e-3, |t| 0.5 * t - 1.0 + if t < 1.0 { (TAU * 50.0 * t).sin() } else { 0.0 });
        let profile = velocity_profile(&time, &command, &velocity, CRITERION, Way::Rising).unwrap();
        near([profile.points[4].unwrap().command], &[-0.5], 0.02);
    }

    #[test]
    fn stick_slip_from_the_beginning_makes_points_coincide() {
        let profile = read(1.0, |command| if command < 1.0 { command + 0.2 } else { 0.0 }).unwrap();
        let coincide = profile.points.map(|point| point.unwrap().coincides);
        assert_eq!(coincide, [None, Some(1), Some(2), None, Some(4)]);
        let absent = profile.sections.map(|section| section.err());
        let together = |one, other| Some(Absent::Coincide(one, other));
        assert_eq!(absent, [together(1, 2), together(2, 3), None, together(4, 5)]);
    }

    #[test]
    fn on_the_way_back_the_same_points_come_last_to_first() {
        for way in [1.0, -1.0] {
            let profile = read_back(way, whole);
            near(commands(&profile).map(|command| way * command), &[0.1, 0.52, 0.8, 1.6, 2.0], 0.02);
            for point in profile.points.map(Result::unwrap) {
                near([12.0 - 2.0 * way * point.command], &[point.time], 1e-6);
            }
            near(profile.jump, &[way * 0.6], 0.02);
            let sections = profile.sections.map(|section| section.unwrap());
            for (section, [begin, end]) in sections.iter().zip([[1, 0], [2, 1], [3, 2], [4, 3]]) {
                near(section.command, &[commands(&profile)[begin], commands(&profile)[end]], 1e-12);
                assert!(section.time[0] < section.time[1]);
            }
            near(sections[2].swing, &[3.6], 0.02);
        }
    }

    #[test]
    fn on_the_way_back_stick_slip_down_to_rest_makes_points_coincide() {
        let profile = read_back(1.0, |command| if command < 1.0 { command + 0.2 } else { 0.0 });
        assert_eq!(
            profile.points.map(|point| point.unwrap().coincides),
            [None, Some(1), Some(2), None, Some(4)]
        );
        near([profile.points[0].unwrap().time, profile.points[4].unwrap().time], &[11.8, 10.0], 0.05);
    }

    #[test]
    fn what_the_way_back_does_not_show_is_told() {
        let absent = |height: &dyn Fn(f64) -> f64| read_back(1.0, height).points.map(|point| point.err());
        let quiet = Some(Absent::Quiet);
        assert_eq!(absent(&|_| 0.0), [None, quiet, quiet, quiet, quiet]);
        let before = absent(&|command| if command > 2.0 { 0.2 } else { 0.0 });
        let no = Some(Absent::NoStickSlip);
        assert_eq!(before, [None, None, no, no, Some(Absent::NotBegun)]);
        // The run ends while it oscillates, or while it slides.
        let cut = |height: fn(f64) -> f64| {
            let (time, command) = sampled(10_001, 5e-4, |t| 0.5 * (6.0 - t));
            let (_, velocity) = sampled(10_001, 5e-4, |t| velocity(6.0 - t, height));
            velocity_profile(&time, &command, &velocity, CRITERION, Way::Falling).unwrap()
        };
        let goes_on = cut(|command| if command < 2.0 { command + 0.2 } else { 0.0 });
        let (no_rest, on) = (Some(Absent::NoRest), Some(Absent::NotEnded));
        assert_eq!(goes_on.points.map(|point| point.err()), [no_rest, on, on, None, None]);
        let absent = [Some(Absent::NoPoint(2)), Some(Absent::NoPoint(3)), None];
        assert_eq!(goes_on.sections.map(|section| section.err())[..3], absent);
        let slides = cut(|command| if (1.0..2.0).contains(&command) { 0.3 } else { 0.0 });
        assert_eq!(slides.points.map(|point| point.err()), [no_rest, None, no, no, None]);
        let short = Some(Absent::TooShort);
        let begins = cut(|command| if command < 0.55 { command + 0.2 } else { 0.0 });
        assert_eq!(begins.points.map(|point| point.err()), [no_rest, short, short, short, short]);
        let bout = cut(|command| if (1.5..1.53).contains(&command) { 0.3 } else { 0.0 });
        assert_eq!(bout.points.map(|point| point.err()), [no_rest, quiet, quiet, quiet, quiet]);
    }

    #[test]
    fn bouts_with_rests_between_them_are_not_added_up() {
        // Three cycles every half second.
        let bouts = |command: f64| if (4.0 * command).fract() < 0.12 { 0.3 } else { 0.0 };
        let rings = Some(Absent::RingsOnly);
        assert_eq!(
            read(1.0, bouts).unwrap().points.map(|point| point.err()),
            [None, rings, rings, rings, rings]
        );
        // Two cycles come down to standstill before a rest, two behind it.
        let parted = |command: f64| match command {
            0.98..1.0 | 1.2..1.22 => command + 0.2,
            0.5..0.98 | 1.22..1.7 => 0.2,
            _ => 0.0,
        };
        let profile = read(1.0, parted).unwrap();
        assert_eq!(profile.points[2], Err(Absent::NoStickSlip));
        near([1, 4].map(|index| profile.points[index].unwrap().command), &[0.5, 1.7], 0.02);
    }

    #[test]
    fn without_standstill_oscillation_grows_and_dies_about_its_largest_swing() {
        let profile = read(1.0, |command| 0.4 * (1.0 - ((command - 1.5) / 0.5).powi(2)).max(0.0)).unwrap();
        let absent = profile.points.map(|point| point.err());
        assert_eq!(absent, [None, None, Some(Absent::NoStickSlip), Some(Absent::NoStickSlip), None]);
        let [_, grows, sticks, dies] = profile.sections;
        near([grows.unwrap().command[1], dies.unwrap().command[0]], &[1.5, 1.5], 0.02);
        assert_eq!(sticks, Err(Absent::NoStickSlip));
    }

    #[test]
    fn what_the_run_does_not_show_is_told() {
        let absent = |height: &dyn Fn(f64) -> f64| read(1.0, height).unwrap().points.map(|point| point.err());
        let rings = Some(Absent::RingsOnly);
        assert_eq!(absent(&|_| 0.0), [None, rings, rings, rings, rings]);
        let goes_on = absent(&|command| if command > 1.0 { command + 0.2 } else { 0.0 });
        assert_eq!(goes_on, [None, None, None, Some(Absent::NotEnded), Some(Absent::NotEnded)]);
        let (time, command) = sampled(6001, 1e-3, |t| 0.5 * t);
        let of =
            |velocity: &[f64]| velocity_profile(&time, &command, velocity, CRITERION, Way::Rising).unwrap();
        assert_eq!(of(&vec![0.0; 6001]).points, [Err(Absent::Sticks); 5]);
        let late: Vec<f64> =
            time.iter().map(|t| 0.5 * t + if *t < 5.9 { 0.0 } else { (TAU * 50.0 * t).sin() }).collect();
        assert_eq!(of(&late).points[1..], [Err(Absent::TooShort); 4]);
        let follows = of(&command);
        assert_eq!((follows.points[0], follows.points[4]), (Err(Absent::NoJump), Err(Absent::Quiet)));
        assert_eq!(follows.sections[0].unwrap().command, [0.0, 3.0]);
    }

    #[test]
    fn what_is_no_profile_is_refused() {
        let (time, command) = sampled(6001, 1e-3, |t| 0.5 * t);
        let with = |command: &[f64], criterion| {
            velocity_profile(&time, command, &vec![0.0; 6001], criterion, Way::Rising)
        };
        let refused = |command: &[f64]| with(command, CRITERION).unwrap_err();
        assert_eq!(refused(&vec![1.0; 6001]), ProfileError::Unreadable(NoCriticalVelocity::Constant));
        let falls: Vec<f64> = command.iter().map(|value| 3.0 - value).collect();
        assert_eq!(refused(&falls), ProfileError::Unreadable(NoCriticalVelocity::NoRise));
        assert_eq!(refused(&command[1..]), ProfileError::Unreadable(NoCriticalVelocity::NotASignal));
        let still = |standstill| with(&command, ProfileCriterion { standstill, ..CRITERION }).unwrap_err();
        assert_eq!(still(0.0), ProfileError::BadStandstill(0.0));
        assert!(matches!(still(f64::NAN), ProfileError::BadStandstill(_)));
        assert_eq!(still(3.0), ProfileError::StandsStill { standstill: 3.0, reached: 3.0 });
        assert!(with(&command, ProfileCriterion { standstill: 2.9, ..CRITERION }).is_ok());
    }
}
