//! Where the points of a profile lie.

use super::super::critical_velocity::NoCriticalVelocity;
use super::super::cycles::Cycle;
use super::ramp::{Beginning, Ramp, bouts};
use super::{Absent, ProfilePoint, Section, Way};

pub(super) type Points = [Result<ProfilePoint, Absent>; 5];
pub(super) type Sections = [Result<Section, Absent>; 4];

/// So many cycles in a row come down to standstill where stick-slip begins and ends: near rest one may by chance.
const IN_A_ROW: usize = 3;

impl Ramp {
    /// Points and sections behind the first point.
    pub fn found(&self, first: Result<ProfilePoint, Absent>) -> (Points, Sections) {
        let beginning = self.beginning(first.ok().map(|point| point.time));
        let (before, oscillating) = self.cycles.split_at(beginning.first);
        match self.why_not(first, &beginning, oscillating) {
            Some(why) => self.without_oscillation(first, &beginning, why),
            None => {
                let points = self.points(first, &beginning, oscillating);
                (points, self.sections(points, before, oscillating))
            }
        }
    }

    /// Why it does not oscillate; nothing where it does.
    fn why_not(
        &self,
        first: Result<ProfilePoint, Absent>,
        beginning: &Beginning,
        oscillating: &[Cycle],
    ) -> Option<Absent> {
        use NoCriticalVelocity::{NotBegun, NotEnded};
        let oscillates = bouts(oscillating).any(|bout| self.lasts(bout));
        let rings = beginning.ringing.is_some_and(|cycles| cycles > 0);
        match (first, self.end) {
            (Err(Absent::Sticks), _) => Some(Absent::Sticks),
            (_, Ok(_) | Err(NotEnded(_) | NotBegun)) if oscillates => None,
            _ if self.way == Way::Rising && rings => Some(Absent::RingsOnly),
            (_, Err(NotEnded(_))) => Some(Absent::TooShort),
            (_, Ok(_)) if self.way == Way::Falling && self.is_cut_off() => Some(Absent::TooShort),
            _ => Some(Absent::Quiet),
        }
    }

    fn without_oscillation(
        &self,
        first: Result<ProfilePoint, Absent>,
        beginning: &Beginning,
        why: Absent,
    ) -> (Points, Sections) {
        let begin = first.map_or(self.begin(), |point| point.time);
        let smooth = beginning.ringing.map(|_| self.section(&self.cycles, [begin, self.finish()])).ok_or(why);
        ([first, Err(why), Err(why), Err(why), Err(why)], [smooth, Err(why), Err(why), Err(why)])
    }

    fn points(&self, first: Result<ProfilePoint, Absent>, beginning: &Beginning, cycles: &[Cycle]) -> Points {
        let begins = self.begins(first, beginning, &cycles[0]);
        let ends = match self.end {
            Ok(time) => Ok(self.point(time)),
            Err(_) => Err(self.way.of([Absent::NotEnded, Absent::NotBegun])),
        };
        let [sticks, slides] = self.stick_slip(cycles, begins, ends);
        let ends = ends.map(|point| {
            let coincides = slides.ok().filter(|slides| slides.time == point.time).map(|_| 4);
            ProfilePoint { coincides, ..point }
        });
        [first, begins, sticks, slides, ends]
    }

    /// Point 2.
    fn begins(
        &self,
        first: Result<ProfilePoint, Absent>,
        beginning: &Beginning,
        cycle: &Cycle,
    ) -> Result<ProfilePoint, Absent> {
        let window = self.criterion.oscillation.window;
        match first {
            // The last slip has no whole cycle of its own.
            Ok(jump)
                if beginning.ringing.is_none()
                    && (self.way == Way::Falling || cycle.begin <= jump.time + window) =>
            {
                Ok(ProfilePoint { coincides: Some(1), ..jump })
            }
            // Backward in time the record begins with what goes on at its end.
            Err(Absent::NoRest) if beginning.ringing.is_none() => Err(Absent::NotEnded),
            _ => Ok(self.point(cycle.begin)),
        }
    }

    /// Points 3 and 4.
    fn stick_slip(
        &self,
        cycles: &[Cycle],
        begins: Result<ProfilePoint, Absent>,
        ends: Result<ProfilePoint, Absent>,
    ) -> [Result<ProfilePoint, Absent>; 2] {
        let sticks = |cycle: &Cycle| cycle.least <= self.criterion.standstill;
        let in_a_row = |row: &[Cycle]| row.iter().all(sticks) && bouts(row).count() == 1;
        let Some(first) = cycles.windows(IN_A_ROW).position(in_a_row) else {
            return [Err(Absent::NoStickSlip); 2];
        };
        let last = cycles.windows(IN_A_ROW).rposition(in_a_row).map_or(first, |row| row + IN_A_ROW - 1);
        let begin = match first {
            0 => begins.map(|begins| ProfilePoint { coincides: Some(2), ..begins }),
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
