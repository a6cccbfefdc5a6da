//! Units, dimensions, functions and formulas, the lowest layer of patchcord.
//!
//! A [`Unit`] is read from text such as `N s/m` and has a size in SI units and a [`Dimension`]. A
//! [`Formula`] is read from text such as `K * position / force`. It can be evaluated and its units
//! can be checked; a [`Scope`] supplies the values and dimensions of the names. An [`Equation`] is
//! read from text such as `m x'' = -k x`. All readers report errors with the bytes at fault, so that
//! the caller can place the error in the patch file. A [`Function`] is a mathematical function that
//! formulas and machine elements share.
//! [`format_significant`], [`format_decimals`] and [`round_significant`] give numbers the same text in
//! all reports, messages and drawings.
//!
//! # Examples
//!
//! ```
//! use patchcord_expr::{Formula, Unit};
//!
//! let unit = Unit::parse("kN/mm")?;
//! assert_eq!(unit.factor(), 1e6);
//! let formula = Formula::parse("K * position / force")?;
//! assert_eq!(formula.names(), ["K", "position", "force"]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod formula;
mod function;
mod number_text;
mod units;

pub use formula::{
    Callee, Equation, EquationFunction, Expression, Formula, FormulaDimension, FormulaError, Node, Operator,
    Scope, split_initial, split_primes,
};
pub use function::Function;
pub use number_text::{format_decimals, format_significant, leading_number, round_significant};
pub use units::{
    Conversion, ConversionError, Dimension, Unit, UnitError, UnitLabel, engineering, nearest,
    plain_superscript,
};
