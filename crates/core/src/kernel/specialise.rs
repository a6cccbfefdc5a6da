//! Specialises a program to a set of modes and amplifier states.
//!
//! The body is walked once. Every register becomes a linear form: a constant plus factors times atoms. Signs, gains,
//! potentiometers and formulas become factors. An amplifier in range is replaced by its demand, an overloaded one by
//! ±100 V. A comparison that affects a rate becomes a corner with a side, so the kernel stays valid on both sides.

mod arithmetic;

use std::collections::HashMap;

use indexmap::IndexSet;

use super::bounds::Bounds;
use super::form::{Atom, Factor, Form, ParameterCode};
use super::node::{Node, Operand};
use super::{AmplifierState, Specialisation};
use crate::ir::{Op, Program, Register};
use crate::machines::REFERENCE;

/// A specialised program, before slots are assigned.
pub(super) struct Specialised {
    /// Operations that compute the factors.
    pub parameter_code: ParameterCode,
    /// The atoms and how each is computed, in order of evaluation.
    pub nodes: Vec<Node>,
    /// The rates of the states, in volts per problem second, in the order of the states.
    pub rates: Vec<Operand>,
    /// What the sampled values become at the end of a step.
    pub sampled: Vec<Operand>,
    /// The inputs of the delay lines.
    pub delay_inputs: Vec<Operand>,
    /// The recorded voltages, in the order of their registers.
    pub recorded: Vec<Operand>,
    /// The bounds within which the kernel is valid.
    pub bounds: Bounds,
    /// Corners in the rates and sampled values.
    pub corners: Vec<Corner>,
    /// The tables that are looked up at time.
    pub scheduled: Vec<u32>,
}

/// A corner: a voltage at which the branch of the kernel changes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    /// The voltage that has the corner, less the voltage with which it is compared.
    pub of: Atom,
    /// The values of the atom at which the branch changes.
    pub at: At,
}

/// The voltages of a corner, and the branch values that depend on the side.
#[derive(Debug, Clone, Copy)]
pub(super) enum At {
    /// At 0 V. The branch value with index `side` is 1 if the voltage is 0 or above, otherwise 0.
    Zero { side: u32 },
    /// At the points of a table. The branch values from index `piece` on are slope, origin and ordinate of the segment,
    /// in this order.
    Points { table: u32, piece: u32 },
}

/// A sum with more terms than this is computed once if several operations read it.
const MAX_SHARED_TERMS: usize = 2;
/// A sum with more terms than this is not merged into others.
const MAX_TERMS: usize = 16;

/// Specialises a program. The result also computes the voltages of these registers.
pub(super) fn specialise(
    program: &Program,
    specialisation: Specialisation<'_>,
    recorded: &[Register],
) -> Specialised {
    let outputs = program
        .lowered
        .lamps
        .iter()
        .zip(specialisation.amplifiers)
        .map(|(lamp, amplifiers)| (lamp.output, (lamp.demand, *amplifiers)));
    let outputs = outputs.collect();
    let mut specialiser = Specialiser {
        program,
        specialisation,
        parameter_code: ParameterCode::default(),
        nodes: Vec::new(),
        known: HashMap::new(),
        forms: Vec::with_capacity(program.lowered.body.len()),
        uses: uses(program),
        needed: needed(program, &outputs),
        corners: Vec::new(),
        sides: HashMap::new(),
        scheduled: IndexSet::new(),
        outputs,
    };
    for at in 0..program.lowered.body.len() {
        let form = specialiser.form(Register(at as u32));
        let form = specialiser.cut(at, form);
        specialiser.forms.push(form);
    }
    specialiser.finish(recorded)
}

/// The number of operations that read each register.
fn uses(program: &Program) -> Vec<u32> {
    let mut uses = vec![0; program.lowered.body.len()];
    for operand in program.lowered.body.iter().flat_map(|op| op.operands()) {
        uses[operand.index()] += 1;
    }
    uses
}

/// For every register, whether a rate, a sampled value or the input of a delay line depends on it. The demand of an
/// overloaded amplifier counts as if the amplifier were in range.
fn needed(program: &Program, outputs: &HashMap<Register, (Register, AmplifierState)>) -> Vec<bool> {
    let mut needed = vec![false; program.lowered.body.len()];
    let rates = program.lowered.states.iter().map(|state| state.rate);
    let delayed = program.lowered.delays.iter().map(|delay| delay.input);
    for register in rates.chain(program.lowered.sampled.iter().map(|sampled| sampled.next)).chain(delayed) {
        needed[register.index()] = true;
    }
    for at in (0..needed.len()).rev() {
        if !needed[at] {
            continue;
        }
        match outputs.get(&Register(at as u32)) {
            Some((demand, _)) => needed[demand.index()] = true,
            None => program.lowered.body[at].operands().for_each(|operand| needed[operand.index()] = true),
        }
    }
    needed
}

