//! The notation of equations: how an expression is written as plain text and as LaTeX.
//!
//! A [`Notation`] has the order and the grouping in which an expression is written. The writers add signs,
//! blanks and parentheses, and never rearrange. So the text of an expression is read again as an expression
//! with the same grouping, and gives the same value to the last bit.

mod json;
mod latex;
mod rounding;
mod symbols;
mod text;

pub use json::EquationDocument;
pub(crate) use latex::{aligned, conditions_latex};
pub use latex::{document, equation_latex, latex};
pub(crate) use rounding::{is_one, rounded, rounded_condition, rounded_equation};
pub(crate) use symbols::{escaped, function_latex};
pub use text::{LINE_WIDTH, equation_text, text};
pub(crate) use text::{conditions_text, primed};

/// An expression in the order and grouping in which it is written.
///
/// A sum or a product of one operand is written as the operand. An empty sum is 0, and an empty product is 1.
#[derive(Debug, Clone, PartialEq)]
pub enum Notation {
    /// A number, unsigned and finite.
    Number {
        /// The value, in the unit if there is one.
        value: f64,
        /// The text of the unit, such as `1/s2`. `None` for a pure number.
        unit: Option<String>,
    },
    /// A quantity or one of its time derivatives: x, x', x''.
    Name {
        /// The name of the quantity.
        name: String,
        /// The number of time derivatives.
        primes: u8,
    },
    /// The operand with the opposite sign.
    Negative(Box<Notation>),
    /// Terms that are added. A [`Notation::Negative`] term is written with a minus sign.
    Sum(Vec<Notation>),
    /// Factors that are multiplied.
    Product(Vec<Notation>),
    /// Numerator and denominator.
    Quotient(Box<Notation>, Box<Notation>),
    /// Base and exponent.
    Power(Box<Notation>, Box<Notation>),
    /// A function of its arguments, such as max, sqrt, sin, delay, or a table; "abs" is one of them.
    Call(String, Vec<Notation>),
    /// Values by condition; the first condition that holds decides. The last case may have none ("otherwise").
    Cases(Vec<(Notation, Option<Condition>)>),
}

/// A condition. It holds if all its comparisons hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition(pub Vec<Comparison>);

/// A part of a condition.
#[derive(Debug, Clone, PartialEq)]
pub enum Comparison {
    /// A comparison of two expressions.
    Compare {
        /// The expression on the left.
        left: Notation,
        /// The relation that must hold.
        relation: Relation,
        /// The expression on the right.
        right: Notation,
    },
    /// A condition in words, such as `R is pulled in`.
    Words(String),
}

/// A relation between two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
    /// `=`
    Equal,
}

/// An equation: left = right.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenEquation {
    /// The left side, usually one name.
    pub left: Notation,
    /// The right side.
    pub right: Notation,
}

impl WrittenEquation {
    /// The equation as plain text. Equations with cases take several lines.
    #[must_use]
    pub fn text(&self) -> String {
        equation_text(self, LINE_WIDTH)
    }
}

/// How strongly a written expression holds together, from weak to strong.
///
/// An expression needs parentheses if its place requires a stronger one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    /// Terms that are added.
    Sum,
    /// A minus sign and its operand.
    Negation,
    /// A quotient on one line, or a number with its unit.
    Quotient,
    /// Factors that are multiplied.
    Product,
    /// A base with its exponent.
    Power,
    /// A single sign, or a part with its own brackets.
    Atom,
}

impl Notation {
    /// Returns the expression without the sums and products of a single operand around it.
    fn unwrapped(&self) -> &Self {
        let (Self::Sum(operands) | Self::Product(operands)) = self else { return self };
        match operands.as_slice() {
            [only] => only.unwrapped(),
            _ => self,
        }
    }
}

/// Returns the terms of a sum, each with the sign in front of it. The first term has a sign only if it is negative.
///
/// `written` returns the text of a term without its sign.
fn signed_terms(terms: &[Notation], written: impl Fn(&Notation) -> String) -> Vec<String> {
    let signed = terms.iter().enumerate().map(|(index, term)| match term.unwrapped() {
        Notation::Negative(operand) if index == 0 => format!("-{}", written(operand)),
        Notation::Negative(operand) => format!("- {}", written(operand)),
        positive if index == 0 => written(positive),
        positive => format!("+ {}", written(positive)),
    });
    signed.collect()
}

#[cfg(test)]
mod tests;
