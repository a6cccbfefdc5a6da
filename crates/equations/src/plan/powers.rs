//! Powers: products, square roots, and exponentials of logarithms.

use patchcord_expr::{Expression, FormulaError, Function, Node, Operator};

use super::builder::Builder;
use super::constants::is_readable;
use super::expressions::{Reader, fault};
use crate::graph::{FunctionKind, NodeId, Operation, Sum, Term};
use crate::symbolic::{Fraction, call, nearest};

/// The largest exponent that becomes a product.
const MAX_EXPONENT: i32 = 64;

impl Reader<'_, '_> {
    /// A power with a constant exponent.
    ///
    /// # Errors
    /// If the exponent varies or is too large.
    pub(super) fn power(&mut self, node: &Node, base: &Node, exponent: &Node) -> Result<Sum, FormulaError> {
        if let Some(value) = self.builder.constants.expression(node).filter(is_readable) {
            return Ok(Sum::constant(&value));
        }
        if let Some(inverse) = self.inverse_of(base, exponent)? {
            self.check_divisor(node, &inverse)?;
            return Ok(self.builder.ratio(&[], &[inverse]));
        }
        let power = self.constant_exponent(base, exponent)?;
        self.raised(base, exponent, &power)
    }

    /// The inverse of a power with a negative exponent that is half a whole number. So x^-2 in a product is a divisor
    /// x^2. `None` for other expressions.
    pub(super) fn inverse_power(&mut self, node: &Node) -> Result<Option<Sum>, FormulaError> {
        match &node.expression {
            Expression::Binary(Operator::Power, base, exponent) => self.inverse_of(base, exponent),
            _ => Ok(None),
        }
    }

    /// The power with the opposite exponent, if the exponent is negative and half a whole number.
    fn inverse_of(&mut self, base: &Node, exponent: &Node) -> Result<Option<Sum>, FormulaError> {
        let Some(power) = self.builder.constants.expression(exponent) else { return Ok(None) };
        if doubled(&power).is_none_or(|doubled| doubled >= 0.0) {
            return Ok(None);
        }
        self.raised(base, exponent, &power.negated()).map(Some)
    }

    /// The exponent, which must be constant.
    fn constant_exponent(&mut self, base: &Node, exponent: &Node) -> Result<Fraction, FormulaError> {
        self.form(exponent)?.as_constant().ok_or_else(|| {
            let [base, power] = [base, exponent].map(|node| self.excerpt(node));
            let message = format!("the exponent {power} varies, and no element computes such a power");
            fault(exponent.range.clone(), message, format!("write exp({power} * ln({base}))"))
        })
    }

    /// A base with an exponent.
    fn raised(&mut self, base: &Node, exponent: &Node, power: &Fraction) -> Result<Sum, FormulaError> {
        let mut form = self.form(base)?;
        if let Some(value) = form.as_constant() {
            let constant = call(Function::Power, &value, power);
            if is_readable(&constant) || constant.size() <= value.size() {
                return Ok(Sum::constant(&constant));
            }
            form = Sum::node(self.builder.node_of(&form));
        }
        match doubled(power) {
            Some(doubled) if doubled.abs() > f64::from(2 * MAX_EXPONENT) => {
                let message = format!("the exponent {} is too large", self.excerpt(exponent));
                let hint = format!("the largest exponent is {MAX_EXPONENT}: scale the equation");
                Err(fault(exponent.range.clone(), message, hint))
            }
            Some(doubled) if doubled >= 0.0 => Ok(self.builder.half_power(&form, doubled as u32)),
            _ => Ok(self.builder.general_power(&form, power)),
        }
    }
}

impl Builder<'_> {
    /// A sum to the power of `doubled / 2`: a product, times a square root if `doubled` is odd.
    fn half_power(&mut self, base: &Sum, doubled: u32) -> Sum {
        let whole = self.whole_power(base, doubled / 2);
        if doubled.is_multiple_of(2) {
            return whole;
        }
        let root = self.add(Operation::Root(base.clone()));
        self.times(&whole, &Sum::node(root))
    }

    /// A whole power of a sum.
    fn whole_power(&mut self, base: &Sum, exponent: u32) -> Sum {
        match exponent {
            0 => Sum::constant(&Fraction::whole(1)),
            1 => base.clone(),
            _ => {
                let Term { coefficient, node } = self.factored(base);
                let power = Fraction::whole(i64::from(exponent));
                let constant = call(Function::Power, &coefficient, &power);
                Sum::term(&constant, self.node_power(node, exponent))
            }
        }
    }

    /// A power of a node, by squares: x^6 = (x^3)^2 and x^3 = x x^2. The exponent is at least 1.
    fn node_power(&mut self, node: NodeId, exponent: u32) -> NodeId {
        if exponent <= 1 {
            return node;
        }
        if exponent.is_multiple_of(2) {
            let root = self.node_power(node, exponent / 2);
            return self.product(root, root);
        }
        let rest = self.node_power(node, exponent - 1);
        self.product(node, rest)
    }

    /// A power with any constant exponent, for a positive base: exp(exponent ln(base)).
    fn general_power(&mut self, base: &Sum, exponent: &Fraction) -> Sum {
        let argument = self.factored(base);
        let logarithm = self.add(Operation::Function { kind: FunctionKind::Ln, argument });
        let argument = self.nonzero_term(&Sum::term(exponent, logarithm));
        let power = Operation::Function { kind: FunctionKind::Exp, argument };
        Sum::node(self.add_as(power, |builder, _| builder.power_notation(base, exponent)))
    }
}

/// Twice a number, if that is a whole number. `None` for other exponents.
fn doubled(exponent: &Fraction) -> Option<f64> {
    let doubled = nearest(&exponent.times(&Fraction::whole(2)).as_rational()?);
    (doubled.fract() == 0.0).then_some(doubled)
}
