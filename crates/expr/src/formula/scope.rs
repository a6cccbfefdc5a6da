//! The interface through which a formula looks up its names.

use std::ops::Range;

use super::callee::Callee;
use super::error::FormulaError;
use super::expression::{Expression, Node};
use super::wording::{excerpt, without_parentheses};
use crate::units::{Dimension, nearest};

/// The values and dimensions of the names in a formula.
///
/// # Examples
///
/// ```
/// use patchcord_expr::{Dimension, Formula, Scope};
///
/// struct Radius; // r = 0.5 m, declared as 500 mm
///
/// impl Scope for Radius {
///     fn value(&self, name: &str) -> Option<f64> {
///         (name == "r").then_some(0.5)
///     }
///     fn dimension(&self, name: &str) -> Option<Dimension> {
///         (name == "r").then_some(Dimension::LENGTH)
///     }
///     fn declared_unit(&self, name: &str) -> Option<&str> {
///         (name == "r").then_some("mm")
///     }
///     fn names(&self) -> Vec<&str> {
///         vec!["r"]
///     }
/// }
///
/// assert_eq!(Formula::parse("4 * r ^ 2")?.evaluate(&Radius)?, 1.0);
/// // Error messages use the declared unit.
/// let error = Formula::parse("sin(r)")?.dimension(&Radius).unwrap_err();
/// assert_eq!(error.message, "sin takes a pure number, but r is in mm");
/// # Ok::<(), patchcord_expr::FormulaError>(())
/// ```
pub trait Scope {
    /// Returns the value of a name in SI units. `None` if the name is unknown or its value is not
    /// available at this stage.
    fn value(&self, name: &str) -> Option<f64>;

    /// Returns the dimension of a name; `None` if it is not known.
    fn dimension(&self, name: &str) -> Option<Dimension>;

    /// Returns the text of the unit in which a name was declared, for error messages. `None` if only
    /// its dimension is known.
    fn declared_unit(&self, _name: &str) -> Option<&str> {
        None
    }

    /// Returns the dimensions of the argument and of the value of a table that an equation applies; `None` if
    /// it is not known.
    fn table(&self, _name: &str) -> Option<(Dimension, Dimension)> {
        None
    }

    /// Returns the dimension of a time. It differs from [`Dimension::TIME`] only if equations count times as
    /// pure numbers.
    fn time(&self) -> Dimension {
        Dimension::TIME
    }

    /// Whether formulas can name scales, so that a hint can advise one. Equations and problems have no scales.
    fn has_scales(&self) -> bool {
        true
    }

    /// Returns every name that may be used; the hint for an unknown name is chosen from them.
    fn names(&self) -> Vec<&str>;
}

/// The empty scope, for formulas without names.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct NoNames;

impl Scope for NoNames {
    fn value(&self, _name: &str) -> Option<f64> {
        None
    }

    fn dimension(&self, _name: &str) -> Option<Dimension> {
        None
    }

    fn names(&self) -> Vec<&str> {
        Vec::new()
    }
}

/// Returns the error for a name that is unknown or has no `property` (`value` or `unit`) in the scope.
///
/// The message distinguishes three cases. A name in the list of the scope exists, but its value or
/// unit is not available at this stage. The name of a function needs arguments. Any other name is
/// unknown, and the hint is the most similar known name. Without such a name, e is the base of the
/// natural logarithm.
pub(super) fn missing_property(
    scope: &dyn Scope,
    name: &str,
    property: &str,
    range: Range<usize>,
) -> FormulaError {
    let names = scope.names();
    if names.contains(&name) {
        return FormulaError::new(range, format!("{name} has no {property} here"));
    }
    let hint = match (Callee::from_name(name), nearest(name, names)) {
        (Some(_), _) => Some(format!("{name} is a function: write {name}( ... )")),
        (None, Some(near)) => Some(format!("did you mean {near}?")),
        (None, None) => (name == "e").then(|| E_HINT.to_owned()),
    };
    FormulaError::new(range, format!("{name} is not known here")).with_hint_if(hint)
}

/// The hint for the name e if it is not known and resembles no known name.
const E_HINT: &str = "the number e is exp(1), and e to the power of x is exp(x)";

/// Returns the error of the base of a power. If the base is the number e, the hint has the exponent: `write exp(k)` for
/// `e^k`.
pub(super) fn base_error(text: &str, base: &Node, exponent: &Node, error: FormulaError) -> FormulaError {
    let is_number_e = matches!(base.expression, Expression::Name(_)) && error.hint.as_deref() == Some(E_HINT);
    match is_number_e {
        true => error.with_hint(format!("write exp({})", without_parentheses(&excerpt(text, exponent)))),
        false => error,
    }
}
