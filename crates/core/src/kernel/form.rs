//! Sums of voltages, each times a factor that the parameters alone decide.

use std::collections::{HashMap, HashSet};
use std::hash::{Hash, Hasher};

use crate::ir::{Op, Register};

/// By so much a fraction may come out below 0.
const ROUNDING: f64 = 1e-12;

/// A number that the parameters alone decide.
#[derive(Debug, Clone, Copy)]
pub(super) enum Factor {
    /// Whatever they are.
    Number(f64),
    /// What an operation of the kernel's own prologue leaves.
    Early(Register),
}

// Numbers by their bits: 0 and -0 are two.
impl PartialEq for Factor {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Factor {}

impl Hash for Factor {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.key().hash(state);
    }
}

impl Factor {
    pub const ZERO: Factor = Factor::Number(0.0);
    pub const ONE: Factor = Factor::Number(1.0);

    pub fn is(self, number: f64) -> bool {
        matches!(self, Factor::Number(value) if value == number)
    }

    /// What tells it from others.
    fn key(self) -> (bool, u64) {
        match self {
            Factor::Number(value) => (false, value.to_bits()),
            Factor::Early(register) => (true, u64::from(register.0)),
        }
    }
}

/// A voltage that is no sum: a state, time, a product, the lower of two.
pub(super) type Atom = u32;

/// constant + sum of factor x atom, in volts; the atoms rise.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Form {
    pub constant: Factor,
    pub terms: Vec<(Atom, Factor)>,
}

impl Form {
    pub fn still(constant: Factor) -> Form {
        Form { constant, terms: Vec::new() }
    }

    pub fn atom(atom: Atom) -> Form {
        Form { constant: Factor::ZERO, terms: vec![(atom, Factor::ONE)] }
    }

    /// The number that it is, where nothing in it moves.
    pub fn as_still(&self) -> Option<Factor> {
        self.terms.is_empty().then_some(self.constant)
    }

    /// The atom that it is, and by how much multiplied, where it is no sum.
    pub fn as_scaled(&self) -> Option<(Atom, Factor)> {
        match self.terms[..] {
            [term] if self.constant.is(0.0) => Some(term),
            _ => None,
        }
    }
}

/// What the kernel's prologue works out once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Value {
    /// By its bits.
    Number(u64),
    Coefficient(u32),
    Sum([Factor; 2]),
    Product([Factor; 2]),
    Quotient([Factor; 2]),
    Lower([Factor; 2]),
    Upper([Factor; 2]),
}

/// The operations that the kernel adds to the prologue: each value once.
#[derive(Debug, Default)]
pub(super) struct Early {
    pub ops: Vec<Op>,
    known: HashMap<Value, Factor>,
    /// Of factors that are each other's negative, the other.
    negatives: HashMap<Factor, Factor>,
    /// Operations that never give less than 0.
    not_negative: HashSet<Register>,
    /// How many numbers it is given beside the coefficients.
    pub given: u32,
}

impl Early {
    /// A coefficient, and the least that it may be.
    pub fn coefficient(&mut self, index: u32, least: f64) -> Factor {
        let factor = self.once(Value::Coefficient(index));
        if let (Factor::Early(register), true) = (factor, least >= -ROUNDING) {
            self.not_negative.insert(register);
        }
        factor
    }

    /// A number that is given beside the coefficients, as long as the voltages stay on their sides of all corners.
    pub fn given(&mut self) -> Factor {
        self.given += 1;
        self.push(Op::State(self.given - 1))
    }

    /// The same, 1 on one side of a corner and 0 on the other.
    pub fn side(&mut self) -> Factor {
        let side = self.given();
        if let Factor::Early(register) = side {
            self.not_negative.insert(register);
        }
        side
    }

    /// Whether a factor is 0 or more whatever the parameters are.
    pub fn is_not_negative(&self, factor: Factor) -> bool {
        match factor {
            Factor::Number(value) => value >= 0.0,
            Factor::Early(register) => self.not_negative.contains(&register),
        }
    }

    pub fn add(&mut self, a: Factor, b: Factor) -> Factor {
        match (a, b) {
            (Factor::Number(a), Factor::Number(b)) => Factor::Number(a + b),
            _ if a.is(0.0) => b,
            _ if b.is(0.0) => a,
            _ if self.negatives.get(&a) == Some(&b) => Factor::ZERO,
            _ => self.once(Value::Sum([a, b])),
        }
    }

