use std::ops::Range;

use super::callee::Callee;
use super::error::FormulaError;
use super::evaluate;
use super::expression::{Expression, Node, Operator};
use super::scope::{NoNames, Scope, not_told};
use super::words::{excerpt, number};
use crate::function::Function;
use crate::units::Dimension;

/// The largest exponent of a quantity that has a unit.
const LARGEST_EXPONENT: f64 = 12.0;

/// What kind of quantity the value of a formula is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// Made of bare numbers only: the place where it stands decides in which unit it is.
    Free,
    /// A quantity of this dimension, in SI units.
    Of(Dimension),
}

impl Measure {
    /// The dimension, where bare numbers count as pure numbers.
    pub fn or_none(self) -> Dimension {
        match self {
            Self::Free => Dimension::NONE,
            Self::Of(dimension) => dimension,
        }
    }

    fn is_pure(self) -> bool {
        self.or_none().is_none()
    }

    fn map(self, change: impl FnOnce(Dimension) -> Dimension) -> Self {
        match self {
            Self::Free => Self::Free,
            Self::Of(dimension) => Self::Of(change(dimension)),
        }
    }

    fn joined(self, other: Self, join: impl FnOnce(Dimension, Dimension) -> Dimension) -> Self {
        match (self, other) {
            (Self::Free, Self::Free) => Self::Free,
            _ => Self::Of(join(self.or_none(), other.or_none())),
        }
    }
}

/// The measure of a node.
pub(super) fn measure(text: &str, node: &Node, scope: &dyn Scope) -> Result<Measure, FormulaError> {
    Measurer { text, scope }.measure(node)
}

struct Measurer<'m> {
    text: &'m str,
    scope: &'m dyn Scope,
}

type Outcome = Result<Measure, FormulaError>;

