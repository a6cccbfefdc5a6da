//! Equations such as `m x'' = -k x - c x'`: two expressions with one `=` between them.
//!
//! The tokenizer, the parser, the evaluation and the check of units are those of formulas. The language
//! permits more: primes for derivatives, `(0)` for initial values, products without a sign, the functions
//! of [`EquationFunction`] and tables by name.

mod function;

use std::fmt;
use std::ops::Range;

pub use function::EquationFunction;

use super::error::FormulaError;
use super::expression::{Expression, Node};
use super::language::Language;
use super::scope::{Scope, missing_property};
use super::tokens::PRIME;
use super::unit_check::FormulaDimension;
use super::{evaluate, parse, unit_check};

/// A parsed equation together with its text.
///
/// The sides are formulas with five additions.
///
/// * Primes after a name mean derivatives with respect to time: `x''`. A name has at most 9 of them.
/// * `(0)` directly after a name and its primes means the value at t = 0: `x'(0)`.
/// * A product needs no sign: `-k x`, `2x`, `k (a + b)`. It binds like `*`. After a division it is an
///   error, because `a / b c` is ambiguous.
/// * The functions of [`EquationFunction`] can be called.
/// * Tables can be applied by their names to one argument.
///
/// An equation displays as its text.
///
/// # Examples
///
/// ```
/// use patchcord_expr::Equation;
///
/// let equation = Equation::parse("m x'' = -k x - friction(x')", &["friction"])?;
/// assert_eq!(equation.names(), ["m", "x''", "k", "x", "x'"]);
/// assert_eq!(equation.to_string(), "m x'' = -k x - friction(x')");
///
/// let error = Equation::parse("x' = a / b c", &[]).unwrap_err();
/// assert_eq!(error.message, "a product without a sign after a division is ambiguous");
/// assert_eq!(error.hint.as_deref(), Some("write (a / b) c or a / (b c)"));
/// # Ok::<(), patchcord_expr::FormulaError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Equation {
    /// The text as the user wrote it. Excerpts in error messages come from it.
    text: String,
    /// The root of the tree of the left side. Its ranges count the bytes of `text`.
    left: Node,
    /// The root of the tree of the right side.
    right: Node,
}

impl Equation {
    /// Parses an equation of at most 2000 bytes and at most 200 levels of nesting. `tables` has the names of
    /// the tables that the equation can apply.
    ///
    /// # Errors
    ///
    /// If the text is not an equation. The error contains the bytes at fault.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::{Equation, Expression};
    ///
    /// let equation = Equation::parse("y = f (x)", &[])?;
    /// assert!(matches!(equation.right().expression, Expression::Binary(..)));
    /// let equation = Equation::parse("y = f (x)", &["f"])?;
    /// assert!(matches!(equation.right().expression, Expression::Apply(..)));
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn parse(text: &str, tables: &[&str]) -> Result<Self, FormulaError> {
        let (left, right) = parse::sides(text, tables)?;
        Ok(Self { text: text.to_owned(), left, right })
    }

    /// Returns the text of the equation as the user wrote it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the root of the tree of the left side. The ranges of its nodes count the bytes of the text.
    pub fn left(&self) -> &Node {
        &self.left
    }

    /// Returns the root of the tree of the right side. The ranges of its nodes count the bytes of the text.
    pub fn right(&self) -> &Node {
        &self.right
    }

    /// Returns each name of the equation once, in the order of first appearance. `x`, `x'` and `x(0)` are
    /// three names. `pi` is a number, and names of functions and tables do not count.
    pub fn names(&self) -> Vec<&str> {
        let mut names = self.left.names();
        let further: Vec<_> = self.right.names().into_iter().filter(|name| !names.contains(name)).collect();
        names.extend(further);
        names
    }

    /// Returns the bytes of the first appearance of a name. `None` if the equation does not contain it.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Equation;
    ///
    /// let equation = Equation::parse("x' = -2 x", &[])?;
    /// assert_eq!(equation.range_of("x"), Some(8..9));
    /// assert_eq!(equation.range_of("y"), None);
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn range_of(&self, name: &str) -> Option<Range<usize>> {
        let found = self.left.find_name(name).or_else(|| self.right.find_name(name));
        found.map(|node| node.range.clone())
    }

    /// Returns the quantity whose initial value the equation states, with its primes. `None` if the left side
    /// is something else.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::Equation;
    ///
    /// assert_eq!(Equation::parse("x'(0) = v0", &[])?.initial_quantity(), Some("x'"));
    /// assert_eq!(Equation::parse("x' = v", &[])?.initial_quantity(), None);
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn initial_quantity(&self) -> Option<&str> {
        match &self.left.expression {
            Expression::Name(name) => split_initial(name),
            _ => None,
        }
    }

