//! Locates the five points of a velocity profile in a ramp.
//!
//! The cycles before the oscillation are removed first. If no oscillation remains, all points after the first have the
//! same reason. Otherwise point 2 is at the first cycle, and point 5 is at the critical velocity. Points 3 and 4 are at
//! the first and the last cycles that reach standstill. All times are transformed times, see `ramp`.

use super::super::critical_velocity::CriticalVelocityError;
use super::super::cycles::Cycle;
use super::ramp::{CycleSplit, RampReader, bouts};
use super::{MissingPointError, ProfilePoint, ProfileSection, RampDirection};

/// Points 1 to 5, or why a point is missing.
pub(super) type Points = [Result<ProfilePoint, MissingPointError>; 5];
/// Sections A to D, or why a section is missing.
pub(super) type Sections = [Result<ProfileSection, MissingPointError>; 4];

/// The number of consecutive cycles that must reach standstill for stick-slip. Near rest a single one may do so by
/// chance.
const STICKING_CYCLES: usize = 3;

impl RampReader {
    /// All points and sections, given the first point.
    pub(super) fn points_with_sections(
        &self,
        first: Result<ProfilePoint, MissingPointError>,
    ) -> (Points, Sections) {
        let split = self.split_cycles(first.ok().map(|point| point.time));
        let (before, oscillating) = self.cycles.split_at(split.first);
        match self.oscillation_error(first, &split, oscillating) {
            Some(why) => self.without_oscillation(first, &split, why),
            None => {
                let points = self.points(first, &split, oscillating);
                (points, self.sections(points, before, oscillating))
            }
        }
    }

    /// Why the ramp has no oscillation; None if it has one.
    ///
    /// The cases are tested in this order: the slideway never slides, there is an oscillation, the velocity only
    /// rings, the record is too short, the velocity does not oscillate.
    fn oscillation_error(
        &self,
        first: Result<ProfilePoint, MissingPointError>,
        split: &CycleSplit,
        oscillating: &[Cycle],
    ) -> Option<MissingPointError> {
        use CriticalVelocityError::{NotBegun, NotEnded};
        let oscillates = bouts(oscillating).any(|bout| self.is_long_enough(bout));
        let rings = split.ringing.is_some_and(|cycles| cycles > 0);
        match (first, self.end) {
            (Err(MissingPointError::Sticks), _) => Some(MissingPointError::Sticks),
            (_, Ok(_) | Err(NotEnded(_) | NotBegun)) if oscillates => None,
            _ if self.direction == RampDirection::Rising && rings => Some(MissingPointError::RingsOnly),
            (_, Err(NotEnded(_))) => Some(MissingPointError::TooShort),
            (_, Ok(_)) if self.direction == RampDirection::Falling && self.is_cut_off() => {
                Some(MissingPointError::TooShort)
            }
            _ => Some(MissingPointError::NoOscillation),
        }
    }

    /// Points and sections of a ramp without oscillation: only point 1 and section A can exist.
    fn without_oscillation(
        &self,
        first: Result<ProfilePoint, MissingPointError>,
        split: &CycleSplit,
        why: MissingPointError,
    ) -> (Points, Sections) {
        let begin = first.map_or(self.begin(), |point| point.time);
        let smooth = split.ringing.map(|_| self.section(&self.cycles, [begin, self.finish()])).ok_or(why);
        ([first, Err(why), Err(why), Err(why), Err(why)], [smooth, Err(why), Err(why), Err(why)])
    }

    /// The five points of a ramp with oscillation. `cycles` are those of the oscillation.
    fn points(
        &self,
        first: Result<ProfilePoint, MissingPointError>,
        split: &CycleSplit,
        cycles: &[Cycle],
    ) -> Points {
        let begins = self.oscillation_point(first, split, &cycles[0]);
        let ends = match self.end {
            Ok(time) => Ok(self.point(time)),
            Err(_) => Err(self.direction.select([MissingPointError::NotEnded, MissingPointError::NotBegun])),
        };
        let [sticks, slides] = self.stick_slip_points(cycles, begins, ends);
        let ends = ends.map(|point| {
            let coincides_with = slides.ok().filter(|slides| slides.time == point.time).map(|_| 4);
            ProfilePoint { coincides_with, ..point }
        });
        [first, begins, sticks, slides, ends]
    }

    /// Point 2. `cycle` is the first cycle of the oscillation.
    fn oscillation_point(
        &self,
        first: Result<ProfilePoint, MissingPointError>,
        split: &CycleSplit,
        cycle: &Cycle,
    ) -> Result<ProfilePoint, MissingPointError> {
        let window = self.criterion.oscillation.window;
        match first {
            // The last slip is not part of a whole cycle.
            Ok(jump)
                if split.ringing.is_none()
                    && (self.direction == RampDirection::Falling || cycle.begin <= jump.time + window) =>
            {
                Ok(ProfilePoint { coincides_with: Some(1), ..jump })
            }
            // A falling ramp is read backward in time, so the end of the record comes first.
            Err(MissingPointError::NoRest) if split.ringing.is_none() => Err(MissingPointError::NotEnded),
            _ => Ok(self.point(cycle.begin)),
        }
    }

    /// Points 3 and 4.
    ///
    /// Stick-slip lasts from the first to the last [`STICKING_CYCLES`] adjoining cycles that reach standstill. Point 3
    /// coincides with point 2 if the first cycle sticks. Point 4 is point 5 if the last cycle sticks.
    fn stick_slip_points(
        &self,
        cycles: &[Cycle],
        begins: Result<ProfilePoint, MissingPointError>,
        ends: Result<ProfilePoint, MissingPointError>,
    ) -> [Result<ProfilePoint, MissingPointError>; 2] {
        let sticks = |cycle: &Cycle| cycle.least <= self.criterion.standstill;
        let in_a_row = |row: &[Cycle]| row.iter().all(sticks) && bouts(row).count() == 1;
        let Some(first) = cycles.windows(STICKING_CYCLES).position(in_a_row) else {
            return [Err(MissingPointError::NoStickSlip); 2];
        };
        let last = cycles
            .windows(STICKING_CYCLES)
            .rposition(in_a_row)
            .map_or(first, |row| row + STICKING_CYCLES - 1);
        let begin = match first {
            0 => begins.map(|begins| ProfilePoint { coincides_with: Some(2), ..begins }),
            _ => Ok(self.point(cycles[first].begin)),
        };
        let end = match ends {
            ends if last + 1 == cycles.len() => ends,
            Ok(ends) if cycles[last].end >= ends.time => Ok(ends),
            _ => Ok(self.point(cycles[last].end)),
        };
        [begin, end]
    }
}
