//! From a program, its modes and what is recorded to a kernel: sums are gathered, signs, gains, potentiometers and
//! formulas become factors of the prologue, amplifiers give what they are asked for, or an end of their range.

use std::collections::HashMap;

use super::bounds::Bounds;
use super::form::{Atom, Early, Factor, Form};
use super::node::{Node, Operand};
use super::{Asked, Stance};
use crate::ir::{Op, Program, Register};
use crate::machines::REFERENCE;

/// A program folded, before it is laid out.
pub(super) struct Terms {
    pub early: Early,
    pub nodes: Vec<Node>,
    pub rates: Vec<Operand>,
    pub kept: Vec<Operand>,
    /// What goes into the delay lines.
    pub stored: Vec<Operand>,
    pub seen: Vec<Operand>,
    pub bounds: Bounds,
    /// What bends the curves of rates and kept values.
    pub corners: Vec<Corner>,
    /// The tables that are looked up at time itself.
    pub scheduled: Vec<u32>,
}

/// A voltage that changes the kernel where it passes a corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub of: Atom,
    pub at: At,
}

/// Where a voltage has its corners, and which of the given numbers follow from it.
#[derive(Debug, Clone, Copy)]
pub(super) enum At {
    /// At 0: its side, 1 where it is 0 or above, else 0.
    Zero { side: u32 },
    /// At the points of a table: slope, origin and ordinate of the piece, one after the other.
    Points { table: u32, piece: u32 },
}

/// Sums of more terms than this are worked out once where they are read by more than one.
const SHARED: usize = 2;
/// Sums of more terms than this are not gathered further.
const LONGEST: usize = 16;
/// Sums are not gathered into what is more than so many times as large: what 100 V lose by rounding becomes 1e-11 V.
const STEEP: f64 = 1e3;

/// Folds a program in a stance, which also gives the voltages of these registers.
pub(super) fn folded(program: &Program, stance: Stance<'_>, seen: &[Register]) -> Terms {
    let outputs =
        program.lamps.iter().zip(stance.asked).map(|(lamp, asked)| (lamp.output, (lamp.demand, *asked)));
    let outputs = outputs.collect();
    let mut folder = Folder {
        program,
        stance,
        early: Early::default(),
        nodes: Vec::new(),
        known: HashMap::new(),
        forms: Vec::with_capacity(program.body.len()),
        uses: uses(program),
        needed: needed(program, &outputs),
        corners: Vec::new(),
        sides: Vec::new(),
        scheduled: Vec::new(),
        outputs,
    };
    for at in 0..program.body.len() {
        let form = folder.form(Register(at as u32));
        let form = folder.cut(at, form);
        folder.forms.push(form);
    }
    folder.finish(seen)
}

/// How many operations read each register.
fn uses(program: &Program) -> Vec<u32> {
    let mut uses = vec![0; program.body.len()];
    for operand in program.body.iter().flat_map(|op| op.operands()) {
        uses[operand.index()] += 1;
    }
    uses
}

/// Of every register, whether a rate or what is kept or delayed depends on it; of what an overloaded amplifier is asked for,
/// whether they would if it came back.
fn needed(program: &Program, outputs: &HashMap<Register, (Register, Asked)>) -> Vec<bool> {
    let mut needed = vec![false; program.body.len()];
    let rates = program.states.iter().map(|state| state.rate);
    let delayed = program.delays.iter().map(|delay| delay.input);
    for register in rates.chain(program.kept.iter().map(|kept| kept.next)).chain(delayed) {
        needed[register.index()] = true;
    }
    for at in (0..needed.len()).rev() {
        if !needed[at] {
            continue;
        }
        match outputs.get(&Register(at as u32)) {
            Some((demand, _)) => needed[demand.index()] = true,
            None => program.body[at].operands().for_each(|operand| needed[operand.index()] = true),
        }
    }
    needed
}

pub(super) struct Folder<'a> {
    pub program: &'a Program,
    pub stance: Stance<'a>,
    pub early: Early,
    pub nodes: Vec<Node>,
    /// Atoms by what they are.
    known: HashMap<Node, Atom>,
    /// What every register of the body is.
    forms: Vec<Form>,
    uses: Vec<u32>,
    /// Of every register, whether a rate or what is kept or delayed depends on it.
    needed: Vec<bool>,
    pub corners: Vec<Corner>,
    /// Of what is compared with 0, its side.
    sides: Vec<(Atom, Factor)>,
    scheduled: Vec<u32>,
    /// Outputs of amplifiers that may be overloaded, with what they are asked for.
    outputs: HashMap<Register, (Register, Asked)>,
}

