//! The operations of a kernel before slots are assigned.
//!
//! A node computes one atom. The atom has the index of its node, and the operands of a node are atoms with smaller
//! indices or factors. So the list of nodes is in order of evaluation.

use super::form::{Atom, Factor, Form};
use patchcord_expr::Function;

/// An operand of an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Operand {
    /// A number that does not vary within a branch.
    Factor(Factor),
    /// A voltage that another node computes.
    Atom(Atom),
}

/// An operation that computes an atom.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// The state with this index.
    State(u32),
    /// Problem time in seconds.
    Time,
    /// A table that is looked up at time, by its index among these.
    Scheduled(u32),
    /// The output of a delay line.
    Delayed(u32),
    /// The sampled value with this index.
    Sampled(u32),
    /// The level with this index.
    Level(u32),
    /// A linear form of other atoms.
    Sum(Form),
    /// The product of two voltages.
    Multiply(Operand, Operand),
    /// The smaller of two voltages, without a corner on which a rate depends.
    Minimum(Operand, Operand),
    /// The larger of two voltages, without such a corner.
    Maximum(Operand, Operand),
    /// The absolute value, without such a corner.
    Absolute(Operand),
    /// A function of one or two voltages.
    Call(Function, Operand, Operand),
    /// The table with this index at a voltage, without such a corner.
    Table(u32, Operand),
}

impl Node {
    /// The operands that the operation reads, with the factors of a sum.
    pub(super) fn operands(&self) -> Vec<Operand> {
        match self {
            Node::State(_)
            | Node::Time
            | Node::Scheduled(_)
            | Node::Delayed(_)
            | Node::Sampled(_)
            | Node::Level(_) => Vec::new(),
            Node::Sum(form) => {
                let terms = form.terms.iter();
                let constant = [Operand::Factor(form.constant)];
                terms
                    .flat_map(|(atom, factor)| [Operand::Factor(*factor), Operand::Atom(*atom)])
                    .chain(constant)
                    .collect()
            }
            Node::Absolute(a) | Node::Table(_, a) => vec![*a],
            Node::Multiply(a, b) | Node::Minimum(a, b) | Node::Maximum(a, b) | Node::Call(_, a, b) => {
                vec![*a, *b]
            }
        }
    }
}

/// The atoms among some operands.
pub(super) fn atoms(operands: &[Operand]) -> impl Iterator<Item = Atom> + '_ {
    operands.iter().filter_map(|operand| match operand {
        Operand::Atom(atom) => Some(*atom),
        Operand::Factor(_) => None,
    })
}

/// For every atom, whether one of the given atoms depends on it.
pub(super) fn needed(nodes: &[Node], by: impl Iterator<Item = Atom>) -> Vec<bool> {
    let mut needed = vec![false; nodes.len()];
    by.for_each(|atom| needed[atom as usize] = true);
    for at in (0..nodes.len()).rev() {
        if needed[at] {
            atoms(&nodes[at].operands()).for_each(|atom| needed[atom as usize] = true);
        }
    }
    needed
}