    /// Returns the values of the left and of the right side in SI units. Both are finite.
    ///
    /// # Errors
    ///
    /// As [`Formula::evaluate`](crate::Formula::evaluate). A delay and a table have no value.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::{Dimension, Equation, Scope};
    ///
    /// struct State; // x = 2 and x' = -5
    ///
    /// impl Scope for State {
    ///     fn value(&self, name: &str) -> Option<f64> {
    ///         match name {
    ///             "x" => Some(2.0),
    ///             "x'" => Some(-5.0),
    ///             _ => None,
    ///         }
    ///     }
    ///     fn dimension(&self, _: &str) -> Option<Dimension> {
    ///         Some(Dimension::NONE)
    ///     }
    ///     fn names(&self) -> Vec<&str> {
    ///         vec!["x", "x'"]
    ///     }
    /// }
    ///
    /// let equation = Equation::parse("x' = -2 limit(x, -1, 1)", &[])?;
    /// assert_eq!(equation.evaluate(&State)?, [-5.0, -2.0]);
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn evaluate(&self, scope: &dyn Scope) -> Result<[f64; 2], FormulaError> {
        let value = |side| evaluate::value(&self.text, side, scope);
        Ok([value(&self.left)?, value(&self.right)?])
    }

    /// Checks that both sides have the same dimension. A side that is the literal number 0 has every
    /// dimension. `scope` supplies the dimensions of the names, also of those with primes.
    ///
    /// # Errors
    ///
    /// As [`Formula::dimension`](crate::Formula::dimension), or if the sides differ in dimension.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_expr::{Dimension, Equation, Scope};
    ///
    /// struct Motion; // x is a length
    ///
    /// impl Scope for Motion {
    ///     fn value(&self, _: &str) -> Option<f64> {
    ///         None
    ///     }
    ///     fn dimension(&self, name: &str) -> Option<Dimension> {
    ///         match name {
    ///             "x" => Some(Dimension::LENGTH),
    ///             "x'" => Some(Dimension::LENGTH.over(Dimension::TIME)),
    ///             _ => None,
    ///         }
    ///     }
    ///     fn names(&self) -> Vec<&str> {
    ///         vec!["x", "x'"]
    ///     }
    /// }
    ///
    /// Equation::parse("x' = 0", &[])?.dimension_check(&Motion)?;
    /// let error = Equation::parse("x' = -x", &[])?.dimension_check(&Motion).unwrap_err();
    /// assert_eq!(error.message, "x' is in m/s but -x is in m");
    /// # Ok::<(), patchcord_expr::FormulaError>(())
    /// ```
    pub fn dimension_check(&self, scope: &dyn Scope) -> Result<(), FormulaError> {
        unit_check::sides(&self.text, &self.left, &self.right, scope)
    }

    /// Returns the dimension of the right side.
    ///
    /// # Errors
    ///
    /// As [`Formula::dimension`](crate::Formula::dimension).
    pub fn right_dimension(&self, scope: &dyn Scope) -> Result<FormulaDimension, FormulaError> {
        unit_check::dimension(&self.text, &self.right, scope, Language::Equation)
    }

    /// Returns the error for a name that `scope` does not have, at its first appearance.
    ///
    /// The hint is the most similar known name, or says that the name is one of a function. `None` if the
    /// equation does not contain the name.
    pub fn unknown_name(&self, name: &str, scope: &dyn Scope) -> Option<FormulaError> {
        let range = self.range_of(name)?;
        let (base, _) = split_primes(name);
        let error = missing_property(scope, base, "unit", range);
        Some(match EquationFunction::from_name(base) {
            Some(_) => error.with_hint(format!("{base} is a function: write {base}( ... )")),
            None => error,
        })
    }
}

impl fmt::Display for Equation {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(&self.text)
    }
}

/// The end of the name of an initial value.
pub(super) const INITIAL: &str = "(0)";

/// Returns a name of an equation without its primes, and their number. The `(0)` of an initial value does
/// not count.
///
/// # Examples
///
/// ```
/// use patchcord_expr::split_primes;
///
/// assert_eq!(split_primes("x''"), ("x", 2));
/// assert_eq!(split_primes("x"), ("x", 0));
/// assert_eq!(split_primes("x'(0)"), ("x", 1));
/// ```
pub fn split_primes(name: &str) -> (&str, usize) {
    let quantity = split_initial(name).unwrap_or(name);
    let base = quantity.trim_end_matches(PRIME);
    (base, quantity.len() - base.len())
}

/// Returns the quantity of an initial value, with its primes. `None` if the name is not an initial value.
///
/// # Examples
///
/// ```
/// use patchcord_expr::split_initial;
///
/// assert_eq!(split_initial("x'(0)"), Some("x'"));
/// assert_eq!(split_initial("x'"), None);
/// ```
pub fn split_initial(name: &str) -> Option<&str> {
    name.strip_suffix(INITIAL)
}

#[cfg(test)]
mod tests;
