//! The memory of a delay line: its past inputs and what it gives back.
//!
//! A line stores samples of its input at the ends of steps. Its output at a time is a cubic through the four samples
//! around the delayed time. The curve never crosses a jump or a corner of the input, so these come out as sharp as
//! they went in.
//!
//! A jump or corner of the input is a discontinuity. It comes out one delay later, and the solver ends a step there.
//! If the output leads back to the input of a delay line, the discontinuity passes through that line again, one
//! derivative smoother each time.

use std::collections::VecDeque;

use crate::divided_differences::newton_coefficients;

/// A sample of the input.
#[derive(Debug, Clone, Copy)]
struct Sample {
    /// Time in problem seconds.
    time: f64,
    /// Voltage of the input.
    volts: f64,
    /// Whether the input has a jump or a corner here. No curve is drawn across it.
    is_discontinuous: bool,
}

/// A jump or corner of the input that has not come out yet.
#[derive(Debug, Clone, Copy)]
struct Discontinuity {
    /// Time at which it went in, in problem seconds.
    time: f64,
    /// How many delay lines it has passed through before. Each pass makes it one derivative smoother.
    passes: u8,
    /// Whether the voltage jumps here.
    is_jump: bool,
}

/// The discontinuities that come out of a line at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Arrival {
    /// The passes of the least smooth one.
    passes: u8,
    /// Whether the voltage jumps at one of them.
    is_jump: bool,
}

/// The past of one input, back to twice the delay.
#[derive(Debug, Clone)]
pub(crate) struct DelayLine {
    /// In problem seconds.
    delay: f64,
    /// Output in volts until the first input arrives.
    initial: f64,
    /// The samples, in order of time. At a jump there are two with the same time.
    past: VecDeque<Sample>,
    /// The discontinuities that have not come out yet, in order of time.
    discontinuities: VecDeque<Discontinuity>,
    /// Times that differ by less than this, in seconds, count as the same.
    time_tolerance: f64,
    /// A curve does not use two samples closer than this, in seconds: the divided differences would amplify their
    /// rounding.
    min_spacing: f64,
    /// Indices of the lines whose output reaches this line's input through anything except other delay lines.
    upstream: Vec<usize>,
    /// The discontinuities that came out last.
    arrived: Option<Arrival>,
    /// The number of samples before the last time that was read: where the next search starts.
    place: usize,
    /// The curve that was read last, if no later sample can change it.
    segment: Option<CachedSegment>,
}

/// Samples stored in addition to those within the delay: the outer points of the cubic, and changes of mode between
/// steps.
const SPARE_SAMPLES: usize = 64;
/// Times that differ by less than this share of a step count as the same.
const SAME_TIME_SHARE: f64 = 1e-9;
/// Least distance between the samples of a curve, as a share of a step. It keeps the rounding error below 1e-11 of the
/// voltage.
const MIN_SPACING_SHARE: f64 = 1e-3;
/// Relative difference between two voltages above which the input jumps. Two ways of computing one voltage differ by
/// less.
const JUMP_TOLERANCE: f64 = 1e-9;
/// Number of samples that are tested in turn before a binary search.
const MAX_PROBES: usize = 4;
/// Passes after which a discontinuity is ignored. Each pass makes it one derivative smoother, and a step of order 4
/// does not notice it after four.
const MAX_PASSES: u8 = 4;

/// Stores the inputs of all lines at the end of a step without jumps. If `is_at_corner`, a table of time has a corner
/// there, and every input counts as discontinuous.
pub(crate) fn record_inputs(
    lines: &mut [DelayLine],
    time: f64,
    volts: impl Iterator<Item = f64> + Clone,
    is_at_corner: bool,
) {
    for (line, volts) in lines.iter_mut().zip(volts.clone()) {
        line.put(time, volts);
        if is_at_corner {
            line.put_discontinuity(time, volts, 0);
        }
    }
    if take_all_arrivals(lines, time).is_some() {
        propagate(lines, time, volts);
    }
}

/// Removes the discontinuities that have come out by `time`. Returns `None` if there were none, otherwise whether one
/// of them is a jump.
pub(crate) fn take_all_arrivals(lines: &mut [DelayLine], time: f64) -> Option<bool> {
    let arrived = lines.iter_mut().filter_map(|line| {
        line.arrived = line.take_arrivals(time);
        line.arrived.map(|arrival| arrival.is_jump)
    });
    arrived.reduce(|any, is_jump| any || is_jump)
}

