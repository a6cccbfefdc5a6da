//! The ranges of all nodes of a plan: a numerical solution in SI units, without voltages.
//!
//! `network` turns a plan into laws with numbers, which `law` evaluates, and `order` puts them into the order of
//! evaluation. `evaluator` computes all values at an instant, with the solutions of loops from `newton`, the drives from
//! `drives` and the past of delayed nodes from `history`. `stated` has the maxima and initial values of the problem.
//! `solution` takes the steps, whose length `step_control` chooses. `extremes` keeps the smallest and the largest values,
//! and `quartic` finds peaks between samples. `watch` finds values that a machine could not have. `fault` turns what is
//! wrong into a diagnostic. `start` has the values before the run, for a plan that is not complete.

mod drives;
mod evaluator;
mod extremes;
mod fault;
mod history;
mod law;
mod network;
mod newton;
mod order;
mod quartic;
mod solution;
mod start;
mod stated;
mod step_control;
mod times;
mod watch;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Problem, ProblemTable};

use crate::graph::Plan;
use drives::Drives;
use evaluator::Evaluator;
use fault::Fault;
use network::{Network, Tables};
use solution::Solution;
pub(crate) use start::{StartError, StartValues, start_values};
use stated::Stated;
use times::RunTimes;

/// The range of every node over the run of a problem, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ranges {
    /// The smallest and the largest value of each node.
    pub nodes: Vec<[f64; 2]>,
    /// The largest magnitude of the derivative of each integral; 0 for other nodes.
    pub rates: Vec<f64>,
}

/// The ranges of a plan over the run of its problem, with the parameter values of the circuit.
///
/// The run lasts from the start to the end of the longest repetition. Changes of parameters within it are not made. The
/// relative error of a range is about 1e-5 where the motion does not amplify errors.
///
/// # Errors
/// If the equations have no solution at some time, a divisor reaches 0, a value becomes infinite or exceeds 1e60 in SI
/// units, or the solution takes more than 2 million evaluations. The diagnostic names the quantity and the time.
pub(crate) fn ranges(plan: &Plan, problem: &Problem, circuit: &Circuit) -> Result<Ranges, Diagnostic> {
    let stated = Stated::of(plan, problem, circuit);
    let ranges = solve(plan, circuit, &tables_in_si(problem), &stated);
    ranges.map_err(|fault| fault.diagnostic(plan, problem))
}

/// The tables of a problem.
fn tables_in_si(problem: &Problem) -> Tables {
    problem.tables.iter().map(|(name, table)| (name.clone(), points_in_si(table))).collect()
}

/// The points of a table in SI units.
pub(crate) fn points_in_si(table: &ProblemTable) -> Vec<[f64; 2]> {
    let point =
        |[input, output]: &[f64; 2]| [table.input_unit.to_si(*input), table.output_unit.to_si(*output)];
    table.points.iter().map(point).collect()
}

/// The ranges of a plan, with what is stated about its nodes.
///
/// # Errors
/// As for [`ranges`].
fn solve(plan: &Plan, circuit: &Circuit, tables: &Tables, stated: &Stated) -> Result<Ranges, Fault> {
    let network = Network::new(plan, circuit, tables)?;
    let times = RunTimes::of(circuit)?;
    let program = Program::new(circuit)?;
    let drives = Drives::new(&network.drives, circuit, &program, times)?;
    let evaluator = Evaluator::new(&network, drives, stated);
    let mut solution = Solution::new(evaluator, times)?;
    solution.run()?;
    Ok(solution.ranges())
}

#[cfg(test)]
mod tests;
