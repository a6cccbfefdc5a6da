//! Equations that share their unknowns with constant factors: they are solved together.
//!
//! An example is the constant mass matrix of x'' + 3 y'' = -y and 2 x'' + y'' = -x. Alone, each equation gives one
//! unknown by the other one. That is a loop of summers, which latches up if its gain exceeds 1.

use std::collections::HashMap;

use patchcord_expr::Equation;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::DiGraph;

use super::constants::Constants;
use super::trees::{Occurrence, occurrences};
use crate::graph::{NodeId, Sum};
use crate::symbolic::Fraction;

/// The most equations that are solved together. In a larger group each unknown would depend on all others.
const MOST_EQUATIONS: usize = 8;
/// The most terms of a determinant. A longer one would be no readable formula.
const MOST_TERMS: usize = 24;

/// The solution of equations that share their unknowns.
pub(super) enum Joint {
    /// The values of the unknowns, in the order of the equations.
    Solved(Vec<Sum>),
    /// The equations do not determine the unknowns, or contradict each other.
    Singular,
    /// The formulas of the parameters would be too long.
    TooLong,
}

/// The groups of equations in which each unknown depends on the others with constant factors. `pairs` has the equations
/// and the unknown of each. A group is a list of indices in ascending order.
pub(super) fn coupled(pairs: &[(&Equation, &str)], constants: &Constants) -> Vec<Vec<usize>> {
    let owners: HashMap<&str, usize> =
        pairs.iter().enumerate().map(|(index, (_, unknown))| (*unknown, index)).collect();
    let is_constant =
        |equation: &Equation, name: &str| how(equation, name, constants) == Occurrence::Constant;
    let mut graph = DiGraph::<usize, ()>::new();
    let nodes: Vec<_> = (0..pairs.len()).map(|index| graph.add_node(index)).collect();
    for (index, (equation, own)) in pairs.iter().enumerate() {
        if !is_constant(equation, own) {
            continue;
        }
        for name in equation.names() {
            if let Some(other) = owners.get(name)
                && *other != index
                && is_constant(equation, name)
            {
                graph.add_edge(nodes[index], nodes[*other], ());
            }
        }
    }
    let members = kosaraju_scc(&graph).into_iter().map(|group| {
        let mut group: Vec<usize> = group.into_iter().map(|node| graph[node]).collect();
        group.sort_unstable();
        group
    });
    let mut groups: Vec<Vec<usize>> = members
        .filter(|group| (2..=MOST_EQUATIONS).contains(&group.len()))
        .filter(|group| is_linear(group, pairs, constants))
        .collect();
    groups.sort_unstable();
    groups
}

/// Whether all equations of a group contain its unknowns with constant factors only.
fn is_linear(group: &[usize], pairs: &[(&Equation, &str)], constants: &Constants) -> bool {
    let contains = |row: usize, column: usize| how(pairs[row].0, pairs[column].1, constants);
    group.iter().all(|row| group.iter().all(|column| contains(*row, *column) <= Occurrence::Constant))
}

/// How a quantity occurs in an equation.
fn how(equation: &Equation, name: &str, constants: &Constants) -> Occurrence {
    let [left, right] = occurrences(equation, name, constants);
    left.max(right)
}

/// Solves equations for their unknowns by Cramer's rule. Each residual is the left side minus the right side.
pub(super) fn solved_together(residuals: &[Sum], unknowns: &[NodeId], constants: &Constants) -> Joint {
    let factor = |residual: &Sum, unknown: &NodeId| residual.terms.get(unknown).cloned().unwrap_or_default();
    let row = |residual: &Sum| unknowns.iter().map(|unknown| factor(residual, unknown)).collect();
    let matrix: Vec<Vec<Fraction>> = residuals.iter().map(row).collect();
    let Some(whole) = determinant(&matrix) else { return Joint::TooLong };
    if whole.is_zero() || constants.value(&whole) == 0.0 {
        return Joint::Singular;
    }
    let rests: Vec<Sum> = residuals.iter().map(|residual| without(residual, unknowns)).collect();
    let mut values = vec![Sum::default(); unknowns.len()];
    for (column, value) in values.iter_mut().enumerate() {
        for (row, rest) in rests.iter().enumerate() {
            let Some(part) = determinant(&minor(&matrix, row, column)) else { return Joint::TooLong };
            let size = part.over(&whole);
            let factor = if (row + column).is_multiple_of(2) { size.negated() } else { size };
            *value = std::mem::take(value).plus(&rest.scaled(&factor));
        }
    }
    Joint::Solved(values)
}

/// The terms of a residual without the unknowns.
pub(super) fn without(residual: &Sum, unknowns: &[NodeId]) -> Sum {
    let mut rest = residual.clone();
    rest.terms.retain(|node, _| !unknowns.contains(node));
    rest
}

/// A matrix without one row and one column.
fn minor(matrix: &[Vec<Fraction>], row: usize, column: usize) -> Vec<Vec<Fraction>> {
    let mut minor = matrix.to_vec();
    minor.remove(row);
    minor.iter_mut().for_each(|entries| drop(entries.remove(column)));
    minor
}

/// The determinant of a square matrix. `None` if it, or that of a part of it, has too many terms.
///
/// Part by part, each set of columns is expanded along the last of as many rows. So every part is computed once.
fn determinant(rows: &[Vec<Fraction>]) -> Option<Fraction> {
    let size = rows.len();
    // The determinants of the first rows, by the set of columns as bits.
    let mut parts = vec![Fraction::whole(1)];
    for set in 1..1_usize << size {
        let row = set.count_ones() as usize - 1;
        let columns = (0..size).filter(|column| (set >> column) & 1 == 1);
        let mut sum = Fraction::zero();
        for (place, column) in columns.enumerate() {
            let term = rows[row][column].times(&parts[set & !(1 << column)]);
            sum = if (row + place).is_multiple_of(2) { sum.plus(&term) } else { sum.minus(&term) };
        }
        if sum.size() > MOST_TERMS {
            return None;
        }
        parts.push(sum);
    }
    parts.pop()
}