/// Stores discontinuous inputs at the instant at which discontinuities came out. Only lines downstream of such a line
/// are affected.
pub(crate) fn propagate(lines: &mut [DelayLine], time: f64, volts: impl Iterator<Item = f64>) {
    for (index, volts) in (0..lines.len()).zip(volts) {
        let arrived = lines[index].upstream.iter().filter_map(|other| lines[*other].arrived).min();
        if let Some(arrival) = arrived {
            lines[index].put_discontinuity(time, volts, arrival.passes + 1);
        }
    }
}

/// The output of a line, in a form that shows how it depends on the line's settings.
#[derive(Debug, Clone, Copy)]
pub(crate) enum DelayOutput {
    /// The initial voltage: no input has arrived yet.
    Initial,
    /// A past input, in volts, and its slope in volts per second.
    Arrived(f64, f64),
}

impl DelayLine {
    /// An empty line with capacity for a delay, in problem seconds, at this step length.
    pub fn new(delay: f64, initial: f64, step: f64) -> Self {
        let capacity = (2.0 * delay / step).min(1e7) as usize + SPARE_SAMPLES;
        DelayLine {
            delay,
            initial,
            past: VecDeque::with_capacity(capacity),
            discontinuities: VecDeque::with_capacity(SPARE_SAMPLES),
            time_tolerance: SAME_TIME_SHARE * step,
            min_spacing: MIN_SPACING_SHARE * step,
            upstream: Vec::new(),
            arrived: None,
            place: 0,
            segment: None,
        }
    }

    /// The same line with the indices of the lines upstream.
    pub fn with_upstream(self, upstream: &[usize]) -> Self {
        DelayLine { upstream: upstream.to_vec(), ..self }
    }

    /// The same line with capacity for this many jumps per second and their repeated passes.
    pub fn with_capacity_for(mut self, jump_rate: f64) -> Self {
        let discontinuities = (2.0 * self.delay * jump_rate * f64::from(1 + MAX_PASSES)).min(1e7) as usize;
        self.discontinuities.reserve(discontinuities);
        self.past.reserve(2 * discontinuities);
        self
    }

    /// The delay in problem seconds.
    pub fn delay(&self) -> f64 {
        self.delay
    }

    /// Changes the delay and the initial voltage at `time`; the stored past stays. Discontinuities that would have
    /// come out earlier with the new delay are dropped.
    pub fn set(&mut self, delay: f64, initial: f64, time: f64) {
        (self.delay, self.initial) = (delay, initial);
        self.take_arrivals(time);
    }

    /// Forgets all past inputs, for a new initial condition.
    pub fn clear(&mut self) {
        self.past.clear();
        self.discontinuities.clear();
        self.segment = None;
    }

    /// Appends a sample. A sample at or before the last time is ignored.
    pub fn put(&mut self, time: f64, volts: f64) {
        if self.past.back().is_none_or(|last| last.time < time) {
            self.past.push_back(Sample { time, volts, is_discontinuous: false });
            self.forget(time);
        }
    }

    /// Appends a sample at which the input jumps or has a corner. `passes` is the number of lines that the
    /// discontinuity has passed through.
    pub fn put_discontinuity(&mut self, time: f64, volts: f64, passes: u8) {
        // The initial voltage comes out before the first input, so the first input counts as a jump.
        let begins = self.past.is_empty();
        self.put(time, volts);
        let Some(last) = self.past.back_mut() else { return };
        let is_jump = (last.volts - volts).abs() > JUMP_TOLERANCE * (1.0 + volts.abs());
        last.is_discontinuous = true;
        if is_jump {
            self.past.push_back(Sample { time, volts, is_discontinuous: true });
        }
        if is_jump || passes < MAX_PASSES {
            let passes = if is_jump { 0 } else { passes };
            self.discontinuities.push_back(Discontinuity { time, passes, is_jump: is_jump || begins });
        }
    }

    /// Drops samples older than twice the delay. The reserve permits a longer delay while the machine runs.
    fn forget(&mut self, time: f64) {
        while self.past.get(3).is_some_and(|sample| sample.time <= time - 2.0 * self.delay) {
            self.past.pop_front();
            self.place = self.place.saturating_sub(1);
        }
    }

    /// Time at which the next discontinuity comes out, if that is before `end`.
    pub fn next_arrival_before(&self, end: f64) -> Option<f64> {
        self.discontinuities
            .front()
            .map(|first| first.time + self.delay)
            .filter(|arrival| *arrival < end - self.time_tolerance)
    }

    /// Time at which the next jump comes out.
    pub fn next_jump(&self) -> Option<f64> {
        self.discontinuities.iter().find(|own| own.is_jump).map(|own| own.time + self.delay)
    }

