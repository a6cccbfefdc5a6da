//! The solution of a network over the run: steps of the pair of Dormand and Prince, with the range of every value.
//!
//! Steps end at the corners of drives and where the first input of a delay line arrives. Comparators and limits have no
//! such stops: the control of the step length crosses them in short steps. Every step is sampled at five equally spaced
//! times. If a value seems to have its peak between them, it is also evaluated at that time.

use patchcord_core::solve::{DORMAND_PRINCE, StateCurve, advance_states, weighted_sum};

use super::Ranges;
use super::evaluator::{Evaluator, MAX_EVALUATIONS, Unsolved};
use super::extremes::Extremes;
use super::fault::Fault;
use super::law::size;
use super::quartic::INTERVALS;
use super::step_control::StepControl;
use super::times::RunTimes;
use super::watch::Watch;

/// Largest error of a step in a state, as a share of the largest magnitude of the state so far.
const TOLERANCE: f64 = 1e-8;
/// Least size of a state as a share of the change that the terms of its rate would make over the run. Without it, no
/// step of a state that leaves 0 would be short enough.
const LEAST_SIZE: f64 = 1e-6;
/// Difference of two times that counts as rounding, as a share of the run.
const SAME_TIME: f64 = 1e-13;

/// The solution up to a time.
#[derive(Debug)]
pub(super) struct Solution<'a> {
    /// The network with its values.
    evaluator: Evaluator<'a>,
    /// The times of the run.
    times: RunTimes,
    /// The present problem time in seconds.
    time: f64,
    /// The present states.
    states: Vec<f64>,
    /// The states at the end of the tried step.
    end_states: Vec<f64>,
    /// The states at an instant within a step.
    inner_states: Vec<f64>,
    /// The rates of the states: the present ones, those of the stages, and those at the end of the tried step.
    rates: Vec<Vec<f64>>,
    /// All values at equally spaced times of the tried step. The first are the present ones.
    samples: [Vec<f64>; INTERVALS + 1],
    /// The range of every value so far.
    extremes: Extremes,
    /// The length of the steps.
    control: StepControl,
    /// The conditions that hold during the run.
    watch: Watch,
}

impl<'a> Solution<'a> {
    /// The solution at the first instant.
    ///
    /// # Errors
    /// If the network has no solution there.
    pub(super) fn new(mut evaluator: Evaluator<'a>, times: RunTimes) -> Result<Self, Fault> {
        let network = evaluator.network;
        let states: Vec<f64> = network.integrals.iter().map(|integral| integral.initial).collect();
        let begun = evaluator.begin(0.0, &states);
        let values = evaluator.values.clone();
        let (extremes, watch) = (Extremes::new(&values), Watch::new(network, &values));
        begun.map_err(|unsolved| watch.unsolved(network, &extremes, &values, unsolved, 0.0))?;
        watch.check(network, &extremes, &values, 0.0)?;
        let control = StepControl::new(times, evaluator.shortest_delay());
        let mut rates = vec![vec![0.0; states.len()]; DORMAND_PRINCE.rates()];
        rates[0].copy_from_slice(evaluator.rates());
        Ok(Solution {
            evaluator,
            times,
            time: 0.0,
            end_states: states.clone(),
            inner_states: states.clone(),
            states,
            rates,
            samples: std::array::from_fn(|_| values.clone()),
            extremes,
            control,
            watch,
        })
    }

    /// Continues the solution to the end of the run.
    ///
    /// # Errors
    /// If the network has no solution at some time, a value grows without bound, or the solution takes too many
    /// evaluations.
    pub(super) fn run(&mut self) -> Result<(), Fault> {
        while self.time < self.times.duration {
            let stop = self.evaluator.next_stop().min(self.times.duration);
            while self.time < stop {
                self.step(stop)?;
            }
            if stop < self.times.duration {
                self.cross()?;
            }
        }
        Ok(())
    }

