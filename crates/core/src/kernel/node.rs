//! What a kernel is made of before it is laid out: voltages that are no sums, and how they come about.

use super::form::{Atom, Factor, Form};
use patchcord_expr::Function;

/// What an operation of a kernel reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Operand {
    Factor(Factor),
    Atom(Atom),
}

/// How an atom comes about.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Node {
    State(u32),
    Time,
    /// What a table gives that is looked up at time itself, by its place among these.
    Scheduled(u32),
    /// What comes out of a delay line.
    Delayed(u32),
    Kept(u32),
    Level(u32),
    Sum(Form),
    Multiply(Operand, Operand),
    Minimum(Operand, Operand),
    Maximum(Operand, Operand),
    Absolute(Operand),
    Call(Function, Operand, Operand),
    Table(u32, Operand),
}

impl Node {
    pub fn operands(&self) -> Vec<Operand> {
        match self {
            Node::State(_)
            | Node::Time
            | Node::Scheduled(_)
            | Node::Delayed(_)
            | Node::Kept(_)
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

/// Those of some operands that are atoms.
pub(super) fn atoms(operands: &[Operand]) -> impl Iterator<Item = Atom> + '_ {
    operands.iter().filter_map(|operand| match operand {
        Operand::Atom(atom) => Some(*atom),
        Operand::Factor(_) => None,
    })
}

/// Of every atom, whether some depend on it.
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
