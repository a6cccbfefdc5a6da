//! Where everything of a kernel stands, and in which order it is worked out.

use std::collections::HashMap;

use super::code::{Code, Instruction, Slot};
use super::fold::{At, Corner, Terms};
use super::form::{Atom, Factor, Form};
use super::node::{Node, Operand, atoms, needed};
use super::{Checks, Kernel, Layout, Watch, Watched};
use crate::ir::{Op, Program};

/// The kernel of what was folded of a program.
pub(super) fn laid_out(folded: Terms, program: &Program) -> Kernel {
    Layouter::new(folded, program).kernel()
}

/// Gives everything its slot.
pub(super) struct Layouter {
    pub folded: Terms,
    factors: Vec<Factor>,
    places: HashMap<Factor, Slot>,
    layout: Layout,
    /// Where every atom stands.
    pub slots: Vec<Slot>,
    /// How many operations one after the other lead to every atom.
    depths: Vec<u32>,
    /// Of every operation of the prologue, whether it depends on the sides of corners.
    pub given: Vec<bool>,
}

impl Layouter {
    fn new(folded: Terms, program: &Program) -> Self {
        let mut layouter = Layouter {
            factors: Vec::new(),
            places: HashMap::new(),
            layout: Layout::default(),
            slots: Vec::new(),
            depths: Vec::new(),
            given: Vec::new(),
            folded,
        };
        layouter.trace_sides();
        layouter.measure_depths();
        layouter.list_factors();
        layouter.place(program);
        layouter
    }

    fn trace_sides(&mut self) {
        for op in &self.folded.early.ops {
            let depends = op.operands().any(|operand| self.given[operand.index()]);
            self.given.push(depends || matches!(op, Op::State(_)));
        }
    }

    fn measure_depths(&mut self) {
        for node in &self.folded.nodes {
            let depth = |operand| match operand {
                Operand::Factor(_) => 0,
                Operand::Atom(atom) => self.depths[atom as usize] + 1,
            };
            self.depths.push(node.operands().into_iter().map(depth).max().unwrap_or(0));
        }
    }

    fn list_factors(&mut self) {
        let folded = &self.folded;
        let outputs =
            folded.rates.iter().chain(&folded.kept).chain(&folded.stored).chain(&folded.seen).copied();
        let bounds = folded.bounds.all.iter().flat_map(|(_, low, high)| [*low, *high].map(Operand::Factor));
        let all = outputs.chain(bounds).chain(folded.nodes.iter().flat_map(Node::operands));
        for operand in all {
            if let Operand::Factor(factor) = operand {
                let next = self.factors.len() as Slot;
                if *self.places.entry(factor).or_insert(next) == next {
                    self.factors.push(factor);
                }
            }
        }
    }

    fn place(&mut self, program: &Program) {
        let states = self.factors.len();
        let time = states + program.states.len();
        let scheduled = time + 1;
        let delayed = scheduled + self.folded.scheduled.len();
        let kept = delayed + program.delays.len();
        let levels = kept + program.kept.len();
        let results = levels + program.levels.len();
        let mut next = results;
        for node in &self.folded.nodes {
            self.slots.push(match node {
                Node::State(index) => states as Slot + index,
                Node::Time => time as Slot,
                Node::Scheduled(index) => scheduled as Slot + index,
                Node::Delayed(index) => delayed as Slot + index,
                Node::Kept(index) => kept as Slot + index,
                Node::Level(index) => levels as Slot + index,
                _ => {
                    next += 1;
                    next as Slot - 1
                }
            });
        }
        self.layout = Layout { states, time, scheduled, delayed, kept, levels, results, all: next };
    }

    pub fn operand(&self, operand: Operand) -> Slot {
        match operand {
            Operand::Factor(factor) => self.factor(factor),
            Operand::Atom(atom) => self.slots[atom as usize],
        }
    }

    pub fn factor(&self, factor: Factor) -> Slot {
        self.places[&factor]
    }

    fn kernel(self) -> Kernel {
        let folded = &self.folded;
        let (watched, watched_in_middle) = self.watched();
        let fences = self.fences(&watched, watched_in_middle);
        let mut followed = Vec::new();
        let seen = folded.seen.iter().map(|operand| self.seen(*operand, &mut followed)).collect();
        let slots = |operands: &[Operand]| operands.iter().map(|operand| self.operand(*operand)).collect();
        let mut done = vec![false; folded.nodes.len()];
        let moving = self.code(&mut done, atoms(&folded.rates));
        let watched_atoms: Vec<Atom> = watched.iter().map(|(atom, _)| *atom).collect();
        let corners = watched.iter().filter(|(_, what)| what.is_corner()).count();
        let slot = |atom: Atom| self.slots[atom as usize];
        Kernel {
            layout: self.layout,
            moving,
            quick: self.checks(&done, &fences.atoms, fences.in_middle, followed.iter().copied()),
            thorough: self.checks(&done, &watched_atoms, watched_in_middle, atoms(&folded.seen)),
            rates: slots(&folded.rates),
            kept: slots(&folded.kept),
            stored: slots(&folded.stored),
            seen,
            followed: followed.into_iter().map(slot).collect(),
            watches: watched.into_iter().map(|(atom, what)| Watch { slot: slot(atom), what }).collect(),
            corners,
            fences: fences.all,
            still: folded.bounds.still.clone(),
            given: folded.early.given as usize,
            scheduled: folded.scheduled.clone(),
            early: self.folded.early.ops,
            factors: self.factors,
        }
    }

