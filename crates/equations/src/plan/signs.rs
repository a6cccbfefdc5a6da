//! Signs of quantities that can stay at 0.
//!
//! A comparator has two outputs, so the sign of f with one comparator is 1 while f is 0. That does not matter if f only
//! passes 0. A dead zone, a limiter or a step can stay at 0, and so can a sum such as x + |x|, or a x with a parameter a that
//! is 0. Then the sign has to be 0, as in a three-point controller. Such a sign is step(f) - step(-f), from two comparators.

use patchcord_core::patch::Problem;
use patchcord_expr::Dimension;

use super::builder::{Entry, NameKind};
use super::constants::Constants;
use crate::graph::{NodeId, ONE, Operation, Sum};
use crate::notation::Notation;
use crate::symbolic::Fraction;

/// The kinds of drives that are constant between jumps, or at the start or the end of the run.
const CONSTANT_DRIVES: [&str; 4] = ["step", "pulse", "square", "table"];

/// Makes two comparators of each sign whose argument can stay at 0.
pub(super) fn split_signs(entries: &mut Vec<Entry>, problem: &Problem, constants: &Constants) {
    let signs = entries.iter().enumerate().filter_map(|(index, entry)| Some((index, sign_argument(entry)?)));
    let signs: Vec<(usize, NodeId)> = signs.collect();
    if signs.is_empty() {
        return;
    }
    let rests = Rests { entries, problem, constants }.of_all();
    for (index, argument) in signs {
        if rests[argument.0 as usize] {
            let [above, below] = comparators(entries, argument);
            entries[index].operation = Some(Operation::Sum(Sum::node(above).minus(&Sum::node(below))));
        }
    }
}

/// The argument of a node that is a sign; `None` for other nodes.
fn sign_argument(entry: &Entry) -> Option<NodeId> {
    match &entry.operation {
        Some(Operation::Switch { input, below_0, .. }) if !below_0.is_zero() => Some(*input),
        _ => None,
    }
}

/// Adds the nodes step(f) and step(-f).
fn comparators(entries: &mut Vec<Entry>, argument: NodeId) -> [NodeId; 2] {
    let Entry { notation, dimension, .. } = &entries[argument.0 as usize];
    let (notation, dimension) = (notation.clone(), *dimension);
    let negative = match notation.clone() {
        Notation::Negative(inner) => *inner,
        other => Notation::Negative(Box::new(other)),
    };
    let opposite = Entry {
        notation: negative.clone(),
        dimension,
        operation: Some(Operation::Sum(Sum::node(argument).negated())),
        kind: NameKind::Expression,
    };
    let opposite = push(entries, opposite);
    [push(entries, step(notation, argument)), push(entries, step(negative, opposite))]
}

/// Adds a node.
fn push(entries: &mut Vec<Entry>, entry: Entry) -> NodeId {
    let node = NodeId(entries.len() as u32);
    entries.push(entry);
    node
}

/// The step of a node with this notation.
fn step(notation: Notation, input: NodeId) -> Entry {
    let (at_least_0, below_0) = (Fraction::whole(1), Fraction::zero());
    Entry {
        notation: Notation::Call("step".to_owned(), vec![notation]),
        dimension: Dimension::NONE,
        operation: Some(Operation::Switch { input, at_least_0, below_0 }),
        kind: NameKind::Expression,
    }
}

/// Finds the nodes that can keep a value for some time while other quantities change.
struct Rests<'a> {
    /// The nodes.
    entries: &'a [Entry],
    /// The problem, for its drives and tables.
    problem: &'a Problem,
    /// The constants, for the present values of coefficients.
    constants: &'a Constants,
}

impl Rests<'_> {
    /// For each node, whether it can keep a value for some time.
    fn of_all(&self) -> Vec<bool> {
        let mut rests = vec![false; self.entries.len()];
        loop {
            let can_rest = |operation: &Operation| self.can_rest(operation, &rests);
            let operations = self.entries.iter().map(|entry| entry.operation.as_ref());
            let found: Vec<bool> = operations.map(|operation| operation.is_some_and(can_rest)).collect();
            if found == rests {
                return rests;
            }
            rests = found;
        }
    }

    /// Whether a node with this operation can keep a value for some time, if that of its inputs is known.
    fn can_rest(&self, operation: &Operation, rests: &[bool]) -> bool {
        let of = |node: &NodeId| rests[node.0 as usize];
        let of_term = |(node, coefficient): (&NodeId, &Fraction)| of(node) || self.is_zero(coefficient);
        let of_sum = |sum: &Sum| sum.terms.iter().all(of_term) || self.can_cancel(sum);
        match operation {
            Operation::One
            | Operation::Limited { .. }
            | Operation::DeadZone { .. }
            | Operation::Switch { .. }
            | Operation::Delay { .. } => true,
            Operation::Zero(_) => false,
            Operation::Integral { rate, .. } => rate.terms.values().all(|factor| self.is_zero(factor)),
            Operation::Drive(name) => {
                let drive = self.problem.patch.drives.get(name);
                drive.is_some_and(|drive| CONSTANT_DRIVES.contains(&drive.kind.name))
            }
            Operation::Sum(sum) | Operation::Root(sum) | Operation::Quotient { dividend: sum, .. } => {
                of_sum(sum)
            }
            Operation::Product(factors) => factors.iter().any(of),
            Operation::Absolute(input) => of(input),
            Operation::Lower(terms) | Operation::Higher(terms) => {
                terms.iter().any(|term| of_term((&term.node, &term.coefficient)))
            }
            Operation::Function { argument, .. } => of_term((&argument.node, &argument.coefficient)),
            Operation::Curve { table, input } => of(&input.node) || self.has_flat_segment(table),
        }
    }

    /// Whether a coefficient is 0 for the present values of the parameters.
    fn is_zero(&self, coefficient: &Fraction) -> bool {
        self.constants.value(coefficient) == 0.0
    }

    /// Whether a table of the problem is constant between two points.
    fn has_flat_segment(&self, table: &str) -> bool {
        let is_flat = |pair: &[[f64; 2]]| pair[0][1] == pair[1][1];
        self.problem.tables.get(table).is_some_and(|table| table.points.windows(2).any(is_flat))
    }

    /// Whether terms of a sum can cancel each other for some time: one is made of straight segments, and another one is an
    /// argument of it, as in x - limit(x, -1, 1).
    fn can_cancel(&self, sum: &Sum) -> bool {
        let is_term = |node: &NodeId| *node != ONE && sum.terms.contains_key(node);
        sum.terms.keys().any(|node| match &self.entries[node.0 as usize].operation {
            Some(operation) if has_segments(operation) => operation.inputs().iter().any(is_term),
            _ => false,
        })
    }
}

/// Whether an operation consists of straight segments.
fn has_segments(operation: &Operation) -> bool {
    matches!(
        operation,
        Operation::Limited { .. }
            | Operation::DeadZone { .. }
            | Operation::Absolute(_)
            | Operation::Lower(_)
            | Operation::Higher(_)
            | Operation::Curve { .. }
    )
}
