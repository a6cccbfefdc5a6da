//! The rules that only equations have: the equals sign, primes, initial values, products without a sign,
//! functions of equations and tables.
//!
//! A name before a parenthesis is the name of a function or a table, or the first factor of a product.
//! Names that resemble a function are errors there, so that a misspelt function is not a product. A name
//! directly before `(0)` is an initial value.

use std::f64::consts::PI;
use std::ops::Range;

use super::{Parser, wrong_argument_count};
use crate::formula::callee::Callee;
use crate::formula::equation::{EquationFunction, INITIAL, split_initial, split_primes};
use crate::formula::error::FormulaError;
use crate::formula::expression::{Expression, Node, Operator};
use crate::formula::language::Language;
use crate::formula::synonyms;
use crate::formula::tokens::TokenKind;
use crate::units::nearest;

/// The maximum number of primes after a name.
const MAX_PRIMES: usize = 9;

/// The name of the time in an equation.
const TIME: &str = "t";

impl Parser<'_> {
    /// Consumes the equals sign between the sides of an equation.
    pub(super) fn equals_sign(&mut self) -> Result<(), FormulaError> {
        if self.take('=').is_some() {
            return Ok(());
        }
        Err(match self.current().kind {
            TokenKind::End => FormulaError::new(0..self.text.len(), "the equation has no =")
                .with_hint("write a left and a right side, such as x' = v"),
            _ => self.superfluous(),
        })
    }

    /// Checks that nothing follows the right side.
    pub(super) fn end_of_equation(&self) -> Result<(), FormulaError> {
        match self.current().kind {
            TokenKind::End => Ok(()),
            TokenKind::Sign('=') => {
                let range = self.current().range.clone();
                Err(FormulaError::new(range, "an equation has only one =")
                    .with_hint("write one equation for each ="))
            }
            _ => Err(self.superfluous()),
        }
    }

    /// Whether the current token is a factor that follows another one without a sign.
    ///
    /// A number does not: `x 2` is rather a misspelt power or name.
    pub(super) fn begins_implied_factor(&self) -> bool {
        self.language == Language::Equation
            && matches!(self.current().kind, TokenKind::Name | TokenKind::Sign('('))
    }

    /// Checks that a quotient of an equation is not a derivative in the notation `dx/dt`.
    pub(super) fn check_quotient(&self, dividend: &Node, divisor: &Node) -> Result<(), FormulaError> {
        let is_equation = self.language == Language::Equation;
        let Some(order) = time_order(divisor).filter(|_| is_equation) else { return Ok(()) };
        let Some((range, variable)) = differential(dividend, order) else { return Ok(()) };
        let range = range.start..divisor.range.end;
        let message = format!("{} is not a derivative here", &self.text[range.clone()]);
        let primes = "'".repeat(order);
        let is_initial = is_initial_value(divisor) || split_initial(variable).is_some();
        let start = if is_initial { INITIAL } else { "" };
        let hint = match split_initial(variable).unwrap_or(variable) {
            "" => format!("the derivative of x is written x{primes}"),
            variable => format!("write {variable}{primes}{start}"),
        };
        Err(FormulaError::new(range, message).with_hint(hint))
    }

    /// Parses what follows a name of an equation: the arguments of a function or a table.
    ///
    /// The name of a function of equations is also the name of a quantity if no argument follows it.
    pub(super) fn equation_name(&mut self, range: Range<usize>) -> Result<Node, FormulaError> {
        let name = self.text_of(&range);
        check_primes(name, &range)?;
        let opens = self.current().kind == TokenKind::Sign('(');
        if Callee::from_name(name).is_some() {
            return match self.take('(') {
                Some(open) => self.call(range, &open),
                None => Err(missing_parentheses(name, range)),
            };
        }
        let is_function = EquationFunction::from_name(name).is_some();
        if is_function || self.tables.contains(&name) {
            if let Some(open) = self.take('(') {
                return self.application(range, &open);
            }
            if matches!(self.current().kind, TokenKind::Name | TokenKind::Number(_)) {
                return Err(missing_parentheses(name, range));
            }
        }
        if name == "pi" {
            return Ok(Node { expression: Expression::Number(PI), range });
        }
        let is_adjacent = opens && self.current().range.start == range.end;
        if let Some(end) = self.end_of_zero_group() {
            return self.initial_value(range.start..end, name, is_adjacent);
        }
        if is_adjacent {
            self.check_product_with_group(name, &range)?;
        }
        Ok(Node { expression: Expression::Name(name.to_owned()), range })
    }

    /// Returns the end of the group `(0)` if it begins at the current token. `None` if something else does.
    fn end_of_zero_group(&self) -> Option<usize> {
        let [open, number, close, ..] = &self.tokens[self.at..] else { return None };
        let is_zero_group = open.kind == TokenKind::Sign('(')
            && number.kind == TokenKind::Number(0.0)
            && close.kind == TokenKind::Sign(')');
        is_zero_group.then_some(close.range.end)
    }

    /// Consumes the group `(0)` after the name of a quantity. `range` is that of both.
    ///
    /// With a blank between them, the text is a product with the factor 0. Nobody means that, so it is an
    /// error.
    fn initial_value(
        &mut self,
        range: Range<usize>,
        name: &str,
        is_adjacent: bool,
    ) -> Result<Node, FormulaError> {
        if !is_adjacent {
            let message = format!("{} is the product of {name} and 0", self.text_of(&range));
            return Err(FormulaError::new(range, message)
                .with_hint(format!("write {name}{INITIAL} for the value at the start")));
        }
        self.at += 3;
        Ok(Node { expression: Expression::Name(format!("{name}{INITIAL}")), range })
    }

    /// Parses the arguments of a function of equations or of a table after the opening parenthesis.
    fn application(&mut self, name: Range<usize>, open: &Range<usize>) -> Result<Node, FormulaError> {
        let applied = self.text_of(&name);
        let arguments = self.arguments()?;
        let range = name.start..self.close(open)?;
        let wanted = EquationFunction::from_name(applied).map_or(1, EquationFunction::argument_count);
        if arguments.len() != wanted {
            return Err(wrong_argument_count(applied, wanted, arguments.len(), range));
        }
        Ok(Node { expression: Expression::Apply(applied.to_owned(), arguments), range })
    }

    /// Checks a name that a parenthesis follows without a blank. It is the first factor of a product,
    /// unless it is a misspelt or foreign function, or a quantity that is written as `x(t)` or `x(5)`.
    fn check_product_with_group(&self, name: &str, range: &Range<usize>) -> Result<(), FormulaError> {
        if let Some(hint) = self.function_hint(name) {
            let message = format!("{name} is not a function");
            return Err(FormulaError::new(range.clone(), message).with_hint(hint));
        }
        let [_, argument, close, ..] = &self.tokens[self.at..] else { return Ok(()) };
        if close.kind != TokenKind::Sign(')') {
            return Ok(());
        }
        let written = self.text_of(&argument.range);
        let hint = match argument.kind {
            TokenKind::Name if written == TIME => {
                format!("write {name}: a quantity depends on the time anyway; its value at the start is")
            }
            TokenKind::Number(_) => format!("the product is {written} {name}; the value at the start is"),
            _ => return Ok(()),
        };
        let message = format!("{name}({written}) is the product of {name} and {written}");
        Err(FormulaError::new(range.start..close.range.end, message)
            .with_hint(format!("{hint} {name}{INITIAL}")))
    }

    /// Returns the hint for a name that is probably meant as a function. `None` for other names.
    fn function_hint(&self, name: &str) -> Option<String> {
        if let Some(advice) = synonyms::equation_advice(name).or_else(|| synonyms::advice(name)) {
            return Some(advice.to_owned());
        }
        let mut known: Vec<&str> = Callee::all().map(Callee::name).collect();
        known.extend(EquationFunction::ALL.map(EquationFunction::name));
        known.extend(self.tables);
        let near = nearest(name, known)?;
        Some(format!("did you mean {near}? A product is written {name} * ( ... )"))
    }
}

