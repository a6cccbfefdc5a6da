//! Reports names of a problem that cannot be used, and names that two of its parts have.
//!
//! Equations use all names of a problem, so parameters, quantities, drives and tables share one set of names.

use std::collections::HashMap;

use super::Problem;
use crate::document::fields::Findings;
use crate::document::{Code, Diagnostic, Span};
use crate::patch::{check_output_name, check_quantity_name, duplicate_name};
use patchcord_expr::{EquationFunction, split_initial, split_primes};

/// Name of the time in equations.
pub(super) const TIME: &str = "t";

/// The maximum number of primes after a name, as in equations.
const MAX_PRIMES: usize = 9;

/// The part of a problem that has a name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// A parameter.
    Parameter,
    /// A quantity, or a derivative of one.
    Quantity,
    /// A drive.
    Drive,
    /// A table.
    Table,
}

impl Part {
    /// What messages call the part.
    fn noun(self) -> &'static str {
        match self {
            Part::Parameter => "parameter",
            Part::Quantity => "quantity",
            Part::Drive => "drive",
            Part::Table => "table",
        }
    }
}

/// Reports names that cannot be used, and names of two parts. Parts with such a name count as unread, so that their uses
/// are not reported as well.
pub(super) fn check(problem: &mut Problem, findings: &mut Findings) {
    for name in report_faulty(problem, findings) {
        remove(problem, &name);
    }
}

/// Removes all parts with a name from a problem. The name then counts as unread.
pub(super) fn remove(problem: &mut Problem, name: &str) {
    let Problem { patch, quantities, tables } = problem;
    patch.parameters.shift_remove(name);
    patch.drives.shift_remove(name);
    quantities.shift_remove(name);
    tables.shift_remove(name);
    patch.unread.names.insert(name.to_owned());
}

/// Reports the names that cannot be used, and returns them.
fn report_faulty(problem: &Problem, findings: &mut Findings) -> Vec<String> {
    let mut first_parts: HashMap<&str, Part> = HashMap::new();
    let mut faulty = Vec::new();
    for (name, span, part) in names(problem) {
        let first = *first_parts.entry(name).or_insert(part);
        let fault = match first == part {
            true => fault(name, span, part),
            false => Some(duplicate_name(name, span, part.noun(), first.noun())),
        };
        if let Some(fault) = fault {
            findings.push(fault);
            faulty.push(name.to_owned());
        }
    }
    faulty
}

/// The names of all parts, each with its position. A name is unique among parts of one kind.
fn names(problem: &Problem) -> Vec<(&str, Span, Part)> {
    let Problem { patch, quantities, tables } = problem;
    let parameters = patch.parameters.iter();
    let parameters = parameters.map(|(name, parameter)| (name.as_str(), parameter.span, Part::Parameter));
    let quantities = quantities.iter().map(|(name, quantity)| (name.as_str(), quantity.span, Part::Quantity));
    let drives = patch.drives.iter().map(|(name, drive)| (name.as_str(), drive.span, Part::Drive));
    let tables = tables.iter().map(|(name, table)| (name.as_str(), table.span, Part::Table));
    parameters.chain(quantities).chain(drives).chain(tables).collect()
}

/// The fault of a name. `None` if the part can have it.
fn fault(name: &str, span: Span, part: Part) -> Option<Diagnostic> {
    let (base, order) = if part == Part::Quantity { split_primes(name) } else { (name, 0) };
    if base == TIME {
        let message = format!("\"{TIME}\" cannot name a {}", part.noun());
        return Some(Diagnostic::at(Code::BAD_NAME, span, message).hint("t is the time in equations"));
    }
    let noun = part.noun();
    match part {
        // The circuit reports all other faults of a parameter's name.
        Part::Parameter => function_fault(name, span, noun),
        Part::Table => check_quantity_name(name, span, noun).or_else(|| function_fault(name, span, noun)),
        Part::Quantity if split_initial(name).is_some() => Some(initial_value(span)),
        Part::Quantity if order > MAX_PRIMES => Some(too_many_primes(span)),
        Part::Quantity | Part::Drive => {
            let fault = check_quantity_name(base, span, noun);
            let fault = fault.or_else(|| check_output_name(base, span, noun));
            fault.or_else(|| function_fault(base, span, noun))
        }
    }
}

/// The fault of a part with the name of a function that only equations have. `None` if the name is another one. `noun` is
/// what messages call the part.
fn function_fault(name: &str, span: Span, noun: &str) -> Option<Diagnostic> {
    let function = EquationFunction::from_name(name)?.name();
    let message = format!("\"{function}\" cannot name a {noun}");
    Some(Diagnostic::at(Code::BAD_NAME, span, message).hint("it is the name of a function"))
}

/// The fault of an initial value such as x(0) among the quantities.
fn initial_value(span: Span) -> Diagnostic {
    let message = "an initial value is not a quantity of its own";
    let hint = "write \"initial\" in the quantity: \"x\": {\"unit\": \"mm\", \"initial\": 50}";
    Diagnostic::at(Code::BAD_NAME, span, message).hint(hint)
}

/// The fault of a name with more primes than equations can have.
fn too_many_primes(span: Span) -> Diagnostic {
    let message = format!("a name has at most {MAX_PRIMES} primes");
    Diagnostic::at(Code::BAD_NAME, span, message).hint("declare a lower derivative as a quantity of its own")
}
