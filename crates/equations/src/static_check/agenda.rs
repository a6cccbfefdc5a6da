//! The order in which equations are solved: those with the fewest unknown quantities first.

use std::collections::{BTreeMap, BTreeSet};

use crate::symbolic::{Fraction, Symbol};

/// Unknowns that several equations determine together, at most.
const MAX_BLOCK: usize = 6;

/// Equations with their unknown quantities. Each is due again when the unknowns of it, or of an equation that shares
/// unknowns with it, change. So the work grows with the number of equations and not with its square.
#[derive(Debug, Default)]
pub(super) struct Agenda {
    /// The equations.
    equations: Vec<Posed>,
    /// The equations in which each quantity occurs.
    readers: BTreeMap<Symbol, Vec<usize>>,
    /// The equations that are due, each after its number of unknowns.
    due: BTreeSet<(usize, usize)>,
}

/// An equation.
#[derive(Debug)]
pub(super) struct Posed {
    /// The expression that is 0.
    pub residual: Fraction,
    /// Index of the stated equation from which it follows.
    pub stated: usize,
    /// The quantities in it that vary.
    pub symbols: BTreeSet<Symbol>,
    /// Those that are unknown.
    pub unknowns: BTreeSet<Symbol>,
}

impl Agenda {
    /// Number of equations.
    pub(super) fn count(&self) -> usize {
        self.equations.len()
    }

    /// The equation at an index.
    pub(super) fn equation(&self, index: usize) -> &Posed {
        &self.equations[index]
    }

    /// Adds an equation.
    pub(super) fn add(&mut self, equation: Posed) {
        let index = self.equations.len();
        for symbol in &equation.symbols {
            self.readers.entry(*symbol).or_default().push(index);
        }
        self.equations.push(equation);
        self.make_due(index);
        self.make_neighbours_due(index);
    }

    /// Notes that a quantity is known.
    pub(super) fn know(&mut self, symbol: Symbol) {
        for index in self.readers.get(&symbol).cloned().unwrap_or_default() {
            let count = self.equations[index].unknowns.len();
            if self.equations[index].unknowns.remove(&symbol) {
                self.due.remove(&(count, index));
                self.make_due(index);
                self.make_neighbours_due(index);
            }
        }
    }

    /// The equation that is due first. It is then no longer due.
    pub(super) fn pop(&mut self) -> Option<usize> {
        self.due.pop_first().map(|(_, index)| index)
    }

    /// An equation with as many others as its unknowns need, which have no further unknowns. `None` if there are too
    /// few.
    pub(super) fn block(&self, index: usize) -> Option<Vec<usize>> {
        let own = &self.equations[index].unknowns;
        let others: BTreeSet<usize> = own.iter().flat_map(|symbol| &self.readers[symbol]).copied().collect();
        let is_inside = |other: &usize| {
            let unknowns = &self.equations[*other].unknowns;
            *other != index && !unknowns.is_empty() && unknowns.is_subset(own)
        };
        let others = others.into_iter().filter(is_inside);
        let block: Vec<usize> = std::iter::once(index).chain(others).take(own.len()).collect();
        (block.len() == own.len()).then_some(block)
    }

    /// Makes an equation due if it has few unknowns.
    fn make_due(&mut self, index: usize) {
        let count = self.equations[index].unknowns.len();
        if (1..=MAX_BLOCK).contains(&count) {
            self.due.insert((count, index));
        }
    }

    /// Makes the equations due that share unknowns with an equation which can be part of their blocks.
    fn make_neighbours_due(&mut self, index: usize) {
        let unknowns = &self.equations[index].unknowns;
        if unknowns.len() > MAX_BLOCK {
            return;
        }
        let neighbours: BTreeSet<usize> =
            unknowns.iter().flat_map(|symbol| &self.readers[symbol]).copied().collect();
        neighbours.into_iter().for_each(|neighbour| self.make_due(neighbour));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::reading::read;
    use crate::testing::symbol;

    /// An equation whose quantities are all unknown.
    fn posed(text: &str, names: &[&str]) -> Posed {
        let symbols: BTreeSet<Symbol> = names.iter().map(|name| symbol(name)).collect();
        Posed { residual: read(text), stated: 0, unknowns: symbols.clone(), symbols }
    }

    #[test]
    fn equations_with_few_unknowns_come_first_and_are_due_again_when_these_change() {
        let mut agenda = Agenda::default();
        agenda.add(posed("x + y + z", &["x", "y", "z"]));
        agenda.add(posed("x - y", &["x", "y"]));
        agenda.add(posed("z - 2", &["z"]));
        assert_eq!(agenda.pop(), Some(2));
        assert_eq!(agenda.block(2), Some(vec![2]));
        // Nothing is known yet: two unknowns need two equations.
        assert_eq!(agenda.pop(), Some(1));
        assert_eq!(agenda.block(1), None);
        assert_eq!(agenda.pop(), Some(0));
        assert_eq!(agenda.block(0), Some(vec![0, 1, 2]));
        assert_eq!(agenda.pop(), None);
        agenda.know(symbol("z"));
        assert_eq!(agenda.pop(), Some(0));
        assert_eq!(agenda.block(0), Some(vec![0, 1]));
        assert_eq!(agenda.pop(), Some(1));
        assert_eq!(agenda.pop(), None);
        agenda.know(symbol("x"));
        agenda.know(symbol("y"));
        assert_eq!(agenda.pop(), None);
    }
}
