//! Assigns slots to everything in a kernel, and orders its operations.
//!
//! The order of the slots is: factors, states, time, tables of time, delay lines, sampled values, levels, results. The
//! order of evaluation is that of the nodes. The operations are split into lists by the part of a step in which they
//! are needed: in every stage, in the middle, or at the end.
//!
//! A quick step tests safe intervals, and a thorough step tests every watch. So each has its own lists for the middle
//! and the end.

use std::collections::{HashMap, HashSet};

use indexmap::IndexSet;

use super::code::{Code, Instruction, Slot};
use super::form::{Atom, Factor, Form};
use super::node::{Node, Operand, atoms, needed};
use super::specialise::{At, Corner, Specialised};
use super::{Checks, Followed, Kernel, Layout, Watch, WatchCondition};
use crate::ir::{Op, Program};

/// Makes the kernel of a specialised program.
pub(super) fn lay_out(specialised: Specialised, program: &Program) -> Kernel {
    Layouter::new(specialised, program).kernel()
}

/// Assigns slots and emits the operations. The fields are filled one after the other by [`Layouter::new`].
pub(super) struct Layouter {
    /// What is laid out: the nodes, the outputs and the bounds.
    pub specialised: Specialised,
    /// The factors in the order of their slots.
    factors: Vec<Factor>,
    /// The slot of every factor.
    factor_slots: HashMap<Factor, Slot>,
    /// The first slots of the inputs and of the results.
    layout: Layout,
    /// The slot of every atom.
    pub slots: Vec<Slot>,
    /// For every atom, the length of the longest chain of operations that leads to it.
    depths: Vec<u32>,
    /// For every operation of the parameter code, whether it depends on the branch.
    pub branch_dependent: Vec<bool>,
    /// For every atom, whether it is a linear function of states, time and constants within a step.
    straight: Vec<bool>,
    /// For every atom, whether its curve within a step is that of a drive or a delay line.
    curved_by_drive: Vec<bool>,
    /// The other atoms with guards or corners, whose parabola within a step is computed.
    pub curved: Vec<Atom>,
    /// Indices of the sampled values whose turning points count.
    turning: Vec<usize>,
}

impl Layouter {
    /// Traces the branches, measures the depths, lists the factors and assigns the slots.
    fn new(specialised: Specialised, program: &Program) -> Self {
        let mut layouter = Layouter {
            factors: Vec::new(),
            factor_slots: HashMap::new(),
            layout: Layout::default(),
            slots: Vec::new(),
            depths: Vec::new(),
            branch_dependent: Vec::new(),
            straight: Vec::new(),
            curved_by_drive: Vec::new(),
            curved: Vec::new(),
            turning: Vec::new(),
            specialised,
        };
        layouter.trace_branches();
        layouter.measure_depths();
        layouter.list_factors();
        layouter.find_straight_atoms();
        layouter.list_followed(program);
        layouter.assign_slots(program);
        layouter
    }

    /// Finds the operations of the parameter code that depend on the branch. Branch values are read as states there,
    /// and the dependence spreads to every operation with such an operand.
    fn trace_branches(&mut self) {
        for op in &self.specialised.parameter_code.ops {
            let depends = op.operands().any(|operand| self.branch_dependent[operand.index()]);
            self.branch_dependent.push(depends || matches!(op, Op::State(_)));
        }
    }

    /// Finds the longest chain of operations that leads to every atom; 0 for inputs.
    fn measure_depths(&mut self) {
        for node in &self.specialised.nodes {
            let depth = |operand| match operand {
                Operand::Factor(_) => 0,
                Operand::Atom(atom) => self.depths[atom as usize] + 1,
            };
            self.depths.push(node.operands().into_iter().map(depth).max().unwrap_or(0));
        }
    }

