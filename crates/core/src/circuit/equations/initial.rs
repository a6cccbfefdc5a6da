//! Checks equations that state initial values, such as `x(0) = x0`.
//!
//! An initial value stands alone on the left of an equation. The right side consists of parameters, numbers and
//! functions, so that it has a value before the run.

use super::names::variable_noun;
use super::scope::TIME;
use crate::patch::Patch;
use patchcord_expr::{Equation, FormulaError, split_initial, split_primes};

/// The fault of an equation in which an initial value is in a wrong place or depends on other names than parameters.
/// `None` if there is no such fault. The names of the equation have been checked.
pub(super) fn fault(patch: &Patch, equation: &Equation) -> Option<FormulaError> {
    match equation.initial_quantity() {
        Some(_) => dependence(patch, equation),
        None => misplaced(equation),
    }
}

/// The fault of the first name on the right of an initial value that is not a parameter.
fn dependence(patch: &Patch, equation: &Equation) -> Option<FormulaError> {
    let right = equation.right();
    let name = right.names().into_iter().find(|name| !patch.parameters.contains_key(*name))?;
    let base = split_primes(name).0;
    let hint = if split_initial(name).is_some() {
        format!("write parameters in place of {name}")
    } else if base == TIME {
        "t is 0 at the start: write the expression without it".to_owned()
    } else {
        format!("{base} is {}: declare a parameter for {name} at the start", variable_noun(patch, base))
    };
    Some(FormulaError {
        range: right.find_name(name)?.range.clone(),
        message: "an initial value is an expression of parameters".to_owned(),
        hint: Some(hint),
    })
}

/// The fault of the first initial value in an equation whose left side is not just an initial value.
fn misplaced(equation: &Equation) -> Option<FormulaError> {
    let name = equation.names().into_iter().find(|name| split_initial(name).is_some())?;
    let hint = match equation.left().find_name(name) {
        Some(_) => format!("write {name} = ... with all other factors and terms on the right"),
        None => format!("write an equation {name} = ... with parameters, and these parameters here"),
    };
    Some(FormulaError {
        range: equation.range_of(name)?,
        message: format!("{name} must stand alone on the left of an equation"),
        hint: Some(hint),
    })
}
