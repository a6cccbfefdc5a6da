//! Compares the parts of a problem with each other: derivatives with their quantities, settings of drives with
//! parameters, equations with tables and initial values.

use super::initial::dependence_fault;
use super::names::remove;
use super::{Problem, ProblemQuantity};
use crate::document::fields::Findings;
use crate::document::{Code, Diagnostic, Placed, Span, formula_diagnostic};
use crate::patch::{Amount, is_time_dimensionless};
use patchcord_expr::{Equation, Expression, FormulaError, Node, Unit, split_primes};

/// Largest relative difference between two conversions of a unit that count as the same.
const CONVERSION_TOLERANCE: f64 = 1e-9;

/// Reports drives whose settings depend on other names than parameters. These drives then count as unread.
///
/// The formulas of a patch can name scales, and quantities are scales of the problem's patch. So the circuit would accept
/// a quantity here, with the value of one unit.
pub(super) fn check_drives(problem: &mut Problem, findings: &mut Findings) {
    let mut faulty = Vec::new();
    for (name, drive) in &problem.patch.drives {
        let reported = findings.len();
        for placed in drive.settings.iter().flatten() {
            if let Amount::Formula(formula) = &placed.value {
                findings.extend(dependence_fault(problem, placed, formula, "a setting of a drive"));
            }
        }
        if findings.len() > reported {
            faulty.push(name.clone());
        }
    }
    for name in faulty {
        remove(problem, &name);
    }
}

/// Reports derivatives without their quantity, and derivatives whose unit is not that of the quantity per time.
///
/// The scales of the patch must be complete. If a unit could not be read, units are not compared: it decides whether
/// times are pure numbers.
pub(super) fn check_derivatives(problem: &Problem, findings: &mut Findings) {
    let unread = &problem.patch.unread;
    let has_all_units = unread.names.is_empty() && !unread.has_unread_section;
    let is_time_dimensionless = is_time_dimensionless(&problem.patch);
    for (name, derivative) in &problem.quantities {
        let (base, order) = split_primes(name);
        match problem.quantities.get(base) {
            _ if order == 0 => {}
            Some(quantity) if has_all_units => {
                let unit = rate_unit(&quantity.unit, if is_time_dimensionless { 0 } else { order });
                if !is_same_quantity(&unit, &derivative.unit) {
                    let names = (name.as_str(), base);
                    findings.push(wrong_unit(names, quantity, derivative, &unit, is_time_dimensionless));
                }
            }
            None if !unread.can_include(base) => findings.push(without_base(problem, name, base, derivative)),
            _ => {}
        }
    }
}

/// The unit of the derivative of this order of a quantity in a unit.
fn rate_unit(unit: &Unit, order: usize) -> Unit {
    (0..order).fold(unit.clone(), |unit, _| unit.per_second())
}

/// Whether values in one unit are converted to the other one by the sizes of both in SI units. False for a number of
/// cycles per second in place of an angle per second.
fn is_same_quantity(expected: &Unit, unit: &Unit) -> bool {
    let in_si = expected.factor() / unit.factor();
    expected
        .conversion_to(unit)
        .is_ok_and(|conversion| (conversion.apply(1.0) / in_si - 1.0).abs() < CONVERSION_TOLERANCE)
}

/// The diagnostic for a derivative in a wrong unit. `names` has its name and that of the quantity.
fn wrong_unit(
    (name, base): (&str, &str),
    quantity: &ProblemQuantity,
    derivative: &ProblemQuantity,
    expected: &Unit,
    is_time_dimensionless: bool,
) -> Diagnostic {
    let base_unit = match quantity.unit.text() {
        "" | "1" => "a pure number".to_owned(),
        text => format!("in {text}"),
    };
    let message = format!("\"{}\" cannot be the unit of {name}: {base} is {base_unit}", derivative.unit);
    let expected = if expected.text().is_empty() { "1" } else { expected.text() };
    let reason = match is_time_dimensionless {
        true => ": no unit of a quantity, drive or parameter contains a time, so the time is a pure number",
        false => "",
    };
    let hint = format!("write \"unit\": \"{expected}\"{reason}");
    Diagnostic::at(Code::UNIT_MISMATCH, derivative.unit_span, message).hint(hint)
}

