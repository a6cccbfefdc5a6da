//! Expressions such as `K * position / force / 100`: reading, computing, and checking the units.

mod callee;
mod error;
mod evaluate;
mod expression;
mod measure;
mod parse;
mod scope;
mod tokens;
mod words;

pub use callee::Callee;
pub use error::FormulaError;
pub use expression::{Expression, Node, Operator};
pub use measure::Measure;
pub use scope::Scope;

use std::fmt;

/// An expression together with the text it was written as.
///
/// It is made of numbers (`1`, `.5`, `1e-3`), names, the constant `pi`, the operators `+ - * / ^`,
/// parentheses, and the functions of [`Callee`]. A power is taken before a sign, so that `-2^2` is
/// -4, and from the right, so that `2^3^2` is 512. It displays as its text.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    text: String,
    root: Node,
}

impl Formula {
    /// Reads a formula of at most 2000 bytes, nested at most 200 deep.
    ///
    /// # Errors
    ///
    /// Text that is not a formula, with the bytes at fault.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        Ok(Self { text: text.to_owned(), root: parse::root(text)? })
    }

    /// The formula that is just this number.
    pub fn constant(value: f64) -> Self {
        let text = words::number(value);
        let root = Node { expression: Expression::Number(value), range: 0..text.len() };
        Self { text, root }
    }

    /// The text of the formula, as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The expression; the ranges of its nodes count the bytes of the text.
    pub fn root(&self) -> &Node {
        &self.root
    }

    /// The names that occur, each once, in the order of their first appearance. `pi` is none.
    pub fn names(&self) -> Vec<&str> {
        self.root.names()
    }

    /// The same formula with other names, for those that `other` has one for; its text stays.
    pub fn renamed(&self, other: &impl Fn(&str) -> Option<String>) -> Self {
        Self { text: self.text.clone(), root: self.root.renamed(other) }
    }

    /// The value, a finite number, when the names have the values they have in `scope`.
    ///
    /// # Errors
    ///
    /// A name without a finite value, a denominator of 0, a root of a negative number and its
    /// like, or a result too large for a number; with the bytes and the values at fault.
    pub fn evaluate(&self, scope: &dyn Scope) -> Result<f64, FormulaError> {
        evaluate::value(&self.text, &self.root, scope)
    }

    /// The dimension of the value, when the names have the dimensions they have in `scope`.
    ///
    /// # Errors
    ///
    /// A name without a dimension, quantities that cannot be added or compared, an exponent or an
    /// argument of a function that has a unit; with the bytes at fault and the units in words.
    pub fn dimension(&self, scope: &dyn Scope) -> Result<Measure, FormulaError> {
        measure::measure(&self.text, &self.root, scope)
    }
}

impl fmt::Display for Formula {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(&self.text)
    }
}

#[cfg(test)]
mod tests;
