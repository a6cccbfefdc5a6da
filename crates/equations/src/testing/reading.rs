//! Reads expressions from text, in the language of equations.

use patchcord_expr::{Equation, Node};

use crate::compare::intended::fraction;
use crate::symbolic::{Fraction, Symbol};

/// Reads an expression of the quantities of the tests.
pub(crate) fn read(text: &str) -> Fraction {
    read_with(text, &super::symbol)
}

/// Reads both sides of an equation between the quantities of the tests.
pub(crate) fn read_sides(text: &str) -> [Fraction; 2] {
    sides(text, &super::symbol)
}

/// Reads an expression. `symbol` returns the symbol of a name.
pub(crate) fn read_with(text: &str, symbol: &dyn Fn(&str) -> Symbol) -> Fraction {
    let [_, expression] = sides(&format!("0 = {text}"), symbol);
    expression
}

/// Reads both sides of an equation.
fn sides(text: &str, symbol: &dyn Fn(&str) -> Symbol) -> [Fraction; 2] {
    let equation = Equation::parse(text, &[]).unwrap_or_else(|error| panic!("{text}: {error}"));
    let read = |node: &Node| fraction(node, &mut |name| Ok(Fraction::symbol(symbol(name)))).unwrap();
    [equation.left(), equation.right()].map(read)
}
