//! Stated maxima that the solution exceeds.

use patchcord_core::document::{Diagnostic, format_number, unit_suffix};
use patchcord_core::machines::REFERENCE;
use patchcord_core::patch::{Problem, ProblemQuantity};

use crate::findings::codes;
use crate::graph::{NodeId, Plan};
use crate::peaks::Ranges;
use crate::synthesis::{ScaleOptions, exceeds_reference};

/// What to do about a kept maximum that is too small.
pub(super) const LARGER_MAXIMUM: &str = "state a larger \"maximum\", or let the scales follow from the peaks";

/// A warning for each quantity that exceeds its stated maximum. Its scale follows from its peak.
///
/// # Errors
/// A fault for each of these quantities, if the maxima are to be kept.
pub(super) fn checked_maxima(
    plan: &Plan,
    problem: &Problem,
    ranges: &Ranges,
    options: &ScaleOptions,
) -> Result<Vec<Diagnostic>, Vec<Diagnostic>> {
    let finding = |(name, quantity): (&String, &ProblemQuantity)| {
        let planned = plan.quantities.iter().find(|planned| planned.name == *name)?;
        if has_prescribed_scale(plan, problem, planned.node) {
            return None;
        }
        let [low, high] = ranges.nodes[planned.node.0 as usize];
        exceeded(name, quantity, low.abs().max(high.abs()), options.keeps_maxima)
    };
    let findings: Vec<Diagnostic> = problem.quantities.iter().filter_map(finding).collect();
    if options.keeps_maxima && !findings.is_empty() { Err(findings) } else { Ok(findings) }
}

/// Whether the problem prescribes the scale of a node, by any of its names.
fn has_prescribed_scale(plan: &Plan, problem: &Problem, node: NodeId) -> bool {
    let mut names =
        plan.quantities.iter().filter(|planned| planned.node == node).map(|planned| &planned.name);
    names.any(|name| problem.quantities.get(name).is_some_and(|quantity| quantity.per_volt.is_some()))
}

/// The diagnostic of a quantity with this peak in SI units. `None` if it does not exceed its maximum.
fn exceeded(name: &str, quantity: &ProblemQuantity, peak: f64, is_kept: bool) -> Option<Diagnostic> {
    let maximum = quantity.maximum.as_ref()?;
    let peak = quantity.unit.out_of_si(peak);
    if !exceeds_reference(peak, maximum.value / REFERENCE) {
        return None;
    }
    let unit = unit_suffix(quantity.unit.text());
    let [peak, stated] = [peak, maximum.value].map(format_number);
    let message = format!("{name} reaches {peak}{unit}, and its maximum is {stated}{unit}");
    Some(if is_kept {
        Diagnostic::at(codes::NO_CIRCUIT, maximum.span, message).hint(LARGER_MAXIMUM)
    } else {
        let hint = "the scale follows from the peak: state a larger \"maximum\"";
        Diagnostic::at(codes::EXCEEDED_MAXIMUM, maximum.span, message).hint(hint)
    })
}
