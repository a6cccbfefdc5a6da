//! The velocity profile of a slideway: points 1 to 5 and sections A to D of the thesis (4.5, Fig 4.8).
//!
//! A command rises slowly from rest and may fall back. The profile locates breaking away, the beginning and end of
//! oscillation and of stick-slip (`points`), and describes what happens between them (`sections`).
//! Both ramps use the same code: `ramp` mirrors and reverses the run first.

mod absence_reason;
mod points;
mod ramp;
mod ramp_direction;
mod sections;

pub use absence_reason::AbsenceReason;
pub use ramp_direction::RampDirection;

use super::critical_velocity::{Criterion, NoCriticalVelocity};
use super::cycles::CyclesError;
use super::quantity::format_quantity;
use patchcord_core::document::format_number;
use ramp::RampReader;

/// The velocity profile of one ramp.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityProfile {
    /// The ramp that was read.
    pub direction: RampDirection,
    /// Points 1 to 5, counted from rest, or why a point is missing.
    ///
    /// * Point 1: the slideway breaks away and the velocity jumps; falling, it comes to rest.
    /// * Point 2: oscillation begins; falling, it ends. This is the lower critical velocity.
    /// * Points 3 and 4: stick-slip lasts from one to the other.
    /// * Point 5: oscillation ends; falling, it begins. This is the upper critical velocity.
    pub points: [Result<ProfilePoint, AbsenceReason>; 5],
    /// Sections A to D between the points, or why a section is missing.
    ///
    /// * Section A: smooth sliding after the jump.
    /// * Section B: oscillation that grows; falling, it decays.
    /// * Section C: stick-slip.
    /// * Section D: oscillation that decays; falling, it grows.
    pub sections: [Result<ProfileSection, AbsenceReason>; 4],
    /// The velocity after the jump at point 1; falling, the velocity of the last slip. None without a jump.
    pub jump: Option<f64>,
}

impl VelocityProfile {
    /// The letters of the sections.
    pub const SECTION_LETTERS: [char; 4] = ['A', 'B', 'C', 'D'];
}

/// A point of a velocity profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// Time in seconds.
    pub time: f64,
    /// Command at this time, in the unit of the command.
    pub command: f64,
    /// The number, 1 to 4, of the previous point if both are the same; None if the point is distinct.
    pub coincides_with: Option<usize>,
}

/// A section of a velocity profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileSection {
    /// Start and end time, in seconds.
    pub time: [f64; 2],
    /// Command at the start and at the end.
    pub command: [f64; 2],
    /// The number of cycles whose middle is in the section.
    pub cycles: usize,
    /// The largest peak-to-peak value of velocity minus command in one cycle; None without a cycle.
    pub swing: Option<f64>,
    /// The frequencies of the first and the last cycle, in Hz; None without a cycle.
    pub frequency: Option<[f64; 2]>,
}

/// Defines when a velocity oscillates and when it stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileCriterion {
    /// When the velocity oscillates; see [`Criterion`].
    pub oscillation: Criterion,
    /// The largest velocity that counts as standstill, in the unit of the velocity, positive. A cycle that falls to
    /// it, or reverses, is stick-slip.
    pub standstill: f64,
}

impl ProfileCriterion {
    /// The default: a velocity up to half the threshold is standstill.
    pub const fn usual(oscillation: Criterion) -> Self {
        ProfileCriterion { oscillation, standstill: 0.5 * oscillation.threshold }
    }
}