    /// Removes the discontinuities that have come out by `time`. `None` if there were none.
    pub fn take_arrivals(&mut self, time: f64) -> Option<Arrival> {
        let mut arrival: Option<Arrival> = None;
        while let Some(&Discontinuity { passes, is_jump, .. }) =
            self.discontinuities.front().filter(|first| first.time + self.delay <= time + self.time_tolerance)
        {
            arrival = Some(arrival.map_or(Arrival { passes, is_jump }, |known| Arrival {
                passes: known.passes.min(passes),
                is_jump: known.is_jump || is_jump,
            }));
            self.discontinuities.pop_front();
        }
        arrival
    }

    /// The output at `time`; at a jump, the voltage after it.
    pub fn right_limit(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.volts(self.past.partition_point(|sample| sample.time <= wanted + self.time_tolerance), wanted)
    }

    /// The output at `time`; at a jump, the voltage before it.
    pub fn left_limit(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.volts(self.past.partition_point(|sample| sample.time < wanted - self.time_tolerance), wanted)
    }

    /// The same as [`right_limit`](DelayLine::right_limit), faster if `time` is close to the last time that was read.
    pub fn next_right_limit(&mut self, time: f64) -> f64 {
        let (wanted, time_tolerance) = (time - self.delay, self.time_tolerance);
        self.read(wanted, |time| time <= wanted + time_tolerance)
    }

    /// The same as [`left_limit`](DelayLine::left_limit), faster if `time` is close to the last time that was read.
    pub fn next_left_limit(&mut self, time: f64) -> f64 {
        let (wanted, time_tolerance) = (time - self.delay, self.time_tolerance);
        self.read(wanted, |time| time < wanted - time_tolerance)
    }

    /// The output at `time` with its slope; at a jump, the values after it.
    pub fn output(&self, time: f64) -> DelayOutput {
        let wanted = time - self.delay;
        match self.past.partition_point(|sample| sample.time <= wanted + self.time_tolerance) {
            0 => DelayOutput::Initial,
            after => DelayOutput::Arrived(self.volts(after, wanted), self.slope(after, wanted)),
        }
    }

    /// The slope of the output just after `time`, in volts per second.
    pub fn right_slope(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.slope(self.past.partition_point(|sample| sample.time <= wanted + self.time_tolerance), wanted)
    }

    /// The slope of the output just before `time`, in volts per second.
    pub fn left_slope(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        self.slope(self.past.partition_point(|sample| sample.time < wanted - self.time_tolerance), wanted)
    }

    /// Whether the output jumps at `time`.
    pub fn has_jump_at(&self, time: f64) -> bool {
        let (before, after) = (self.left_limit(time), self.right_limit(time));
        (after - before).abs() > JUMP_TOLERANCE * (1.0 + after.abs())
    }

    /// Times that differ by less than this, in seconds, count as the same.
    pub fn time_tolerance(&self) -> f64 {
        self.time_tolerance
    }

    /// Time and voltage of the last sample; `None` if there is none.
    pub fn last(&self) -> Option<(f64, f64)> {
        self.past.back().map(|sample| (sample.time, sample.volts))
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
        self.place = self.count(is_before);
        let horizon = self.horizon(wanted);
        if self.place == 0 || self.is_after(self.place, horizon) {
            return self.volts(self.place, wanted);
        }
        let nodes = self.around(self.place, horizon);
        let curve = self.curve(nodes);
        let [from, until] = [self.place - 1, self.place].map(|at| self.past[at].time);
        self.segment = nodes.is_final.then_some(CachedSegment { from, until, curve });
        curve.value(wanted)
    }

    /// The number of samples for which `is_before` holds. It is mostly one or two more than in the last call.
    fn count(&self, is_before: impl Fn(f64) -> bool) -> usize {
        let is_before = |sample: &Sample| is_before(sample.time);
        let place = self.place.min(self.past.len());
        if place == 0 || is_before(&self.past[place - 1]) {
            let found =
                (place..place + MAX_PROBES).find(|at| self.past.get(*at).is_none_or(|own| !is_before(own)));
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
                NextNode::There(next) if nodes.count < 4 => {
                    last = next;
                    nodes.add(next);
                }
                NextNode::ToCome => nodes.is_final = false,
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
                return NextNode::ToCome;
            }
            if self.past[node].time - self.past[last].time > self.min_spacing {
                return NextNode::There(node);
            }
        }
        NextNode::None
    }

    /// The polynomial through these samples.
    fn curve(&self, nodes: CurveNodes) -> Curve {
        let mut curve = Curve { times: [0.0; 4], coefficients: [0.0; 4] };
        for (place, node) in nodes.indices[..nodes.count].iter().enumerate() {
            (curve.times[place], curve.coefficients[place]) = (self.past[*node].time, self.past[*node].volts);
        }
        newton_coefficients(&curve.times, &mut curve.coefficients[..nodes.count]);
        curve
    }
}

