//! Tables looked up at time itself, which give the same in every lane. Within a step each is one straight piece, that which
//! holds in its middle: so a step may end on a corner, and no stage of it sees what comes beyond.

use super::Kernel;
use super::frame::Frame;
use super::lane::Lane;
use crate::delay_line::DelayLine;
use crate::ir::segment_after;

/// A table and the piece of it that holds in the present step.
#[derive(Debug, Clone)]
pub(super) struct Schedule {
    table: u32,
    /// How many points of the table lie before it.
    after: usize,
    /// Between which instants it holds.
    from: f64,
    until: f64,
    slope: f64,
    origin: f64,
    ordinate: f64,
}

impl Schedule {
    /// Of a table, on no piece yet.
    pub fn of(table: u32) -> Self {
        Schedule { table, after: 0, from: f64::NAN, until: f64::NAN, slope: 0.0, origin: 0.0, ordinate: 0.0 }
    }

    /// Goes over to the piece that holds at a time.
    #[inline(always)]
    fn go_to(&mut self, tables: &[Vec<[f64; 2]>], time: f64) {
        let holds = self.from <= time && time < self.until;
        if !holds {
            self.find(&tables[self.table as usize], time);
        }
    }

    // Apart from those who ask: a piece holds for many steps, or for all lanes.
    #[inline(never)]
    fn find(&mut self, points: &[[f64; 2]], time: f64) {
        let is_after = |point: &[f64; 2]| point[0] <= time;
        // Mostly it is the next.
        let next = self.after + 1;
        let is_next = points.get(next - 1).is_some_and(is_after) && !points.get(next).is_some_and(is_after);
        self.after = if is_next { next } else { points.partition_point(is_after) };
        self.from = points[..self.after].last().map_or(f64::NEG_INFINITY, |point| point[0]);
        self.until = points.get(self.after).map_or(f64::INFINITY, |point| point[0]);
        (self.ordinate, self.slope, self.origin) = segment_after(points, self.after);
    }

    /// What it gives at a time, as the table would on this piece.
    #[inline(always)]
    fn at<V: Lane>(&self, time: V) -> V {
        let [ordinate, slope, origin] = [self.ordinate, self.slope, self.origin].map(V::splat);
        ordinate.add(slope.multiply(time.subtract(origin)))
    }

    /// Whether its piece ends by a time.
    pub fn ends_by(&self, time: f64) -> bool {
        self.until <= time
    }
}

impl Kernel {
    /// Goes over to the pieces that hold at a time: that of the middle of a step, before it.
    #[inline(always)]
    pub(super) fn go_to_pieces<V: Lane>(&self, frame: &mut Frame<V>, tables: &[Vec<[f64; 2]>], time: f64) {
        for schedule in &mut frame.schedules {
            schedule.go_to(tables, time);
        }
    }

    /// Puts a time into the slots, and what the tables of time give there on their present pieces.
    #[inline(always)]
    pub(super) fn put_time<V: Lane>(&self, frame: &mut Frame<V>, time: V) {
        frame.slots[self.layout.time] = time;
        for (index, schedule) in frame.schedules.iter().enumerate() {
            frame.slots[self.layout.scheduled + index] = schedule.at(time);
        }
    }

    /// The same on the pieces that hold there, and what the delay lines give.
    pub(super) fn put_instant<V: Lane>(
        &self,
        frame: &mut Frame<V>,
        tables: &[Vec<[f64; 2]>],
        time: V,
        output: fn(&mut DelayLine, f64) -> f64,
    ) {
        self.go_to_pieces(frame, tables, time.get(0));
        self.put_time(frame, time);
        self.put_delayed(frame, time, output);
    }
}

impl Frame<f64> {
    /// Works out for native code what tables of time give in the middle of a step and at its end.
    #[cfg_attr(not(feature = "native"), allow(dead_code, reason = "native code alone is told it"))]
    pub(super) fn put_ahead(&mut self, tables: &[Vec<[f64; 2]>], [middle, end]: [f64; 2]) {
        let (in_middle, at_end) = self.ahead.split_at_mut(self.schedules.len());
        for (schedule, (first, second)) in self.schedules.iter_mut().zip(in_middle.iter_mut().zip(at_end)) {
            schedule.go_to(tables, middle);
            (*first, *second) = (schedule.at(middle), schedule.at(end));
        }
    }
}
