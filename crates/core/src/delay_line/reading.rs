//! Reads the output of a delay line: voltages and slopes at delayed times.
//!
//! A reader finds the samples around the delayed time and evaluates the cubic through them. Sequential reads keep the
//! last curve and the last position, which makes them faster.

use super::curve::{CachedSegment, Curve, CurveNodes, NextNode};
use super::{DelayLine, JUMP_TOLERANCE, Sample};
use crate::divided_differences::newton_coefficients;

/// Number of samples that are tested in turn before a binary search.
const MAX_PROBES: usize = 4;

/// The output of a line, in a form that shows how it depends on the line's settings.
#[derive(Debug, Clone, Copy)]
pub(crate) enum DelayOutput {
    /// The initial voltage: no input has arrived yet.
    Initial,
    /// A past input, in volts, and its slope in volts per second.
    Arrived(f64, f64),
}

impl DelayLine {
    /// The output at `time`; at a jump, the voltage after it.
    pub(crate) fn right_limit(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.volts(self.past.partition_point(|sample| sample.time <= wanted + self.time_tolerance), wanted)
    }

    /// The output at `time`; at a jump, the voltage before it.
    pub(crate) fn left_limit(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.volts(self.past.partition_point(|sample| sample.time < wanted - self.time_tolerance), wanted)
    }

    /// The same as [`right_limit`](DelayLine::right_limit), faster if `time` is close to the last time that was read.
    pub(crate) fn next_right_limit(&mut self, time: f64) -> f64 {
        let (wanted, time_tolerance) = (time - self.delay, self.time_tolerance);
        self.read(wanted, |time| time <= wanted + time_tolerance)
    }

    /// The same as [`left_limit`](DelayLine::left_limit), faster if `time` is close to the last time that was read.
    pub(crate) fn next_left_limit(&mut self, time: f64) -> f64 {
        let (wanted, time_tolerance) = (time - self.delay, self.time_tolerance);
        self.read(wanted, |time| time < wanted - time_tolerance)
    }

    /// The output at `time` with its slope; at a jump, the values after it.
    pub(crate) fn output(&self, time: f64) -> DelayOutput {
        let wanted = time - self.delay;
        match self.past.partition_point(|sample| sample.time <= wanted + self.time_tolerance) {
            0 => DelayOutput::Initial,
            after => DelayOutput::Arrived(self.volts(after, wanted), self.slope(after, wanted)),
        }
    }

    /// The slope of the output just after `time`, in volts per second.
    pub(crate) fn right_slope(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.slope(self.past.partition_point(|sample| sample.time <= wanted + self.time_tolerance), wanted)
    }

    /// The slope of the output just before `time`, in volts per second.
    pub(crate) fn left_slope(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.slope(self.past.partition_point(|sample| sample.time < wanted - self.time_tolerance), wanted)
    }

    /// Whether the output jumps at `time`.
    pub(crate) fn has_jump_at(&self, time: f64) -> bool {
        let (before, after) = (self.left_limit(time), self.right_limit(time));
        (after - before).abs() > JUMP_TOLERANCE * (1.0 + after.abs())
    }

    /// The voltage at the input time `wanted`, which is before the sample `after` and not before the sample in front
    /// of it.
    fn volts(&self, after: usize, wanted: f64) -> f64 {
        let horizon = self.horizon(wanted);
        match after {
            0 => self.initial,
            _ if self.is_after(after, horizon) => self.past[after - 1].volts,
            _ => self.curve(self.around(after, horizon)).value(wanted),
        }
    }

    /// The latest input time that the output at `wanted` may depend on. A curve uses only samples before it, so the
    /// output is the same before and after a sample is stored.
    fn horizon(&self, wanted: f64) -> f64 {
        wanted + self.delay - self.time_tolerance
    }

    /// Whether there is no sample with this index before the horizon.
    fn is_after(&self, index: usize, horizon: f64) -> bool {
        self.past.get(index).is_none_or(|sample| sample.time >= horizon)
    }

