//! Branches: on which side of every corner the voltages are, and when a watch is hit.
//!
//! The factors depend on the branch. When a voltage crosses a corner, the solver ends the step there and switches to
//! the other branch; the kernel stays the same. Guards and ranges end the validity of the kernel.

use std::ops::Range;

use super::code::Slot;
use super::frame::Frame;
use super::lane::Lane;
use super::{IntervalWatch, Kernel, WatchCondition};
use crate::ir::{KINK_TOLERANCE, Program, segment};
use crate::multiply_add::multiply_add;

/// Distance in volts by which a voltage is moved past a corner to choose the branch behind it.
const BRANCH_DISTANCE: f64 = 10.0 * KINK_TOLERANCE;

/// The margin of a corner's watch at which a step should end. It is past the corner, but not far enough to be a hit.
/// So a voltage that a diode holds at its limit does not count as beyond it.
const CORNER_MARGIN: f64 = 0.5 * KINK_TOLERANCE;

/// A watch that was hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WatchHit {
    /// Index of the watch.
    watch: usize,
    /// The margin of the watch at which the step should end.
    margin: f64,
    /// What was hit.
    pub kind: WatchKind,
}

/// The kind of a watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WatchKind {
    /// A corner: the kernel stays valid beyond it.
    Corner,
    /// A change of mode.
    Guard,
    /// The end of the range in which the kernel is valid.
    Range,
}

impl WatchHit {
    /// The distance, in volts, from the hit within which a step may end. It is 0 if the step must end past the hit.
    pub(crate) fn tolerance(self) -> f64 {
        self.margin
    }
}

impl Kernel {
    /// Evaluates everything at the frame's states and time, on the branch of its voltages, and binds the watches.
    /// Returns whether the kernel is valid there. `is_outdated` says that the factors must be computed again for other
    /// coefficients.
    pub(crate) fn settle(
        &self,
        frame: &mut Frame<f64>,
        program: &Program,
        coefficients: &[f64],
        mut is_outdated: bool,
    ) -> bool {
        if is_outdated {
            frame.branch_cache.clear();
        }
        // A corner may depend on another one. Each round settles at least one of them.
        for _ in 0..self.corners + 2 {
            let are_factors_valid = !is_outdated || self.compute_factors(frame, program, coefficients);
            self.evaluate_present(frame, &program.tables);
            is_outdated = self.bind(frame, &program.tables, 0..self.watches.len());
            if !is_outdated {
                self.update_safe_intervals(frame);
                self.update_margins(frame, self.watches.len());
                return self.accept_present(frame) && are_factors_valid;
            }
        }
        false
    }

    /// Binds watches to the voltages of the last evaluation, and corners to the sides on which these are. Returns
    /// whether a side has changed, so that the factors must be computed again.
    pub(super) fn bind(
        &self,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        watches: Range<usize>,
    ) -> bool {
        watches.fold(false, |any, watch| {
            let value = self.watches[watch].value(&frame.slots);
            self.bind_watch(frame, tables, watch, value) || any
        })
    }

