//! From a program, its modes and what is recorded to a kernel: sums are gathered, signs, gains, potentiometers and
//! formulas become factors of the prologue, amplifiers are taken as not overloaded.

use std::collections::HashMap;

use super::bounds::Bounds;
use super::form::{Atom, Early, Factor, Form};
use super::node::{Node, Operand, key};
use crate::program::{Op, Program, Register};

/// A program folded, before it is laid out.
pub(super) struct Terms {
    pub early: Early,
    pub nodes: Vec<Node>,
    pub rates: Vec<Operand>,
    pub kept: Vec<Operand>,
    pub seen: Vec<Operand>,
    pub bounds: Bounds,
    /// The corners of the atoms that rates and kept values depend on.
    pub corners: Vec<Atom>,
    /// The same of tables, with what they are looked up at.
    pub points: Vec<(u32, Operand)>,
}

/// Sums of more terms than this are worked out once where they are read by more than one.
const SHARED: usize = 2;
/// Sums of more terms than this are not gathered further.
const LONGEST: usize = 16;

/// Folds a program in these modes, which also gives the voltages of these registers.
pub(super) fn folded(program: &Program, modes: &[f64], seen: &[Register]) -> Terms {
    let mut folder = Folder {
        program,
        modes,
        early: Early::default(),
        nodes: Vec::new(),
        known: HashMap::new(),
        forms: Vec::with_capacity(program.body.len()),
        uses: uses(program),
        outputs: program.lamps.iter().map(|lamp| (lamp.output, lamp.demand)).collect(),
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

pub(super) struct Folder<'a> {
    pub program: &'a Program,
    pub modes: &'a [f64],
    pub early: Early,
    pub nodes: Vec<Node>,
    /// Atoms by what they are.
    known: HashMap<Vec<u64>, Atom>,
    /// What every register of the body is.
    forms: Vec<Form>,
    uses: Vec<u32>,
    /// Outputs of amplifiers that may be overloaded, with what they are asked for.
    outputs: HashMap<Register, Register>,
}

impl Folder<'_> {
    pub fn of(&self, register: Register) -> &Form {
        &self.forms[register.index()]
    }

    fn form(&mut self, at: Register) -> Form {
        if let Some(demand) = self.outputs.get(&at) {
            return self.of(*demand).clone();
        }
        match self.program.body[at.index()] {
            Op::Constant(value) => Form::still(Factor::Number(value)),
            Op::Coefficient(index) => Form::still(self.coefficient(index)),
            Op::Mode(index) => Form::still(Factor::Number(self.modes[index as usize])),
            Op::State(index) => self.node(Node::State(index)),
            Op::Time => self.node(Node::Time),
            Op::Kept(index) => self.node(Node::Kept(index)),
            Op::Noise(index) => self.node(Node::Noise(index)),
            Op::Add(a, b) => self.early.sum(&self.forms[a.index()], &self.forms[b.index()], Factor::ONE),
            Op::Subtract(a, b) => {
                self.early.sum(&self.forms[a.index()], &self.forms[b.index()], Factor::Number(-1.0))
            }
            Op::Multiply(a, b) => self.product(a, b),
            Op::Divide(a, b) => self.quotient(a, b),
            Op::Minimum(a, b) => self.lower_of(a, b),
            Op::Maximum(a, b) => self.upper_of(a, b),
            Op::Select { left, right, then, otherwise } => self.select(left, right, then, otherwise),
            op => self.other(op),
        }
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
            return self.early.scaled(&right, factor);
        }
        if let Some(factor) = right.as_still() {
            return self.early.scaled(&left, factor);
        }
        let (left, by) = self.split(&left);
        let (right, and) = self.split(&right);
        let factor = self.early.multiply(by, and);
        let product = self.node(Node::Multiply(left, right));
        self.early.scaled(&product, factor)
    }

    fn quotient(&mut self, a: Register, b: Register) -> Form {
        let (left, right) = (self.of(a).clone(), self.of(b).clone());
        if let Some(divisor) = right.as_still() {
            if let Some(factor) = left.as_still() {
                return Form::still(self.early.divide(factor, divisor));
            }
            let share = self.early.divide(Factor::ONE, divisor);
            return self.early.scaled(&left, share);
        }
        let (left, by) = self.split(&left);
        let right = self.operand(&right);
        let quotient = self.node(Node::Divide(left, right));
        self.early.scaled(&quotient, by)
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

    fn select(&mut self, left: Register, right: Register, then: Register, otherwise: Register) -> Form {
        let sides = [left, right].map(|register| self.of(register).as_still());
        if let [Some(Factor::Number(left)), Some(Factor::Number(right))] = sides {
            return self.of(if left >= right { then } else { otherwise }).clone();
        }
        self.other(Op::Select { left, right, then, otherwise })
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
            Op::Select { left, right, then, otherwise } => Node::Select {
                left: self.read(left),
                right: self.read(right),
                then: self.read(then),
                otherwise: self.read(otherwise),
            },
            _ => unreachable!("a kernel is folded of programs without loops and delay lines"),
        };
        self.node(node)
    }

    /// Works a long sum out where it stands.
    fn cut(&mut self, at: usize, form: Form) -> Form {
        let length = form.terms.len();
        if length > LONGEST || (length > SHARED && self.uses[at] > 1) {
            return match self.operand(&form) {
                Operand::Atom(atom) => Form::atom(atom),
                Operand::Factor(factor) => Form::still(factor),
            };
        }
        form
    }

    fn read(&mut self, register: Register) -> Operand {
        let form = self.of(register).clone();
        self.operand(&form)
    }

    /// A form as what an operation reads.
    pub fn operand(&mut self, form: &Form) -> Operand {
        if let Some(factor) = form.as_still() {
            return Operand::Factor(factor);
        }
        if let Some((atom, factor)) = form.as_scaled()
            && factor.is(1.0)
        {
            return Operand::Atom(atom);
        }
        Operand::Atom(self.once(Node::Sum(form.clone())))
    }

    fn node(&mut self, node: Node) -> Form {
        Form::atom(self.once(node))
    }

    fn once(&mut self, node: Node) -> Atom {
        let next = self.nodes.len() as Atom;
        let atom = *self.known.entry(key(&node)).or_insert(next);
        if atom == next {
            self.nodes.push(node);
        }
        atom
    }

    fn finish(mut self, seen: &[Register]) -> Terms {
        let program = self.program;
        let rates: Vec<Operand> = program.states.iter().map(|state| self.read(state.rate)).collect();
        let kept: Vec<Operand> = program.kept.iter().map(|kept| self.read(kept.next)).collect();
        let seen = seen.iter().map(|register| self.read(*register)).collect();
        let (corners, points) = self.corners(&rates, &kept);
        let bounds = self.bounds();
        Terms { early: self.early, nodes: self.nodes, rates, kept, seen, bounds, corners, points }
    }
}