/// A polynomial in Newton's form, with coefficients of 1, (t - t0), (t - t0)(t - t1) and so on.
#[derive(Debug, Clone, Copy)]
struct Curve {
    /// The times of the nodes; only the first three are read.
    times: [f64; 4],
    /// The Newton coefficients in ascending order.
    coefficients: [f64; 4],
}

impl Curve {
    /// The polynomial at a time.
    fn value(&self, time: f64) -> f64 {
        let [from_first, from_second, from_third, _] = self.times.map(|own| time - own);
        let [constant, first, second, third] = self.coefficients;
        constant + from_first * (first + from_second * (second + from_third * third))
    }

    /// The derivative of the polynomial at a time, in volts per second.
    fn slope(&self, time: f64) -> f64 {
        let [a, b, c, _] = self.times.map(|own| time - own);
        let [_, first, second, third] = self.coefficients;
        first + (a + b) * second + (a * b + a * c + b * c) * third
    }
}

/// The curve between two adjacent samples, which no later sample changes.
#[derive(Debug, Clone, Copy)]
struct CachedSegment {
    /// Input time from which the curve applies.
    from: f64,
    /// Input time up to which the curve applies.
    until: f64,
    curve: Curve,
}

/// The result of the search for a further sample of a curve.
enum NextNode {
    /// The sample with this index.
    There(usize),
    /// There is none: the smooth piece ends.
    None,
    /// There is none yet: the horizon comes first.
    ToCome,
}

/// Indices of up to four samples through which a curve is drawn.
#[derive(Debug, Clone, Copy)]
struct CurveNodes {
    indices: [usize; 4],
    /// How many of the indices are used.
    count: usize,
    /// Whether no later sample can change the curve.
    is_final: bool,
}

impl CurveNodes {
    /// The two samples between which the curve is read; one if both are the same.
    fn pair(first: usize, last: usize) -> Self {
        CurveNodes { indices: [first, last, 0, 0], count: if first == last { 1 } else { 2 }, is_final: true }
    }

    fn add(&mut self, index: usize) {
        self.indices[self.count] = index;
        self.count += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrival(passes: u8, is_jump: bool) -> Option<Arrival> {
        Some(Arrival { passes, is_jump })
    }

    #[test]
    fn a_cubic_and_its_slope_are_reproduced() {
        let cubic = |t: f64| 1.0 + t - 2.0 * t * t + 0.5 * t * t * t;
        let slope = |t: f64| 1.0 - 4.0 * t + 1.5 * t * t;
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        (0..=30).for_each(|k| line.put(f64::from(k) * 0.1, cubic(f64::from(k) * 0.1)));
        for t in [3.05, 3.51, 3.77, 3.97] {
            assert!((line.right_limit(t) - cubic(t - 1.0)).abs() < 1e-12, "{t}");
            let DelayOutput::Arrived(volts, found) = line.output(t) else { panic!("{t}") };
            assert!(
                (volts - line.right_limit(t)).abs() < 1e-12 && (found - slope(t - 1.0)).abs() < 1e-11,
                "{t}"
            );
        }
    }

    #[test]
    fn before_the_delay_the_initial_voltage_comes_out() {
        let mut line = DelayLine::new(1.0, 7.0, 0.1);
        line.put_discontinuity(0.0, 3.0, 0);
        line.put(0.1, 3.0);
        assert_eq!((line.right_limit(0.5), line.left_limit(1.0), line.right_limit(1.0)), (7.0, 7.0, 3.0));
    }

    #[test]
    fn a_jump_stays_a_jump() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        [0.0, 0.1, 0.15].iter().for_each(|time| line.put(*time, 1.0));
        line.put_discontinuity(0.15, 5.0, 0);
        [0.2, 0.3].iter().for_each(|time| line.put(*time, 5.0));
        assert_eq!((line.right_limit(1.149), line.right_limit(1.151)), (1.0, 5.0));
        assert_eq!((line.left_limit(1.15), line.right_limit(1.15)), (1.0, 5.0));
    }

