//! Matches each equation with the unknown that it determines.
//!
//! The matching is bipartite, by augmenting paths. Pairs of the best class are matched first, then those of the next
//! one. The class of a pair is better if the equation is easier to solve for the unknown, and if the unknown is on the
//! left.

use std::collections::{HashMap, VecDeque};

use patchcord_core::circuit::Circuit;
use patchcord_expr::Equation;

use super::constants::Constants;
use super::trees::{Occurrence, occurrences, only_name};
use super::unknowns::{Unknowns, laws};

/// Which equation determines which unknown.
pub(super) struct Matching {
    /// The unknown of each equation, as an index. `None` for initial values and for equations without an unknown.
    pub of_equation: Vec<Option<usize>>,
    /// The equation of each unknown, as an index. `None` if no equation determines it.
    pub of_unknown: Vec<Option<usize>>,
}

/// An unknown that an equation contains.
struct Edge {
    /// The index of the unknown.
    unknown: usize,
    /// The class of the pair. 0 is the best.
    class: u8,
}

/// The class of an equation that is not linear in an unknown on its right.
const WORST_CLASS: u8 = 6;

/// Matches as many equations and unknowns as possible.
pub(super) fn matched(circuit: &Circuit, unknowns: &Unknowns, constants: &Constants) -> Matching {
    let mut edges: Vec<Vec<Edge>> = circuit.equations().iter().map(|_| Vec::new()).collect();
    for (index, placed) in laws(circuit) {
        edges[index] = edges_of(&placed.value, unknowns, constants);
    }
    let of_equation = vec![None; edges.len()];
    let mut matching = Matching { of_equation, of_unknown: vec![None; unknowns.all.len()] };
    for class in 0..=WORST_CLASS {
        for equation in 0..edges.len() {
            if matching.of_equation[equation].is_none() {
                matching.augment(&edges, class, equation);
            }
        }
    }
    matching
}

/// The unknowns of an equation, the best class first.
fn edges_of(equation: &Equation, unknowns: &Unknowns, constants: &Constants) -> Vec<Edge> {
    let edge = |name: &str| {
        let unknown = unknowns.index(name)?;
        Some(Edge { unknown, class: class(equation, name, constants) })
    };
    let mut edges: Vec<Edge> = equation.names().into_iter().filter_map(edge).collect();
    edges.sort_by_key(|edge| edge.class);
    edges
}

/// The class of an equation with an unknown.
fn class(equation: &Equation, name: &str, constants: &Constants) -> u8 {
    let [left, right] = occurrences(equation, name, constants);
    let is_on_right = u8::from(left == Occurrence::Absent);
    match left.max(right) {
        Occurrence::Absent | Occurrence::Constant => {
            let is_alone = only_name(equation.left()).is_some() && is_on_right == 0;
            if is_alone && right == Occurrence::Absent { 0 } else { 1 + is_on_right }
        }
        Occurrence::Varying => 3 + is_on_right,
        Occurrence::Nonlinear => WORST_CLASS - 1 + is_on_right,
    }
}

impl Matching {
    /// Matches one more equation, by edges up to this class: along the shortest path from the equation to a free
    /// unknown, every equation gets the next unknown.
    fn augment(&mut self, edges: &[Vec<Edge>], class: u8, equation: usize) {
        let mut reached_from: HashMap<usize, usize> = HashMap::new();
        let mut open = VecDeque::from([equation]);
        while let Some(equation) = open.pop_front() {
            for edge in edges[equation].iter().filter(|edge| edge.class <= class) {
                if reached_from.contains_key(&edge.unknown) {
                    continue;
                }
                reached_from.insert(edge.unknown, equation);
                match self.of_unknown[edge.unknown] {
                    Some(other) => open.push_back(other),
                    None => return self.flip(&reached_from, edge.unknown),
                }
            }
        }
    }

    /// Matches the equations on a path to a free unknown, each with the unknown that was reached from it.
    fn flip(&mut self, reached_from: &HashMap<usize, usize>, free: usize) {
        let mut next = Some(free);
        while let Some(unknown) = next {
            let equation = reached_from[&unknown];
            next = self.of_equation[equation].replace(unknown);
            self.of_unknown[unknown] = Some(equation);
        }
    }
}
