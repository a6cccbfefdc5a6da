//! On which sides of the corners the voltages are, and what they may not pass.

use std::ops::Range;

use super::code::Slot;
use super::frame::Frame;
use super::lane::Lane;
use super::{Kernel, Posted, Watched};
use crate::ir::{ON_THE_KINK, Program, segment};

/// So many volts beyond a corner a voltage is on the other side.
const BEYOND: f64 = 10.0 * ON_THE_KINK;

/// So much is left of a corner's watch where a step ends on it: past the corner, by no more than the watch lets pass. What a
/// diode holds back is not beyond its limit then.
const PAST: f64 = 0.5 * ON_THE_KINK;

/// Something met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Met {
    /// Index of the watch.
    watch: usize,
    /// What is left of the watch where it is met.
    rest: f64,
    pub kind: Kind,
}

/// What is met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A corner: the kernel still holds beyond it.
    Corner,
    /// A change of mode.
    Guard,
    /// The end of what a kernel can tell.
    Range,
}

impl Met {
    /// Within so many volts of where it is met a step may end; 0 where it must end past it.
    pub fn room(self) -> f64 {
        self.rest
    }
}

impl Kernel {
    /// Works everything out where a frame is, on the sides of the corners on which its voltages are, and binds it. Tells
    /// whether the kernel holds there. The factors may be due for other coefficients.
    pub fn settle(
        &self,
        frame: &mut Frame<f64>,
        program: &Program,
        coefficients: &[f64],
        mut is_due: bool,
    ) -> bool {
        if is_due {
            frame.known.clear();
        }
        // A corner may lie behind others: one at least is settled in each round.
        for _ in 0..self.corners + 2 {
            let fits = !is_due || self.put_factors(frame, program, coefficients);
            self.show(frame, &program.tables);
            is_due = self.bind(frame, &program.tables, 0..self.watches.len());
            if !is_due {
                self.put_fences(frame);
                self.rest(frame, self.watches.len());
                return self.stand(frame) && fits;
            }
        }
        false
    }

    /// Binds watches to where the voltages are that were worked out last, corners to the sides on which they are. Tells
    /// whether any is on another side than before: the factors have to be worked out again then.
    pub(super) fn bind(
        &self,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        watches: Range<usize>,
    ) -> bool {
        watches.fold(false, |any, watch| {
            let value = self.watches[watch].value(&frame.slots);
            self.bind_one(frame, tables, watch, value) || any
        })
    }

    /// The same of a watch whose voltage is here.
    fn bind_one(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], watch: usize, value: f64) -> bool {
        let of = |slot: Slot| frame.slots[slot as usize];
        let given = &mut frame.given;
        let (is_new, [slope, room]) = match self.watches[watch].what {
            Watched::Corner { side } => {
                let (now, slope) = if value >= 0.0 { (1.0, 1.0) } else { (0.0, -1.0) };
                (replace(given, side, [now]), [slope, ON_THE_KINK])
            }
            Watched::Points { table, above, piece } => {
                let points = &tables[table as usize];
                let (ordinate, slope, origin) = segment(points, value);
                (replace(given, piece, [slope, origin, ordinate]), beside_corner(points, value, above))
            }
            Watched::Above(low) => (false, [1.0, -of(low)]),
            Watched::Below(high) | Watched::Size(high) => (false, [-1.0, of(high)]),
        };
        frame.slopes[watch] = slope;
        frame.rooms[watch] = room;
        is_new
    }

    /// Takes what was worked out last, no step away, as the present. Tells whether all but those that are at a corner
    /// are within their bounds.
    pub fn stand(&self, frame: &mut Frame<f64>) -> bool {
        frame.stand();
        let beyond = self.short(frame, self.corners..self.watches.len()).next();
        beyond.is_none()
    }

    /// Puts the fences where the watches are that they stand for.
    pub(super) fn put_fences(&self, frame: &mut Frame<f64>) {
        frame.rows.forget_fences();
        for (index, fence) in self.fences.iter().enumerate() {
            // What is infinite is within no fence.
            let mut range = [f64::MIN, f64::MAX];
            for Posted { watch, line } in &fence.watches {
                let of = |slot: Slot| frame.slots[slot as usize];
                let [constant, factor] = line.map_or([0.0, 1.0], |line| line.map(of));
                let [slope, room] = [&frame.slopes, &frame.rooms].map(|all| all[*watch]);
                // Beyond its last point a table has no corner.
                if room == f64::INFINITY {
                    continue;
                }
                // By rounding of a line a fence stands rather too near: what is met is told by the watch.
                let rounding = line.map_or(0.0, |_| 4.0 * f64::EPSILON * (constant.abs() + room.abs()));
                let mut keep = |slope: f64| {
                    range = narrowed(range, slope * factor, slope.mul_add(constant, room) - rounding);
                };
                keep(slope);
                if matches!(self.watches[*watch].what, Watched::Size(_)) {
                    keep(-slope);
                }
            }
            let [low, high] = range;
            frame.lows[index] = low;
            frame.highs[index] = high;
        }
    }

    /// What was met on the way to what was looked at: guards first, as modes change at some corners; corners before ranges,
    /// as beyond a corner the kernel tells of voltages that there are none.
    pub fn met(&self, frame: &Frame<f64>) -> Option<Met> {
        let guard = self.short(frame, self.corners..self.thorough.in_middle).next();
        let range = || self.short(frame, self.thorough.in_middle..self.thorough.all).next();
        let watch = guard.or_else(|| self.passed(frame).next()).or_else(range)?;
        let kind = self.kind(watch);
        Some(Met { watch, rest: if kind == Kind::Corner { PAST } else { 0.0 }, kind })
    }

    /// A corner on which the frame is, and that it left on its other side.
    pub fn left_behind(&self, frame: &Frame<f64>) -> Option<Met> {
        let is_near = |watch: &usize| frame.present[*watch] <= 3.0 * ON_THE_KINK;
        let watch = self.passed(frame).find(is_near)?;
        Some(Met { watch, rest: PAST, kind: Kind::Corner })
    }

    /// The corners that were passed; without their room where a range shows what lies beyond one of them.
    fn passed(&self, frame: &Frame<f64>) -> impl Iterator<Item = usize> {
        let ranges = self.thorough.in_middle..self.thorough.all;
        let least = if self.short(frame, ranges).next().is_some() { ON_THE_KINK } else { 0.0 };
        (0..self.corners).filter(move |watch| frame.rests[*watch] < least)
    }

    /// Of some watches those of which less than nothing is left at what was looked at.
    fn short(&self, frame: &Frame<f64>, of: Range<usize>) -> impl Iterator<Item = usize> {
        of.filter(move |watch| {
            let rest = frame.rests[*watch];
            rest < 0.0 || rest.is_nan()
        })
    }

    fn kind(&self, watch: usize) -> Kind {
        match watch {
            _ if watch < self.corners => Kind::Corner,
            _ if watch < self.thorough.in_middle => Kind::Guard,
            _ => Kind::Range,
        }
    }

    /// How far past it what was looked at is; negative before it.
    pub fn excess(&self, frame: &Frame<f64>, met: Met) -> f64 {
        met.rest - frame.rests[met.watch]
    }

    /// The same of the present.
    pub fn excess_now(&self, frame: &Frame<f64>, met: Met) -> f64 {
        met.rest - frame.present[met.watch]
    }

    /// Goes over to the other side of a corner on which the frame is; everything has to be worked out there then. Tells
    /// whether the factors can be used there.
    pub fn cross(&self, frame: &mut Frame<f64>, program: &Program, coefficients: &[f64], met: Met) -> bool {
        let [slope, room] = [&frame.slopes, &frame.rooms].map(|line| line[met.watch]);
        let beyond = beyond((frame.present[met.watch] - room) / slope, slope);
        let watches = match self.watches[met.watch].what {
            Watched::Points { above, .. } => {
                let lower = met.watch - usize::from(above);
                lower..lower + 2
            }
            _ => met.watch..met.watch + 1,
        };
        for watch in watches {
            self.bind_one(frame, &program.tables, watch, beyond);
        }
        self.follow(frame, program, coefficients)
    }
}

