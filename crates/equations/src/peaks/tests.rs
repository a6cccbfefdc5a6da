//! Ranges of plans that are built by hand, compared with closed solutions, and of all problems, compared with SciPy.

mod faults;
mod functions;
mod growth;
mod loops;
mod motions;
mod parts;
mod starts;
mod systems;

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Patch;
use patchcord_expr::Dimension;

use super::fault::Fault;
use super::network::Tables;
use super::stated::Stated;
use super::{Ranges, solve};
use crate::graph::{Node, NodeId, Operation, Plan, Sum, Term};
use crate::symbolic::{Fraction, Symbols};

/// A drive that is 0.
const NO_DRIVE: &str = r#"{"kind": "step", "height": 0, "scale": "force"}"#;

/// The circuit of a problem with a drive "push" on a scale "force" of 0.5 mm per volt, and a run of 1000 steps.
fn circuit(duration: f64, drive: &str) -> Circuit {
    let scales = r#"{"force": {"per_volt": 0.5, "unit": "mm"}}"#;
    let (step, every) = (duration / 1000.0, duration / 100.0);
    let run = format!(r#"{{"for": {duration:?}, "step": {step:?}, "every": {every:?}}}"#);
    let text =
        format!(r#"{{"patchcord": 1, "scales": {scales}, "drives": {{"push": {drive}}}, "run": {run}}}"#);
    let patch = Patch::parse("p.json", &text).unwrap_or_else(|report| panic!("{report}"));
    Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"))
}

/// A plan of nodes with names, without parameters.
fn planned(nodes: Vec<(&str, Operation)>) -> Plan {
    let node = |(name, operation): (&str, Operation)| Node {
        name: name.to_owned(),
        dimension: Dimension::NONE,
        operation,
    };
    let nodes = nodes.into_iter().map(node).collect();
    Plan { symbols: Symbols::default(), nodes, quantities: Vec::new() }
}

/// A sum of nodes, each with a factor.
fn sum(terms: &[(f64, u32)]) -> Sum {
    let term = |(factor, node): &(f64, u32)| (NodeId(*node), Fraction::number(*factor));
    Sum { terms: terms.iter().map(term).collect() }
}

/// A node times a number.
fn term(factor: f64, node: u32) -> Term {
    Term { coefficient: Fraction::number(factor), node: NodeId(node) }
}

/// An integral of a sum of nodes from an initial value.
fn integral(initial: f64, rate: &[(f64, u32)]) -> Operation {
    Operation::Integral { initial: Fraction::number(initial), rate: sum(rate) }
}

/// The product of two nodes.
fn product(one: u32, other: u32) -> Operation {
    Operation::Product([NodeId(one), NodeId(other)])
}

/// That nothing is stated about the nodes of a plan.
fn nothing_stated(plan: &Plan) -> Stated {
    Stated { sizes: vec![0.0; plan.nodes.len()], starts: vec![None; plan.nodes.len()] }
}

/// The ranges of nodes over a run with a drive, or the fault.
fn outcome(duration: f64, drive: &str, nodes: Vec<(&str, Operation)>) -> Result<Ranges, Fault> {
    let plan = planned(nodes);
    solve(&plan, &circuit(duration, drive), &Tables::new(), &nothing_stated(&plan))
}

/// The ranges of nodes over a run with a drive.
fn driven(duration: f64, drive: &str, nodes: Vec<(&str, Operation)>) -> Ranges {
    outcome(duration, drive, nodes).unwrap_or_else(|fault| panic!("{fault:?}"))
}

/// The ranges of nodes over a run.
fn solved(duration: f64, nodes: Vec<(&str, Operation)>) -> Ranges {
    driven(duration, NO_DRIVE, nodes)
}

/// Asserts that the range of a node is this one, to within 1e-5 of its largest magnitude.
fn assert_range(ranges: &Ranges, node: usize, expected: [f64; 2]) {
    let (found, size) = (ranges.nodes[node], expected[0].abs().max(expected[1].abs()));
    let is_near = found.iter().zip(&expected).all(|(one, other)| (one - other).abs() <= 1e-5 * size);
    assert!(is_near, "node {node}: {found:?} instead of {expected:?}");
}

/// The range of a function of time from 0 on, from 200 000 points.
fn range_of(duration: f64, function: impl Fn(f64) -> f64) -> [f64; 2] {
    let points = 0..=200_000;
    let values = points.map(|point| function(duration * f64::from(point) / 200_000.0));
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}