    /// Binds one watch to a voltage. Returns whether the branch has changed.
    ///
    /// Binding sets slope and offset so that the margin slope x voltage + offset is not below 0 on the present side.
    /// The margin of a corner at the corner itself is the kink tolerance, and it is 0 that far beyond.
    fn bind_watch(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], watch: usize, value: f64) -> bool {
        let of = |slot: Slot| frame.slots[slot as usize];
        let branch_values = &mut frame.branch_values;
        let (has_changed, [slope, offset]) = match self.watches[watch].condition {
            WatchCondition::Corner { side } => {
                let (now, slope) = if value >= 0.0 { (1.0, 1.0) } else { (0.0, -1.0) };
                (replace(branch_values, side, [now]), [slope, KINK_TOLERANCE])
            }
            WatchCondition::Points { table, is_above, piece } => {
                let points = &tables[table as usize];
                let (ordinate, slope, origin) = segment(points, value);
                (
                    replace(branch_values, piece, [slope, origin, ordinate]),
                    corner_line(points, value, is_above),
                )
            }
            WatchCondition::Above(low) => (false, [1.0, -of(low)]),
            WatchCondition::Below(high) | WatchCondition::Size(high) => (false, [-1.0, of(high)]),
        };
        frame.slopes[watch] = slope;
        frame.offsets[watch] = offset;
        has_changed
    }

    /// Takes the last evaluation as the present. Returns whether all watches except those of corners are within their
    /// bounds.
    pub(crate) fn accept_present(&self, frame: &mut Frame<f64>) -> bool {
        frame.accept_present();
        for followed in &self.followed[..self.curved_intervals] {
            frame.slots[followed.begin as usize] = frame.slots[followed.slot as usize];
        }
        let outside = self.short(frame, self.corners..self.watches.len()).next();
        outside.is_none()
    }

    /// Computes the safe intervals from the watches that they replace. Each is the part of all voltages in which the
    /// margin of no watch is below 0.
    pub(super) fn update_safe_intervals(&self, frame: &mut Frame<f64>) {
        frame.rows.invalidate_safe_intervals();
        for (index, interval) in self.safe_intervals.iter().enumerate() {
            // The bounds are finite, so an infinite voltage is outside.
            let mut range = [f64::MIN, f64::MAX];
            for IntervalWatch { watch, line } in &interval.watches {
                let of = |slot: Slot| frame.slots[slot as usize];
                let [constant, factor] = line.map_or([0.0, 1.0], |line| line.map(of));
                let [slope, offset] = [&frame.slopes, &frame.offsets].map(|all| all[*watch]);
                // There is no corner beyond the last point of a table.
                if offset == f64::INFINITY {
                    continue;
                }
                // The bound is moved inward by the rounding of the linear function. A hit is then confirmed by the
                // watch itself.
                let rounding = line.map_or(0.0, |_| 4.0 * f64::EPSILON * (constant.abs() + offset.abs()));
                let mut keep = |slope: f64| {
                    range = narrowed(range, slope * factor, multiply_add(slope, constant, offset) - rounding);
                };
                keep(slope);
                if matches!(self.watches[*watch].condition, WatchCondition::Size(_)) {
                    keep(-slope);
                }
            }
            let [low, high] = range;
            frame.lows[index] = low;
            frame.highs[index] = high;
        }
    }

    /// The first watch that was hit in the step ahead.
    ///
    /// Guards come first, because modes may change at a corner. Corners come before ranges, because the kernel gives
    /// wrong voltages beyond a corner.
    pub(crate) fn first_hit(&self, frame: &Frame<f64>) -> Option<WatchHit> {
        let guard = self.short(frame, self.corners..self.thorough.within).next();
        let range = || self.short(frame, self.thorough.within..self.thorough.all).next();
        let watch = guard.or_else(|| self.passed(frame).next()).or_else(range)?;
        let kind = self.kind(watch);
        Some(WatchHit { watch, margin: if kind == WatchKind::Corner { CORNER_MARGIN } else { 0.0 }, kind })
    }

    /// A corner that the frame is on, and that it left on the other side.
    pub(crate) fn passed_corner(&self, frame: &Frame<f64>) -> Option<WatchHit> {
        let is_near = |watch: &usize| frame.present[*watch] <= 3.0 * KINK_TOLERANCE;
        let watch = self.passed(frame).find(is_near)?;
        Some(WatchHit { watch, margin: CORNER_MARGIN, kind: WatchKind::Corner })
    }

    /// The corners that were crossed. If a range was hit as well, a corner counts even within its tolerance, as the
    /// voltages behind it may be wrong.
    fn passed(&self, frame: &Frame<f64>) -> impl Iterator<Item = usize> {
        let ranges = self.thorough.within..self.thorough.all;
        let least = if self.short(frame, ranges).next().is_some() { KINK_TOLERANCE } else { 0.0 };
        (0..self.corners).filter(move |watch| frame.margins[*watch] < least)
    }

    /// The watches with a negative margin, or one that is not a number.
    fn short(&self, frame: &Frame<f64>, of: Range<usize>) -> impl Iterator<Item = usize> {
        of.filter(move |watch| {
            let margin = frame.margins[*watch];
            margin < 0.0 || margin.is_nan()
        })
    }

    /// The kind of a watch, by its position in the list: corners, then guards, then ranges.
    fn kind(&self, watch: usize) -> WatchKind {
        match watch {
            _ if watch < self.corners => WatchKind::Corner,
            _ if watch < self.thorough.within => WatchKind::Guard,
            _ => WatchKind::Range,
        }
    }

    /// How far the step ahead is past a hit; negative before it.
    pub(crate) fn value(&self, frame: &Frame<f64>, hit: WatchHit) -> f64 {
        hit.margin - frame.margins[hit.watch]
    }

    /// How far the present is past a hit; negative before it.
    pub(crate) fn value_now(&self, frame: &Frame<f64>, hit: WatchHit) -> f64 {
        hit.margin - frame.present[hit.watch]
    }

    /// Switches to the other branch of a corner that the frame is on. The caller must evaluate everything again.
    /// Returns whether the factors are valid there.
    pub(crate) fn switch_branch(
        &self,
        frame: &mut Frame<f64>,
        program: &Program,
        coefficients: &[f64],
        hit: WatchHit,
    ) -> bool {
        let [slope, offset] = [&frame.slopes, &frame.offsets].map(|line| line[hit.watch]);
        let voltage = other_side((frame.present[hit.watch] - offset) / slope, slope);
        let watches = match self.watches[hit.watch].condition {
            WatchCondition::Points { is_above, .. } => {
                let lower = hit.watch - usize::from(is_above);
                lower..lower + 2
            }
            _ => hit.watch..hit.watch + 1,
        };
        for watch in watches {
            self.bind_watch(frame, &program.tables, watch, voltage);
        }
        self.update_branch(frame, program, coefficients)
    }
}

