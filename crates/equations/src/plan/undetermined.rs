//! The faults of equations and unknowns that have no partner.

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Diagnostic, Placed, formula_diagnostic};
use patchcord_core::patch::Problem;
use patchcord_expr::{Equation, FormulaError, split_primes};

use super::matching::Matching;
use super::trees::only_name;
use super::unknowns::{Unknown, Unknowns, laws};

/// Reports equations that determine nothing, and unknowns that no equation determines.
pub(super) fn faults(
    problem: &Problem,
    circuit: &Circuit,
    unknowns: &Unknowns,
    matching: &Matching,
) -> Vec<Diagnostic> {
    let surplus = laws(circuit).filter(|(index, _)| matching.of_equation[*index].is_none());
    let surplus: Vec<&Placed<Equation>> = surplus.map(|(_, placed)| placed).collect();
    let missing = unknowns.all.iter().zip(&matching.of_unknown).filter(|(_, equation)| equation.is_none());
    let missing: Vec<Diagnostic> =
        missing.map(|(unknown, _)| undetermined(problem, circuit, unknown)).collect();
    let derivatives = surplus.iter().filter_map(|placed| defined_derivative(circuit, unknowns, placed));
    let derivatives: Vec<Diagnostic> = derivatives.collect();
    // The lack of an equation follows from these.
    if !missing.is_empty() && !derivatives.is_empty() {
        return derivatives;
    }
    surplus.iter().map(|placed| superfluous(unknowns, placed)).chain(missing).collect()
}

/// The fault of an equation such as `F = k x` if F' occurs in another one: F is then both a state and algebraic. `None`
/// for other equations.
fn defined_derivative(
    circuit: &Circuit,
    unknowns: &Unknowns,
    placed: &Placed<Equation>,
) -> Option<Diagnostic> {
    let equation = &placed.value;
    let name = only_name(equation.left())?;
    let unknown = unknowns.of(name).filter(|unknown| unknown.order > split_primes(name).1)?;
    let derivative = unknown.name();
    let (other, range) =
        laws(circuit).find_map(|(_, other)| Some((other, other.value.range_of(&derivative)?)))?;
    let right = equation.text().get(equation.right().range.clone()).unwrap_or_default();
    let message = format!("{derivative} is the derivative of a quantity that another equation defines");
    let hint = Some(format!("in place of {derivative}, write the derivative of {name} = {right}"));
    Some(formula_diagnostic(Code::BAD_FORMULA, other, FormulaError { range, message, hint }))
}

/// The fault of an equation that determines nothing.
fn superfluous(unknowns: &Unknowns, placed: &Placed<Equation>) -> Diagnostic {
    let names = placed.value.names();
    let determined: Vec<&str> = names.into_iter().filter(|name| unknowns.index(name).is_some()).collect();
    let (message, hint) = if determined.is_empty() {
        let message = "this equation contains neither a highest derivative nor an algebraic quantity";
        (message.to_owned(), "remove it, or add the quantity that it determines")
    } else {
        let message = format!("other equations determine {} already", determined.join(", "));
        (message, "remove one of these equations")
    };
    Diagnostic::at(Code::BAD_FORMULA, placed.span, message).hint(hint)
}

/// The fault of an unknown that no equation determines: at its declaration, or at its first appearance.
fn undetermined(problem: &Problem, circuit: &Circuit, unknown: &Unknown) -> Diagnostic {
    let name = unknown.name();
    let message = format!("no equation determines {name}");
    let hint = match unknown.order {
        0 => format!("add an equation such as {name} = ..., or remove {name}"),
        _ => format!("add an equation that contains {name}"),
    };
    if let Some(quantity) = problem.quantities.get(&name) {
        return Diagnostic::at(Code::UNKNOWN_NAME, quantity.span, message).hint(hint);
    }
    let first = laws(circuit).find_map(|(_, placed)| Some((placed, placed.value.range_of(&name)?)));
    match first {
        Some((placed, range)) => {
            let error = FormulaError { range, message, hint: Some(hint) };
            formula_diagnostic(Code::UNKNOWN_NAME, placed, error)
        }
        None => Diagnostic::without_span(Code::UNKNOWN_NAME, message).hint(hint),
    }
}