    /// The ranges of all nodes so far.
    pub(super) fn ranges(&self) -> Ranges {
        let network = self.evaluator.network;
        let nodes = (0..network.node_count()).map(|node| self.extremes.range(node)).collect();
        let mut rates = vec![0.0; network.node_count()];
        for (index, integral) in network.integrals.iter().enumerate() {
            rates[integral.node] = self.extremes.peak(network.node_count() + index);
        }
        Ranges { nodes, rates }
    }

    /// Takes a step towards a stop. Steps whose error is too large are tried again with a shorter length.
    ///
    /// # Errors
    /// As for [`Solution::run`].
    fn step(&mut self, stop: f64) -> Result<(), Fault> {
        loop {
            if self.evaluator.evaluations > MAX_EVALUATIONS {
                return Err(Fault::TooLong { time: self.time });
            }
            let remaining = stop - self.time;
            let length = self.control.length(remaining);
            let end = if length < remaining { self.time + length } else { stop };
            let outcome = self.try_step(length);
            let error = outcome.unwrap_or(f64::INFINITY);
            let is_accepted = self.control.is_acceptable(length, error);
            self.control.adapt(length, error);
            if is_accepted {
                return self.accept(end);
            }
            if self.control.is_shortest(length) {
                return Err(self.reason(outcome, end));
            }
        }
    }

    /// Tries a step of this length. Returns its error in tolerances; infinity if it is not a number. If the error is
    /// acceptable, the samples are those of the step. A rate that is not finite ends the attempt, so that the values of
    /// the evaluator show its cause.
    ///
    /// # Errors
    /// If a loop has no solution.
    fn try_step(&mut self, length: f64) -> Result<f64, Unsolved> {
        let method = &DORMAND_PRINCE;
        self.evaluator.values.copy_from_slice(&self.samples[0]);
        for (index, stage) in method.stages.iter().enumerate() {
            advance_states(&mut self.inner_states, &self.states, &self.rates, stage.weights, length);
            self.evaluator.evaluate(self.time + stage.node * length, &self.inner_states)?;
            self.rates[index + 1].copy_from_slice(self.evaluator.rates());
            if !self.evaluator.rates().iter().all(|rate| rate.is_finite()) {
                return Ok(f64::INFINITY);
            }
        }
        let weights = method.end_weights;
        advance_states(&mut self.end_states, &self.states, &self.rates, weights, length / method.divisor);
        self.evaluator.evaluate(self.time + length, &self.end_states)?;
        self.rates[method.rates() - 1].copy_from_slice(self.evaluator.rates());
        let error = self.error(length);
        if self.control.is_acceptable(length, error) {
            self.take_samples(length)?;
        }
        Ok(error)
    }

    /// The largest error of a state in the tried step, in tolerances.
    fn error(&self, length: f64) -> f64 {
        let values = &self.evaluator.values;
        let mut largest: f64 = 0.0;
        for (index, integral) in self.evaluator.network.integrals.iter().enumerate() {
            let error = length * weighted_sum(&self.rates, DORMAND_PRINCE.error_weights, index).abs();
            let least = LEAST_SIZE * self.times.duration * size(&integral.rate, values);
            let size = self.extremes.peak(integral.node).max(values[integral.node].abs()).max(least);
            let share = if error == 0.0 { 0.0 } else { error / (TOLERANCE * size) };
            largest = largest.max(if share.is_nan() { f64::INFINITY } else { share });
        }
        largest
    }

    /// Samples the tried step, at whose end the values are those of the last evaluation.
    ///
    /// # Errors
    /// If a loop has no solution.
    fn take_samples(&mut self, length: f64) -> Result<(), Unsolved> {
        self.samples[INTERVALS].copy_from_slice(&self.evaluator.values);
        self.evaluator.values.copy_from_slice(&self.samples[0]);
        for index in 1..INTERVALS {
            self.evaluate_within(length, index as f64 / INTERVALS as f64)?;
            self.samples[index].copy_from_slice(&self.evaluator.values);
        }
        Ok(())
    }