impl Folder<'_> {
    pub fn of(&self, register: Register) -> &Form {
        &self.forms[register.index()]
    }

    fn form(&mut self, at: Register) -> Form {
        match self.outputs.get(&at) {
            Some((demand, Asked::Within)) => return self.of(*demand).clone(),
            Some((_, Asked::TooLow)) => return Form::still(Factor::Number(-REFERENCE)),
            Some((_, Asked::TooHigh)) => return Form::still(Factor::Number(REFERENCE)),
            None => {}
        }
        match self.program.body[at.index()] {
            Op::Constant(value) => Form::still(Factor::Number(value)),
            Op::Coefficient(index) => Form::still(self.coefficient(index)),
            Op::Mode(index) => Form::still(Factor::Number(self.stance.modes[index as usize])),
            Op::State(index) => self.node(Node::State(index)),
            Op::Time => self.node(Node::Time),
            Op::Delayed(index) => self.node(Node::Delayed(index)),
            Op::Kept(index) => self.node(Node::Kept(index)),
            Op::Level(index) => self.node(Node::Level(index)),
            Op::Add(a, b) => self.early.sum(&self.forms[a.index()], &self.forms[b.index()], Factor::ONE),
            Op::Subtract(a, b) => {
                self.early.sum(&self.forms[a.index()], &self.forms[b.index()], Factor::Number(-1.0))
            }
            Op::Multiply(a, b) => self.product(a, b),
            Op::Divide(a, b) => self.quotient(a, b),
            Op::Minimum(a, b) if self.bends(at, [a, b]) => self.chosen([b, a], [a, b]),
            Op::Maximum(a, b) if self.bends(at, [a, b]) => self.chosen([a, b], [a, b]),
            Op::Absolute(a) if self.bends(at, [a, a]) => self.size(a),
            Op::Table(table, a) if self.program.body[a.index()] == Op::Time => self.scheduled(table),
            Op::Table(table, a) if self.bends(at, [a, a]) => self.piece(table, a),
            Op::Minimum(a, b) => self.lower_of(a, b),
            Op::Maximum(a, b) => self.upper_of(a, b),
            Op::Select { left, right, then, otherwise } => self.select([left, right], [then, otherwise]),
            op => self.other(op),
        }
    }

    /// Whether an operation bends the curve of a rate where what it compares passes a corner.
    fn bends(&self, at: Register, compared: [Register; 2]) -> bool {
        let moves = compared.iter().any(|register| self.of(*register).as_still().is_none());
        moves && self.needed[at.index()]
    }

    /// The first of two voltages as long as one that is compared is not below the other, else the second.
    fn chosen(&mut self, [first, second]: [Register; 2], compared: [Register; 2]) -> Form {
        let side = self.side(compared);
        let [first, second] = [first, second].map(|register| self.of(register).clone());
        let difference = self.early.sum(&first, &second, Factor::Number(-1.0));
        self.early.sum(&second, &difference, side)
    }

    /// A voltage without its sign.
    fn size(&mut self, of: Register) -> Form {
        let form = self.of(of).clone();
        let side = self.side_of(form.clone());
        let twice = self.early.multiply(side, Factor::Number(2.0));
        let sign = self.early.add(twice, Factor::Number(-1.0));
        self.early.scaled(&form, sign)
    }

    /// What a table gives on the piece on which it is looked up: ordinate + slope x (voltage - origin).
    fn piece(&mut self, table: u32, at: Register) -> Form {
        let form = self.of(at).clone();
        let of = self.atom(&form);
        self.corners.push(Corner { of, at: At::Points { table, piece: self.early.given } });
        let [slope, origin, ordinate] = [(); 3].map(|()| self.early.given());
        // Worked out by itself: slope x origin would have lost the digits that count on a steep piece.
        let beside = self.early.sum(&form, &Form::still(origin), Factor::Number(-1.0));
        let beside = Form::atom(self.atom(&beside));
        self.early.sum(&Form::still(ordinate), &beside, slope)
    }

    /// What a table gives that is looked up at time itself. Steps end at its corners, which need no watch then.
    fn scheduled(&mut self, table: u32) -> Form {
        let place = self.scheduled.iter().position(|known| *known == table);
        let place = place.unwrap_or_else(|| {
            self.scheduled.push(table);
            self.scheduled.len() - 1
        });
        self.node(Node::Scheduled(place as u32))
    }

    /// 1 where one voltage is not below another, else 0.
    fn side(&mut self, [left, right]: [Register; 2]) -> Factor {
        let difference =
            self.early.sum(&self.forms[left.index()], &self.forms[right.index()], Factor::Number(-1.0));
        self.side_of(difference)
    }

    fn side_of(&mut self, difference: Form) -> Factor {
        if let Some(still) = difference.as_still() {
            return self.early.is_reached(still);
        }
        let of = self.atom(&difference);
        if let Some((_, side)) = self.sides.iter().find(|(known, _)| *known == of) {
            return *side;
        }
        self.corners.push(Corner { of, at: At::Zero { side: self.early.given } });
        let side = self.early.side();
        self.sides.push((of, side));
        side
    }

    /// A coefficient that is written down in the patch is a number.
    fn coefficient(&mut self, index: u32) -> Factor {
        let coefficient = &self.program.coefficients[index as usize];
        match self.program.prologue[coefficient.register.index()] {
            Op::Constant(value) => Factor::Number(value),
            _ => self.early.coefficient(index, coefficient.range.0),
        }
    }

    fn product(&mut self, a: Register, b: Register) -> Form {
        let (left, right) = (self.of(a).clone(), self.of(b).clone());
        if let Some(factor) = left.as_still() {
            return self.magnified(right, factor);
        }
        if let Some(factor) = right.as_still() {
            return self.magnified(left, factor);
        }
        let (left, by) = self.split(&left);
        let (right, and) = self.split(&right);
        let factor = self.early.multiply(by, and);
        let product = self.node(Node::Multiply(left, right));
        self.early.scaled(&product, factor)
    }

    /// A form times a factor. A sum that is magnified much is worked out first, as its terms have more rounding to magnify
    /// than what they leave.
    fn magnified(&mut self, form: Form, factor: Factor) -> Form {
        let is_steep = matches!(factor, Factor::Number(value) if value.abs() > STEEP);
        let form = if is_steep && form.as_still().is_none() { Form::atom(self.atom(&form)) } else { form };
        self.early.scaled(&form, factor)
    }

    fn quotient(&mut self, a: Register, b: Register) -> Form {
        let (left, right) = (self.of(a).clone(), self.of(b).clone());
        let divisor = right.as_still().expect("what elements divide by does not move");
        if let Some(factor) = left.as_still() {
            return Form::still(self.early.divide(factor, divisor));
        }
        let share = self.early.divide(Factor::ONE, divisor);
        self.early.scaled(&left, share)
    }

    /// A form as something that is multiplied by a factor.
    fn split(&mut self, form: &Form) -> (Operand, Factor) {
        match form.as_scaled() {
            Some((atom, factor)) => (Operand::Atom(atom), factor),
            None => (self.operand(form), Factor::ONE),
        }
    }

    fn lower_of(&mut self, a: Register, b: Register) -> Form {
        match self.size_of_opposites(a, b) {
            Some(size) => self.early.scaled(&size, Factor::Number(-1.0)),
            None => self.one_of(a, b, Early::lower_of, Node::Minimum),
        }
    }

    fn upper_of(&mut self, a: Register, b: Register) -> Form {
        match self.size_of_opposites(a, b) {
            Some(size) => size,
            None => self.one_of(a, b, Early::upper_of, Node::Maximum),
        }
    }

    /// The lower or the upper of two: of the prologue where neither moves.
    fn one_of(
        &mut self,
        a: Register,
        b: Register,
        still: fn(&mut Early, Factor, Factor) -> Factor,
        moving: fn(Operand, Operand) -> Node,
    ) -> Form {
        if let [Some(a), Some(b)] = [a, b].map(|register| self.of(register).as_still()) {
            return Form::still(still(&mut self.early, a, b));
        }
        if let Some((atom, factor)) = self.beside_zero(a, b) {
            let node = self.node(moving(Operand::Atom(atom), Operand::Factor(Factor::ZERO)));
            return self.early.scaled(&node, factor);
        }
        let [a, b] = [a, b].map(|register| self.read(register));
        self.node(moving(a, b))
    }

    /// Of an atom times a factor that is not negative, beside 0: both. The factor may as well be taken afterwards.
    fn beside_zero(&self, a: Register, b: Register) -> Option<(Atom, Factor)> {
        let scaled = match [a, b].map(|register| self.of(register)) {
            [form, other] if other.as_still().is_some_and(|still| still.is(0.0)) => form.as_scaled(),
            _ => None,
        };
        scaled.filter(|(_, factor)| self.early.is_not_negative(*factor))
    }

    /// The size of either, where one is the negative of the other.
    fn size_of_opposites(&mut self, a: Register, b: Register) -> Option<Form> {
        let sum = self.early.sum(&self.forms[a.index()], &self.forms[b.index()], Factor::ONE);
        let cancels = sum.as_still().is_some_and(|rest| rest.is(0.0)) && self.of(a).as_still().is_none();
        cancels.then(|| {
            let operand = self.read(a);
            self.node(Node::Absolute(operand))
        })
    }

    fn select(&mut self, compared: [Register; 2], choice: [Register; 2]) -> Form {
        let sides = compared.map(|register| self.of(register).as_still());
        match sides {
            // Modes are numbers, and ends of ranges.
            [Some(Factor::Number(left)), Some(Factor::Number(right))] => {
                self.of(choice[usize::from(left < right)]).clone()
            }
            _ => self.chosen(choice, compared),
        }
    }

    /// An operation that nothing simplifies: of the prologue where nothing in it moves.
    fn other(&mut self, op: Op) -> Form {
        let registers: Vec<Register> = op.operands().collect();
        let stills: Option<Vec<Factor>> =
            registers.iter().map(|register| self.of(*register).as_still()).collect();
        if let Some(stills) = stills {
            if let (Op::Absolute(_), [Factor::Number(value)]) = (op, &stills[..]) {
                return Form::still(Factor::Number(value.abs()));
            }
            return Form::still(self.early.apply(|early| {
                let places: Vec<Register> = stills.iter().map(|factor| early.register(*factor)).collect();
                let place = |old| registers.iter().position(|register| *register == old).unwrap_or_default();
                op.with_operands(|old| places[place(old)])
            }));
        }
        let node = match op {
            Op::Absolute(a) => Node::Absolute(self.read(a)),
            Op::Call(function, a, b) => Node::Call(function, self.read(a), self.read(b)),
            Op::Table(table, at) => Node::Table(table, self.read(at)),
            _ => unreachable!("a kernel is folded of programs without loops"),
        };
        self.node(node)
    }

    /// Works a long sum out where it stands.
    fn cut(&mut self, at: usize, form: Form) -> Form {
        let length = form.terms.len();
        if length > LONGEST || (length > SHARED && self.uses[at] > 1) {
            return Form::atom(self.atom(&form));
        }
        form
    }

    fn read(&mut self, register: Register) -> Operand {
        let form = self.of(register).clone();
        self.operand(&form)
    }

    /// A form as what an operation reads.
    pub fn operand(&mut self, form: &Form) -> Operand {
        match form.as_still() {
            Some(factor) => Operand::Factor(factor),
            None => Operand::Atom(self.atom(form)),
        }
    }

    /// A form that moves as an atom.
    pub fn atom(&mut self, form: &Form) -> Atom {
        match form.as_scaled() {
            Some((atom, factor)) if factor.is(1.0) => atom,
            _ => self.once(Node::Sum(form.clone())),
        }
    }

    fn node(&mut self, node: Node) -> Form {
        Form::atom(self.once(node))
    }

    fn once(&mut self, node: Node) -> Atom {
        let next = self.nodes.len() as Atom;
        let atom = *self.known.entry(node.clone()).or_insert(next);
        if atom == next {
            self.nodes.push(node);
        }
        atom
    }

    fn finish(mut self, seen: &[Register]) -> Terms {
        let program = self.program;
        let rates: Vec<Operand> = program.states.iter().map(|state| self.read(state.rate)).collect();
        let kept: Vec<Operand> = program.kept.iter().map(|kept| self.read(kept.next)).collect();
        let stored = program.delays.iter().map(|delay| self.read(delay.input)).collect();
        let seen = seen.iter().map(|register| self.read(*register)).collect();
        let bounds = self.bounds();
        let Folder { early, nodes, corners, scheduled, .. } = self;
        Terms { early, nodes, rates, kept, stored, seen, bounds, corners, scheduled }
    }
}