    #[test]
    fn a_corner_is_not_rounded() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        let corner = |k: i32| (f64::from(k) * 0.1, f64::from((k - 5).max(0)).powi(3));
        for (time, volts) in (0..=10).map(corner) {
            line.put(time, volts);
            if volts == 0.0 && time > 0.45 {
                line.put_discontinuity(time, volts, 0);
            }
        }
        assert_eq!(line.right_limit(1.45), 0.0);
        assert!((line.right_limit(1.55) - 0.125).abs() < 1e-9);
    }

    #[test]
    fn close_samples_do_not_amplify_rounding() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        for k in 0..20 {
            let time = f64::from(k) * 0.1;
            line.put(time, time);
            line.put(time + 1e-14, time + 5e-14);
        }
        assert!(
            (1..10)
                .all(|k| (line.right_limit(1.05 + f64::from(k) * 0.1) - f64::from(k) * 0.1 - 0.05).abs()
                    < 1e-11)
        );
    }

    #[test]
    fn discontinuities_come_out_in_order_and_fade() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        line.put_discontinuity(0.0, 1.0, 0);
        line.put_discontinuity(0.25, 1.0, MAX_PASSES);
        line.put_discontinuity(0.5, 1.0, 3);
        assert_eq!((line.next_arrival_before(1.0), line.next_arrival_before(1.1)), (None, Some(1.0)));
        assert_eq!((line.take_arrivals(0.9), line.take_arrivals(1.0)), (None, arrival(0, true)));
        assert_eq!(line.next_arrival_before(9.0), Some(1.5));
    }

    #[test]
    fn sequential_reads_equal_random_reads() {
        for delay in [0.1, 0.137, 0.25, 1.0] {
            let mut line = DelayLine::new(delay, 7.0, 0.1);
            line.put_discontinuity(0.0, 3.0, 0);
            for k in 1..100 {
                let time = f64::from(k) * 0.1;
                for share in [-0.9, -0.5, -0.31, 0.0] {
                    let at = time + 0.1 * share;
                    assert_eq!(
                        line.next_left_limit(at).to_bits(),
                        line.left_limit(at).to_bits(),
                        "{delay} {at}"
                    );
                    assert_eq!(
                        line.next_right_limit(at).to_bits(),
                        line.right_limit(at).to_bits(),
                        "{delay} {at}"
                    );
                }
                line.put(time, (0.9 * time).sin());
                match k % 7 {
                    2 => line.put_discontinuity(time, (0.9 * time).sin(), 0),
                    5 => line.put(time + 3e-5, (0.9 * (time + 3e-5)).sin()),
                    _ => {}
                }
            }
        }
    }

    #[test]
    fn jumps_differ_from_corners() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        line.put_discontinuity(0.0, 1.0, 0);
        line.put_discontinuity(0.25, 1.0, 0);
        line.put_discontinuity(0.5, 2.0, 1);
        assert_eq!(line.next_jump(), Some(1.0));
        assert_eq!(line.take_arrivals(1.3), arrival(0, true));
        // A voltage that is the same on both sides of the instant has a corner, but no jump.
        assert_eq!((line.next_jump(), line.next_arrival_before(9.0)), (None, Some(1.5)));
        line.put(0.75, 2.0);
        line.put_discontinuity(0.75, 3.0, 1);
        assert_eq!((line.next_jump(), line.take_arrivals(1.5)), (Some(1.75), arrival(1, false)));
    }

    #[test]
    fn discontinuities_pass_to_lines_downstream() {
        let mut lines =
            [&[][..], &[0], &[0, 1]].map(|upstream| DelayLine::new(1.0, 0.0, 0.1).with_upstream(upstream));
        let mut step_to =
            |time: f64, is_at_corner| record_inputs(&mut lines, time, [time; 3].into_iter(), is_at_corner);
        step_to(0.0, true);
        (1..=10).for_each(|k| step_to(f64::from(k) * 0.1, false));
        assert_eq!(lines.each_ref().map(|line| line.next_arrival_before(9.0)), [None, Some(2.0), Some(2.0)]);
        let mut step_to = |time: f64| record_inputs(&mut lines, time, [time; 3].into_iter(), false);
        (11..=20).for_each(|k| step_to(f64::from(k) * 0.1));
        assert_eq!(lines.each_ref().map(|line| line.next_arrival_before(9.0)), [None, None, Some(3.0)]);
    }

    #[test]
    fn a_sample_does_not_change_earlier_outputs() {
        for delay in [0.1, 0.137, 0.25, 0.31] {
            let mut line = DelayLine::new(delay, 7.0, 0.1);
            for time in (0..40).map(|k| f64::from(k) * 0.1) {
                let before = line.next_left_limit(time);
                line.put(time, (0.9 * time).sin());
                assert_eq!(before.to_bits(), line.next_left_limit(time).to_bits(), "{delay} {time}");
                let after = line.next_right_limit(time);
                assert!(time < delay + 0.05 || (after - before).abs() < 1e-9, "{delay} {time}");
            }
        }
    }
}
