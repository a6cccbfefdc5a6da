//! Formulas such as `K * position / force / 100`: parsing, evaluation and the check of units.
//!
//! Equations such as `m x'' = -k x` share all of this. Their parser permits more.
//!
//! The text is split into tokens and parsed into a tree of nodes. Every node records the bytes of
//! the text that it covers. Evaluation and the check of units both walk this tree and ask a scope
//! for the values and dimensions of the names. An error carries the bytes of the node at fault and
//! the values or units that caused it.

mod angle;
mod callee;
mod equation;
mod error;
mod evaluate;
mod expression;
mod foreign_signs;
mod language;
mod parse;
mod scope;
mod synonyms;
mod tokens;
mod unit_check;
mod wording;

pub use callee::Callee;
pub use equation::{Equation, EquationFunction, split_initial, split_primes};
pub use error::FormulaError;
pub use expression::{Expression, Node, Operator};
pub use scope::Scope;
pub use unit_check::FormulaDimension;

use std::fmt;
use std::str::FromStr;

use crate::number_text::format_shortest;
use language::Language;

/// A parsed expression together with its text.
///
/// A formula consists of numbers (`1`, `.5`, `1e-3`), names, the constant `pi`, the operators
/// `+ - * / ^`, parentheses and the functions of [`Callee`]. A power binds more strongly than a
/// sign: `-2^2` is -4. Powers associate to the right: `2^3^2` is 512. A formula displays as its
/// text.
///
/// # Examples
///
/// ```
/// use patchcord_expr::Formula;
///
/// let formula: Formula = "2 * K * position".parse()?;
/// assert_eq!(formula.names(), ["K", "position"]);
/// assert_eq!(formula.to_string(), "2 * K * position");
/// assert_eq!(formula, Formula::parse("2 * K * position")?);
///
/// let error = Formula::parse("2 *").unwrap_err();
/// assert_eq!(error.message, "a number, a name or a parenthesis is missing here");
/// # Ok::<(), patchcord_expr::FormulaError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    /// The text as the user wrote it. Excerpts in error messages come from it.
    text: String,
    /// The root of the expression tree. Its ranges count the bytes of `text`.
    root: Node,
}