/// The state of the specialisation. `forms` grows with the walk over the body; every form only refers to earlier atoms.
pub(super) struct Specialiser<'a> {
    /// The program, whose body is walked in order.
    pub program: &'a Program,
    /// The modes and amplifier states that count as fixed.
    pub specialisation: Specialisation<'a>,
    /// The operations for the factors so far.
    pub parameter_code: ParameterCode,
    /// The atoms so far and how each is computed.
    pub nodes: Vec<Node>,
    /// The atom of each node, so that equal nodes share one.
    known: HashMap<Node, Atom>,
    /// The form of every register of the body so far.
    forms: Vec<Form>,
    /// The number of operations that read each register.
    uses: Vec<u32>,
    /// For every register, whether a rate, a sampled value or the input of a delay line depends on it.
    needed: Vec<bool>,
    /// The corners so far, in the order in which the walk meets them.
    pub corners: Vec<Corner>,
    /// The side of each atom that is compared with 0.
    sides: HashMap<Atom, Factor>,
    /// The tables that are looked up at time.
    scheduled: IndexSet<u32>,
    /// For the output register of every amplifier, its demand and its state.
    outputs: HashMap<Register, (Register, AmplifierState)>,
}

impl Specialiser<'_> {
    /// The form of a register that the walk has passed.
    pub(super) fn of(&self, register: Register) -> &Form {
        &self.forms[register.index()]
    }

    /// The linear form of a register.
    ///
    /// Outputs of amplifiers come first: they are replaced by the demand or by ±100 V. Minima, maxima,
    /// absolute values and tables on which a rate depends become branches. Elsewhere they stay operations, because no
    /// step has to end at their corner.
    fn form(&mut self, at: Register) -> Form {
        match self.outputs.get(&at) {
            Some((demand, AmplifierState::Within)) => return self.of(*demand).clone(),
            Some((_, AmplifierState::Below)) => return Form::fixed(Factor::Number(-REFERENCE)),
            Some((_, AmplifierState::Above)) => return Form::fixed(Factor::Number(REFERENCE)),
            None => {}
        }
        match self.program.lowered.body[at.index()] {
            Op::Constant(value) => Form::fixed(Factor::Number(value)),
            Op::Coefficient(index) => Form::fixed(self.coefficient(index)),
            Op::Mode(index) => Form::fixed(Factor::Number(self.specialisation.modes[index as usize])),
            Op::State(index) => self.node(Node::State(index)),
            Op::Time => self.node(Node::Time),
            Op::Delayed(index) => self.node(Node::Delayed(index)),
            Op::Sampled(index) => self.node(Node::Sampled(index)),
            Op::Level(index) => self.node(Node::Level(index)),
            Op::Add(a, b) => {
                self.parameter_code.sum(&self.forms[a.index()], &self.forms[b.index()], Factor::ONE)
            }
            Op::Subtract(a, b) => {
                self.parameter_code.sum(&self.forms[a.index()], &self.forms[b.index()], Factor::Number(-1.0))
            }
            Op::Multiply(a, b) => self.product(a, b),
            Op::Divide(a, b) => self.quotient(a, b),
            Op::Minimum(a, b) if self.has_rate_corner(at, [a, b]) => self.select_by_branch([b, a], [a, b]),
            Op::Maximum(a, b) if self.has_rate_corner(at, [a, b]) => self.select_by_branch([a, b], [a, b]),
            Op::Absolute(a) if self.has_rate_corner(at, [a, a]) => self.size(a),
            Op::Table(table, a) if self.program.lowered.body[a.index()] == Op::Time => self.scheduled(table),
            Op::Table(table, a) if self.has_rate_corner(at, [a, a]) => self.piece(table, a),
            Op::Minimum(a, b) => self.lower_of(a, b),
            Op::Maximum(a, b) => self.upper_of(a, b),
            Op::Select { left, right, then, otherwise } => self.select([left, right], [then, otherwise]),
            op => self.other(op),
        }
    }

    /// Whether an operation has a corner that changes a rate. A comparison of fixed values has none.
    fn has_rate_corner(&self, at: Register, compared: [Register; 2]) -> bool {
        let has_moving = compared.iter().any(|register| self.of(*register).as_fixed().is_none());
        has_moving && self.needed[at.index()]
    }

    /// The first of two voltages if the first compared voltage is not below the second, otherwise the second.
    ///
    /// The form is second + side x (first - second), with the side as a factor.
    fn select_by_branch(&mut self, [first, second]: [Register; 2], compared: [Register; 2]) -> Form {
        let side = self.side(compared);
        let [first, second] = [first, second].map(|register| self.of(register).clone());
        let difference = self.parameter_code.sum(&first, &second, Factor::Number(-1.0));
        self.parameter_code.sum(&second, &difference, side)
    }

    /// The absolute value of a voltage: (2 side - 1) x voltage.
    fn size(&mut self, of: Register) -> Form {
        let form = self.of(of).clone();
        let side = self.side_of(form.clone());
        let twice = self.parameter_code.multiply(side, Factor::Number(2.0));
        let sign = self.parameter_code.add(twice, Factor::Number(-1.0));
        self.parameter_code.scaled(&form, sign)
    }

    /// The value of a table on one segment: ordinate + slope x (voltage - origin).
    fn piece(&mut self, table: u32, at: Register) -> Form {
        let form = self.of(at).clone();
        let of = self.atom(&form);
        self.corners.push(Corner { of, at: At::Points { table, piece: self.parameter_code.branch_values } });
        let [slope, origin, ordinate] = [(); 3].map(|()| self.parameter_code.branch_value());
        // The difference is computed first: with slope x origin as a separate term, a steep segment would lose its
        // digits.
        let distance = self.parameter_code.sum(&form, &Form::fixed(origin), Factor::Number(-1.0));
        let distance = Form::atom(self.atom(&distance));
        self.parameter_code.sum(&Form::fixed(ordinate), &distance, slope)
    }

    /// The value of a table that is looked up at time. Steps end at its corners, so it needs no watch.
    fn scheduled(&mut self, table: u32) -> Form {
        let (index, _) = self.scheduled.insert_full(table);
        self.node(Node::Scheduled(index as u32))
    }

    /// A factor that is 1 if the first voltage is not below the second, and otherwise 0.
    fn side(&mut self, [left, right]: [Register; 2]) -> Factor {
        let difference = self.parameter_code.sum(
            &self.forms[left.index()],
            &self.forms[right.index()],
            Factor::Number(-1.0),
        );
        self.side_of(difference)
    }

    /// The factor for the side of a difference: 1 if it is 0 V or above, and otherwise 0. Equal differences share one
    /// corner. A fixed difference needs no corner.
    fn side_of(&mut self, difference: Form) -> Factor {
        if let Some(fixed) = difference.as_fixed() {
            return self.parameter_code.is_reached(fixed);
        }
        let of = self.atom(&difference);
        if let Some(side) = self.sides.get(&of) {
            return *side;
        }
        self.corners.push(Corner { of, at: At::Zero { side: self.parameter_code.branch_values } });
        let side = self.parameter_code.side();
        self.sides.insert(of, side);
        side
    }

    /// A coefficient without parameters is a fixed number.
    fn coefficient(&mut self, index: u32) -> Factor {
        let coefficient = &self.program.lowered.coefficients[index as usize];
        match self.program.lowered.prologue[coefficient.register.index()] {
            Op::Constant(value) => Factor::Number(value),
            _ => self.parameter_code.coefficient(index, coefficient.range.0),
        }
    }

    /// Turns a long sum into an atom, which is then computed once. Short sums are merged into their readers, which
    /// saves an operation and a rounding.
    fn cut(&mut self, at: usize, form: Form) -> Form {
        let length = form.terms.len();
        if length > MAX_TERMS || (length > MAX_SHARED_TERMS && self.uses[at] > 1) {
            return Form::atom(self.atom(&form));
        }
        form
    }

    /// The operand for a register.
    fn read(&mut self, register: Register) -> Operand {
        let form = self.of(register).clone();
        self.operand(&form)
    }

    /// A form as the operand of an operation.
    pub(super) fn operand(&mut self, form: &Form) -> Operand {
        match form.as_fixed() {
            Some(factor) => Operand::Factor(factor),
            None => Operand::Atom(self.atom(form)),
        }
    }

    /// A form that is not fixed, as an atom.
    pub(super) fn atom(&mut self, form: &Form) -> Atom {
        match form.as_scaled() {
            Some((atom, factor)) if factor.is(1.0) => atom,
            _ => self.shared_atom(Node::Sum(form.clone())),
        }
    }

    /// The form that consists of the atom of a node.
    fn node(&mut self, node: Node) -> Form {
        Form::atom(self.shared_atom(node))
    }

    /// The atom of a node, shared with equal nodes.
    fn shared_atom(&mut self, node: Node) -> Atom {
        let next = self.nodes.len() as Atom;
        let atom = *self.known.entry(node.clone()).or_insert(next);
        if atom == next {
            self.nodes.push(node);
        }
        atom
    }

    /// The specialised program, with the outputs as operands and the bounds. The walk over the body is complete.
    fn finish(mut self, recorded: &[Register]) -> Specialised {
        let program = self.program;
        let rates: Vec<Operand> = program.lowered.states.iter().map(|state| self.read(state.rate)).collect();
        let sampled: Vec<Operand> =
            program.lowered.sampled.iter().map(|sampled| self.read(sampled.next)).collect();
        let delay_inputs = program.lowered.delays.iter().map(|delay| self.read(delay.input)).collect();
        let recorded = recorded.iter().map(|register| self.read(*register)).collect();
        let bounds = self.bounds();
        let Specialiser { parameter_code, nodes, corners, scheduled, .. } = self;
        Specialised {
            parameter_code,
            nodes,
            rates,
            sampled,
            delay_inputs,
            recorded,
            bounds,
            corners,
            scheduled: scheduled.into_iter().collect(),
        }
    }
}
