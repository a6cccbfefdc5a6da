//! The values of all nodes before the run. A plan needs them while it is made.
//!
//! They decide the signs of implicit equations, and are the initial values of delays.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::ir::Program;
use patchcord_core::patch::Problem;

use super::drives::Drives;
use super::evaluator::{Evaluator, Unsolved};
use super::fault::{Fault, FaultKind};
use super::network::Network;
use super::stated::Stated;
use super::tables_in_si;
use super::times::RunTimes;
use crate::graph::{NodeId, Plan, Sum};

/// The values at the start.
#[derive(Debug)]
pub(crate) struct StartValues {
    /// The value of each node in SI units. It is not finite if an expression has no value.
    pub values: Vec<f64>,
    /// For each implicit node except angles, the derivative of its sum with respect to its own value.
    pub slopes: BTreeMap<NodeId, f64>,
}

/// Why a plan has no values at the start.
#[derive(Debug)]
pub(crate) enum StartError {
    /// The loop of this node has no solution near the stated values.
    Unsolved(NodeId),
    /// A number of the plan, a drive or the run is wrong.
    Other(Box<Diagnostic>),
}

/// The values of all nodes at the start. The implicit equations of the plan can have any sign, and the initial values of
/// its delays are not used.
///
/// `angles` are the implicit nodes that are angles, each with the two sums of which it is `atan2`.
///
/// # Errors
/// If a loop has no solution near the initial values of its quantities, or near 0, if a coefficient is not finite, or if
/// the drives have no values.
pub(crate) fn start_values(
    plan: &Plan,
    problem: &Problem,
    circuit: &Circuit,
    angles: &BTreeMap<NodeId, [Sum; 2]>,
) -> Result<StartValues, StartError> {
    solved(plan, problem, circuit, angles).map_err(|fault| match fault {
        Fault::Node { kind: FaultKind::Unsolved, node, .. } => StartError::Unsolved(NodeId(node as u32)),
        fault => StartError::Other(Box::new(fault.diagnostic(plan, problem))),
    })
}

/// The values at the start, or the fault.
///
/// # Errors
/// As for [`start_values`].
fn solved(
    plan: &Plan,
    problem: &Problem,
    circuit: &Circuit,
    angles: &BTreeMap<NodeId, [Sum; 2]>,
) -> Result<StartValues, Fault> {
    let network = Network::at_start(plan, circuit, &tables_in_si(problem), angles)?;
    let program = Program::new(circuit)?;
    let drives = Drives::new(&network.drives, circuit, &program, RunTimes::of(circuit)?)?;
    let mut evaluator = Evaluator::new(&network, drives, &Stated::in_units(plan, problem, circuit));
    let states: Vec<f64> = network.integrals.iter().map(|integral| integral.initial).collect();
    let unsolved = |Unsolved(node)| Fault::node(FaultKind::Unsolved, node, 0.0);
    evaluator.approach(0.0, &states).map_err(unsolved)?;
    let values = evaluator.values[..network.node_count()].to_vec();
    let slopes = evaluator.slopes().into_iter().map(|(node, slope)| (NodeId(node as u32), slope));
    Ok(StartValues { values, slopes: slopes.collect() })
}
