//! Expressions with exact numbers, in a normal form.
//!
//! Two expressions are equal if their difference is 0 in normal form. The numbers are rational, so gains and scales
//! cancel exactly.
//!
//! Long products are not multiplied out: above [`polynomial::MOST_PRODUCTS`] pairs of terms, each sum becomes one factor. The
//! normal form is then that of another expression with the same value, so a difference can be 0 although its normal form
//! is not. The comparison of equations decides such cases by values.

mod application;
mod apply;
mod derivative;
mod evaluate;
mod fraction;
mod linear_system;
mod monomial;
mod number;
mod polynomial;
mod replacement;
mod roots;
mod symbol;

pub(crate) use application::Application;
pub(crate) use apply::{absolute, call, delay, opaque, root, sign, step, with_reduced_powers};
pub(crate) use derivative::{derivative, partial_derivative};
pub(crate) use evaluate::{Values, corner_arguments, is_at_switch, term_size, value};
pub(crate) use fraction::Fraction;
pub(crate) use linear_system::linear_solution;
pub(crate) use monomial::{Atom, CallOrder, Monomial, Operation};
pub(crate) use number::{Rational, nearest, whole};
pub(crate) use polynomial::Polynomial;
pub(crate) use roots::Roots;
pub(crate) use symbol::{Symbol, SymbolEntry, SymbolKind, Symbols};

#[cfg(test)]
mod tests;
