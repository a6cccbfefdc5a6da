//! What a kernel is made of before it is laid out: voltages that are no sums, and how they come about.

use super::form::{Atom, Factor, Form};
use crate::patch::Function;

/// What an operation of a kernel reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operand {
    Factor(Factor),
    Atom(Atom),
}

/// How an atom comes about.
#[derive(Debug, Clone)]
pub(super) enum Node {
    State(u32),
    Time,
    Kept(u32),
    Noise(u32),
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
            Node::State(_) | Node::Time | Node::Kept(_) | Node::Noise(_) => Vec::new(),
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

/// What tells a node from others.
pub(super) fn key(node: &Node) -> Vec<u64> {
    let tag = match node {
        Node::State(index) => [0, u64::from(*index)],
        Node::Time => [1, 0],
        Node::Kept(index) => [2, u64::from(*index)],
        Node::Noise(index) => [3, u64::from(*index)],
        Node::Sum(_) => [4, 0],
        Node::Multiply(..) => [5, 0],
        Node::Minimum(..) => [6, 0],
        Node::Maximum(..) => [7, 0],
        Node::Absolute(_) => [8, 0],
        Node::Call(function, ..) => [9, *function as u64],
        Node::Table(table, _) => [10, u64::from(*table)],
    };
    let operands = node.operands().into_iter().flat_map(|operand| match operand {
        Operand::Factor(factor) => [u64::from(factor.key().0), factor.key().1],
        Operand::Atom(atom) => [2, u64::from(atom)],
    });
    tag.into_iter().chain(operands).collect()
}