/// Why the velocity profile cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// The run is no velocity profile, or the criterion is unusable with it.
    #[error(transparent)]
    Unreadable(#[from] NoCriticalVelocity),
    /// The samples are too far apart.
    #[error(transparent)]
    Cycles(#[from] CyclesError),
    /// The standstill velocity is not positive.
    #[error("standstill must be positive, got {0}")]
    BadStandstill(f64),
    /// Neither command nor velocity exceeds standstill.
    #[error("{}", motionless(&format_number(*.reached), &format_number(*.standstill)))]
    Motionless {
        /// The largest velocity that counts as standstill.
        standstill: f64,
        /// The largest absolute value of command and velocity.
        reached: f64,
    },
}

impl ProfileError {
    /// The message with velocities in `unit`, formatted for people.
    pub fn message_in(self, unit: &str) -> String {
        match self {
            ProfileError::Unreadable(reason) => reason.message_in(unit),
            ProfileError::Motionless { standstill, reached } => {
                motionless(&format_quantity(reached, unit), &format_quantity(standstill, unit))
            }
            error => error.to_string(),
        }
    }
}

/// The message of [`ProfileError::Motionless`], from formatted velocities.
fn motionless(reached: &str, standstill: &str) -> String {
    format!("the run reaches only {reached}, and velocities up to {standstill} count as standstill")
}

/// Locates the points and sections of a velocity profile in one ramp of a run.
///
/// The rising ramp goes from the start of the run to the command of largest absolute value, in either direction. The
/// falling ramp goes from there to a change of sign of the command. The rest of the run is ignored.
///
/// * Point 1: the velocity first exceeds standstill. Within a window it must exceed the command by more than the
///   threshold.
/// * Section A: from point 1 to point 2. It includes two kinds of cycles that are no oscillation. The first kind
///   follows the jump, and each cycle is smaller than 0.9 of the previous one until the velocity follows the command
///   for four windows. The second kind lasts for less than four windows before the velocity follows the command again.
/// * Point 2: the start of the first cycle of the oscillation. It coincides with point 1 if the velocity does not
///   follow the command for four windows in between.
/// * Points 3 and 4: the start of the first, and the end of the last, three consecutive cycles that reach standstill.
/// * Point 5: the rising critical velocity, see [`critical_velocity`](super::critical_velocity()).
/// * Without stick-slip, section B ends and section D starts in the middle of the cycle with the largest swing.
///
/// The falling ramp is read backward in time. Point 5, the falling critical velocity, is then the earliest. At point
/// 1 the slideway comes to rest after a last slip. This slip belongs to the oscillation unless smooth sliding came
/// before. A falling ramp has no ringing.
///
/// # Errors
/// If the slices do not form signals, or threshold, window or standstill are unusable with the run. Also if a cycle has
/// fewer than eight samples, or the command does not follow that ramp.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::{AbsenceReason, Criterion, ProfileCriterion, RampDirection};
/// use patchcord_analysis::instruments::velocity_profile;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // The command rises by 0.5 per second to 3. The velocity oscillates at 50 Hz from t = 2 s to 4 s.
/// let time: Vec<f64> = (0..6001).map(|index| 1e-3 * f64::from(index)).collect();
/// let command: Vec<f64> = time.iter().map(|t| 0.5 * t).collect();
/// let swing = |t: f64| if (2.0..4.0).contains(&t) { 0.3 * (100.0 * std::f64::consts::PI * t).sin() } else { 0.0 };
/// let velocity: Vec<f64> = time.iter().map(|t| 0.5 * t + swing(*t)).collect();
///
/// let criterion = ProfileCriterion::usual(Criterion { threshold: 0.1, window: 0.04 });
/// let profile = velocity_profile(&time, &command, &velocity, criterion, RampDirection::Rising)?;
/// let [breaks_away, begins, sticks, _, ends] = profile.points;
/// assert!((begins?.command - 1.0).abs() < 0.02 && (ends?.command - 2.0).abs() < 0.02);
/// assert_eq!(breaks_away, Err(AbsenceReason::NoJump));
/// assert_eq!(sticks, Err(AbsenceReason::NoStickSlip));
/// # Ok(())
/// # }
/// ```
pub fn velocity_profile(
    time: &[f64],
    command: &[f64],
    velocity: &[f64],
    criterion: ProfileCriterion,
    direction: RampDirection,
) -> Result<VelocityProfile, ProfileError> {
    let standstill = criterion.standstill;
    if !(standstill > 0.0 && standstill.is_finite()) {
        return Err(ProfileError::BadStandstill(standstill));
    }
    Ok(RampReader::new(time, command, velocity, criterion, direction)?.profile())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::instruments::sampled;

    const CRITERION: ProfileCriterion = ProfileCriterion::usual(Criterion { threshold: 0.1, window: 0.04 });

    /// A rising profile. The command rises by 0.5 per second to 3. The velocity sticks up to 0.1, jumps to 0.6 and
    /// rings about the command. An oscillation at 50 Hz is added, with the amplitude `height(command)`. `sign`
    /// mirrors it all.
    fn read(sign: f64, height: impl Fn(f64) -> f64) -> Result<VelocityProfile, ProfileError> {
        let (time, command) = sampled(12_001, 5e-4, |t| sign * 0.5 * t);
        let (_, velocity) = sampled(12_001, 5e-4, |t| sign * velocity(t, &height));
        velocity_profile(&time, &command, &velocity, CRITERION, RampDirection::Rising)
    }

    fn velocity(t: f64, height: impl Fn(f64) -> f64) -> f64 {
        let rings = |t: f64| 0.5 * (-30.0 * t).exp() * (TAU * 50.0 * t).cos();
        let swing = height(0.5 * t) * (TAU * 50.0 * t).sin();
        if t < 0.2 { 0.0 } else { 0.5 * t + rings(t - 0.2) + swing }
    }

    /// The same reversed in time, after 6 s of smooth sliding.
    fn read_back(sign: f64, height: impl Fn(f64) -> f64) -> VelocityProfile {
        let back = |t: f64| (12.0 - t).min(6.0);
        let (time, command) = sampled(24_001, 5e-4, |t| sign * 0.5 * t.min(back(t)));
        let (_, velocity) =
            sampled(24_001, 5e-4, |t| sign * if t < 6.0 { 0.5 * t } else { velocity(back(t), &height) });
        velocity_profile(&time, &command, &velocity, CRITERION, RampDirection::Falling).unwrap()
    }

    /// An amplitude that grows from command 0.5 on, exceeds the command from 0.9 to 1.6, and is 0 from 2 on.
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
    fn a_complete_profile_has_all_points_and_sections() {
        let profile = read(1.0, whole).unwrap();
        near(commands(&profile), &[0.1, 0.51, 0.8, 1.6, 1.99], 0.02);
        assert!(profile.points.iter().all(|point| point.unwrap().coincides_with.is_none()), "{profile:?}");
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
    fn a_mirrored_run_gives_the_mirrored_profile() {
        let [forward, backward] = [1.0, -1.0].map(|sign| read(sign, whole).unwrap());
        near(commands(&backward), &commands(&forward).map(|command| -command), 1e-9);
        assert_eq!(backward.jump, forward.jump.map(|jump| -jump));
    }

    #[test]
    fn a_command_may_start_with_the_opposite_sign() {
        let (time, command) = sampled(8001, 1e-3, |t| 0.5 * t - 1.0);
        let (_, velocity) =
            sampled(8001, 1e-3, |t| 0.5 * t - 1.0 + if t < 1.0 { (TAU * 50.0 * t).sin() } else { 0.0 });
        let profile = velocity_profile(&time, &command, &velocity, CRITERION, RampDirection::Rising).unwrap();
        near([profile.points[4].unwrap().command], &[-0.5], 0.02);
    }

    #[test]
    fn stick_slip_from_the_beginning_makes_points_coincide() {
        let profile = read(1.0, |command| if command < 1.0 { command + 0.2 } else { 0.0 }).unwrap();
        let coincide = profile.points.map(|point| point.unwrap().coincides_with);
        assert_eq!(coincide, [None, Some(1), Some(2), None, Some(4)]);
        let absent = profile.sections.map(|section| section.err());
        let empty = |one, other| Some(AbsenceReason::Coincide(one, other));
        assert_eq!(absent, [empty(1, 2), empty(2, 3), None, empty(4, 5)]);
    }

    #[test]
    fn on_the_falling_ramp_the_same_points_are_in_reverse_order() {
        for sign in [1.0, -1.0] {
            let profile = read_back(sign, whole);
            near(commands(&profile).map(|command| sign * command), &[0.1, 0.52, 0.8, 1.6, 2.0], 0.02);
            for point in profile.points.map(Result::unwrap) {
                near([12.0 - 2.0 * sign * point.command], &[point.time], 1e-6);
            }
            near(profile.jump, &[sign * 0.6], 0.02);
            let sections = profile.sections.map(|section| section.unwrap());
            for (section, [begin, end]) in sections.iter().zip([[1, 0], [2, 1], [3, 2], [4, 3]]) {
                near(section.command, &[commands(&profile)[begin], commands(&profile)[end]], 1e-12);
                assert!(section.time[0] < section.time[1]);
            }
            near(sections[2].swing, &[3.6], 0.02);
        }
    }

    #[test]
    fn on_the_falling_ramp_stick_slip_down_to_rest_makes_points_coincide() {
        let profile = read_back(1.0, |command| if command < 1.0 { command + 0.2 } else { 0.0 });
        assert_eq!(
            profile.points.map(|point| point.unwrap().coincides_with),
            [None, Some(1), Some(2), None, Some(4)]
        );
        near([profile.points[0].unwrap().time, profile.points[4].unwrap().time], &[11.8, 10.0], 0.05);
    }

    #[test]
    fn missing_points_of_the_falling_ramp_have_a_reason() {
        let absent = |height: &dyn Fn(f64) -> f64| read_back(1.0, height).points.map(|point| point.err());
        let quiet = Some(AbsenceReason::NoOscillation);
        assert_eq!(absent(&|_| 0.0), [None, quiet, quiet, quiet, quiet]);
        let before = absent(&|command| if command > 2.0 { 0.2 } else { 0.0 });
        let no = Some(AbsenceReason::NoStickSlip);
        assert_eq!(before, [None, None, no, no, Some(AbsenceReason::NotBegun)]);
        // The run ends during oscillation, or during sliding.
        let cut = |height: fn(f64) -> f64| {
            let (time, command) = sampled(10_001, 5e-4, |t| 0.5 * (6.0 - t));
            let (_, velocity) = sampled(10_001, 5e-4, |t| velocity(6.0 - t, height));
            velocity_profile(&time, &command, &velocity, CRITERION, RampDirection::Falling).unwrap()
        };
        let continues = cut(|command| if command < 2.0 { command + 0.2 } else { 0.0 });
        let (no_rest, on) = (Some(AbsenceReason::NoRest), Some(AbsenceReason::NotEnded));
        assert_eq!(continues.points.map(|point| point.err()), [no_rest, on, on, None, None]);
        let absent = [Some(AbsenceReason::NoPoint(2)), Some(AbsenceReason::NoPoint(3)), None];
        assert_eq!(continues.sections.map(|section| section.err())[..3], absent);
        let slides = cut(|command| if (1.0..2.0).contains(&command) { 0.3 } else { 0.0 });
        assert_eq!(slides.points.map(|point| point.err()), [no_rest, None, no, no, None]);
        let short = Some(AbsenceReason::TooShort);
        let begins = cut(|command| if command < 0.55 { command + 0.2 } else { 0.0 });
        assert_eq!(begins.points.map(|point| point.err()), [no_rest, short, short, short, short]);
        let bout = cut(|command| if (1.5..1.53).contains(&command) { 0.3 } else { 0.0 });
        assert_eq!(bout.points.map(|point| point.err()), [no_rest, quiet, quiet, quiet, quiet]);
    }

    #[test]
    fn bouts_separated_by_steady_sliding_are_not_added() {
        // Three cycles every half second.
        let bouts = |command: f64| if (4.0 * command).fract() < 0.12 { 0.3 } else { 0.0 };
        let rings = Some(AbsenceReason::RingsOnly);
        assert_eq!(
            read(1.0, bouts).unwrap().points.map(|point| point.err()),
            [None, rings, rings, rings, rings]
        );
        // Two cycles reach standstill before steady sliding, two after it.
        let parted = |command: f64| match command {
            0.98..1.0 | 1.2..1.22 => command + 0.2,
            0.5..0.98 | 1.22..1.7 => 0.2,
            _ => 0.0,
        };
        let profile = read(1.0, parted).unwrap();
        assert_eq!(profile.points[2], Err(AbsenceReason::NoStickSlip));
        near([1, 4].map(|index| profile.points[index].unwrap().command), &[0.5, 1.7], 0.02);
    }

    #[test]
    fn without_stick_slip_sections_b_and_d_meet_at_the_largest_swing() {
        let profile = read(1.0, |command| 0.4 * (1.0 - ((command - 1.5) / 0.5).powi(2)).max(0.0)).unwrap();
        let absent = profile.points.map(|point| point.err());
        assert_eq!(
            absent,
            [None, None, Some(AbsenceReason::NoStickSlip), Some(AbsenceReason::NoStickSlip), None]
        );
        let [_, grows, sticks, dies] = profile.sections;
        near([grows.unwrap().command[1], dies.unwrap().command[0]], &[1.5, 1.5], 0.02);
        assert_eq!(sticks, Err(AbsenceReason::NoStickSlip));
    }

    #[test]
    fn missing_points_of_the_rising_ramp_have_a_reason() {
        let absent = |height: &dyn Fn(f64) -> f64| read(1.0, height).unwrap().points.map(|point| point.err());
        let rings = Some(AbsenceReason::RingsOnly);
        assert_eq!(absent(&|_| 0.0), [None, rings, rings, rings, rings]);
        let continues = absent(&|command| if command > 1.0 { command + 0.2 } else { 0.0 });
        assert_eq!(
            continues,
            [None, None, None, Some(AbsenceReason::NotEnded), Some(AbsenceReason::NotEnded)]
        );
        let (time, command) = sampled(6001, 1e-3, |t| 0.5 * t);
        let of = |velocity: &[f64]| {
            velocity_profile(&time, &command, velocity, CRITERION, RampDirection::Rising).unwrap()
        };
        assert_eq!(of(&vec![0.0; 6001]).points, [Err(AbsenceReason::Sticks); 5]);
        let late: Vec<f64> =
            time.iter().map(|t| 0.5 * t + if *t < 5.9 { 0.0 } else { (TAU * 50.0 * t).sin() }).collect();
        assert_eq!(of(&late).points[1..], [Err(AbsenceReason::TooShort); 4]);
        let follows = of(&command);
        assert_eq!(
            (follows.points[0], follows.points[4]),
            (Err(AbsenceReason::NoJump), Err(AbsenceReason::NoOscillation))
        );
        assert_eq!(follows.sections[0].unwrap().command, [0.0, 3.0]);
    }

    #[test]
    fn unusable_runs_return_errors() {
        let (time, command) = sampled(6001, 1e-3, |t| 0.5 * t);
        let with = |command: &[f64], criterion| {
            velocity_profile(&time, command, &vec![0.0; 6001], criterion, RampDirection::Rising)
        };
        let error = |command: &[f64]| with(command, CRITERION).unwrap_err();
        assert_eq!(error(&vec![1.0; 6001]), ProfileError::Unreadable(NoCriticalVelocity::Constant));
        let falls: Vec<f64> = command.iter().map(|value| 3.0 - value).collect();
        assert_eq!(error(&falls), ProfileError::Unreadable(NoCriticalVelocity::NoRise));
        assert_eq!(error(&command[1..]), ProfileError::Unreadable(NoCriticalVelocity::NotASignal));
        let still = |standstill| with(&command, ProfileCriterion { standstill, ..CRITERION }).unwrap_err();
        assert_eq!(still(0.0), ProfileError::BadStandstill(0.0));
        assert!(matches!(still(f64::NAN), ProfileError::BadStandstill(_)));
        assert_eq!(still(3.0), ProfileError::Motionless { standstill: 3.0, reached: 3.0 });
        assert!(with(&command, ProfileCriterion { standstill: 2.9, ..CRITERION }).is_ok());
    }
}