impl Formula {
    /// Parses a formula of at most 2000 bytes and at most 200 levels of nesting.
    ///
    /// # Errors
    ///
    /// If the text is not a formula. The error contains the bytes at fault.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        Ok(Self { text: text.to_owned(), root: parse::root(text)? })
    }

    /// Returns a formula that consists of one number.
    ///
    /// A number that is not finite is accepted here; [`Formula::evaluate`] refuses it.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Formula;
    ///
    /// assert_eq!(Formula::constant(0.5).text(), "0.5");
    /// assert_eq!(Formula::constant(45e6).text(), "4.5e7");
    /// assert!(Formula::constant(0.5).names().is_empty());
    /// ```
    pub fn constant(value: f64) -> Self {
        let text = format_shortest(value);
        let root = Node { expression: Expression::Number(value), range: 0..text.len() };
        Self { text, root }
    }

    /// Returns the text of the formula as the user wrote it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the root of the expression tree. The ranges of its nodes count the bytes of the text.
    pub fn root(&self) -> &Node {
        &self.root
    }

    /// Returns each name of the formula once, in the order of first appearance. `pi` is a number, not
    /// a name.
    pub fn names(&self) -> Vec<&str> {
        self.root.names()
    }

    /// Returns the formula with each name replaced by `new_name(name)`.
    ///
    /// A name stays if `new_name` returns `None` for it. The text of the formula does not change.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Formula;
    ///
    /// let inside = Formula::parse("T * gain")?;
    /// let outside = inside.renamed(&|name: &str| (name == "T").then(|| "L1.T".to_owned()));
    /// assert_eq!(outside.names(), ["L1.T", "gain"]);
    /// assert_eq!(outside.text(), "T * gain");
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn renamed(&self, new_name: &impl Fn(&str) -> Option<String>) -> Self {
        Self { text: self.text.clone(), root: self.root.renamed(new_name) }
    }

    /// Returns the value of the formula in SI units. The value is always finite.
    ///
    /// # Errors
    ///
    /// If a name has no finite value in `scope`, a denominator is 0, an argument is outside the
    /// domain of its function, or a result overflows. The error contains the bytes and the values
    /// at fault.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::{Dimension, Formula, Scope};
    ///
    /// struct Spring; // k = 200 N/m
    ///
    /// impl Scope for Spring {
    ///     fn value(&self, name: &str) -> Option<f64> {
    ///         (name == "k").then_some(200.0)
    ///     }
    ///     fn dimension(&self, name: &str) -> Option<Dimension> {
    ///         (name == "k").then_some(Dimension::FORCE.over(Dimension::LENGTH))
    ///     }
    ///     fn names(&self) -> Vec<&str> {
    ///         vec!["k"]
    ///     }
    /// }
    ///
    /// assert_eq!(Formula::parse("2 * k")?.evaluate(&Spring)?, 400.0);
    /// let error = Formula::parse("1 / (k - 200)")?.evaluate(&Spring).unwrap_err();
    /// assert_eq!(error.message, "the denominator (k - 200) is 0: k is 200");
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn evaluate(&self, scope: &dyn Scope) -> Result<f64, FormulaError> {
        evaluate::value(&self.text, &self.root, scope)
    }

    /// Returns the dimension of the value; `scope` supplies the dimensions of the names.
    ///
    /// # Errors
    ///
    /// If a name has no dimension in `scope`, quantities of different dimensions are added or
    /// compared, or an exponent or an argument of a function has a unit. The error contains the
    /// bytes at fault and names the units.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::{Dimension, Formula, FormulaDimension, Scope};
    ///
    /// struct Mass; // m has a dimension, but no value yet
    ///
    /// impl Scope for Mass {
    ///     fn value(&self, _: &str) -> Option<f64> {
    ///         None
    ///     }
    ///     fn dimension(&self, name: &str) -> Option<Dimension> {
    ///         (name == "m").then_some(Dimension::MASS)
    ///     }
    ///     fn names(&self) -> Vec<&str> {
    ///         vec!["m"]
    ///     }
    /// }
    ///
    /// let square = Formula::parse("m ^ 2")?.dimension(&Mass)?;
    /// assert_eq!(square, FormulaDimension::Of(Dimension::MASS.power(2.0)));
    /// let error = Formula::parse("m + 1")?.dimension(&Mass).unwrap_err();
    /// assert_eq!(error.message, "m is in kg but 1 is a pure number");
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn dimension(&self, scope: &dyn Scope) -> Result<FormulaDimension, FormulaError> {
        unit_check::dimension(&self.text, &self.root, scope, Language::Formula)
    }

    /// Returns whether the value is an angular frequency, such as one in rad/s, and not a number of cycles
    /// per second.
    ///
    /// The declared units of the names decide: rad, deg and rpm contain an angle. The number pi counts as an
    /// angle too, so an angular frequency that the formula divides by `2 * pi` is not angular. A formula
    /// without a name in such a unit is never angular.
    ///
    /// # Errors
    ///
    /// If only one term of a sum is angular, or the unit has an angle to another power than 1. The error
    /// contains the bytes at fault.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::{Dimension, Formula, Scope};
    ///
    /// struct Speed; // n is declared in rpm
    ///
    /// impl Scope for Speed {
    ///     fn value(&self, _: &str) -> Option<f64> {
    ///         None
    ///     }
    ///     fn dimension(&self, name: &str) -> Option<Dimension> {
    ///         (name == "n").then_some(Dimension::FREQUENCY)
    ///     }
    ///     fn declared_unit(&self, name: &str) -> Option<&str> {
    ///         (name == "n").then_some("rpm")
    ///     }
    ///     fn names(&self) -> Vec<&str> {
    ///         vec!["n"]
    ///     }
    /// }
    ///
    /// assert!(Formula::parse("n / 2")?.is_angular(&Speed)?);
    /// assert!(!Formula::parse("n / (2 * pi)")?.is_angular(&Speed)?);
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn is_angular(&self, scope: &dyn Scope) -> Result<bool, FormulaError> {
        angle::is_angular(&self.text, &self.root, scope)
    }
}

impl FromStr for Formula {
    type Err = FormulaError;

    /// Parses a formula, see [`Formula::parse`].
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::parse(text)
    }
}

impl fmt::Display for Formula {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(&self.text)
    }
}

#[cfg(test)]
mod tests;
