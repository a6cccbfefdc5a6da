//! Linear forms: sums of voltages times factors that depend on parameters only.
//!
//! The factors themselves are computed by the parameter code, which contains every value once. Simplifications such as
//! x 0, x 1 and a - a keep forms short.

use std::collections::{HashMap, HashSet};
use std::hash::{Hash, Hasher};

use crate::ir::{Op, Register};

/// The amount by which the lower end of a fraction's range may be below 0.
const FACTOR_ROUNDING: f64 = 1e-12;

/// A number that depends on parameters and on the branch only. It is constant within a step.
#[derive(Debug, Clone, Copy)]
pub(super) enum Factor {
    /// A fixed number.
    Number(f64),
    /// The result of an operation of the parameter code.
    Computed(Register),
}

// Numbers are compared by their bits, so 0 and -0 differ.
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
    /// The number 0. A term with this factor is left out.
    pub(super) const ZERO: Factor = Factor::Number(0.0);
    /// The number 1.
    pub(super) const ONE: Factor = Factor::Number(1.0);

    /// Whether it is this fixed number.
    pub(super) fn is(self, number: f64) -> bool {
        matches!(self, Factor::Number(value) if value == number)
    }

    /// A key that identifies the factor.
    fn key(self) -> (bool, u64) {
        match self {
            Factor::Number(value) => (false, value.to_bits()),
            Factor::Computed(register) => (true, u64::from(register.0)),
        }
    }
}

/// Index of a voltage that is not a sum: a state, time, a product, a minimum and so on.
pub(super) type Atom = u32;

/// constant + sum of factor x atom, in volts. The atoms are in ascending order.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Form {
    /// The part that does not vary, in volts.
    pub constant: Factor,
    /// Atoms with their factors.
    pub terms: Vec<(Atom, Factor)>,
}

impl Form {
    /// A form without terms: a voltage that does not vary.
    pub(super) fn fixed(constant: Factor) -> Form {
        Form { constant, terms: Vec::new() }
    }

    /// The form that is one atom alone.
    pub(super) fn atom(atom: Atom) -> Form {
        Form { constant: Factor::ZERO, terms: vec![(atom, Factor::ONE)] }
    }

    /// The constant if there are no terms.
    pub(super) fn as_fixed(&self) -> Option<Factor> {
        self.terms.is_empty().then_some(self.constant)
    }

    /// The atom and its factor if the form is one term without a constant.
    pub(super) fn as_scaled(&self) -> Option<(Atom, Factor)> {
        match self.terms[..] {
            [term] if self.constant.is(0.0) => Some(term),
            _ => None,
        }
    }
}

/// A value of the parameter code. Equal values are computed once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Value {
    /// A number, by its bits.
    Number(u64),
    /// A coefficient of the program, by its index.
    Coefficient(u32),
    /// The sum of two factors.
    Sum([Factor; 2]),
    /// The product of two factors.
    Product([Factor; 2]),
    /// The first factor divided by the second.
    Quotient([Factor; 2]),
    /// The smaller of two factors.
    Lower([Factor; 2]),
    /// The larger of two factors.
    Upper([Factor; 2]),
}

/// The operations that compute the factors of a kernel.
///
/// They read coefficients and branch values; the latter are `Op::State` here. The code runs again when the parameters
/// or the branch change, and never within a step.
#[derive(Debug, Default)]
pub(super) struct ParameterCode {
    /// The operations, in order of evaluation.
    pub ops: Vec<Op>,
    /// The factor of every value that is already computed.
    known: HashMap<Value, Factor>,
    /// For every factor with a computed negative, that negative.
    negatives: HashMap<Factor, Factor>,
    /// Registers that are never below 0.
    not_negative: HashSet<Register>,
    /// The number of branch values so far.
    pub branch_values: u32,
}

impl ParameterCode {
    /// A coefficient. `least` is its smallest permitted value.
    pub(super) fn coefficient(&mut self, index: u32, least: f64) -> Factor {
        let factor = self.once(Value::Coefficient(index));
        if let (Factor::Computed(register), true) = (factor, least >= -FACTOR_ROUNDING) {
            self.not_negative.insert(register);
        }
        factor
    }

    /// A value that depends on the branch of the kernel. It is constant while no voltage crosses a corner.
    pub(super) fn branch_value(&mut self) -> Factor {
        self.branch_values += 1;
        self.push(Op::State(self.branch_values - 1))
    }

    /// A branch value that is 1 on one side of a corner and 0 on the other.
    pub(super) fn side(&mut self) -> Factor {
        let side = self.branch_value();
        if let Factor::Computed(register) = side {
            self.not_negative.insert(register);
        }
        side
    }

    /// Whether a factor is at least 0 for all parameters.
    pub(super) fn is_not_negative(&self, factor: Factor) -> bool {
        match factor {
            Factor::Number(value) => value >= 0.0,
            Factor::Computed(register) => self.not_negative.contains(&register),
        }
    }

