//! Expressions with exact numbers, in a normal form.
//!
//! Two expressions are equal if their difference is 0 in normal form. The numbers are rational, so gains and scales
//! cancel exactly.

mod apply;
mod derivative;
mod elimination;
mod evaluate;
mod fraction;
mod monomial;
mod number;
mod polynomial;
mod roots;
mod symbol;

pub(crate) use apply::{absolute, call, delay, opaque, root, sign, step, with_reduced_powers};
pub(crate) use derivative::{derivative, partial_derivative};
pub(crate) use evaluate::{Values, is_at_switch, term_size, value};
pub(crate) use fraction::Fraction;
pub(crate) use monomial::{Application, Atom, CallOrder, Monomial, Operation};
pub(crate) use number::{Rational, nearest, whole};
pub(crate) use polynomial::Polynomial;
pub(crate) use roots::Roots;
pub(crate) use symbol::{Symbol, SymbolEntry, SymbolKind, Symbols};

#[cfg(test)]
mod tests;
