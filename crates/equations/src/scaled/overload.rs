//! The faults of scales with which an amplifier overloads.

use patchcord_core::document::{Diagnostic, unit_suffix};
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::{Problem, ProblemQuantity};
use patchcord_expr::format_significant;

use super::attempt::{Attempt, Basis};
use super::built_patch::BuiltPatch;
use super::maxima::LARGER_MAXIMUM;
use super::measured::OverloadedAmplifier;
use crate::findings::codes;
use crate::graph::{Plan, PlannedQuantity};
use crate::peaks::Ranges;
use crate::synthesis::{exceeds_reference, suitable_scale};

/// The peak behind an overload is taken to be this multiple of 100 V if it is not known.
const UNKNOWN_PEAK: f64 = 2.0;
/// Significant digits of the numbers in messages.
const DIGITS: usize = 3;

/// A fault for each scale that the problem prescribes and that is too small for the solution without scales.
pub(super) fn prescribed_faults(plan: &Plan, problem: &Problem, ranges: &Ranges) -> Vec<Diagnostic> {
    let fault = |planned: &PlannedQuantity| {
        let quantity = problem.quantities.get(&planned.name)?;
        let per_volt = quantity.per_volt.as_ref()?.value;
        let [low, high] = ranges.nodes[planned.node.0 as usize];
        let peak = quantity.unit.out_of_si(low.abs().max(high.abs()));
        let is_too_small = exceeds_reference(peak, per_volt);
        is_too_small.then(|| prescribed_fault(&planned.name, quantity, Some(peak / per_volt))).flatten()
    };
    plan.quantities.iter().filter_map(fault).collect()
}

/// The fault of a prescribed scale with which a quantity has this peak in volts. `None` if the scale is not prescribed.
fn prescribed_fault(name: &str, quantity: &ProblemQuantity, volts: Option<f64>) -> Option<Diagnostic> {
    let per_volt = quantity.per_volt.as_ref()?;
    let in_unit = |value: f64| in_unit(value, quantity.unit.text());
    let reached = match volts {
        Some(volts) => format!("reaches {} V", format_significant(volts, DIGITS)),
        None => format!("exceeds {REFERENCE} V"),
    };
    let scale = in_unit(per_volt.value);
    let message = format!("the scale of {name} is prescribed as {scale} per volt, but {name} {reached}");
    let peak = volts.unwrap_or(UNKNOWN_PEAK * REFERENCE) * per_volt.value;
    let hint = format!("let 1 V represent at least {}", in_unit(suitable_scale(peak)));
    Some(Diagnostic::at(codes::NO_CIRCUIT, per_volt.span, message).hint(hint))
}

/// A value with its unit.
fn in_unit(value: f64, unit: &str) -> String {
    format!("{}{}", format_significant(value, DIGITS), unit_suffix(unit))
}

/// A fault for each amplifier that overloads in a run of a patch with these scales.
pub(super) fn faults(attempt: &Attempt, built: &BuiltPatch<'_>) -> Vec<Diagnostic> {
    let basis = &built.basis;
    let fault = |overload: &OverloadedAmplifier| {
        let fault = match attempt.quantity_of(&overload.element, basis.plan) {
            Some((name, per_volt)) => quantity_fault(overload, basis, &name, per_volt),
            None => part_fault(overload, attempt),
        };
        Diagnostic { span: fault.span.or_else(|| built.span_of(&overload.element)), ..fault }
    };
    attempt.measured.overloads.iter().map(fault).collect()
}

/// How far an amplifier is driven.
fn reached(overload: &OverloadedAmplifier) -> String {
    match overload.demand {
        Some(volts) => format!("would need {} V", format_significant(volts, DIGITS)),
        None => format!("would need more than {REFERENCE} V"),
    }
}

/// The fault of an amplifier with the value of a quantity or an expression, whose value of one volt in SI units is given.
fn quantity_fault(
    overload: &OverloadedAmplifier,
    basis: &Basis<'_>,
    name: &str,
    per_volt: f64,
) -> Diagnostic {
    let message = format!("{} overloads: {name} {}", overload.element, reached(overload));
    let Some(quantity) = basis.problem.quantities.get(name) else {
        let hint = format!(
            "write the equation in another form, or state a larger \"maximum\" for a quantity in {name}"
        );
        return Diagnostic::without_span(codes::NO_CIRCUIT, message).hint(hint);
    };
    if let Some(fault) = prescribed_fault(name, quantity, overload.demand) {
        return fault;
    }
    let unit = quantity.unit.text();
    let scale = quantity.unit.out_of_si(per_volt);
    let peak = overload.demand.unwrap_or(UNKNOWN_PEAK * REFERENCE) * scale;
    let message = format!("{message} with 1 V for {}", in_unit(scale, unit));
    if let Some(maximum) = quantity.maximum.as_ref().filter(|_| basis.options.keeps_maxima) {
        return Diagnostic::at(codes::NO_CIRCUIT, maximum.span, message).hint(LARGER_MAXIMUM);
    }
    let hint = format!("give {name} a \"per_volt\" of {}", in_unit(suitable_scale(peak), unit));
    Diagnostic::at(codes::NO_CIRCUIT, quantity.span, message).hint(hint)
}

/// The fault of an amplifier that is a part of the circuit of a quantity.
fn part_fault(overload: &OverloadedAmplifier, attempt: &Attempt) -> Diagnostic {
    let entry = attempt.synthesis.patch.elements.get(&overload.element);
    let note = entry.map(|entry| entry.note.as_str()).filter(|note| !note.is_empty());
    let note = note.map_or(String::new(), |note| format!(" ({note})"));
    let message = format!("{}{note} overloads: it {}", overload.element, reached(overload));
    let hint =
        "state a larger \"maximum\" for the quantity in its note, or write the equation in another form";
    Diagnostic::without_span(codes::NO_CIRCUIT, message).hint(hint)
}
