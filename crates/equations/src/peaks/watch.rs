//! Values that the machine could not have: divisors that pass 0, roots and logarithms of negative numbers, and states
//! without bounds.
//!
//! A finite peak can be scaled, however fast a value grows before it. So a value only counts as unbounded if it exceeds
//! every sensible unit, or if no step is short enough for its growth.

use patchcord_expr::Function;

use super::evaluator::Unsolved;
use super::extremes::Extremes;
use super::fault::{Fault, FaultKind};
use super::law::{Law, Weighted, size, total};
use super::network::Network;
use super::order::Block;

/// Magnitude of a state, in SI units, above which it counts as unbounded.
pub(super) const MAX_MAGNITUDE: f64 = 1e60;
/// Magnitude of a negative argument of a root that counts as an error of the solution, as a share of the square of the
/// largest root so far.
const ROOT_ERROR: f64 = 1e-6;
/// Magnitude of a negative argument of a root that counts as rounding, as a share of the magnitudes of its terms.
const ROOT_ROUNDING: f64 = 1e-12;

/// Magnitude of a divisor that counts as nearly 0, as a share of its terms, or of its peak if it is no
/// sum.
const VANISHING_SHARE: f64 = 1e-6;

/// The conditions that hold during a run.
#[derive(Debug)]
pub(super) struct Watch {
    /// The divisors, each with its sign at the start.
    divisors: Vec<(usize, f64)>,
    /// The nodes in order of evaluation.
    order: Vec<usize>,
}

impl Watch {
    /// The conditions of a run, from the values at its first instant.
    pub(super) fn new(network: &Network, values: &[f64]) -> Self {
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
        Watch { divisors, order: order.collect() }
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
        if let Some(fault) = self.not_finite(network, extremes, values, &self.order, time) {
            return Err(fault);
        }
        for node in &self.order {
            if let Law::Root(sum) = &network.laws[*node]
                && is_negative(sum, values, extremes.peak(*node))
            {
                return Err(Fault::node(FaultKind::NegativeRoot, *node, time));
            }
        }
        let mut states = network.integrals.iter().map(|integral| integral.node);
        match states.find(|node| values[*node].abs() > MAX_MAGNITUDE) {
            Some(node) => Err(Fault::node(FaultKind::TooLarge, node, time)),
            None => Ok(()),
        }
    }

    /// The fault of a loop without a solution: that of a value before the loop if one is not finite.
    pub(super) fn unsolved(
        &self,
        network: &Network,
        extremes: &Extremes,
        values: &[f64],
        Unsolved(node): Unsolved,
        time: f64,
    ) -> Fault {
        let is_member = |other: &usize| {
            network.blocks.iter().any(|block| match block {
                Block::Node(_) => false,
                Block::Loop(entry) => {
                    entry.tears.contains(&node) && entry.members.iter().any(|(member, _)| member == other)
                }
            })
        };
        let end = self.order.iter().position(is_member).unwrap_or(0);
        let before = self.not_finite(network, extremes, values, &self.order[..end], time);
        before.unwrap_or(Fault::node(FaultKind::Unsolved, node, time))
    }

    /// The fault of values that are not finite: that of the first node, in order of evaluation, whose inputs are finite.
    /// `None` if all values of these nodes are finite.
    fn not_finite(
        &self,
        network: &Network,
        extremes: &Extremes,
        values: &[f64],
        nodes: &[usize],
        time: f64,
    ) -> Option<Fault> {
        let is_finite = |node: usize| values[node].is_finite();
        let first = *nodes.iter().find(|node| !is_finite(**node))?;
        let is_cause = |node: &&usize| {
            let law = &network.laws[**node];
            !is_finite(**node) && !matches!(law, Law::Given) && law.inputs().into_iter().all(is_finite)
        };
        let Some(cause) = nodes.iter().find(is_cause).copied() else {
            return Some(self.unbounded(network, extremes, values, first, time));
        };
        let (kind, node) = match &network.laws[cause] {
            Law::Function(Function::Ln, argument) if argument.value(values) == 0.0 => {
                (FaultKind::LogarithmOf0, cause)
            }
            Law::Function(Function::Ln, _) => (FaultKind::NegativeLogarithm, cause),
            Law::Quotient { divisor, .. } if values[*divisor] == 0.0 => (FaultKind::Divisor, *divisor),
            _ if values[cause].is_infinite() => {
                return Some(self.unbounded(network, extremes, values, cause, time));
            }
            _ => (FaultKind::NotFinite, cause),
        };
        Some(Fault::node(kind, node, time))
    }

    /// The fault of a node that grows without bound. If a divisor is nearly 0, the divisor is the cause.
    pub(super) fn unbounded(
        &self,
        network: &Network,
        extremes: &Extremes,
        values: &[f64],
        node: usize,
        time: f64,
    ) -> Fault {
        let vanishes = |divisor: &usize| {
            // A sum of positive terms is never nearly 0, although it can be far below its peak.
            let size = match &network.laws[*divisor] {
                Law::Sum(terms) => size(terms, values),
                _ => extremes.peak(*divisor),
            };
            values[*divisor].abs() <= VANISHING_SHARE * size
        };
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