    pub fn multiply(&mut self, a: Factor, b: Factor) -> Factor {
        match (a, b) {
            (Factor::Number(a), Factor::Number(b)) => Factor::Number(a * b),
            _ if a.is(1.0) => b,
            _ if b.is(1.0) => a,
            // Coefficients are finite.
            _ if a.is(0.0) || b.is(0.0) => Factor::ZERO,
            _ if a.is(-1.0) => self.negative(b),
            _ if b.is(-1.0) => self.negative(a),
            _ => {
                let product = self.once(Value::Product([a, b]));
                if let (Factor::Early(register), true) =
                    (product, self.is_not_negative(a) && self.is_not_negative(b))
                {
                    self.not_negative.insert(register);
                }
                product
            }
        }
    }

    fn negative(&mut self, a: Factor) -> Factor {
        if let Some(known) = self.negatives.get(&a) {
            return *known;
        }
        let negative = self.once(Value::Product([a, Factor::Number(-1.0)]));
        self.negatives.insert(a, negative);
        self.negatives.insert(negative, a);
        negative
    }

    pub fn divide(&mut self, a: Factor, b: Factor) -> Factor {
        if b.is(1.0) { a } else { self.once(Value::Quotient([a, b])) }
    }

    pub fn lower_of(&mut self, a: Factor, b: Factor) -> Factor {
        match (a, b) {
            (Factor::Number(a), Factor::Number(b)) => Factor::Number(a.min(b)),
            _ => self.once(Value::Lower([a, b])),
        }
    }

    pub fn upper_of(&mut self, a: Factor, b: Factor) -> Factor {
        match (a, b) {
            (Factor::Number(a), Factor::Number(b)) => Factor::Number(a.max(b)),
            _ => self.once(Value::Upper([a, b])),
        }
    }

    /// 1 where a factor is 0 or more, else 0.
    pub fn is_reached(&mut self, factor: Factor) -> Factor {
        let [left, right, then] = [factor, Factor::ZERO, Factor::ONE].map(|factor| self.register(factor));
        self.push(Op::Select { left, right, then, otherwise: right })
    }

    /// Any other operation, on factors.
    pub fn apply(&mut self, op: impl FnOnce(&mut Self) -> Op) -> Factor {
        let op = op(self);
        self.push(op)
    }

    /// Where a factor stands among the operations.
    pub fn register(&mut self, factor: Factor) -> Register {
        match factor {
            Factor::Early(register) => register,
            Factor::Number(value) => {
                let written = self.once(Value::Number(value.to_bits()));
                self.register(written)
            }
        }
    }

    /// A value, worked out where it is not yet.
    fn once(&mut self, value: Value) -> Factor {
        if let Some(known) = self.known.get(&value) {
            return *known;
        }
        let op = self.op(value);
        let factor = self.push(op);
        self.known.insert(value, factor);
        factor
    }

    fn op(&mut self, value: Value) -> Op {
        let (of, [a, b]): (fn(Register, Register) -> Op, _) = match value {
            Value::Number(bits) => return Op::Constant(f64::from_bits(bits)),
            Value::Coefficient(index) => return Op::Coefficient(index),
            Value::Sum(both) => (Op::Add, both),
            Value::Product(both) => (Op::Multiply, both),
            Value::Quotient(both) => (Op::Divide, both),
            Value::Lower(both) => (Op::Minimum, both),
            Value::Upper(both) => (Op::Maximum, both),
        };
        let [a, b] = [a, b].map(|factor| self.register(factor));
        of(a, b)
    }

    fn push(&mut self, op: Op) -> Factor {
        self.ops.push(op);
        Factor::Early(Register(self.ops.len() as u32 - 1))
    }

    /// a + b x factor.
    pub fn sum(&mut self, a: &Form, b: &Form, factor: Factor) -> Form {
        let mut terms = Vec::with_capacity(a.terms.len() + b.terms.len());
        let (mut left, mut right) = (a.terms.iter().peekable(), b.terms.iter().peekable());
        loop {
            let term = match (left.peek(), right.peek()) {
                (None, None) => break,
                (Some(&&(atom, own)), Some(&&(other, share))) if atom == other => {
                    left.next();
                    right.next();
                    let share = self.multiply(share, factor);
                    (atom, self.add(own, share))
                }
                (Some(&&(atom, own)), other) if other.is_none_or(|(other, _)| atom < *other) => {
                    left.next();
                    (atom, own)
                }
                (_, Some(&&(atom, share))) => {
                    right.next();
                    (atom, self.multiply(share, factor))
                }
                (Some(_), None) => unreachable!("the left alone is taken above"),
            };
            if !term.1.is(0.0) {
                terms.push(term);
            }
        }
        let constant = self.multiply(b.constant, factor);
        Form { constant: self.add(a.constant, constant), terms }
    }

    /// a x factor.
    pub fn scaled(&mut self, a: &Form, factor: Factor) -> Form {
        self.sum(&Form::still(Factor::ZERO), a, factor)
    }
}
