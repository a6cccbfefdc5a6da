//! Where fences stand: at the voltages that are watched, at every state, and at what is recorded.

use std::collections::HashMap;

use super::code::Slot;
use super::form::{Atom, Factor, Form};
use super::layout::Layouter;
use super::node::{Node, Operand};
use super::{Fence, Posted, Seen, Watched};

/// Fences, and the atoms at which they stand.
#[derive(Default)]
pub(super) struct Fences {
    pub all: Vec<Fence>,
    pub atoms: Vec<Atom>,
    /// So many, the first, are looked at in the middle of a step too.
    pub in_middle: usize,
    places: HashMap<Atom, usize>,
}

impl Fences {
    /// The fence at an atom, which stands in a slot.
    fn at(&mut self, atom: Atom, slot: Slot) -> &mut Fence {
        let at = *self.places.entry(atom).or_insert_with(|| {
            self.all.push(Fence { slot, watches: Vec::new() });
            self.atoms.push(atom);
            self.all.len() - 1
        });
        &mut self.all[at]
    }
}

impl Layouter {
    /// Fences for watches, some of which, the first, are looked at in the middle of a step too; and one at every state, which
    /// must be a number.
    pub fn fences(&self, watched: &[(Atom, Watched)], in_middle: usize) -> Fences {
        let mut fences = Fences::default();
        for (watch, (atom, _)) in watched.iter().enumerate() {
            let (of, line) = self.straight(*atom, |_| true);
            fences.at(of, self.slots[of as usize]).watches.push(Posted { watch, line });
            if watch < in_middle {
                fences.in_middle = fences.all.len();
            }
        }
        for (atom, node) in self.folded.nodes.iter().enumerate() {
            if matches!(node, Node::State(_)) {
                fences.at(atom as Atom, self.slots[atom]);
            }
        }
        fences
    }

    /// What is recorded, and among others what it follows on all sides of the corners.
    pub fn seen(&self, operand: Operand, followed: &mut Vec<Atom>) -> Seen {
        let slot = self.operand(operand);
        let Operand::Atom(atom) = operand else { return Seen { slot, follows: None } };
        let (of, line) = self.straight(atom, |factor| !self.depends_on_sides(factor));
        if matches!(self.folded.nodes[of as usize], Node::Time) {
            return Seen { slot, follows: None };
        }
        let at = followed.iter().position(|known| *known == of).unwrap_or_else(|| {
            followed.push(of);
            followed.len() - 1
        });
        Seen { slot, follows: Some((at, line)) }
    }

    /// An atom as a constant and another atom times a factor, where it is and both will do; else as itself.
    fn straight(&self, atom: Atom, will_do: impl Fn(Factor) -> bool) -> (Atom, Option<[Slot; 2]>) {
        match &self.folded.nodes[atom as usize] {
            Node::Sum(Form { constant, terms }) if terms.len() == 1 => {
                let (of, line) = (terms[0].0, [*constant, terms[0].1]);
                if line.into_iter().all(will_do) {
                    return (of, Some(line.map(|factor| self.factor(factor))));
                }
                (atom, None)
            }
            _ => (atom, None),
        }
    }

    fn depends_on_sides(&self, factor: Factor) -> bool {
        matches!(factor, Factor::Early(register) if self.given[register.index()])
    }
}