    /// Evaluates all values after a share (0 ... 1) of the tried step.
    ///
    /// # Errors
    /// If a loop has no solution.
    fn evaluate_within(&mut self, length: f64, share: f64) -> Result<(), Unsolved> {
        let curve = StateCurve::new(&DORMAND_PRINCE, length, share);
        for (index, state) in self.inner_states.iter_mut().enumerate() {
            *state = curve.value([self.states[index], self.end_states[index]], &self.rates, index);
        }
        self.evaluator.evaluate(self.time + share * length, &self.inner_states)
    }

    /// Accepts the tried step, which ends at this time.
    ///
    /// # Errors
    /// If a value in the step is one that the machine could not have.
    fn accept(&mut self, end: f64) -> Result<(), Fault> {
        let length = end - self.time;
        for (index, sample) in self.samples.iter().enumerate().skip(1) {
            self.extremes.include(sample);
            let time = self.time + length * index as f64 / INTERVALS as f64;
            self.watch.check(self.evaluator.network, &self.extremes, sample, time)?;
        }
        self.find_hidden_peaks(length);
        self.evaluator.record(self.time, end, &self.samples);
        self.samples.swap(0, INTERVALS);
        self.rates.swap(0, DORMAND_PRINCE.rates() - 1);
        self.states.copy_from_slice(&self.end_states);
        self.time = end;
        Ok(())
    }

    /// Extends the ranges by the peaks between the samples of the tried step. A loop without a solution there does not
    /// matter, because it has solutions at the samples.
    fn find_hidden_peaks(&mut self, length: f64) {
        for index in 0..self.evaluator.values.len() {
            for sign in [1.0, -1.0] {
                if let Some(share) = self.extremes.hidden_peak(index, &self.samples, sign)
                    && self.evaluate_within(length, share).is_ok()
                {
                    self.extremes.include(&self.evaluator.values);
                }
            }
        }
    }

    /// Handles the jumps and corners at the present time.
    ///
    /// # Errors
    /// If the network has no solution after them.
    fn cross(&mut self) -> Result<(), Fault> {
        self.evaluator.cross(self.time + SAME_TIME * self.times.duration)?;
        self.evaluator.values.copy_from_slice(&self.samples[0]);
        let near = self.evaluator.evaluate(self.time, &self.states);
        let solved = near.or_else(|_| self.evaluator.begin(self.time, &self.states));
        solved.map_err(|unsolved| self.unsolved(unsolved, self.time))?;
        self.samples[0].copy_from_slice(&self.evaluator.values);
        self.rates[0].copy_from_slice(self.evaluator.rates());
        self.extremes.include(&self.samples[0]);
        self.watch.check(self.evaluator.network, &self.extremes, &self.samples[0], self.time)
    }

    /// Why the shortest step to this time is not accepted.
    fn reason(&self, outcome: Result<f64, Unsolved>, end: f64) -> Fault {
        if let Err(unsolved) = outcome {
            return self.unsolved(unsolved, end);
        }
        let (network, values) = (self.evaluator.network, &self.evaluator.values);
        if let Err(fault) = self.watch.check(network, &self.extremes, values, end) {
            return fault;
        }
        let error = |index: usize| weighted_sum(&self.rates, DORMAND_PRINCE.error_weights, index).abs();
        let share = |index: usize| error(index) / self.extremes.peak(network.integrals[index].node);
        let indices = 0..network.integrals.len();
        let worst = indices.max_by(|one, other| share(*one).total_cmp(&share(*other)));
        let node = worst.map_or(0, |index| network.integrals[index].node);
        self.watch.unbounded(network, &self.extremes, values, node, end)
    }

    /// The fault of a loop without a solution at the last evaluation, at this time.
    fn unsolved(&self, unsolved: Unsolved, time: f64) -> Fault {
        let values = &self.evaluator.values;
        self.watch.unsolved(self.evaluator.network, &self.extremes, values, unsolved, time)
    }
}
