//! Helpers of the unit tests: the quantities of expressions, expressions from text, random trees, and files of problems.

#[path = "../../tests/problem_files.rs"]
pub(crate) mod problem_files;
pub(crate) mod reading;
pub(crate) mod trees;

use crate::symbolic::{Fraction, Symbol, Values, value};

/// The quantities of the tests. The first [`VARIABLES`] can have any sign, and the others are always above 0.
pub(crate) const QUANTITIES: [&str; 8] = ["x", "y", "z", "p", "q", "F", "Fs", "T"];

/// Number of quantities that can have any sign.
pub(crate) const VARIABLES: usize = 3;

/// The symbol of a quantity.
pub(crate) fn symbol(name: &str) -> Symbol {
    let index = QUANTITIES.iter().position(|known| *known == name);
    let index = index.unwrap_or_else(|| panic!("{name} is no quantity of the tests"));
    let is_parameter = index >= VARIABLES;
    Symbol {
        index: index as u32,
        is_nonnegative: is_parameter,
        is_positive: is_parameter,
        is_constant: is_parameter,
    }
}

/// The values of the first quantities at one instant. Each of them rises at a rate of 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point(pub [f64; 5]);

impl Values for Point {
    fn symbol(&self, symbol: Symbol) -> f64 {
        self.0[symbol.index as usize]
    }

    /// The value of a table. Every table is the cube of its abscissa.
    fn table(&self, _table: u32, at: f64) -> f64 {
        at.powi(3)
    }

    fn slope(&self, _table: u32, at: f64) -> f64 {
        3.0 * at.powi(2)
    }

    fn delayed(&self, expression: &Fraction, time: f64) -> f64 {
        value(expression, &Point(self.0.map(|own| own - time)))
    }
}
