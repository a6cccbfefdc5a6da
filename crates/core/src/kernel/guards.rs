//! Chooses the voltages that a quick step tests, and the interval of each.
//!
//! A quick step does not evaluate every watch. Several watches are linear functions of one voltage, so one interval of
//! that voltage replaces them. Every state gets an interval as well, so that a state that is not a number is noticed.

use std::collections::{HashMap, HashSet};

use indexmap::IndexSet;

use super::code::Slot;
use super::form::{Atom, Factor, Form};
use super::layout::Layouter;
use super::node::{Node, Operand};
use super::{IntervalWatch, RecordedVoltage, SafeInterval, WatchCondition};

/// Safe intervals, with the atoms to which they belong. Intervals of watches come first, then those of states that no
/// watch has used.
#[derive(Default)]
pub(super) struct SafeIntervals {
    /// The intervals, each with its slot and its watches.
    pub all: Vec<SafeInterval>,
    /// The atom of every interval.
    pub atoms: Vec<Atom>,
    /// Number of intervals that are tested at the first stage of a step; the first ones of all.
    pub first: usize,
    /// Number of intervals that are tested within a step: those of the first stage, then those of parabolas.
    pub within: usize,
    /// Index of the interval of each atom.
    indices: HashMap<Atom, usize>,
}

impl SafeIntervals {
    /// The interval of an atom in a slot, created if there is none.
    fn at(&mut self, atom: Atom, slot: Slot) -> &mut SafeInterval {
        let at = *self.indices.entry(atom).or_insert_with(|| {
            self.all.push(SafeInterval { slot, watches: Vec::new() });
            self.atoms.push(atom);
            self.all.len() - 1
        });
        &mut self.all[at]
    }
}

impl Layouter {
    /// The safe intervals for these watches, of which the first `within` are also tested within a step. Every state gets
    /// one, too.
    pub(super) fn safe_intervals(&self, watched: &[(Atom, WatchCondition)], within: usize) -> SafeIntervals {
        let mut safe_intervals = SafeIntervals::default();
        let lines: Vec<_> = watched.iter().map(|(atom, _)| self.as_line(*atom, |_| true)).collect();
        let curved: HashSet<Atom> = self.curved.iter().copied().collect();
        let (followed, first): (Vec<usize>, Vec<usize>) =
            (0..within).partition(|watch| curved.contains(&lines[*watch].0));
        let mut add_all = |watches: &mut dyn Iterator<Item = usize>| {
            for watch in watches {
                let (of, line) = lines[watch];
                let watches = &mut safe_intervals.at(of, self.slots[of as usize]).watches;
                watches.push(IntervalWatch { watch, line });
            }
            safe_intervals.all.len()
        };
        let first = add_all(&mut first.into_iter());
        let all_within = add_all(&mut followed.into_iter());
        add_all(&mut (within..watched.len()));
        (safe_intervals.first, safe_intervals.within) = (first, all_within);
        for (atom, node) in self.specialised.nodes.iter().enumerate() {
            if matches!(node, Node::State(_)) {
                safe_intervals.at(atom as Atom, self.slots[atom]);
            }
        }
        safe_intervals
    }

    /// A recorded voltage, with the tracked voltage on which it depends on every branch.
    pub(super) fn recorded(&self, operand: Operand, tracked: &mut IndexSet<Atom>) -> RecordedVoltage {
        let slot = self.operand(operand);
        let Operand::Atom(atom) = operand else { return RecordedVoltage { slot, tracks: None } };
        let (of, line) = self.as_line(atom, |factor| !self.is_branch_dependent(factor));
        if matches!(self.specialised.nodes[of as usize], Node::Time) {
            return RecordedVoltage { slot, tracks: None };
        }
        let (at, _) = tracked.insert_full(of);
        RecordedVoltage { slot, tracks: Some((at, line)) }
    }

    /// An atom as constant + factor x another atom, if it has this form and both numbers are acceptable. Otherwise the
    /// atom itself.
    pub(super) fn as_line(
        &self,
        atom: Atom,
        is_acceptable: impl Fn(Factor) -> bool,
    ) -> (Atom, Option<[Slot; 2]>) {
        match &self.specialised.nodes[atom as usize] {
            Node::Sum(Form { constant, terms }) if terms.len() == 1 => {
                let (of, line) = (terms[0].0, [*constant, terms[0].1]);
                if line.into_iter().all(is_acceptable) {
                    return (of, Some(line.map(|factor| self.factor(factor))));
                }
                (atom, None)
            }
            _ => (atom, None),
        }
    }

    /// Whether a factor differs between the branches.
    fn is_branch_dependent(&self, factor: Factor) -> bool {
        matches!(factor, Factor::Computed(register) if self.branch_dependent[register.index()])
    }
}
