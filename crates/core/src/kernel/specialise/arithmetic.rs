//! The linear forms of products, quotients, minima, maxima and functions.
//!
//! If all operands are fixed, the parameter code computes the result. Otherwise factors are split off where possible,
//! and one node computes the rest.

use super::Specialiser;
use crate::ir::{Op, Register};
use crate::kernel::form::{Atom, Factor, Form, ParameterCode};
use crate::kernel::node::{Node, Operand};

/// A sum is not merged into a product with a larger factor than this: the rounding of 100 V becomes up to 1e-11 V.
const MAX_GAIN: f64 = 1e3;

impl Specialiser<'_> {
    /// A product. If one operand is fixed, it becomes a factor; otherwise their factors are split off, and one node is
    /// the product of the rest.
    pub(super) fn product(&mut self, a: Register, b: Register) -> Form {
        let (left, right) = (self.of(a).clone(), self.of(b).clone());
        if let Some(factor) = left.as_fixed() {
            return self.scaled_sum(right, factor);
        }
        if let Some(factor) = right.as_fixed() {
            return self.scaled_sum(left, factor);
        }
        let (left, left_factor) = self.split(&left);
        let (right, right_factor) = self.split(&right);
        let factor = self.parameter_code.multiply(left_factor, right_factor);
        let product = self.node(Node::Multiply(left, right));
        self.parameter_code.scaled(&product, factor)
    }

    /// A form times a factor. With a large factor, a sum is computed first: its terms can be much larger than the sum,
    /// and so is their rounding.
    fn scaled_sum(&mut self, form: Form, factor: Factor) -> Form {
        let is_steep = matches!(factor, Factor::Number(value) if value.abs() > MAX_GAIN);
        let form = if is_steep && form.as_fixed().is_none() { Form::atom(self.atom(&form)) } else { form };
        self.parameter_code.scaled(&form, factor)
    }

    /// A quotient. The divisor is always fixed: no law of an element divides by a voltage.
    pub(super) fn quotient(&mut self, a: Register, b: Register) -> Form {
        let (left, right) = (self.of(a).clone(), self.of(b).clone());
        let divisor = right.as_fixed().expect("elements divide by constants only");
        if let Some(factor) = left.as_fixed() {
            return Form::fixed(self.parameter_code.divide(factor, divisor));
        }
        let reciprocal = self.parameter_code.divide(Factor::ONE, divisor);
        self.parameter_code.scaled(&left, reciprocal)
    }

    /// A form as an operand times a factor. The factor is 1 unless the form is one term without a constant.
    fn split(&mut self, form: &Form) -> (Operand, Factor) {
        match form.as_scaled() {
            Some((atom, factor)) => (Operand::Atom(atom), factor),
            None => (self.operand(form), Factor::ONE),
        }
    }

    /// The smaller of two voltages, without a corner. The smaller of x and -x is -|x|.
    pub(super) fn lower_of(&mut self, a: Register, b: Register) -> Form {
        match self.size_of_opposites(a, b) {
            Some(size) => self.parameter_code.scaled(&size, Factor::Number(-1.0)),
            None => self.one_of(a, b, ParameterCode::lower_of, Node::Minimum),
        }
    }

    /// The larger of two voltages, without a corner. The larger of x and -x is |x|.
    pub(super) fn upper_of(&mut self, a: Register, b: Register) -> Form {
        match self.size_of_opposites(a, b) {
            Some(size) => size,
            None => self.one_of(a, b, ParameterCode::upper_of, Node::Maximum),
        }
    }

    /// The minimum or maximum of two. If both are fixed, the parameter code computes it.
    fn one_of(
        &mut self,
        a: Register,
        b: Register,
        fixed: fn(&mut ParameterCode, Factor, Factor) -> Factor,
        moving: fn(Operand, Operand) -> Node,
    ) -> Form {
        if let [Some(a), Some(b)] = [a, b].map(|register| self.of(register).as_fixed()) {
            return Form::fixed(fixed(&mut self.parameter_code, a, b));
        }
        if let Some((atom, factor)) = self.scaled_with_zero(a, b) {
            let node = self.node(moving(Operand::Atom(atom), Operand::Factor(Factor::ZERO)));
            return self.parameter_code.scaled(&node, factor);
        }
        let [a, b] = [a, b].map(|register| self.read(register));
        self.node(moving(a, b))
    }

    /// The atom and the factor of the first operand if the factor is not negative and the second operand is 0. Then the
    /// factor can be applied afterwards.
    fn scaled_with_zero(&self, a: Register, b: Register) -> Option<(Atom, Factor)> {
        let scaled = match [a, b].map(|register| self.of(register)) {
            [form, other] if other.as_fixed().is_some_and(|fixed| fixed.is(0.0)) => form.as_scaled(),
            _ => None,
        };
        scaled.filter(|(_, factor)| self.parameter_code.is_not_negative(*factor))
    }

    /// The absolute value of either operand if one is the negative of the other. `None` otherwise.
    ///
    /// One operand then moves, and their sum cancels to the fixed number 0.
    fn size_of_opposites(&mut self, a: Register, b: Register) -> Option<Form> {
        let sum = self.parameter_code.sum(&self.forms[a.index()], &self.forms[b.index()], Factor::ONE);
        let cancels = sum.as_fixed().is_some_and(|sum| sum.is(0.0)) && self.of(a).as_fixed().is_none();
        cancels.then(|| {
            let operand = self.read(a);
            self.node(Node::Absolute(operand))
        })
    }

    /// A selection. It is decided here if modes are compared, and otherwise depends on the branch.
    pub(super) fn select(&mut self, compared: [Register; 2], choice: [Register; 2]) -> Form {
        let sides = compared.map(|register| self.of(register).as_fixed());
        match sides {
            // Modes and the ends of an amplifier's range are fixed numbers.
            [Some(Factor::Number(left)), Some(Factor::Number(right))] => {
                self.of(choice[usize::from(left < right)]).clone()
            }
            _ => self.select_by_branch(choice, compared),
        }
    }

    /// An operation that cannot be simplified. If all operands are fixed, the parameter code computes it.
    pub(super) fn other(&mut self, op: Op) -> Form {
        let registers: Vec<Register> = op.operands().collect();
        let fixed_values: Option<Vec<Factor>> =
            registers.iter().map(|register| self.of(*register).as_fixed()).collect();
        if let Some(fixed_values) = fixed_values {
            if let (Op::Absolute(_), [Factor::Number(value)]) = (op, &fixed_values[..]) {
                return Form::fixed(Factor::Number(value.abs()));
            }
            return Form::fixed(self.parameter_code.apply(|parameter_code| {
                let fixed_registers: Vec<Register> =
                    fixed_values.iter().map(|factor| parameter_code.register(*factor)).collect();
                let position =
                    |old| registers.iter().position(|register| *register == old).unwrap_or_default();
                op.with_operands(|old| fixed_registers[position(old)])
            }));
        }
        let node = match op {
            Op::Absolute(a) => Node::Absolute(self.read(a)),
            Op::Call(function, a, b) => Node::Call(function, self.read(a), self.read(b)),
            Op::Table(table, at) => Node::Table(table, self.read(at)),
            _ => unreachable!("a program with loops has no kernel"),
        };
        self.node(node)
    }
}
