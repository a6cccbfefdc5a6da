//! What lies between the points of a profile.

use super::super::cycles::Cycle;
use super::points::{Points, Sections};
use super::ramp::Ramp;
use super::{Absent, ProfilePoint, Section};

impl Ramp {
    /// The sections between points, with the cycles before oscillation and those of it.
    pub fn sections(
        &self,
        [first, begins, sticks, slides, ends]: Points,
        before: &[Cycle],
        cycles: &[Cycle],
    ) -> Sections {
        let largest = cycles.iter().max_by(|one, other| one.amplitude.total_cmp(&other.amplitude));
        let largest = largest.map_or(self.finish(), |cycle| 0.5 * (cycle.begin + cycle.end));
        let at =
            |point: Result<ProfilePoint, Absent>, otherwise: f64| point.map_or(otherwise, |point| point.time);
        let of = |cycles: &[Cycle], begin: f64, end: f64| Ok(self.section(cycles, [begin, end]));
        let smooth = match begins {
            Err(_) => Err(Absent::NoPoint(2)),
            _ => apart(begins, 1, 2).and_then(|()| of(before, at(first, self.begin()), at(begins, largest))),
        };
        let grows = match sticks {
            Err(Absent::NotEnded) => Err(Absent::NoPoint(3)),
            _ => apart(sticks, 2, 3).and_then(|()| of(cycles, at(begins, self.begin()), at(sticks, largest))),
        };
        let sticking = match (sticks, slides) {
            (Err(Absent::NoStickSlip), _) => Err(Absent::NoStickSlip),
            _ => of(cycles, at(sticks, self.begin()), at(slides, self.finish())),
        };
        let dies = match slides {
            Err(Absent::NotEnded | Absent::NotBegun) => Err(Absent::NoPoint(4)),
            _ => apart(ends, 4, 5).and_then(|()| of(cycles, at(slides, largest), at(ends, self.finish()))),
        };
        [smooth, grows, sticking, dies]
    }

    pub fn section(&self, cycles: &[Cycle], time: [f64; 2]) -> Section {
        let is_within = |cycle: &&Cycle| (time[0]..time[1]).contains(&(0.5 * (cycle.begin + cycle.end)));
        let cycles: Vec<_> = cycles.iter().filter(is_within).collect();
        let swings = cycles.iter().map(|cycle| 2.0 * cycle.amplitude);
        Section {
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

/// That a point, which is one of two, does not coincide with the one before.
fn apart(point: Result<ProfilePoint, Absent>, one: usize, other: usize) -> Result<(), Absent> {
    match point.ok().and_then(|point| point.coincides) {
        Some(_) => Err(Absent::Coincide(one, other)),
        None => Ok(()),
    }
}
