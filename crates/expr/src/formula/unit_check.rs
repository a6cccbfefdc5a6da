//! Checks the units of a formula and computes the dimension of its value.
//!
//! Dimensions are derived from the leaves to the root. Operands of a sum, and of `min`, `max` and
//! `atan2`, must have the same dimension. Arguments of other functions and exponents must be pure
//! numbers. A literal number counts as a pure number, except that a literal 0 fits every dimension.
//! The sides of an equation agree like the operands of a sum.

use std::ops::Range;

use super::callee::Callee;
use super::equation::EquationFunction;
use super::error::FormulaError;
use super::evaluate;
use super::expression::{Expression, Node, Operator};
use super::language::Language;
use super::scope::{NoNames, Scope, base_error, missing_property};
use super::wording::excerpt;
use crate::function::Function;
use crate::number_text::format_shortest;
use crate::units::Dimension;

/// The maximum exponent of a quantity that has a unit, as in the unit syntax (`m^12`).
const MAX_EXPONENT: f64 = 12.0;

/// The dimension of the value of a formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FormulaDimension {
    /// The formula contains literal numbers only. The setting that uses it decides the unit.
    Literal,
    /// A quantity of this dimension, in SI units.
    Of(Dimension),
}

impl FormulaDimension {
    /// Returns the dimension; literal numbers count as pure numbers.
    pub fn or_dimensionless(self) -> Dimension {
        match self {
            Self::Literal => Dimension::NONE,
            Self::Of(dimension) => dimension,
        }
    }

    /// Whether the value has no unit.
    fn is_pure_number(self) -> bool {
        self.or_dimensionless().is_dimensionless()
    }

    /// Returns the dimension changed by `change`. A literal stays a literal.
    fn map(self, change: impl FnOnce(Dimension) -> Dimension) -> Self {
        match self {
            Self::Literal => Self::Literal,
            Self::Of(dimension) => Self::Of(change(dimension)),
        }
    }

    /// Returns the joint dimension of two operands. The result is a literal only if both are.
    fn combined(self, other: Self, join: impl FnOnce(Dimension, Dimension) -> Dimension) -> Self {
        match (self, other) {
            (Self::Literal, Self::Literal) => Self::Literal,
            _ => Self::Of(join(self.or_dimensionless(), other.or_dimensionless())),
        }
    }
}

/// Returns the dimension of a node.
pub(super) fn dimension(text: &str, node: &Node, scope: &dyn Scope, language: Language) -> DimensionResult {
    UnitChecker { text, scope, language }.dimension(node)
}

/// Checks that both sides of an equation have the same dimension.
pub(super) fn sides(text: &str, left: &Node, right: &Node, scope: &dyn Scope) -> Result<(), FormulaError> {
    let checker = UnitChecker { text, scope, language: Language::Equation };
    checker.agreeing(&(left.range.start..right.range.end), left, right).map(|_| ())
}

/// Derives the dimensions of the nodes of one formula.
struct UnitChecker<'m> {
    /// The text of the formula, for excerpts in error messages.
    text: &'m str,
    /// The dimensions of the names, and the units in which they were declared.
    scope: &'m dyn Scope,
    /// The language of the text.
    language: Language,
}

/// The dimension of a node, or the error of the first node whose operands do not fit.
type DimensionResult = Result<FormulaDimension, FormulaError>;

