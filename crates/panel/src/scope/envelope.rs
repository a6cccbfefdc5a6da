//! Minimum and maximum of voltages in equal intervals of time.

use std::array;

use super::{CHANNELS, Sample};

/// Minimum and maximum. If there is no value, the minimum is above the maximum.
pub(super) type Extremes = [f64; 2];

/// The extremes of an interval without values.
const EMPTY: Extremes = [f64::INFINITY, f64::NEG_INFINITY];

/// Share of a bucket by which an edge may be missed because of rounding.
const EDGE: f64 = 1e-6;

/// The extremes of voltages in buckets of equal length. Voltages change linearly between samples.
#[derive(Debug, Clone)]
pub(super) struct Envelope {
    /// Time at which the first bucket begins, in seconds.
    left: f64,
    /// Length of a bucket in seconds.
    width: f64,
    /// Number of buckets per second.
    per_second: f64,
    /// Number of buckets up to the last one that a line has reached. Later ones are empty.
    reached: usize,
    /// The extremes of every bucket, for each channel.
    extremes: [Vec<Extremes>; CHANNELS],
}

impl Envelope {
    /// An envelope of empty buckets.
    pub(super) fn new(buckets: usize, left: f64, width: f64) -> Self {
        let extremes = array::from_fn(|_| vec![EMPTY; buckets]);
        Envelope { left, width, per_second: 1.0 / width, reached: 0, extremes }
    }

    /// Empties all buckets and moves them.
    pub(super) fn reset(&mut self, left: f64, width: f64) {
        self.clear();
        self.left = left;
        self.width = width;
        self.per_second = 1.0 / width;
    }

    /// Empties all buckets.
    pub(super) fn clear(&mut self) {
        (0..CHANNELS).for_each(|channel| self.clear_channel(channel));
        self.reached = 0;
    }

    /// Empties the buckets of a channel.
    pub(super) fn clear_channel(&mut self, channel: usize) {
        self.extremes[channel][..self.reached].fill(EMPTY);
    }

    /// Empties the buckets after the one with this time.
    pub(super) fn cut(&mut self, time: f64) {
        let kept = (self.bucket(self.position(time)) + 1).min(self.reached);
        for extremes in &mut self.extremes {
            extremes[kept..self.reached].fill(EMPTY);
        }
        self.reached = kept;
    }

    /// Time at which the first bucket begins, in seconds.
    pub(super) fn left(&self) -> f64 {
        self.left
    }

    /// Time at which the last bucket ends, in seconds.
    pub(super) fn right(&self) -> f64 {
        self.left + self.width * self.count()
    }

    /// Length of a bucket in seconds.
    pub(super) fn width(&self) -> f64 {
        self.width
    }

    /// Number of buckets up to the last one that a line has reached.
    pub(super) fn reached(&self) -> usize {
        self.reached
    }

    /// The extremes of a channel in the buckets that lines have reached.
    pub(super) fn extremes(&self, channel: usize) -> &[Extremes] {
        &self.extremes[channel][..self.reached]
    }

    /// Whether a time is after the last bucket.
    pub(super) fn is_past(&self, time: f64) -> bool {
        self.position(time) > self.count() + EDGE
    }

    /// The number of buckets.
    fn count(&self) -> f64 {
        self.extremes[0].len() as f64
    }

    /// The number of buckets between the left edge and a time.
    fn position(&self, time: f64) -> f64 {
        (time - self.left) * self.per_second
    }

    /// The bucket at a position, or the nearest one. The right edge belongs to the last bucket.
    fn bucket(&self, position: f64) -> usize {
        // The conversion rounds down, and makes 0 from negative positions.
        (position as usize).min(self.extremes[0].len() - 1)
    }

    /// Extends the extremes of a bucket by voltages. Those that are NaN have no effect.
    fn include(&mut self, bucket: usize, volts: &[f64; CHANNELS]) {
        for (extremes, volts) in self.extremes.iter_mut().zip(volts) {
            extremes[bucket] = merged(extremes[bucket], [*volts; 2]);
        }
    }

    /// Adds the straight line between two samples, as far as it is between the edges. The second sample is not the
    /// earlier one. Neighbouring buckets of a line share the voltage at their common edge, so a steep line is closed.
    pub(super) fn add_line(&mut self, from: &Sample, to: &Sample) {
        let count = self.count();
        let [start, end] = [from, to].map(|sample| self.position(sample.time));
        if end < 0.0 || start > count {
            return;
        }
        let [first, last] = [start, end].map(|position| self.bucket(position));
        self.reached = self.reached.max(last + 1);
        if first == last && start >= 0.0 && end <= count {
            self.include(first, &from.volts);
            self.include(first, &to.volts);
            return;
        }
        for bucket in first..=last {
            let ends = [start.max(bucket as f64), end.min((bucket + 1) as f64)];
            for position in ends {
                self.include(bucket, &from.towards(to, (position - start) / (end - start)));
            }
        }
    }

    /// Doubles the length of the buckets until they reach this time.
    pub(super) fn grow_to(&mut self, time: f64) {
        while self.is_past(time) {
            self.double();
        }
    }

    /// Merges buckets in pairs. The buckets then cover twice the time. Their number must be even.
    fn double(&mut self) {
        for extremes in &mut self.extremes {
            let half = extremes.len() / 2;
            for bucket in 0..half {
                extremes[bucket] = merged(extremes[2 * bucket], extremes[2 * bucket + 1]);
            }
            extremes[half..].fill(EMPTY);
        }
        self.width *= 2.0;
        self.per_second = 1.0 / self.width;
        self.reached = self.reached.div_ceil(2);
    }

    /// Adds the extremes of another envelope up to a time. A bucket of the other one counts in every bucket that it
    /// overlaps.
    pub(super) fn add_envelope(&mut self, other: &Envelope, until: f64) {
        let (count, until) = (self.count(), self.position(until));
        if until < 0.0 {
            return;
        }
        for index in 0..other.reached {
            let start = self.position(other.left + index as f64 * other.width) + EDGE;
            let end = (start + other.width * self.per_second).min(until) - 2.0 * EDGE;
            if start >= count.min(until) || end < 0.0 {
                continue;
            }
            let (first, last) = (self.bucket(start), self.bucket(end));
            for bucket in first..=last.max(first) {
                for (own, other) in self.extremes.iter_mut().zip(&other.extremes) {
                    own[bucket] = merged(own[bucket], other[index]);
                }
            }
        }
        self.reached = self.reached.max(self.bucket(until) + 1);
    }
}

/// The extremes of two intervals together.
fn merged(first: Extremes, second: Extremes) -> Extremes {
    [first[0].min(second[0]), first[1].max(second[1])]
}

#[cfg(test)]
mod tests;
