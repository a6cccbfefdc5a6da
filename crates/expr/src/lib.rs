//! Units, dimensions, functions and formulas.

#![forbid(unsafe_code)]

mod formula;
mod function;
mod units;

pub use formula::{
    Callee, Expression, Formula, FormulaError, Measure as FormulaMeasure, Node, Operator, Scope,
};
pub use function::Function;
pub use units::{Dimension, Unit, UnitError, engineering, nearest};