/// The diagnostic for a derivative of something that is not a quantity.
fn without_base(problem: &Problem, name: &str, base: &str, derivative: &ProblemQuantity) -> Diagnostic {
    let other = if problem.patch.drives.contains_key(base) {
        Some("a drive")
    } else {
        problem.patch.parameters.contains_key(base).then_some("a parameter")
    };
    let (noun, hint) = match other {
        Some(noun) => (noun, "remove it: only quantities have derivatives here".to_owned()),
        None => ("not a quantity", format!("declare {base} as well: \"{base}\": {{\"unit\": ...}}")),
    };
    let message = format!("{name} is the derivative of {base}, which is {noun}");
    Diagnostic::at(Code::UNKNOWN_NAME, derivative.span, message).hint(hint)
}

/// Reports tables without an argument in equations, and initial values that are stated twice.
///
/// A table without an argument counts as unread, so that it is not reported as an unknown quantity as well.
pub(super) fn check_equations(problem: &mut Problem, findings: &mut Findings) {
    let Problem { patch, quantities, tables } = problem;
    for placed in &patch.equations {
        for name in placed.value.names() {
            let base = split_primes(name).0;
            if tables.contains_key(base) {
                findings.push(without_argument(placed, name, base));
                patch.unread.names.insert(base.to_owned());
            }
        }
        let initial = placed.value.initial_quantity();
        if let Some(quantity) = initial.filter(|name| has_initial_value(quantities.get(*name))) {
            let message = format!("{quantity} has two initial values: this equation and its key \"initial\"");
            findings.push(Diagnostic::at(Code::EXCLUDING_KEYS, placed.span, message));
        }
    }
}

/// Whether a quantity is declared with an initial value.
fn has_initial_value(quantity: Option<&ProblemQuantity>) -> bool {
    quantity.is_some_and(|quantity| quantity.initial.is_some())
}

/// The diagnostic for a table that an equation does not apply. `name` is its name as written, possibly with primes.
fn without_argument(placed: &Placed<Equation>, name: &str, table: &str) -> Diagnostic {
    let range = placed.value.range_of(name).unwrap_or_default();
    let message = format!("{table} is a table");
    let hint = Some(format!("write {table}( ... ) with its argument in the parentheses"));
    formula_diagnostic(Code::BAD_FORMULA, placed, FormulaError { range, message, hint })
}

/// Warns of drives and tables that no equation contains. If there are no equations, that fault is reported already.
pub(super) fn warn_of_unused(problem: &Problem, findings: &mut Findings) {
    let equations = &problem.patch.equations;
    if equations.is_empty() {
        return;
    }
    for (name, drive) in &problem.patch.drives {
        let is_used = |placed: &Placed<Equation>| {
            placed.value.names().into_iter().any(|used| split_primes(used).0 == name)
        };
        if !equations.iter().any(is_used) {
            findings.push(unused(&format!("drive {name}"), drive.span));
        }
    }
    for (name, table) in &problem.tables {
        if !equations.iter().any(|placed| applies_table(&placed.value, name)) {
            findings.push(unused(&format!("table {name}"), table.span));
        }
    }
}

/// The warning about a part that no equation contains.
fn unused(part: &str, span: Span) -> Diagnostic {
    Diagnostic::at(Code::UNUSED_ELEMENT, span, format!("no equation contains the {part}"))
        .hint("use it in an equation, or remove it")
}

/// Whether an equation applies a table.
pub(super) fn applies_table(equation: &Equation, table: &str) -> bool {
    [equation.left(), equation.right()].into_iter().any(|side| node_applies_table(side, table))
}

/// Whether a node, or a node below it, applies a table.
fn node_applies_table(node: &Node, table: &str) -> bool {
    let applies = |node: &Node| node_applies_table(node, table);
    match &node.expression {
        Expression::Number(_) | Expression::Name(_) => false,
        Expression::Negate(inner) => applies(inner),
        Expression::Binary(_, left, right) => applies(left) || applies(right),
        Expression::Call(_, arguments) => arguments.iter().any(applies),
        Expression::Apply(name, arguments) => name == table || arguments.iter().any(applies),
    }
}