impl Measurer<'_> {
    fn measure(&self, node: &Node) -> Outcome {
        match &node.expression {
            Expression::Number(_) => Ok(Measure::Free),
            Expression::Name(name) => self.named(name, &node.range),
            Expression::Negate(inner) => self.measure(inner),
            Expression::Binary(operator, left, right) => self.binary(node, *operator, left, right),
            Expression::Call(callee, arguments) => self.call(node, *callee, arguments),
        }
    }

    fn named(&self, name: &str, range: &Range<usize>) -> Outcome {
        match self.scope.dimension(name) {
            Some(dimension) => Ok(Measure::Of(dimension)),
            None => Err(not_told(self.scope, name, "unit", range.clone())),
        }
    }

    fn binary(&self, node: &Node, operator: Operator, left: &Node, right: &Node) -> Outcome {
        match operator {
            Operator::Add | Operator::Subtract => self.agreeing(node, left, right),
            Operator::Multiply => {
                let (a, b) = (self.measure(left)?, self.measure(right)?);
                Ok(a.joined(b, Dimension::times))
            }
            Operator::Divide => {
                let (a, b) = (self.measure(left)?, self.measure(right)?);
                Ok(a.joined(b, Dimension::over))
            }
            Operator::Power => self.power(left, right),
        }
    }

    fn call(&self, node: &Node, callee: Callee, arguments: &[Node]) -> Outcome {
        match (callee, arguments) {
            (Callee::Absolute, [only]) => self.measure(only),
            (Callee::Minimum | Callee::Maximum, [a, b]) => self.agreeing(node, a, b),
            (Callee::Function(Function::Sqrt), [only]) => {
                Ok(self.measure(only)?.map(|dimension| dimension.power(0.5)))
            }
            (Callee::Function(Function::Power), [base, exponent]) => self.power(base, exponent),
            (Callee::Function(Function::Atan2), [a, b]) => {
                Ok(self.agreeing(node, a, b)?.map(|_| Dimension::NONE))
            }
            (_, arguments) => self.pure_arguments(callee, arguments),
        }
    }

    fn agreeing(&self, node: &Node, left: &Node, right: &Node) -> Outcome {
        let (a, b) = (self.measure(left)?, self.measure(right)?);
        let agreed = match (a, b) {
            (Measure::Free, _) if is_literal_zero(left) => Some(b),
            (_, Measure::Free) if is_literal_zero(right) => Some(a),
            _ if a.or_none() == b.or_none() => Some(a.joined(b, |dimension, _| dimension)),
            _ => None,
        };
        agreed.ok_or_else(|| self.disagreement(node, (left, a), (right, b)))
    }

    fn disagreement(
        &self,
        node: &Node,
        (left, a): (&Node, Measure),
        (right, b): (&Node, Measure),
    ) -> FormulaError {
        let message = format!("{} but {}", self.in_words(left, a), self.in_words(right, b));
        let hint = match (a.is_pure(), b.is_pure()) {
            (true, false) => Some(self.made_quantity(left, right, b)),
            (false, true) => Some(self.made_quantity(right, left, a)),
            _ => None,
        };
        FormulaError::new(node.range.clone(), message).with_hint_if(hint)
    }

    fn power(&self, base: &Node, exponent: &Node) -> Outcome {
        let (of_base, of_exponent) = (self.measure(base)?, self.measure(exponent)?);
        if !of_exponent.is_pure() {
            let message = format!("the exponent {}", self.in_words(exponent, of_exponent));
            return Err(
                FormulaError::new(exponent.range.clone(), message).with_hint("an exponent is a pure number")
            );
        }
        if of_base.is_pure() {
            return Ok(of_base.joined(of_exponent, |_, _| Dimension::NONE));
        }
        let power = self.fixed_exponent(base, of_base, exponent, of_exponent)?;
        Ok(of_base.map(|dimension| dimension.power(power)))
    }

    // With an exponent that can change, the unit of the power would change with it.
    fn fixed_exponent(
        &self,
        base: &Node,
        of_base: Measure,
        exponent: &Node,
        of_exponent: Measure,
    ) -> Result<f64, FormulaError> {
        let in_words = self.in_words(base, of_base);
        let refusal =
            |reason: String| FormulaError::new(exponent.range.clone(), format!("{in_words}, {reason}"));
        if of_exponent != Measure::Free {
            let written = excerpt(self.text, exponent);
            let reason = format!("so its exponent must be a number, and {written} is not");
            return Err(refusal(reason));
        }
        let power = evaluate::value(self.text, exponent, &NoNames)?;
        if power.abs() > LARGEST_EXPONENT {
            let power = number(power);
            let reason = format!("so its exponent can be at most {LARGEST_EXPONENT}, not {power}");
            return Err(refusal(reason));
        }
        Ok(power)
    }

    fn pure_arguments(&self, callee: Callee, arguments: &[Node]) -> Outcome {
        let mut result = Measure::Free;
        for argument in arguments {
            let measure = self.measure(argument)?;
            if !measure.is_pure() {
                return Err(self.impure(callee, argument, measure));
            }
            result = result.joined(measure, Dimension::times);
        }
        Ok(result)
    }

    fn impure(&self, callee: Callee, argument: &Node, measure: Measure) -> FormulaError {
        let in_words = self.in_words(argument, measure);
        let message = format!("{} takes a pure number, but {in_words}", callee.name());
        FormulaError::new(argument.range.clone(), message)
            .with_hint(format!("divide it by a scale in {}", self.unit(argument, measure)))
    }

    /// What makes a pure number a quantity like another.
    fn made_quantity(&self, number: &Node, other: &Node, measure: Measure) -> String {
        let (number, unit) = (excerpt(self.text, number), self.unit(other, measure));
        format!("declare {number} as a parameter in {unit}, or write its volts times a scale in {unit}")
    }

    fn in_words(&self, node: &Node, measure: Measure) -> String {
        let written = excerpt(self.text, node);
        if measure.is_pure() {
            format!("{written} is a pure number")
        } else {
            format!("{written} is in {}", self.unit(node, measure))
        }
    }

    /// The unit of a node: of a name the one that it was declared in.
    fn unit(&self, node: &Node, measure: Measure) -> String {
        let declared = match &node.expression {
            Expression::Name(name) => self.scope.declared_unit(name).map(str::to_owned),
            _ => None,
        };
        declared.unwrap_or_else(|| measure.or_none().to_string())
    }
}

// Nothing is nothing in any unit.
fn is_literal_zero(node: &Node) -> bool {
    matches!(node.expression, Expression::Number(0.0))
}
