//! Groups of corners: which corners can influence each other before time advances.
//!
//! Two corners are in one group if a voltage, a rate, a bound or a watch in the step ahead depends on the sides of
//! both. Corners of different groups can be crossed in any order or together, with the same bits.

use petgraph::unionfind::UnionFind;

use super::form::Factor;
use super::node::{Node, Operand};
use super::specialise::{At, Specialised};
use crate::ir::Op;

/// A corner on whose side something depends; `None` if it depends on no side. If it depends on several sides, their
/// corners are in one group, so any of them represents all.
type Dependence = Option<u32>;

/// The group of every watch of a corner, in the order of the watches.
pub(super) fn corner_groups(specialised: &Specialised) -> Vec<u32> {
    let mut groups = UnionFind::new(specialised.corners.len());
    let computed = dependences_of_factors(specialised, &mut groups);
    let of_factor = |factor: Factor| match factor {
        Factor::Number(_) => None,
        Factor::Computed(register) => computed[register.index()],
    };
    let of_atoms = dependences_of_atoms(specialised, of_factor, &mut groups);
    for (corner, entry) in (0..).zip(&specialised.corners) {
        join(&mut groups, [Some(corner), of_atoms[entry.of as usize]]);
    }
    for (atom, low, high) in &specialised.bounds.all {
        join(&mut groups, [of_atoms[*atom as usize], of_factor(*low), of_factor(*high)]);
    }
    for value_and_bounds in &specialised.bounds.fixed {
        join(&mut groups, value_and_bounds.map(of_factor));
    }
    let watches = |at: At| match at {
        At::Zero { .. } => 1,
        At::Points { .. } => 2,
    };
    let labels = groups.into_labeling().into_iter().zip(&specialised.corners);
    labels.flat_map(|(group, corner)| std::iter::repeat_n(group, watches(corner.at))).collect()
}

/// Joins the groups of some corners. Returns one of the corners.
fn join(groups: &mut UnionFind<u32>, corners: impl IntoIterator<Item = Dependence>) -> Dependence {
    corners.into_iter().flatten().reduce(|one, other| {
        groups.union(one, other);
        one
    })
}

/// The dependence of every operation of the parameter code.
fn dependences_of_factors(specialised: &Specialised, groups: &mut UnionFind<u32>) -> Vec<Dependence> {
    let code = &specialised.parameter_code;
    let mut owners = vec![0; code.branch_values as usize];
    for (corner, entry) in (0..).zip(&specialised.corners) {
        match entry.at {
            At::Zero { side } => owners[side as usize] = corner,
            At::Points { piece, .. } => owners[piece as usize..][..3].fill(corner),
        }
    }
    let mut found: Vec<Dependence> = Vec::with_capacity(code.ops.len());
    for op in &code.ops {
        // Branch values are read as states there.
        let own = if let Op::State(value) = *op { Some(owners[value as usize]) } else { None };
        let all = op.operands().map(|operand| found[operand.index()]).chain([own]);
        let joint = join(groups, all);
        found.push(joint);
    }
    found
}

/// The dependence of every atom. A state depends on its rate, because the step ahead is examined before a corner is
/// crossed.
fn dependences_of_atoms(
    specialised: &Specialised,
    of_factor: impl Fn(Factor) -> Dependence,
    groups: &mut UnionFind<u32>,
) -> Vec<Dependence> {
    let nodes = &specialised.nodes;
    let mut found: Vec<Dependence> = vec![None; nodes.len()];
    let mut readers: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    for (at, node) in nodes.iter().enumerate() {
        let rate =
            if let Node::State(state) = node { Some(specialised.rates[*state as usize]) } else { None };
        for operand in node.operands().into_iter().chain(rate) {
            match operand {
                Operand::Factor(factor) => found[at] = join(groups, [found[at], of_factor(factor)]),
                Operand::Atom(atom) => readers[atom as usize].push(at),
            }
        }
    }
    let mut open: Vec<usize> = (0..nodes.len()).filter(|at| found[*at].is_some()).collect();
    while let Some(at) = open.pop() {
        for reader in &readers[at] {
            if found[*reader].is_none() {
                open.push(*reader);
            }
            found[*reader] = join(groups, [found[*reader], found[at]]);
        }
    }
    found
}