    /// Lists every factor that an operation or a bound reads, once. Factors that only lead to other factors stay in
    /// registers of the parameter code and get no slot.
    fn list_factors(&mut self) {
        let specialised = &self.specialised;
        let outputs = specialised
            .rates
            .iter()
            .chain(&specialised.sampled)
            .chain(&specialised.delay_inputs)
            .chain(&specialised.recorded)
            .copied();
        let bounds =
            specialised.bounds.all.iter().flat_map(|(_, low, high)| [*low, *high].map(Operand::Factor));
        let all = outputs.chain(bounds).chain(specialised.nodes.iter().flat_map(Node::operands));
        for operand in all {
            if let Operand::Factor(factor) = operand {
                let next = self.factors.len() as Slot;
                if *self.factor_slots.entry(factor).or_insert(next) == next {
                    self.factors.push(factor);
                }
            }
        }
    }

    /// Finds the atoms that are linear functions of states and time, and those whose curve within a step is that of a drive
    /// or a delay line. Tables of time are linear, because steps end at their corners.
    fn find_straight_atoms(&mut self) {
        let mut depends_on_time: Vec<bool> = Vec::new();
        for node in &self.specialised.nodes {
            let operands = node.operands();
            let any = |flags: &[bool]| atoms(&operands).any(|atom| flags[atom as usize]);
            let is_curved_by_drive = match node {
                Node::Sum(_) => any(&self.curved_by_drive),
                Node::Delayed(_) => true,
                _ => any(&depends_on_time),
            };
            self.curved_by_drive.push(is_curved_by_drive);
            let is_time = matches!(node, Node::Time | Node::Scheduled(_) | Node::Delayed(_));
            depends_on_time.push(is_time || any(&depends_on_time));
            self.straight.push(match node {
                Node::State(_) | Node::Time | Node::Scheduled(_) | Node::Sampled(_) | Node::Level(_) => true,
                Node::Sum(form) => form.terms.iter().all(|(atom, _)| self.straight[*atom as usize]),
                _ => false,
            });
        }
    }

    /// Lists the voltages whose parabola within a step is computed: those with guards that are not linear functions of
    /// states and time. Those with corners only are among them if their curve is that of a drive, or if there are sampled
    /// values whose turning points count. For products of states, the test of a corner at the first stage is enough.
    fn list_followed(&mut self, program: &Program) {
        let sampled = program.lowered.sampled.iter().zip(&self.specialised.sampled).enumerate();
        let turning = sampled
            .filter(|(_, (sampled, next))| sampled.follows.is_some() && matches!(next, Operand::Atom(_)));
        self.turning = turning.map(|(index, _)| index).collect();
        let (watched, within) = self.watched();
        let lines: Vec<Atom> =
            watched[..within].iter().map(|(atom, _)| self.as_line(*atom, |_| true).0).collect();
        let counts = |of: Atom, condition: WatchCondition| {
            !condition.is_corner() || self.curved_by_drive[of as usize] || !self.turning.is_empty()
        };
        let pairs = lines.iter().zip(&watched);
        let mut counted: HashSet<Atom> =
            pairs.filter(|(of, (_, condition))| counts(**of, *condition)).map(|(of, _)| *of).collect();
        // The order is that of the intervals.
        let curved = lines.iter().filter(|of| !self.straight[**of as usize] && counted.remove(of));
        self.curved = curved.copied().collect();
    }

