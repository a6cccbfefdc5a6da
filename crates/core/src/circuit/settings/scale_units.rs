//! Finds the scale whose unit is wrong by a factor of 1000, if settings of pots are outside 0 ... 1.
//!
//! A scale in m in place of mm makes settings wrong whose formulas are right. Some are too large, and others are too small.

use super::ranges::formulas;
use crate::circuit::Quantities;
use crate::document::{Code, Diagnostic, format_number, unit_suffix};
use crate::elements::{Setting, SettingQuantity};
use crate::patch::Patch;
use patchcord_expr::Formula;

/// Factors by which a wrong prefix of a unit changes a scale.
const FACTORS: [f64; 2] = [1e-3, 1e3];
/// The smallest setting that a correction gives. So a setting that lacks a factor of 10 only is not explained by a scale.
const MIN_SETTING: f64 = 0.05;

/// Replaces the hints about settings that are outside 0 ... 1, if one other scale would correct all of them.
pub(super) fn explain(patch: &Patch, quantities: &Quantities, findings: &mut [Diagnostic]) {
    let is_outside = |finding: &Diagnostic| finding.code == Code::SETTING_OUTSIDE;
    if !findings.iter().any(is_outside) {
        return;
    }
    let corrections = corrections(patch, quantities);
    if corrections.is_empty() {
        return;
    }
    let corrections = corrections.join(", or if ");
    let hint = format!("is the unit of a scale wrong? All settings are within 0 ... 1 if {corrections}");
    for finding in findings.iter_mut().filter(|finding| is_outside(finding)) {
        finding.hint = Some(hint.clone());
    }
}

/// The changes of one scale after which all settings of pots are within 0 ... 1, each as a clause.
fn corrections(patch: &Patch, quantities: &Quantities) -> Vec<String> {
    let settings = patch.elements.values().flat_map(formulas);
    let settings: Vec<(&Setting, &Formula)> =
        settings.filter(|(row, _)| row.quantity == SettingQuantity::Fraction).collect();
    let mut found = Vec::new();
    for (index, (name, scale)) in patch.scales.iter().enumerate() {
        let Some(per_volt) = quantities.per_volt(index) else { continue };
        let unit = unit_suffix(scale.unit.text());
        let number = |per_volt: f64| format_number(scale.unit.out_of_si(per_volt));
        for changed in FACTORS.map(|factor| factor * per_volt) {
            if corrects(quantities, &settings, (index, changed)) {
                let (changed, present) = (number(changed), number(per_volt));
                found.push(format!("1 V of the scale {name} is {changed}{unit} in place of {present}{unit}"));
            }
        }
    }
    found
}

/// Whether all settings are within their ranges if a scale has another value per volt. Those that are too large now must
/// not become very small.
fn corrects(
    quantities: &Quantities,
    settings: &[(&Setting, &Formula)],
    (scale, per_volt): (usize, f64),
) -> bool {
    let changed = quantities.with_scale(scale, per_volt);
    settings.iter().all(|(row, formula)| match (formula.evaluate(quantities), formula.evaluate(&changed)) {
        (Ok(before), Ok(after)) => row.is_allowed(after) && (row.is_allowed(before) || after >= MIN_SETTING),
        // A formula without a value has a finding of its own.
        _ => true,
    })
}