/// Replaces branch values from an index on. Returns whether any has changed.
fn replace<const N: usize>(branch_values: &mut [f64], index: u32, new: [f64; N]) -> bool {
    let old = &mut branch_values[index as usize..][..N];
    let has_changed = *old != new;
    old.copy_from_slice(&new);
    has_changed
}

/// A voltage on the other side of a corner, for a watch with this slope. The distance exceeds the rounding of any
/// voltage.
fn other_side(value: f64, slope: f64) -> f64 {
    value - slope * BRANCH_DISTANCE.max(4.0 * f64::EPSILON * value.abs())
}

/// The part of an interval in which slope x + offset is not below 0.
fn narrowed([low, high]: [f64; 2], slope: f64, offset: f64) -> [f64; 2] {
    let edge = -offset / slope;
    // For denormal numbers the quotient is inexact, so the bound is tested.
    let is_beyond = multiply_add(slope, edge, offset) < 0.0;
    match slope {
        slope if slope > 0.0 => [low.max(if is_beyond { edge.next_up() } else { edge }), high],
        slope if slope < 0.0 => [low, high.min(if is_beyond { edge.next_down() } else { edge })],
        _ => [low, high],
    }
}

/// Slope and offset of a watch for the next corner of a table below or above a voltage. The offset is infinite if there
/// is no such corner, so the watch is never hit.
fn corner_line(points: &[[f64; 2]], voltage: f64, is_above: bool) -> [f64; 2] {
    let after = points.partition_point(|point| point[0] <= voltage);
    let corner = if is_above { points.get(after) } else { points[..after].last() };
    match corner {
        Some([corner, _]) if is_above => [-1.0, corner + KINK_TOLERANCE],
        Some([corner, _]) => [1.0, KINK_TOLERANCE - corner],
        None => [1.0, f64::INFINITY],
    }
}

impl super::Watch {
    /// The watched voltage in the slots, or its absolute value for a symmetric range.
    #[inline(always)]
    pub(super) fn value<V: Lane>(&self, slots: &[V]) -> V {
        let value = slots[self.slot as usize];
        if matches!(self.condition, WatchCondition::Size(_)) { value.absolute() } else { value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_a_corner_is_another_number() {
        for value in [0.0, 1e-11, 100.0, -1e9, 1e300] {
            assert!(other_side(value, 1.0) < value && other_side(value, -1.0) > value, "{value}");
        }
        assert_eq!(other_side(0.0, -1.0), BRANCH_DISTANCE);
    }

    #[test]
    fn a_range_ends_before_a_hit_at_0() {
        let just_below = -5e-324;
        assert_eq!(narrowed([-10.0, 10.0], -2.0, just_below), [-10.0, just_below]);
        assert_eq!(narrowed([-10.0, 10.0], 2.0, just_below), [-just_below, 10.0]);
    }
}