    /// a + b, simplified if one is 0 or both cancel.
    pub(super) fn add(&mut self, a: Factor, b: Factor) -> Factor {
        match (a, b) {
            (Factor::Number(a), Factor::Number(b)) => Factor::Number(a + b),
            _ if a.is(0.0) => b,
            _ if b.is(0.0) => a,
            _ if self.negatives.get(&a) == Some(&b) => Factor::ZERO,
            _ => self.once(Value::Sum([a, b])),
        }
    }

    /// a x b, simplified if one is 0, 1 or -1.
    pub(super) fn multiply(&mut self, a: Factor, b: Factor) -> Factor {
        match (a, b) {
            (Factor::Number(a), Factor::Number(b)) => Factor::Number(a * b),
            _ if a.is(1.0) => b,
            _ if b.is(1.0) => a,
            // Coefficients are finite, so the product is 0.
            _ if a.is(0.0) || b.is(0.0) => Factor::ZERO,
            _ if a.is(-1.0) => self.negative(b),
            _ if b.is(-1.0) => self.negative(a),
            _ => {
                let product = self.once(Value::Product([a, b]));
                if let (Factor::Computed(register), true) =
                    (product, self.is_not_negative(a) && self.is_not_negative(b))
                {
                    self.not_negative.insert(register);
                }
                product
            }
        }
    }

    /// -a. The negative of a negative is the original factor.
    fn negative(&mut self, a: Factor) -> Factor {
        if let Some(known) = self.negatives.get(&a) {
            return *known;
        }
        let negative = self.once(Value::Product([a, Factor::Number(-1.0)]));
        self.negatives.insert(a, negative);
        self.negatives.insert(negative, a);
        negative
    }

    /// a / b, simplified if b is 1.
    pub(super) fn divide(&mut self, a: Factor, b: Factor) -> Factor {
        if b.is(1.0) { a } else { self.once(Value::Quotient([a, b])) }
    }

    /// The smaller of two factors; a number if both are numbers.
    pub(super) fn lower_of(&mut self, a: Factor, b: Factor) -> Factor {
        match (a, b) {
            (Factor::Number(a), Factor::Number(b)) => Factor::Number(a.min(b)),
            _ => self.once(Value::Lower([a, b])),
        }
    }

    /// The larger of two factors; a number if both are numbers.
    pub(super) fn upper_of(&mut self, a: Factor, b: Factor) -> Factor {
        match (a, b) {
            (Factor::Number(a), Factor::Number(b)) => Factor::Number(a.max(b)),
            _ => self.once(Value::Upper([a, b])),
        }
    }

    /// A factor that is 1 if the given factor is at least 0, and otherwise 0.
    pub(super) fn is_reached(&mut self, factor: Factor) -> Factor {
        let [left, right, then] = [factor, Factor::ZERO, Factor::ONE].map(|factor| self.register(factor));
        self.push(Op::Select { left, right, then, otherwise: right })
    }

    /// Any other operation on factors.
    pub(super) fn apply(&mut self, op: impl FnOnce(&mut Self) -> Op) -> Factor {
        let op = op(self);
        self.push(op)
    }

    /// The register of a factor. A fixed number is emitted if necessary.
    pub(super) fn register(&mut self, factor: Factor) -> Register {
        match factor {
            Factor::Computed(register) => register,
            Factor::Number(value) => {
                let written = self.once(Value::Number(value.to_bits()));
                self.register(written)
            }
        }
    }

    /// The factor of a value, emitted if it is not there yet.
    fn once(&mut self, value: Value) -> Factor {
        if let Some(known) = self.known.get(&value) {
            return *known;
        }
        let op = self.op(value);
        let factor = self.push(op);
        self.known.insert(value, factor);
        factor
    }

    /// The operation that computes a value. Operands that are numbers are emitted first.
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

    /// Appends an operation.
    fn push(&mut self, op: Op) -> Factor {
        self.ops.push(op);
        Factor::Computed(Register(self.ops.len() as u32 - 1))
    }

    /// a + b x factor. Both lists of terms are in ascending order of their atoms, so they are merged. Terms whose
    /// factor is 0 are left out.
    pub(super) fn sum(&mut self, a: &Form, b: &Form, factor: Factor) -> Form {
        let mut terms = Vec::with_capacity(a.terms.len() + b.terms.len());
        let (mut left, mut right) = (a.terms.iter().peekable(), b.terms.iter().peekable());
        loop {
            let term = match (left.peek(), right.peek()) {
                (None, None) => break,
                (Some(&&(atom, left_factor)), Some(&&(other, right_factor))) if atom == other => {
                    left.next();
                    right.next();
                    let right_factor = self.multiply(right_factor, factor);
                    (atom, self.add(left_factor, right_factor))
                }
                (Some(&&(atom, left_factor)), other) if other.is_none_or(|(other, _)| atom < *other) => {
                    left.next();
                    (atom, left_factor)
                }
                (_, Some(&&(atom, right_factor))) => {
                    right.next();
                    (atom, self.multiply(right_factor, factor))
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

    /// a x factor, term by term.
    pub(super) fn scaled(&mut self, a: &Form, factor: Factor) -> Form {
        self.sum(&Form::fixed(Factor::ZERO), a, factor)
    }
}
