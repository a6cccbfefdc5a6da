//! All values of a network at an instant.

use super::drives::Drives;
use super::fault::Fault;
use super::history::History;
use super::law::{Law, total};
use super::network::Network;
use super::newton::OpenLoop;
use super::order::{Block, Loop};
use super::quartic::{INTERVALS, Values};
use super::stated::Stated;

/// Largest number of evaluations of a solution. With some hundred nodes they take a few seconds.
pub(super) const MAX_EVALUATIONS: u64 = 2_000_000;

/// A network with its drives and delay lines, and the values of all nodes at the instant that was evaluated last.
#[derive(Debug)]
pub(super) struct Evaluator<'a> {
    /// The laws.
    pub network: &'a Network,
    /// The drives.
    drives: Drives<'a>,
    /// The past of the input of each delay line.
    histories: Vec<History>,
    /// The value of every node, and then the rate of every integrator.
    pub values: Vec<f64>,
    /// The largest magnitude of each node as the unknown of a loop.
    sizes: Vec<f64>,
    /// The value of each node near which the first solution is sought.
    starts: Vec<Option<f64>>,
    /// Number of evaluations so far.
    pub evaluations: u64,
}

/// A loop without a solution. The field is one of its nodes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unsolved(pub usize);

impl<'a> Evaluator<'a> {
    /// An evaluator before the first evaluation, with what is stated about the nodes.
    pub(super) fn new(network: &'a Network, drives: Drives<'a>, stated: &Stated) -> Self {
        Evaluator {
            network,
            drives,
            histories: network.lines.iter().map(|line| History::new(line.time, line.initial)).collect(),
            values: vec![f64::NAN; network.node_count() + network.integrals.len()],
            sizes: stated.sizes.clone(),
            starts: stated.starts.clone(),
            evaluations: 0,
        }
    }

    /// The rates of the integrators at the instant that was evaluated last.
    pub(super) fn rates(&self) -> &[f64] {
        &self.values[self.network.node_count()..]
    }

    /// Evaluates all values for these states at a time in problem seconds. Each loop is solved from the solution of the
    /// last evaluation.
    ///
    /// # Errors
    /// If a loop has no solution near that of the last evaluation.
    pub(super) fn evaluate(&mut self, time: f64, states: &[f64]) -> Result<(), Unsolved> {
        self.evaluate_with(time, states, |open| open.follow())
    }

    /// The same for an instant that no other one precedes: loops are solved from the stated values, and otherwise from
    /// several starts.
    ///
    /// # Errors
    /// If a loop has no solution.
    pub(super) fn begin(&mut self, time: f64, states: &[f64]) -> Result<(), Unsolved> {
        self.evaluate_with(time, states, |open| open.search())
    }

    /// The same, but the sum of an equation can fall with its unknown. If a value is stated, the solution is sought near it
    /// only.
    ///
    /// # Errors
    /// If a loop has no solution near the stated values.
    pub(super) fn approach(&mut self, time: f64, states: &[f64]) -> Result<(), Unsolved> {
        self.evaluate_with(time, states, |open| open.approach())
    }

    /// The derivative of the sum of each equation with respect to its own unknown, at the last evaluation.
    pub(super) fn slopes(&mut self) -> Vec<(usize, f64)> {
        let network = self.network;
        let mut slopes = Vec::new();
        for block in &network.blocks {
            let Block::Loop(entry) = block else { continue };
            let mut open = self.open(entry);
            for (index, tear) in entry.tears.iter().enumerate() {
                if matches!(network.laws[*tear], Law::Zero(_)) {
                    slopes.push((*tear, open.own_slope(index)));
                }
            }
        }
        slopes
    }

    /// A loop with the present values.
    fn open<'s>(&'s mut self, entry: &'s Loop) -> OpenLoop<'s> {
        let laws = &self.network.laws;
        let (values, sizes, starts) = (&mut self.values, &mut self.sizes, &self.starts);
        OpenLoop { laws, entry, values, sizes, starts }
    }

    /// Evaluates all values, with a function that solves a loop.
    ///
    /// # Errors
    /// If the function does not solve a loop.
    fn evaluate_with(
        &mut self,
        time: f64,
        states: &[f64],
        solve: fn(&mut OpenLoop<'_>) -> bool,
    ) -> Result<(), Unsolved> {
        self.evaluations += 1;
        self.give(time, states);
        let network = self.network;
        for block in &network.blocks {
            match block {
                Block::Node(node) => {
                    let value = network.laws[*node].value(*node, &self.values);
                    self.values[*node] = value;
                }
                Block::Loop(entry) => {
                    if !solve(&mut self.open(entry)) {
                        return Err(Unsolved(entry.tears[0]));
                    }
                }
            }
        }
        for (index, integral) in network.integrals.iter().enumerate() {
            let rate = total(&integral.rate, &self.values);
            self.values[network.node_count() + index] = rate;
        }
        Ok(())
    }

    /// Sets the values that are known before an evaluation: drives, delay lines and states.
    fn give(&mut self, time: f64, states: &[f64]) {
        self.drives.give(time, &mut self.values);
        for (line, history) in self.network.lines.iter().zip(&self.histories) {
            self.values[line.node] = history.value(time);
        }
        for (integral, state) in self.network.integrals.iter().zip(states) {
            self.values[integral.node] = *state;
        }
    }

    /// Records the inputs of the delay lines over a step, from all values at equal distances.
    pub(super) fn record(&mut self, begin: f64, end: f64, samples: &[Vec<f64>; INTERVALS + 1]) {
        for (line, history) in self.network.lines.iter().zip(&mut self.histories) {
            let values: Values = samples.each_ref().map(|sample| sample[line.input]);
            history.record(begin, end, values);
        }
    }

    /// The next time at which a value may jump or have a corner, in problem seconds; infinity if none is known.
    pub(super) fn next_stop(&self) -> f64 {
        self.histories.iter().map(History::arrival).fold(self.drives.end(), f64::min)
    }

    /// The shortest delay in seconds; infinity without delay lines.
    pub(super) fn shortest_delay(&self) -> f64 {
        self.network.lines.iter().map(|line| line.time).fold(f64::INFINITY, f64::min)
    }

    /// Handles the jumps and corners up to a problem time. The next evaluation has the values after them.
    ///
    /// # Errors
    /// If a drive has no value, or there are too many corners.
    pub(super) fn cross(&mut self, time: f64) -> Result<(), Fault> {
        while self.drives.end() <= time {
            self.evaluations += 1;
            if self.evaluations > MAX_EVALUATIONS {
                return Err(Fault::TooLong { time });
            }
            self.drives.advance()?;
        }
        self.histories.iter_mut().for_each(|history| history.arrive(time));
        Ok(())
    }
}