    /// What is watched, and how much of it, the first, in the middle of a step too.
    fn watched(&self) -> (Vec<(Atom, Watched)>, usize) {
        let mut watched = Vec::new();
        for &Corner { of, at } in &self.folded.corners {
            match at {
                At::Zero { side } => watched.push((of, Watched::Corner { side })),
                At::Points { table, piece } => {
                    watched.extend([false, true].map(|above| (of, Watched::Points { table, above, piece })))
                }
            }
        }
        let mut in_middle = watched.len();
        let bounds = &self.folded.bounds;
        for (index, (atom, low, high)) in bounds.all.iter().enumerate() {
            watched.extend(self.bounds(*low, *high).into_iter().map(|what| (*atom, what)));
            if index < bounds.guards {
                in_middle = watched.len();
            }
        }
        (watched, in_middle)
    }

    /// What has to be watched of a voltage between two numbers.
    fn bounds(&self, low: Factor, high: Factor) -> Vec<Watched> {
        match (low, high) {
            (Factor::Number(low), Factor::Number(number)) if low == -number => {
                vec![Watched::Size(self.factor(high))]
            }
            (Factor::Number(f64::NEG_INFINITY), _) => vec![Watched::Below(self.factor(high))],
            (_, Factor::Number(f64::INFINITY)) => vec![Watched::Above(self.factor(low))],
            _ => vec![Watched::Above(self.factor(low)), Watched::Below(self.factor(high))],
        }
    }

    /// What is worked out to look at some atoms, beyond what is done: the first of them in the middle of a step too. At
    /// its end also what is kept or delayed, and what is seen.
    fn checks(
        &self,
        done: &[bool],
        looked_at: &[Atom],
        in_middle: usize,
        seen: impl Iterator<Item = Atom>,
    ) -> Checks {
        let mut done = done.to_vec();
        let ending = atoms(&self.folded.kept).chain(atoms(&self.folded.stored)).chain(seen);
        Checks {
            middle: self.code(&mut done, looked_at[..in_middle].iter().copied()),
            ending: self.code(&mut done, looked_at[in_middle..].iter().copied().chain(ending)),
            in_middle,
            all: looked_at.len(),
        }
    }

    /// The operations that some atoms need, and that are not done yet.
    fn code(&self, done: &mut [bool], wanted: impl Iterator<Item = Atom>) -> Code {
        let mut code = Code::default();
        let needed = needed(&self.folded.nodes, wanted);
        for (at, node) in self.folded.nodes.iter().enumerate() {
            if needed[at] && !std::mem::replace(&mut done[at], true) {
                self.emit(node, self.slots[at], &mut code);
            }
        }
        code
    }

    fn emit(&self, node: &Node, out: Slot, code: &mut Code) {
        let of = |operand: &Operand| self.operand(*operand);
        let instruction = match node {
            Node::State(_)
            | Node::Time
            | Node::Scheduled(_)
            | Node::Delayed(_)
            | Node::Kept(_)
            | Node::Level(_) => return,
            Node::Sum(form) => self.sum(form, out, code),
            Node::Multiply(a, b) => Instruction::Multiply { out, a: of(a), b: of(b) },
            Node::Minimum(a, b) => Instruction::Minimum { out, a: of(a), b: of(b) },
            Node::Maximum(a, b) => Instruction::Maximum { out, a: of(a), b: of(b) },
            Node::Absolute(a) => Instruction::Absolute { out, a: of(a) },
            Node::Call(function, a, b) => Instruction::Call { out, function: *function, a: of(a), b: of(b) },
            Node::Table(table, a) => Instruction::Table { out, table: *table, a: of(a) },
        };
        code.instructions.push(instruction);
    }

    fn sum(&self, form: &Form, out: Slot, code: &mut Code) -> Instruction {
        let constant = self.factor(form.constant);
        let slots = |&(atom, factor): &(Atom, Factor)| (self.factor(factor), self.slots[atom as usize]);
        if let [term] = &form.terms[..] {
            let (factor, a) = slots(term);
            return if form.constant.is(0.0) {
                Instruction::Multiply { out, a: factor, b: a }
            } else {
                Instruction::Line { out, constant, factor, a }
            };
        }
        // What comes last is added last, so that it is waited for but once.
        let mut terms = form.terms.clone();
        terms.sort_by_key(|(atom, _)| self.depths[*atom as usize]);
        let first = code.terms.len() as u32;
        code.terms.extend(terms.iter().map(slots));
        Instruction::Sum { out, constant, first, count: terms.len() as u32 }
    }
}
