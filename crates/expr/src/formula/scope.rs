use std::ops::Range;

use super::callee::Callee;
use super::error::FormulaError;
use crate::units::{Dimension, nearest};

/// What the names in a formula stand for.
pub trait Scope {
    /// The value of a name, in SI units; `None` if it has none (here, or yet).
    fn value(&self, name: &str) -> Option<f64>;

    /// The dimension of a name; `None` if it is not known.
    fn dimension(&self, name: &str) -> Option<Dimension>;

    /// Text of the unit that a name was declared in; `None` where its dimension is all that is known.
    fn declared_unit(&self, _name: &str) -> Option<&str> {
        None
    }

    /// Every name that may be used, for the hint of what an unknown name was meant to be.
    fn names(&self) -> Vec<&str>;
}

/// The scope in which no name is known, for formulas made of numbers only.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoNames;

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

/// The error for a name about which the scope does not tell `what` is asked of it.
pub(super) fn not_told(scope: &dyn Scope, name: &str, what: &str, range: Range<usize>) -> FormulaError {
    let names = scope.names();
    if names.contains(&name) {
        return FormulaError::new(range, format!("{name} has no {what} here"));
    }
    let hint = match Callee::named(name) {
        Some(_) => Some(format!("{name} is a function: write {name}( ... )")),
        None => nearest(name, names).map(|near| format!("did you mean {near}?")),
    };
    FormulaError::new(range, format!("{name} is not known here")).with_hint_if(hint)
}
