//! The memory of a delay line: its past inputs and what it gives back.
//!
//! A line stores samples of its input at the ends of steps. Its output at a time is a cubic through the four samples
//! around the delayed time. The curve never crosses a jump or a corner of the input, so these come out as sharp as
//! they went in.
//!
//! A jump or corner of the input is a discontinuity. It comes out one delay later, and the solver ends a step there.
//! If the output leads back to the input of a delay line, the discontinuity passes through that line again, one
//! derivative smoother each time. `reading` computes outputs, and `curve` has the polynomial between samples.

mod curve;
mod reading;

use std::collections::VecDeque;

use curve::CachedSegment;
pub(crate) use reading::DelayOutput;

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
    /// The number of samples before the last time that was read. The next search starts there.
    search_start: usize,
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

/// Largest number of samples for which memory is reserved before the run. A line with more samples grows.
const MAX_CAPACITY: f64 = 1e5;

impl DelayLine {
    /// An empty line with capacity for a delay, in problem seconds, at this step length.
    pub(crate) fn new(delay: f64, initial: f64, step: f64) -> Self {
        let capacity = (2.0 * delay / step).min(MAX_CAPACITY) as usize + SPARE_SAMPLES;
        DelayLine {
            delay,
            initial,
            past: VecDeque::with_capacity(capacity),
            discontinuities: VecDeque::with_capacity(SPARE_SAMPLES),
            time_tolerance: SAME_TIME_SHARE * step,
            min_spacing: MIN_SPACING_SHARE * step,
            upstream: Vec::new(),
            arrived: None,
            search_start: 0,
            segment: None,
        }
    }

    /// The same line with the indices of the lines upstream.
    pub(crate) fn with_upstream(self, upstream: &[usize]) -> Self {
        DelayLine { upstream: upstream.to_vec(), ..self }
    }

    /// The same line with capacity for this many jumps per second and their repeated passes.
    pub(crate) fn with_capacity_for(mut self, jump_rate: f64) -> Self {
        let discontinuities =
            (2.0 * self.delay * jump_rate * f64::from(1 + MAX_PASSES)).min(MAX_CAPACITY) as usize;
        self.discontinuities.reserve(discontinuities);
        self.past.reserve(2 * discontinuities);
        self
    }

    /// Size of the stored past in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.past.len() * size_of::<Sample>() + self.discontinuities.len() * size_of::<Discontinuity>()
    }

    /// The delay in problem seconds.
    pub(crate) fn delay(&self) -> f64 {
        self.delay
    }

    /// Changes the delay and the initial voltage at `time`; the stored past stays. Discontinuities that would have
    /// come out earlier with the new delay are dropped.
    pub(crate) fn set(&mut self, delay: f64, initial: f64, time: f64) {
        (self.delay, self.initial) = (delay, initial);
        self.take_arrivals(time);
    }

    /// Takes over the past of another line at a problem time. The delay stays.
    pub(crate) fn take_past_of(&mut self, other: &DelayLine, time: f64) {
        self.past.clone_from(&other.past);
        self.discontinuities.clone_from(&other.discontinuities);
        (self.search_start, self.segment) = (0, None);
        self.take_arrivals(time);
    }

    /// Forgets all past inputs, for a new initial condition.
    pub(crate) fn clear(&mut self) {
        self.past.clear();
        self.discontinuities.clear();
        self.segment = None;
    }

    /// Appends a sample. A sample at or before the last time is ignored.
    pub(crate) fn put(&mut self, time: f64, volts: f64) {
        if self.past.back().is_none_or(|last| last.time < time) {
            self.past.push_back(Sample { time, volts, is_discontinuous: false });
            self.forget(time);
        }
    }

    /// Appends a sample at which the input jumps or has a corner. `passes` is the number of lines that the
    /// discontinuity has passed through.
    pub(crate) fn put_discontinuity(&mut self, time: f64, volts: f64, passes: u8) {
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
            self.search_start = self.search_start.saturating_sub(1);
        }
    }

    /// Time at which the next discontinuity comes out, if that is before `end`.
    pub(crate) fn next_arrival_before(&self, end: f64) -> Option<f64> {
        self.discontinuities
            .front()
            .map(|first| first.time + self.delay)
            .filter(|arrival| *arrival < end - self.time_tolerance)
    }

    /// Time at which the next jump comes out.
    pub(crate) fn next_jump(&self) -> Option<f64> {
        self.discontinuities
            .iter()
            .find(|discontinuity| discontinuity.is_jump)
            .map(|jump| jump.time + self.delay)
    }

    /// Removes the discontinuities that have come out by `time`. `None` if there were none.
    pub(crate) fn take_arrivals(&mut self, time: f64) -> Option<Arrival> {
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

    /// Times that differ by less than this, in seconds, count as the same.
    pub(crate) fn time_tolerance(&self) -> f64 {
        self.time_tolerance
    }

    /// Time and voltage of the last sample; `None` if there is none.
    pub(crate) fn last(&self) -> Option<(f64, f64)> {
        self.past.back().map(|sample| (sample.time, sample.volts))
    }
}

#[cfg(test)]
mod tests;
