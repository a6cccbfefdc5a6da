//! What went into a delay line, and what comes out.

use std::collections::VecDeque;

/// A sample of the input.
#[derive(Debug, Clone, Copy)]
struct Sample {
    time: f64,
    volts: f64,
    /// Whether the input jumped here from the sample before.
    jumped: bool,
}

/// The past of one input, as far back as its delay.
#[derive(Debug, Clone)]
pub(super) struct DelayLine {
    delay: f64,
    initial: f64,
    past: VecDeque<Sample>,
}

/// Room beyond the delay: for the cubic's outer points, and for changes of mode between steps.
const SPARE: usize = 64;

impl DelayLine {
    /// An empty line with room for a delay at a step.
    pub fn new(delay: f64, initial: f64, step: f64) -> Self {
        let room = (2.0 * delay / step).min(1e7) as usize + SPARE;
        DelayLine { delay, initial, past: VecDeque::with_capacity(room) }
    }

    pub fn delay(&self) -> f64 {
        self.delay
    }

    /// The delay and initial output as they are set now; the past stays.
    pub fn set(&mut self, delay: f64, initial: f64) {
        (self.delay, self.initial) = (delay, initial);
    }

    pub fn clear(&mut self) {
        self.past.clear();
    }

    /// Takes in a sample; one at the same time as the last, but of another voltage, is a jump.
    pub fn put(&mut self, time: f64, volts: f64) {
        let last = self.past.back();
        if last.is_some_and(|last| last.time == time && last.volts == volts) {
            return;
        }
        let jumped = last.is_some_and(|last| last.time == time);
        self.past.push_back(Sample { time, volts, jumped });
        // Twice the delay is kept, so that the delay may be made longer while the machine runs.
        while self.past.get(3).is_some_and(|sample| sample.time <= time - 2.0 * self.delay) {
            self.past.pop_front();
        }
    }

    /// What comes out at a time: the cubic through the four samples around, never across a jump.
    pub fn at(&self, time: f64) -> f64 {
        let wanted = time - self.delay;
        let after = self.past.partition_point(|sample| sample.time <= wanted);
        let Some(before) = after.checked_sub(1) else { return self.initial };
        if after == self.past.len() {
            return self.past[before].volts;
        }
        let (first, last) = self.around(before, after);
        self.lagrange(first, last, wanted)
    }

    /// Four samples around a pair without a jump between them, or as many as there are.
    fn around(&self, mut first: usize, mut last: usize) -> (usize, usize) {
        for _ in 0..2 {
            if last - first < 3 && first > 0 && !self.past[first].jumped {
                first -= 1;
            }
            if last - first < 3 && self.past.get(last + 1).is_some_and(|sample| !sample.jumped) {
                last += 1;
            }
        }
        (first, last)
    }

    fn lagrange(&self, first: usize, last: usize, time: f64) -> f64 {
        let nodes = first..=last;
        nodes.clone().map(|i| self.past[i].volts * self.weight(nodes.clone(), i, time)).sum()
    }

    fn weight(&self, nodes: impl Iterator<Item = usize>, own: usize, time: f64) -> f64 {
        let own_time = self.past[own].time;
        let others = nodes.filter(|node| *node != own).map(|node| self.past[node].time);
        others.map(|other| (time - other) / (own_time - other)).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_comes_out_as_it_went_in() {
        let cubic = |t: f64| 1.0 + t - 2.0 * t * t + 0.5 * t * t * t;
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        (0..=30).for_each(|k| line.put(f64::from(k) * 0.1, cubic(f64::from(k) * 0.1)));
        for t in [3.05, 3.51, 3.77, 3.97] {
            assert!((line.at(t) - cubic(t - 1.0)).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn before_the_delay_the_initial_voltage_comes_out() {
        let mut line = DelayLine::new(1.0, 7.0, 0.1);
        line.put(0.0, 3.0);
        line.put(0.1, 3.0);
        assert_eq!((line.at(0.5), line.at(1.0)), (7.0, 3.0));
    }

    #[test]
    fn a_jump_stays_a_jump() {
        let mut line = DelayLine::new(1.0, 0.0, 0.1);
        let samples = [(0.0, 1.0), (0.1, 1.0), (0.15, 1.0), (0.15, 5.0), (0.2, 5.0), (0.3, 5.0)];
        samples.iter().for_each(|(time, volts)| line.put(*time, *volts));
        assert_eq!((line.at(1.149), line.at(1.151)), (1.0, 5.0));
    }
}