impl UnitChecker<'_> {
    /// Returns the dimension of a node. A sign does not change it.
    fn dimension(&self, node: &Node) -> DimensionResult {
        match &node.expression {
            Expression::Number(_) => Ok(FormulaDimension::Literal),
            Expression::Name(name) => self.named(name, &node.range),
            Expression::Negate(inner) => self.dimension(inner),
            Expression::Binary(operator, left, right) => self.binary(node, *operator, left, right),
            Expression::Call(callee, arguments) => self.call(node, *callee, arguments),
            Expression::Apply(name, arguments) => self.application(node, name, arguments),
        }
    }

    /// Returns the dimension of a name from the scope.
    fn named(&self, name: &str, range: &Range<usize>) -> DimensionResult {
        match self.scope.dimension(name) {
            Some(dimension) => Ok(FormulaDimension::Of(dimension)),
            None => Err(missing_property(self.scope, name, "unit", range.clone())),
        }
    }

    /// Returns the dimension of an operation. Products and quotients accept all dimensions.
    fn binary(&self, node: &Node, operator: Operator, left: &Node, right: &Node) -> DimensionResult {
        match operator {
            Operator::Add | Operator::Subtract => self.agreeing(&node.range, left, right),
            Operator::Multiply => {
                let (a, b) = (self.dimension(left)?, self.dimension(right)?);
                Ok(a.combined(b, Dimension::times))
            }
            Operator::Divide => {
                let (a, b) = (self.dimension(left)?, self.dimension(right)?);
                Ok(a.combined(b, Dimension::over))
            }
            Operator::Power => self.power(left, right),
        }
    }

    /// Returns the dimension of a call.
    ///
    /// `abs` keeps the dimension of its argument, and `min` and `max` that of their two arguments. `sqrt`
    /// halves the exponents. `atan2` gives a pure number from two lengths, for example. All other
    /// functions take pure numbers.
    fn call(&self, node: &Node, callee: Callee, arguments: &[Node]) -> DimensionResult {
        match (callee, arguments) {
            (Callee::Absolute, [only]) => self.dimension(only),
            (Callee::Minimum | Callee::Maximum, [a, b]) => self.agreeing(&node.range, a, b),
            (Callee::Function(Function::Sqrt), [only]) => {
                Ok(self.dimension(only)?.map(|dimension| dimension.power(0.5)))
            }
            (Callee::Function(Function::Power), [base, exponent]) => self.power(base, exponent),
            (Callee::Function(Function::Atan2), [a, b]) => {
                Ok(self.agreeing(&node.range, a, b)?.map(|_| Dimension::NONE))
            }
            (_, arguments) => self.pure_arguments(callee, arguments),
        }
    }

    /// Returns the dimension of a function of equations or a table.
    ///
    /// `sign` and `step` give pure numbers. The arguments of `dead_zone` and `limit` agree, and their value
    /// has the same dimension. `delay` keeps the dimension of its first argument; the second is a time.
    fn application(&self, node: &Node, name: &str, arguments: &[Node]) -> DimensionResult {
        use EquationFunction::{DeadZone, Delay, Limit, Sign, Step};
        match (EquationFunction::from_name(name), arguments) {
            (Some(Sign | Step), [only]) => Ok(self.dimension(only)?.map(|_| Dimension::NONE)),
            (Some(DeadZone | Limit), arguments) => self.all_agreeing(&node.range, arguments),
            (Some(Delay), [input, time]) => {
                let dimension = self.dimension(input)?;
                self.check_argument(name, time, self.scope.time())?;
                Ok(dimension)
            }
            (_, arguments) => self.table(node, name, arguments),
        }
    }

    /// Returns the dimension of the value of a table, whose argument has the dimension from the scope.
    fn table(&self, node: &Node, name: &str, arguments: &[Node]) -> DimensionResult {
        let Some((of_argument, of_value)) = self.scope.table(name) else {
            let message = format!("the table {name} is not known here");
            return Err(FormulaError::new(node.range.clone(), message));
        };
        for argument in arguments {
            self.check_argument(name, argument, of_argument)?;
        }
        Ok(FormulaDimension::Of(of_value))
    }

    /// Checks that an argument has the expected dimension. A literal 0 has every dimension.
    fn check_argument(&self, name: &str, argument: &Node, expected: Dimension) -> Result<(), FormulaError> {
        let found = self.dimension(argument)?;
        if is_literal_zero(argument) || found.or_dimensionless() == expected {
            return Ok(());
        }
        let wanted = if expected == Dimension::TIME {
            "a time".to_owned()
        } else if expected.is_dimensionless() {
            "a pure number".to_owned()
        } else {
            format!("a quantity in {expected}")
        };
        let message = format!("{name} takes {wanted}, but {}", self.describe(argument, found));
        let hint = (found == FormulaDimension::Literal).then(|| {
            let written = excerpt(self.text, argument);
            format!("declare {written} as a parameter in {expected}")
        });
        Err(FormulaError::new(argument.range.clone(), message).with_hint_if(hint))
    }

    /// Returns the common dimension of several arguments. Each literal 0 adapts to the others.
    ///
    /// The dimension of each argument is derived once, so that nested calls take no exponential time.
    fn all_agreeing(&self, range: &Range<usize>, arguments: &[Node]) -> DimensionResult {
        let mut dimensions = Vec::with_capacity(arguments.len());
        for argument in arguments {
            dimensions.push((argument, self.dimension(argument)?));
        }
        let reference = dimensions.iter().copied().find(|(argument, _)| !is_literal_zero(argument));
        let Some(reference) = reference else { return Ok(FormulaDimension::Literal) };
        let mut common = reference.1;
        for argument in dimensions {
            let agreed = self.common(range, reference, argument)?;
            common = common.combined(agreed, |dimension, _| dimension);
        }
        Ok(common)
    }

    /// Returns the common dimension of two operands. `range` is that of both.
    fn agreeing(&self, range: &Range<usize>, left: &Node, right: &Node) -> DimensionResult {
        let (a, b) = (self.dimension(left)?, self.dimension(right)?);
        self.common(range, (left, a), (right, b))
    }

    /// Returns the common dimension of two operands with these dimensions. A literal 0 adapts to the other
    /// operand.
    fn common(
        &self,
        range: &Range<usize>,
        (left, a): (&Node, FormulaDimension),
        (right, b): (&Node, FormulaDimension),
    ) -> DimensionResult {
        let agreed = match (a, b) {
            (FormulaDimension::Literal, _) if is_literal_zero(left) => Some(b),
            (_, FormulaDimension::Literal) if is_literal_zero(right) => Some(a),
            _ if a.or_dimensionless() == b.or_dimensionless() => {
                Some(a.combined(b, |dimension, _| dimension))
            }
            _ => None,
        };
        agreed.ok_or_else(|| self.disagreement(range, (left, a), (right, b)))
    }

    /// Returns the error for operands of different dimensions: `k is in N/m but 1 is a pure number`.
    ///
    /// If one of them is a pure number, the hint says how to give it the unit of the other.
    fn disagreement(
        &self,
        range: &Range<usize>,
        (left, a): (&Node, FormulaDimension),
        (right, b): (&Node, FormulaDimension),
    ) -> FormulaError {
        let message = format!("{} but {}", self.describe(left, a), self.describe(right, b));
        let hint = match (a.is_pure_number(), b.is_pure_number()) {
            (true, false) => Some(self.quantity_hint((left, a), (right, b))),
            (false, true) => Some(self.quantity_hint((right, b), (left, a))),
            _ => None,
        };
        FormulaError::new(range.clone(), message).with_hint_if(hint)
    }

    /// Returns the dimension of a power. The exponent is always a pure number.
    ///
    /// If the base has a unit, the exponents of its dimension are multiplied by the value of the exponent.
    fn power(&self, base: &Node, exponent: &Node) -> DimensionResult {
        let of_base = self.dimension(base).map_err(|error| base_error(self.text, base, exponent, error))?;
        let of_exponent = self.dimension(exponent)?;
        if !of_exponent.is_pure_number() {
            let message = format!("the exponent {}", self.describe(exponent, of_exponent));
            return Err(
                FormulaError::new(exponent.range.clone(), message).with_hint("an exponent is a pure number")
            );
        }
        if of_base.is_pure_number() {
            return Ok(of_base.combined(of_exponent, |_, _| Dimension::NONE));
        }
        let power = self.constant_exponent(base, of_base, exponent, of_exponent)?;
        Ok(of_base.map(|dimension| dimension.power(power)))
    }

    /// Returns the exponent of a base with a unit. It must consist of literal numbers, and its magnitude is at
    /// most [`MAX_EXPONENT`].
    ///
    /// If the exponent could change, the unit of the power would change with it.
    fn constant_exponent(
        &self,
        base: &Node,
        of_base: FormulaDimension,
        exponent: &Node,
        of_exponent: FormulaDimension,
    ) -> Result<f64, FormulaError> {
        let described = self.describe(base, of_base);
        let refusal =
            |reason: String| FormulaError::new(exponent.range.clone(), format!("{described}, {reason}"));
        if of_exponent != FormulaDimension::Literal {
            let written = excerpt(self.text, exponent);
            let reason = format!("so its exponent must be a number, and {written} is not");
            return Err(refusal(reason));
        }
        let power = evaluate::value(self.text, exponent, &NoNames)?;
        if power.abs() > MAX_EXPONENT {
            let power = format_shortest(power);
            let reason = format!("so its exponent can be at most {MAX_EXPONENT}, not {power}");
            return Err(refusal(reason));
        }
        Ok(power)
    }

    /// Checks a call whose arguments must be pure numbers. The value is a pure number, too.
    fn pure_arguments(&self, callee: Callee, arguments: &[Node]) -> DimensionResult {
        let mut result = FormulaDimension::Literal;
        for argument in arguments {
            let dimension = self.dimension(argument)?;
            if !dimension.is_pure_number() {
                return Err(self.impure(callee, argument, dimension));
            }
            result = result.combined(dimension, Dimension::times);
        }
        Ok(result)
    }

    /// Whether hints can advise a scale. Equations have none, and the scope decides for formulas.
    fn has_scales(&self) -> bool {
        self.language == Language::Formula && self.scope.has_scales()
    }

    /// Returns the error for an argument with a unit. The hint says to divide it by a scale, if there are scales.
    fn impure(&self, callee: Callee, argument: &Node, dimension: FormulaDimension) -> FormulaError {
        let described = self.describe(argument, dimension);
        let message = format!("{} takes a pure number, but {described}", callee.name());
        let divisor = if self.has_scales() { "scale" } else { "parameter" };
        FormulaError::new(argument.range.clone(), message)
            .with_hint(format!("divide it by a {divisor} in {}", self.unit(argument, dimension)))
    }

    /// Returns the hint for a pure number that must have the dimension of another node.
    fn quantity_hint(
        &self,
        (number, of_number): (&Node, FormulaDimension),
        (other, of_other): (&Node, FormulaDimension),
    ) -> String {
        let (number, unit) = (excerpt(self.text, number), self.unit(other, of_other));
        match (self.has_scales(), of_number) {
            (true, _) => {
                format!(
                    "declare {number} as a parameter in {unit}, or write its volts times a scale in {unit}"
                )
            }
            (false, FormulaDimension::Literal) => {
                format!("declare {number} as a parameter in {unit}")
            }
            (false, FormulaDimension::Of(_)) => {
                format!("multiply {number} by a parameter in {unit}")
            }
        }
    }

    /// Describes the unit of a node for a message: `k is in N/m` or `2 * a is a pure number`.
    fn describe(&self, node: &Node, dimension: FormulaDimension) -> String {
        let written = excerpt(self.text, node);
        if dimension.is_pure_number() {
            format!("{written} is a pure number")
        } else {
            format!("{written} is in {}", self.unit(node, dimension))
        }
    }

    /// Returns the unit of a node. For a name it is the unit of its declaration.
    fn unit(&self, node: &Node, dimension: FormulaDimension) -> String {
        let declared = match &node.expression {
            Expression::Name(name) => self.scope.declared_unit(name).map(str::to_owned),
            _ => None,
        };
        declared.unwrap_or_else(|| dimension.or_dimensionless().to_string())
    }
}

/// Whether a node is the literal number 0.
///
/// A literal 0 has the same value in every unit.
pub(super) fn is_literal_zero(node: &Node) -> bool {
    matches!(node.expression, Expression::Number(0.0))
}