/// Checks the primes of a name. There are at most [`MAX_PRIMES`], and a number or a function has none.
fn check_primes(name: &str, range: &Range<usize>) -> Result<(), FormulaError> {
    let (base, order) = split_primes(name);
    let primes = range.start + base.len()..range.end;
    if order > MAX_PRIMES {
        let message = format!("a name has at most {MAX_PRIMES} primes");
        return Err(FormulaError::new(primes, message).with_hint("name a lower derivative by a signal"));
    }
    let noun = match base {
        _ if order == 0 => return Ok(()),
        "pi" => "a number",
        _ if Callee::from_name(base).is_some() => "a function",
        _ => return Ok(()),
    };
    Err(FormulaError::new(primes, format!("{base} is {noun} and has no derivative"))
        .with_hint("a prime follows the name of a quantity"))
}

/// Returns the error for the name of a function without parentheses.
fn missing_parentheses(name: &str, range: Range<usize>) -> FormulaError {
    FormulaError::new(range, format!("{name} is a function: write {name}( ... )"))
        .with_hint("the arguments of a function are in parentheses")
}

/// Whether a node is an initial value, such as `x'(0)`.
fn is_initial_value(node: &Node) -> bool {
    matches!(&node.expression, Expression::Name(name) if split_initial(name).is_some())
}