    /// The slope at the input time `wanted`; 0 before the first sample.
    fn slope(&self, after: usize, wanted: f64) -> f64 {
        if after == 0 {
            return 0.0;
        }
        let horizon = self.horizon(wanted);
        let after = if self.is_after(after, horizon) { after - 1 } else { after };
        self.curve(self.around(after, horizon)).slope(wanted)
    }

    /// The voltage at the input time `wanted`. `is_before` says which sample times count as before it.
    fn read(&mut self, wanted: f64, is_before: impl Fn(f64) -> bool) -> f64 {
        if let Some(segment) = &self.segment
            && is_before(segment.from)
            && !is_before(segment.until)
        {
            return segment.curve.value(wanted);
        }
        self.search_start = self.count(is_before);
        let horizon = self.horizon(wanted);
        if self.search_start == 0 || self.is_after(self.search_start, horizon) {
            return self.volts(self.search_start, wanted);
        }
        let nodes = self.around(self.search_start, horizon);
        let curve = self.curve(nodes);
        let [from, until] = [self.search_start - 1, self.search_start].map(|at| self.past[at].time);
        self.segment = nodes.is_final.then_some(CachedSegment { from, until, curve });
        curve.value(wanted)
    }

    /// The number of samples for which `is_before` holds. It is mostly one or two more than in the last call.
    fn count(&self, is_before: impl Fn(f64) -> bool) -> usize {
        let is_before = |sample: &Sample| is_before(sample.time);
        let start = self.search_start.min(self.past.len());
        if start == 0 || is_before(&self.past[start - 1]) {
            let is_end = |index: &usize| self.past.get(*index).is_none_or(|sample| !is_before(sample));
            let found = (start..start + MAX_PROBES).find(is_end);
            if let Some(found) = found {
                return found;
            }
        }
        self.past.partition_point(is_before)
    }

    /// The four samples around the pair that ends at `after`, or fewer if the smooth piece or the horizon ends
    /// earlier.
    fn around(&self, after: usize, horizon: f64) -> CurveNodes {
        let (mut first, mut last) = (after.saturating_sub(1), after);
        let mut nodes = CurveNodes::pair(first, last);
        for _ in 0..2 {
            if nodes.count == 4 {
                break;
            }
            if let Some(before) = self.node_before(first).filter(|_| nodes.count < 4) {
                first = before;
                nodes.add(before);
            }
            match self.node_after(last, horizon) {
                NextNode::Found(next) if nodes.count < 4 => {
                    last = next;
                    nodes.add(next);
                }
                NextNode::Pending => nodes.is_final = false,
                _ => {}
            }
        }
        nodes
    }

    /// The next usable sample before `first` on the same smooth piece.
    fn node_before(&self, first: usize) -> Option<usize> {
        let mut node = first;
        while node > 0 && !self.past[node].is_discontinuous {
            node -= 1;
            if self.past[first].time - self.past[node].time > self.min_spacing {
                return Some(node);
            }
        }
        None
    }

    /// The next usable sample after `last` on the same smooth piece.
    fn node_after(&self, last: usize, horizon: f64) -> NextNode {
        let mut node = last;
        while !self.past[node].is_discontinuous {
            node += 1;
            if self.is_after(node, horizon) {
                return NextNode::Pending;
            }
            if self.past[node].time - self.past[last].time > self.min_spacing {
                return NextNode::Found(node);
            }
        }
        NextNode::PieceEnds
    }

    /// The polynomial through these samples.
    fn curve(&self, nodes: CurveNodes) -> Curve {
        let mut curve = Curve { times: [0.0; 4], coefficients: [0.0; 4] };
        for (index, node) in nodes.indices[..nodes.count].iter().enumerate() {
            (curve.times[index], curve.coefficients[index]) = (self.past[*node].time, self.past[*node].volts);
        }
        newton_coefficients(&curve.times, &mut curve.coefficients[..nodes.count]);
        curve
    }
}
