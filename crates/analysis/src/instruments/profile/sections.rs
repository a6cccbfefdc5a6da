//! The sections A to D between the points of a velocity profile.

use super::super::cycles::Cycle;
use super::points::{Points, Sections};
use super::ramp::RampReader;
use super::{MissingPointError, ProfilePoint, ProfileSection};

impl RampReader {
    /// Sections A to D, from the five points, the cycles before the oscillation and the cycles of the oscillation.
    ///
    /// A missing end point is replaced: by the start or the finish of the ramp, or by the middle of the cycle with the
    /// largest swing where sections B and D meet.
    pub(super) fn sections(
        &self,
        [first, begins, sticks, slides, ends]: Points,
        before: &[Cycle],
        cycles: &[Cycle],
    ) -> Sections {
        let widest = cycles.iter().max_by(|one, other| one.amplitude.total_cmp(&other.amplitude));
        let largest = widest.map_or(self.finish(), |cycle| 0.5 * (cycle.begin + cycle.end));
        let at = |point: Result<ProfilePoint, MissingPointError>, otherwise: f64| {
            point.map_or(otherwise, |point| point.time)
        };
        let of = |cycles: &[Cycle], begin: f64, end: f64| Ok(self.section(cycles, [begin, end]));
        let smooth = match begins {
            Err(_) => Err(MissingPointError::NoPoint(2)),
            _ => check_distinct(begins, 1, 2)
                .and_then(|()| of(before, at(first, self.begin()), at(begins, largest))),
        };
        let grows = match sticks {
            Err(MissingPointError::NotEnded) => Err(MissingPointError::NoPoint(3)),
            _ => check_distinct(sticks, 2, 3)
                .and_then(|()| of(cycles, at(begins, self.begin()), at(sticks, largest))),
        };
        let sticking = match (sticks, slides) {
            (Err(MissingPointError::NoStickSlip), _) => Err(MissingPointError::NoStickSlip),
            _ => of(cycles, at(sticks, self.begin()), at(slides, self.finish())),
        };
        let dies = match slides {
            Err(MissingPointError::NotEnded | MissingPointError::NotBegun) => {
                Err(MissingPointError::NoPoint(4))
            }
            _ => check_distinct(ends, 4, 5)
                .and_then(|()| of(cycles, at(slides, largest), at(ends, self.finish()))),
        };
        [smooth, grows, sticking, dies]
    }

    /// The section between two times. A cycle belongs to it if the middle of the cycle does.
    pub(super) fn section(&self, cycles: &[Cycle], time: [f64; 2]) -> ProfileSection {
        let is_within = |cycle: &&Cycle| (time[0]..time[1]).contains(&(0.5 * (cycle.begin + cycle.end)));
        let cycles: Vec<_> = cycles.iter().filter(is_within).collect();
        let swings = cycles.iter().map(|cycle| 2.0 * cycle.amplitude);
        ProfileSection {
            time,
            command: time.map(|time| self.command(time)),
            cycles: cycles.len(),
            swing: swings.reduce(f64::max),
            frequency: cycles
                .first()
                .zip(cycles.last())
                .map(|(first, last)| [first.frequency, last.frequency]),
        }
    }
}

/// An error if `point`, the second of points `one` and `other`, coincides with the first.
fn check_distinct(
    point: Result<ProfilePoint, MissingPointError>,
    one: usize,
    other: usize,
) -> Result<(), MissingPointError> {
    match point.ok().and_then(|point| point.coincides_with) {
        Some(_) => Err(MissingPointError::Coincide(one, other)),
        None => Ok(()),
    }
}