/// Returns the order of the derivative with this divisor: 1 for `dt` and `dt(0)`, 2 for `dt^2` and `dt2`.
/// `None` for other divisors.
fn time_order(divisor: &Node) -> Option<usize> {
    match &divisor.expression {
        Expression::Name(name) => order_of(split_initial(name).unwrap_or(name).strip_prefix("dt")?),
        Expression::Binary(Operator::Power, base, exponent) => match (&base.expression, &exponent.expression)
        {
            (Expression::Name(name), Expression::Number(order)) if name == "dt" => whole_order(*order),
            _ => None,
        },
        _ => None,
    }
}

/// Returns the order that follows a letter: 2 for the text "2", and 1 for an empty text.
fn order_of(digits: &str) -> Option<usize> {
    if digits.is_empty() { Some(1) } else { whole_order(digits.parse().ok()?) }
}

/// Returns a number as the order of a derivative. `None` if it is not a whole number from 1 to
/// [`MAX_PRIMES`].
fn whole_order(number: f64) -> Option<usize> {
    (1..=MAX_PRIMES).find(|order| *order as f64 == number)
}

/// Returns the range and the variable of the differential at the end of a dividend: `x` for `m dx`, and
/// for `d^2 x` and `d2x` if the order is 2. The variable of `d` alone is empty.
fn differential(dividend: &Node, order: usize) -> Option<(Range<usize>, &str)> {
    let last = last_factor(dividend);
    let Expression::Name(name) = &last.expression else {
        return is_differential_sign(last, order).then(|| (last.range.clone(), ""));
    };
    if let Some(rest) = name.strip_prefix('d') {
        let digits = rest.len() - rest.trim_start_matches(|letter: char| letter.is_ascii_digit()).len();
        if order_of(&rest[..digits]) == Some(order) {
            return Some((last.range.clone(), &rest[digits..]));
        }
    }
    let Expression::Binary(Operator::Multiply, others, _) = &dividend.expression else { return None };
    let sign = last_factor(others);
    is_differential_sign(sign, order).then_some((sign.range.start..last.range.end, name.as_str()))
}

/// Whether a node is the sign of a differential in front of its variable: `d`, or `d^2` if the order is 2.
fn is_differential_sign(node: &Node, order: usize) -> bool {
    let is_d = |node: &Node| matches!(&node.expression, Expression::Name(name) if name == "d");
    match &node.expression {
        Expression::Binary(Operator::Power, base, exponent) => match exponent.expression {
            Expression::Number(number) => is_d(base) && whole_order(number) == Some(order),
            _ => false,
        },
        _ => order == 1 && is_d(node),
    }
}

/// Returns the last factor of a product; the node itself if it is not a product.
fn last_factor(node: &Node) -> &Node {
    match &node.expression {
        Expression::Binary(Operator::Multiply, _, right) => right,
        Expression::Negate(inner) => inner,
        _ => node,
    }
}
