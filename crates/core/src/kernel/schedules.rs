//! Tables that are looked up at time.
//!
//! They are the same in every lane. Within a step a table is one straight segment, the one at the middle of the step.
//! So a step may end exactly on a corner, and no stage of it reads the segment beyond.

use super::Kernel;
use super::frame::Frame;
use super::lane::Lane;
use crate::delay_line::DelayLine;
use crate::ir::segment_after;

/// A table with its segment in the present step.
#[derive(Debug, Clone)]
pub(super) struct Schedule {
    /// Index of the table.
    table: u32,
    /// Number of points of the table before the segment.
    after: usize,
    /// Time at which the segment begins, in problem seconds; -infinity before the first point.
    from: f64,
    /// Time at which the segment ends, in problem seconds; infinity after the last point.
    until: f64,
    /// The segment: ordinate + slope x (time - origin), with the slope in units of the table per second.
    slope: f64,
    /// Time of the point at which the segment begins.
    origin: f64,
    /// Value at the origin, in units of the table.
    ordinate: f64,
}

impl Schedule {
    /// A table without a segment yet.
    pub(super) fn of(table: u32) -> Self {
        Schedule { table, after: 0, from: f64::NAN, until: f64::NAN, slope: 0.0, origin: 0.0, ordinate: 0.0 }
    }

    /// Switches to the segment at a time, unless the present one applies.
    #[inline(always)]
    fn move_to(&mut self, tables: &[Vec<[f64; 2]>], time: f64) {
        let is_current = self.from <= time && time < self.until;
        if !is_current {
            self.find(&tables[self.table as usize], time);
        }
    }

    /// Finds the segment at a time. It is not inlined, because it runs rarely: a segment applies to many steps and to
    /// all lanes.
    #[inline(never)]
    fn find(&mut self, points: &[[f64; 2]], time: f64) {
        let is_after = |point: &[f64; 2]| point[0] <= time;
        // It is mostly the next one.
        let next = self.after + 1;
        let is_next = points.get(next - 1).is_some_and(is_after) && !points.get(next).is_some_and(is_after);
        self.after = if is_next { next } else { points.partition_point(is_after) };
        self.from = points[..self.after].last().map_or(f64::NEG_INFINITY, |point| point[0]);
        self.until = points.get(self.after).map_or(f64::INFINITY, |point| point[0]);
        (self.ordinate, self.slope, self.origin) = segment_after(points, self.after);
    }

    /// The value of the segment at a time.
    #[inline(always)]
    fn at<V: Lane>(&self, time: V) -> V {
        let [ordinate, slope, origin] = [self.ordinate, self.slope, self.origin].map(V::splat);
        ordinate.add(slope.multiply(time.subtract(origin)))
    }

    /// Whether the segment ends at a time or before it.
    pub(super) fn has_ended_by(&self, time: f64) -> bool {
        self.until <= time
    }
}

impl Kernel {
    /// Switches all tables to the segments at a time. Before a step this is the time of its middle.
    #[inline(always)]
    pub(super) fn select_pieces<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], time: f64) {
        for schedule in &mut frame.schedules {
            schedule.move_to(tables, time);
        }
    }

    /// Sets the time and the values of the tables on their present segments.
    #[inline(always)]
    pub(super) fn set_time<V: Lane>(&self, frame: &mut Frame<V>, time: V) {
        frame.slots[self.layout.time] = time;
        for (index, schedule) in frame.schedules.iter().enumerate() {
            frame.slots[self.layout.scheduled + index] = schedule.at(time);
        }
    }

    /// Sets the time, the values of the tables there, and the outputs of the delay lines.
    pub(super) fn set_instant<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        time: V,
        output: fn(&mut DelayLine, f64) -> f64,
    ) {
        self.select_pieces(frame, tables, time.get(0));
        self.set_time(frame, time);
        self.set_delayed(frame, time, output);
    }
}

impl Frame<f64> {
    /// Computes the values of the tables in the middle and at the end of a step, for native code.
    #[cfg_attr(not(feature = "native"), allow(dead_code, reason = "only native code needs it"))]
    pub(super) fn compute_scheduled_values(&mut self, tables: &[Vec<[f64; 2]>], [middle, end]: [f64; 2]) {
        let (in_middle, at_end) = self.scheduled_values.split_at_mut(self.schedules.len());
        for (schedule, (first, second)) in self.schedules.iter_mut().zip(in_middle.iter_mut().zip(at_end)) {
            schedule.move_to(tables, middle);
            (*first, *second) = (schedule.at(middle), schedule.at(end));
        }
    }
}
