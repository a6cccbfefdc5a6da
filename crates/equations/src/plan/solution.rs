//! Solves an equation for its unknown.

use patchcord_expr::{Equation, FormulaError, Node};

use super::expressions::{Reader, fault};
use super::trees::{contains, factors, only_name, terms};
use crate::graph::{Operation, Sum};
use crate::symbolic::Fraction;

/// An expression that is linear in an unknown: factor x unknown + rest.
struct Linear {
    /// The factor of the unknown.
    factor: Sum,
    /// The part without the unknown.
    rest: Sum,
}

impl Reader<'_, '_> {
    /// The value of an unknown from an equation that is linear in it.
    ///
    /// The equation is divided by the factor of the unknown. A factor that varies makes a quotient.
    ///
    /// # Errors
    /// If an expression cannot be read, or the factor is 0.
    pub(super) fn linear_solution(
        &mut self,
        equation: &Equation,
        unknown: &str,
    ) -> Result<Sum, FormulaError> {
        let left = self.linear(equation.left(), unknown)?;
        let right = self.linear(equation.right(), unknown)?;
        let factor = left.factor.minus(&right.factor);
        let rest = right.rest.minus(&left.rest);
        if let Some(constant) = factor.as_constant()
            && (constant.is_zero() || self.builder.constants.value(&constant) == 0.0)
        {
            let message = format!("the factor of {unknown} is 0, so this equation does not determine it");
            let hint = format!("choose parameters for which the factor is not 0, or remove {unknown}");
            let range = equation.range_of(unknown).unwrap_or_default();
            return Err(fault(range, message, hint));
        }
        Ok(self.builder.ratio(&[rest], &[factor]))
    }

    /// The operation that computes an unknown from an equation that is not linear in it. Of several solutions it is the
    /// one near `start`. The reader knows the node of the unknown.
    ///
    /// # Errors
    /// If an expression cannot be read, or the unknown cancels.
    pub(super) fn implicit_solution(
        &mut self,
        equation: &Equation,
        unknown: &str,
        start: Option<&Fraction>,
    ) -> Result<Operation, FormulaError> {
        if let Some(value) = self.rational_solution(equation, unknown, start)? {
            return Ok(Operation::Sum(value));
        }
        let zero = self.residual(equation)?;
        if zero.as_constant().is_some() {
            let message = format!("both sides have the same value for every {unknown}");
            let hint = format!("write an equation that determines {unknown}");
            let range = equation.range_of(unknown).unwrap_or_default();
            return Err(fault(range, message, hint));
        }
        Ok(Operation::Zero(zero))
    }

    /// The left side of an equation minus its right side.
    ///
    /// # Errors
    /// If an expression cannot be read.
    pub(super) fn residual(&mut self, equation: &Equation) -> Result<Sum, FormulaError> {
        let left = self.form(equation.left())?;
        Ok(left.minus(&self.form(equation.right())?))
    }

    /// An expression as a linear function of an unknown.
    fn linear(&mut self, node: &Node, unknown: &str) -> Result<Linear, FormulaError> {
        let mut sum = Linear { factor: Sum::default(), rest: Sum::default() };
        for (is_negative, term) in terms(node) {
            let term = self.linear_term(term, unknown)?;
            let sign = Fraction::whole(if is_negative { -1 } else { 1 });
            sum.factor = sum.factor.plus(&term.factor.scaled(&sign));
            sum.rest = sum.rest.plus(&term.rest.scaled(&sign));
        }
        Ok(sum)
    }

    /// A term as a linear function of an unknown.
    fn linear_term(&mut self, term: &Node, unknown: &str) -> Result<Linear, FormulaError> {
        if !contains(term, unknown) {
            return Ok(Linear { factor: Sum::default(), rest: self.form(term)? });
        }
        if only_name(term).is_some() {
            return Ok(Linear { factor: Sum::constant(&Fraction::whole(1)), rest: Sum::default() });
        }
        let product = factors(term);
        let (own, others): (Vec<_>, Vec<_>) =
            product.factors.into_iter().partition(|(factor, _)| contains(factor, unknown));
        let [(own, false)] = own.as_slice() else { return Err(self.not_linear(term, unknown)) };
        if std::ptr::eq(*own, term) {
            return Err(self.not_linear(term, unknown));
        }
        let Linear { factor, rest } = self.linear(own, unknown)?;
        let [tops, bottoms] = self.factor_forms(&others)?;
        let sign = Fraction::whole(if product.is_negative { -1 } else { 1 });
        let mut times_others = |inner: Sum| {
            let tops: Vec<Sum> = [inner.scaled(&sign)].into_iter().chain(tops.iter().cloned()).collect();
            self.builder.ratio(&tops, &bottoms)
        };
        Ok(Linear { factor: times_others(factor), rest: times_others(rest) })
    }

    /// The fault of a term that is not linear in an unknown.
    fn not_linear(&self, term: &Node, unknown: &str) -> FormulaError {
        let message = format!("{} is not linear in {unknown}", self.excerpt(term));
        fault(term.range.clone(), message, format!("write an equation that is linear in {unknown}"))
    }
}
