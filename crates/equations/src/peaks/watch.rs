//! Values that the machine could not have: divisors that pass 0, roots of negative numbers, and states without bounds.

use super::extremes::Extremes;
use super::fault::{Fault, FaultKind};
use super::law::{Law, Weighted, size, total};
use super::network::Network;
use super::order::Block;

/// Growth of a state from its size at the start at which the solution counts as unbounded.
const MAX_GROWTH: f64 = 1e12;
/// Share of the run in which the size at the start is measured.
const START_SHARE: f64 = 0.1;
/// Magnitude of a negative argument of a root that counts as an error of the solution, as a share of the square of the
/// largest root so far.
const ROOT_ERROR: f64 = 1e-6;
/// Magnitude of a negative argument of a root that counts as rounding, as a share of the magnitudes of its terms.
const ROOT_ROUNDING: f64 = 1e-12;

/// Magnitude of a divisor that counts as nearly 0, as a share of its peak.
const VANISHING_SHARE: f64 = 1e-6;

/// The conditions that hold during a run.
#[derive(Debug)]
pub(super) struct Watch {
    /// The divisors, each with its sign at the start.
    divisors: Vec<(usize, f64)>,
    /// The nodes in order of evaluation.
    order: Vec<usize>,
    /// The size of each state at the start: its magnitude, or how far its rate would take it in the run.
    sizes: Vec<f64>,
    /// The end of the start, in problem seconds.
    start: f64,
}

impl Watch {
    /// The conditions of a run of this duration, from the values at its first instant. `maxima` has the magnitude that
    /// is expected of each node, or 0.
    pub(super) fn new(network: &Network, values: &[f64], duration: f64, maxima: &[f64]) -> Self {
        let mut divisors: Vec<(usize, f64)> = Vec::new();
        for law in &network.laws {
            if let Law::Quotient { divisor, .. } = law
                && divisors.iter().all(|(known, _)| known != divisor)
            {
                divisors.push((*divisor, values[*divisor]));
            }
        }
        let order = network.blocks.iter().flat_map(|block| match block {
            Block::Node(node) => vec![*node],
            Block::Loop(entry) => entry.members.iter().map(|(node, _)| *node).collect(),
        });
        let sizes = network.integrals.iter().map(|integral| {
            let by_rate = duration * size(&integral.rate, values);
            integral.initial.abs().max(by_rate).max(maxima[integral.node])
        });
        Watch { divisors, order: order.collect(), sizes: sizes.collect(), start: START_SHARE * duration }
    }

    /// Measures the size of the states in the first part of the run.
    pub(super) fn measure(&mut self, time: f64, states: &[f64]) {
        if time <= self.start {
            for (size, state) in self.sizes.iter_mut().zip(states) {
                *size = size.max(state.abs());
            }
        }
    }

    /// Checks the values of an instant.
    ///
    /// # Errors
    /// If a divisor has another sign than at the start, the argument of a root is negative, a value is not finite, or a
    /// state is too large.
    pub(super) fn check(
        &self,
        network: &Network,
        extremes: &Extremes,
        values: &[f64],
        time: f64,
    ) -> Result<(), Fault> {
        let passes =
            |(divisor, start): &&(usize, f64)| values[*divisor] * start.signum() <= 0.0 || *start == 0.0;
        if let Some((divisor, _)) = self.divisors.iter().find(passes) {
            return Err(Fault::node(FaultKind::Divisor, *divisor, time));
        }
        for node in &self.order {
            let (law, is_finite) = (&network.laws[*node], values[*node].is_finite());
            match law {
                Law::Root(sum) if is_negative(sum, values, extremes.peak(*node)) => {
                    return Err(Fault::node(FaultKind::NegativeRoot, *node, time));
                }
                Law::Given if !is_finite => return Err(self.unbounded(extremes, values, *node, time)),
                _ if !is_finite => return Err(Fault::node(FaultKind::NotFinite, *node, time)),
                _ => {}
            }
        }
        let is_too_large =
            |(node, size): &(usize, f64)| *size > 0.0 && values[*node].abs() > MAX_GROWTH * size;
        let nodes = network.integrals.iter().map(|integral| integral.node);
        match nodes.zip(self.sizes.iter().copied()).find(is_too_large) {
            Some((node, _)) => Err(self.unbounded(extremes, values, node, time)),
            None => Ok(()),
        }
    }

    /// The fault of a node that grows without bound. If a divisor is nearly 0, the divisor is the cause.
    pub(super) fn unbounded(&self, extremes: &Extremes, values: &[f64], node: usize, time: f64) -> Fault {
        let vanishes = |divisor: &usize| values[*divisor].abs() <= VANISHING_SHARE * extremes.peak(*divisor);
        match self.divisors.iter().map(|(divisor, _)| *divisor).find(vanishes) {
            Some(divisor) => Fault::node(FaultKind::Divisor, divisor, time),
            None => Fault::node(FaultKind::Unbounded, node, time),
        }
    }
}

/// Whether the argument of a root is negative, and not only by the error of the solution or by rounding. `peak` is the
/// largest root so far.
fn is_negative(argument: &[Weighted], values: &[f64], peak: f64) -> bool {
    total(argument, values) < -(ROOT_ERROR * peak.powi(2) + ROOT_ROUNDING * size(argument, values))
}