/// Replaces numbers from a place on; whether any is another than before.
fn replace<const N: usize>(given: &mut [f64], place: u32, by: [f64; N]) -> bool {
    let old = &mut given[place as usize..][..N];
    let is_new = *old != by;
    old.copy_from_slice(&by);
    is_new
}

/// A voltage on the other side of a corner, of one that stands there and comes down this slope: far enough for it to be
/// another number, however large it is.
fn beyond(value: f64, slope: f64) -> f64 {
    value - slope * BEYOND.max(4.0 * f64::EPSILON * value.abs())
}

/// Of a range of numbers x, those for which slope x + room is not below 0.
fn narrowed([low, high]: [f64; 2], slope: f64, room: f64) -> [f64; 2] {
    let edge = -room / slope;
    // The smallest numbers lose by division what tells them from 0.
    let is_beyond = slope.mul_add(edge, room) < 0.0;
    match slope {
        slope if slope > 0.0 => [low.max(if is_beyond { edge.next_up() } else { edge }), high],
        slope if slope < 0.0 => [low, high.min(if is_beyond { edge.next_down() } else { edge })],
        _ => [low, high],
    }
}

/// Slope and room of a place that must not pass the next corner below or above it.
fn beside_corner(points: &[[f64; 2]], place: f64, above: bool) -> [f64; 2] {
    let after = points.partition_point(|point| point[0] <= place);
    let corner = if above { points.get(after) } else { points[..after].last() };
    match corner {
        Some([corner, _]) if above => [-1.0, corner + ON_THE_KINK],
        Some([corner, _]) => [1.0, ON_THE_KINK - corner],
        None => [1.0, f64::INFINITY],
    }
}

impl super::Watch {
    #[inline(always)]
    pub(super) fn value<V: Lane>(&self, slots: &[V]) -> V {
        let value = slots[self.slot as usize];
        if matches!(self.what, Watched::Size(_)) { value.absolute() } else { value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_a_corner_is_another_number() {
        for value in [0.0, 1e-11, 100.0, -1e9, 1e300] {
            assert!(beyond(value, 1.0) < value && beyond(value, -1.0) > value, "{value}");
        }
        assert_eq!(beyond(0.0, -1.0), BEYOND);
    }

    #[test]
    fn a_range_ends_before_what_is_met_at_0() {
        let just_below = -5e-324;
        assert_eq!(narrowed([-10.0, 10.0], -2.0, just_below), [-10.0, just_below]);
        assert_eq!(narrowed([-10.0, 10.0], 2.0, just_below), [-just_below, 10.0]);
    }
}