    /// The atoms of the sampled values whose turning points count.
    fn turning_atoms(&self) -> impl Iterator<Item = Atom> + '_ {
        self.turning.iter().flat_map(|index| atoms(&self.specialised.sampled[*index..=*index]))
    }

    /// The voltages whose parabola is computed: those with an interval first.
    fn followed(&self) -> Vec<Followed> {
        let Layout { sampled, begins, .. } = self.layout;
        let curved = self.curved.iter().copied().zip(begins..);
        let turning = self.turning_atoms().zip(self.turning.iter().map(|index| sampled + index));
        let slots =
            |(atom, begin): (Atom, usize)| Followed { slot: self.slots[atom as usize], begin: begin as Slot };
        curved.chain(turning).map(slots).collect()
    }

    /// Assigns the slots of inputs and results. All inputs of the program get a slot, even if the kernel does not read
    /// them, so that the solver can copy its lists as a whole.
    fn assign_slots(&mut self, program: &Program) {
        let states = self.factors.len();
        let time = states + program.lowered.states.len();
        let scheduled = time + 1;
        let delayed = scheduled + self.specialised.scheduled.len();
        let sampled = delayed + program.lowered.delays.len();
        let begins = sampled + program.lowered.sampled.len();
        let levels = begins + self.curved.len();
        let results = levels + program.lowered.levels.len();
        let mut next = results;
        for node in &self.specialised.nodes {
            self.slots.push(match node {
                Node::State(index) => states as Slot + index,
                Node::Time => time as Slot,
                Node::Scheduled(index) => scheduled as Slot + index,
                Node::Delayed(index) => delayed as Slot + index,
                Node::Sampled(index) => sampled as Slot + index,
                Node::Level(index) => levels as Slot + index,
                _ => {
                    next += 1;
                    next as Slot - 1
                }
            });
        }
        self.layout =
            Layout { states, time, scheduled, delayed, sampled, begins, levels, results, all: next };
    }

    /// The slot of an operand.
    pub(super) fn operand(&self, operand: Operand) -> Slot {
        match operand {
            Operand::Factor(factor) => self.factor(factor),
            Operand::Atom(atom) => self.slots[atom as usize],
        }
    }

    /// The slot of a factor that an operation or a bound reads.
    pub(super) fn factor(&self, factor: Factor) -> Slot {
        self.factor_slots[&factor]
    }

    /// Assembles the kernel: watches and safe intervals first, then the operations for the rates, then those of the
    /// checks, which leave out what is already computed.
    fn kernel(self) -> Kernel {
        let specialised = &self.specialised;
        let (watched, watched_within) = self.watched();
        let safe_intervals = self.safe_intervals(&watched, watched_within);
        let mut tracked = IndexSet::new();
        let recorded =
            specialised.recorded.iter().map(|operand| self.recorded(*operand, &mut tracked)).collect();
        let slots = |operands: &[Operand]| operands.iter().map(|operand| self.operand(*operand)).collect();
        let mut done = vec![false; specialised.nodes.len()];
        let moving = self.code(&mut done, atoms(&specialised.rates));
        let watched_atoms: Vec<Atom> = watched.iter().map(|(atom, _)| *atom).collect();
        let corners = watched.iter().filter(|(_, condition)| condition.is_corner()).count();
        let slot = |atom: Atom| self.slots[atom as usize];
        Kernel {
            layout: self.layout,
            moving,
            quick: self.checks(
                &done,
                (&safe_intervals.atoms, safe_intervals.within),
                &self.curved,
                tracked.iter().copied(),
            ),
            thorough: self.checks(
                &done,
                (&watched_atoms, watched_within),
                &watched_atoms[..watched_within],
                atoms(&specialised.recorded),
            ),
            rates: slots(&specialised.rates),
            sampled: specialised
                .sampled
                .iter()
                .map(|operand| self.operand(*operand))
                .chain(self.curved.iter().map(|atom| slot(*atom)))
                .collect(),
            first_intervals: safe_intervals.first,
            followed: self.followed(),
            curved_intervals: self.curved.len(),
            delay_inputs: slots(&specialised.delay_inputs),
            recorded,
            tracked: tracked.into_iter().map(slot).collect(),
            watches: watched
                .into_iter()
                .map(|(atom, condition)| Watch { slot: slot(atom), condition })
                .collect(),
            corners,
            safe_intervals: safe_intervals.all,
            fixed: specialised.bounds.fixed.clone(),
            branch_values: specialised.parameter_code.branch_values as usize,
            scheduled: specialised.scheduled.clone(),
            parameter_code: self.specialised.parameter_code.ops,
            factors: self.factors,
        }
    }

    /// The watched atoms with their conditions, and how many of the first ones are also tested within a step.
    ///
    /// The order is: corners, guards and ends of overloads, ranges of amplifiers. A table has two watches, for the next
    /// point below and above. Ranges are tested at the end of a step only.
    fn watched(&self) -> (Vec<(Atom, WatchCondition)>, usize) {
        let mut watched = Vec::new();
        for &Corner { of, at } in &self.specialised.corners {
            match at {
                At::Zero { side } => watched.push((of, WatchCondition::Corner { side })),
                At::Points { table, piece } => watched.extend(
                    [false, true].map(|is_above| (of, WatchCondition::Points { table, is_above, piece })),
                ),
            }
        }
        let mut within = watched.len();
        let bounds = &self.specialised.bounds;
        for (index, (atom, low, high)) in bounds.all.iter().enumerate() {
            watched.extend(self.bounds(*low, *high).into_iter().map(|condition| (*atom, condition)));
            if index < bounds.guards {
                within = watched.len();
            }
        }
        (watched, within)
    }

    /// The conditions for a voltage between two bounds: one if the bounds are symmetric or if one is infinite,
    /// otherwise two.
    fn bounds(&self, low: Factor, high: Factor) -> Vec<WatchCondition> {
        match (low, high) {
            (Factor::Number(low), Factor::Number(number)) if low == -number => {
                vec![WatchCondition::Size(self.factor(high))]
            }
            (Factor::Number(f64::NEG_INFINITY), _) => vec![WatchCondition::Below(self.factor(high))],
            (_, Factor::Number(f64::INFINITY)) => vec![WatchCondition::Above(self.factor(low))],
            _ => vec![WatchCondition::Above(self.factor(low)), WatchCondition::Below(self.factor(high))],
        }
    }

    /// The operations for testing some atoms, except those that are done already. The rates are done, because their
    /// code always runs before. The first `within` atoms are tested within a step, too, and some of them need the second
    /// stage. Sampled values, inputs of delay lines and recorded voltages are added at the end.
    fn checks(
        &self,
        done: &[bool],
        (tested, within): (&[Atom], usize),
        in_second: &[Atom],
        recorded: impl Iterator<Item = Atom>,
    ) -> Checks {
        let mut done = done.to_vec();
        let ending =
            atoms(&self.specialised.sampled).chain(atoms(&self.specialised.delay_inputs)).chain(recorded);
        Checks {
            second: self.code(&mut done.clone(), in_second.iter().copied().chain(self.turning_atoms())),
            first: self.code(&mut done, tested[..within].iter().copied().chain(self.turning_atoms())),
            ending: self.code(&mut done, tested[within..].iter().copied().chain(ending)),
            within,
            all: tested.len(),
        }
    }

    /// The operations that some atoms need and that are not done yet. `done` is updated.
    fn code(&self, done: &mut [bool], wanted: impl Iterator<Item = Atom>) -> Code {
        let mut code = Code::default();
        let needed = needed(&self.specialised.nodes, wanted);
        for (at, node) in self.specialised.nodes.iter().enumerate() {
            if needed[at] && !std::mem::replace(&mut done[at], true) {
                self.emit(node, self.slots[at], &mut code);
            }
        }
        code
    }

    /// Emits the operation of a node, with its result in the slot `out`. Inputs need none: the solver writes their
    /// slots.
    fn emit(&self, node: &Node, out: Slot, code: &mut Code) {
        let of = |operand: &Operand| self.operand(*operand);
        let instruction = match node {
            Node::State(_)
            | Node::Time
            | Node::Scheduled(_)
            | Node::Delayed(_)
            | Node::Sampled(_)
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

    /// Emits a sum: a product or a line if it has one term. The order of the terms decides the rounding, so every
    /// backend takes it from here.
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
        // Terms with the longest chains are added last, so that the sum waits for them only once.
        let mut terms = form.terms.clone();
        terms.sort_by_key(|(atom, _)| self.depths[*atom as usize]);
        let first = code.terms.len() as u32;
        code.terms.extend(terms.iter().map(slots));
        Instruction::Sum { out, constant, first, count: terms.len() as u32 }
    }
}
