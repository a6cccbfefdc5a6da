//! The velocity profile of a slideway: points 1 to 5 and sections A to D of the thesis (4.5, Fig 4.8).
//!
//! A command rises slowly from rest and may fall back. The profile locates breaking away, the beginning and end of
//! oscillation and of stick-slip (`points`), and describes what happens between them (`sections`).
//! Both ramps use the same code: `ramp` mirrors and reverses the run first.

mod missing_point_error;
mod points;
mod ramp;
mod ramp_direction;
mod sections;

pub use missing_point_error::MissingPointError;
pub use ramp_direction::RampDirection;

use super::critical_velocity::{Criterion, CriticalVelocityError};
use super::cycles::CyclesError;
use crate::format::format_quantity;
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
    pub points: [Result<ProfilePoint, MissingPointError>; 5],
    /// Sections A to D between the points, or why a section is missing.
    ///
    /// * Section A: smooth sliding after the jump.
    /// * Section B: oscillation that grows; falling, it decays.
    /// * Section C: stick-slip.
    /// * Section D: oscillation that decays; falling, it grows.
    pub sections: [Result<ProfileSection, MissingPointError>; 4],
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
#[non_exhaustive]
pub enum ProfileError {
    /// The run is no velocity profile, or the criterion is unusable with it.
    #[error(transparent)]
    Unreadable(#[from] CriticalVelocityError),
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
/// use patchcord_analysis::instruments::{Criterion, MissingPointError, ProfileCriterion, RampDirection};
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
/// assert_eq!(breaks_away, Err(MissingPointError::NoJump));
/// assert_eq!(sticks, Err(MissingPointError::NoStickSlip));
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
mod tests;
