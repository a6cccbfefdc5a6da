//! The tables of a rescaling: scales and peaks before and after, and reasons for peaks outside 50 to 95 V.

use std::collections::BTreeSet;

use patchcord_core::elements::{Family, OutputStage};
use patchcord_expr::round_significant;
use serde::Serialize;

use super::decision::Decided;
use super::measured::Measured;
use super::model::Model;
use super::relations::Affine;
use super::wiring::Wiring;
use crate::synthesis::is_good_peak;

/// Digits of a scale without the rounding of a conversion of units.
const DIGITS: usize = 12;

/// The value of one volt of a scale before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RescaledScale {
    /// The name of the scale.
    pub name: String,
    /// The text of its unit.
    pub unit: String,
    /// The value of one volt before, in the unit.
    pub before: f64,
    /// The value of one volt after, in the unit.
    pub after: f64,
}

/// The peak of an output before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RescaledOutput {
    /// The element or the drive.
    pub output: String,
    /// The largest magnitude of its voltage before. Behind an overload it is not exact.
    pub before: f64,
    /// Whether it overloaded before.
    pub overloaded: bool,
    /// The name of its scale, if a signal or a drive gives it one.
    pub scale: Option<String>,
    /// The factor by which its voltage is multiplied.
    pub factor: f64,
    /// The largest magnitude of its voltage after.
    pub after: f64,
    /// The reason why the peak is not from 50 to 95 V. `None` if it is, and if only the time scale changes.
    pub reason: Option<String>,
}

impl RescaledOutput {
    /// Whether the output uses the range of its amplifier: it peaks from 50 to 95 V.
    pub fn is_good(&self) -> bool {
        is_good_peak(self.after)
    }
}

/// The rows of all scales of signals and drives.
pub(super) fn scale_rows(wiring: &Wiring<'_>, new: &Measured) -> Vec<RescaledScale> {
    let used: BTreeSet<usize> = wiring.scales.values().flatten().copied().collect();
    let row = |scale: usize| {
        let (name, _) = wiring.circuit.derived(scale);
        Some(RescaledScale {
            name: name.to_owned(),
            unit: wiring.circuit.derived_unit(scale).text().to_owned(),
            before: round_significant(wiring.circuit.per_volt(scale)?, DIGITS),
            after: round_significant(new.circuit.per_volt(scale)?, DIGITS),
        })
    };
    used.into_iter().filter_map(row).collect()
}

/// The rows of all amplifiers and drives. `model` has the relations that limit the peaks; `None` if only the time scale
/// changes.
pub(super) fn output_rows(
    decided: &Decided<'_>,
    old: &Measured,
    new: &Measured,
    model: Option<&Model<'_>>,
) -> Vec<RescaledOutput> {
    let wiring = decided.wiring;
    let after: Vec<f64> = (0..wiring.len()).map(|element| new_peak(wiring, new, element)).collect();
    let is_amplifier = |element: &usize| {
        let kind = wiring.kind(*element);
        kind.family != Family::Reference && kind.output != OutputStage::Passive
    };
    let row = |element: usize| {
        let name = wiring.name(element);
        let scale = wiring.scales.get(&element).and_then(|scales| scales.first());
        RescaledOutput {
            output: name.to_owned(),
            before: old.peaks[element],
            overloaded: old.overloads.contains(name),
            scale: scale.map(|scale| wiring.circuit.derived(*scale).0.to_owned()),
            factor: decided.factor(element, 0).unwrap_or(1.0),
            after: after[element],
            reason: model.and_then(|model| reason(model, element, &after)),
        }
    };
    (0..wiring.len()).filter(is_amplifier).map(row).collect()
}

/// The peak of an element of the old patch in the run of the new one, in volts.
pub(super) fn new_peak(wiring: &Wiring<'_>, new: &Measured, element: usize) -> f64 {
    let name = wiring.name(element);
    let elements = new.circuit.elements();
    let position = elements.iter().position(|other| other.name == name);
    position.map_or(0.0, |position| new.peaks[position])
}

/// The reason why an output is not from 50 to 95 V. `None` if it is.
fn reason(model: &Model<'_>, element: usize, after: &[f64]) -> Option<String> {
    let wiring = model.evidence.wiring;
    if is_good_peak(after[element]) {
        return None;
    }
    if after[element] == 0.0 {
        return Some("it is 0 V in the whole run".to_owned());
    }
    if wiring.kind(element).name == "multiplier" {
        return Some("its factors are not large at the same time".to_owned());
    }
    let own = model.relations.reduced(&Affine::unknown(element));
    if own.terms.is_empty() {
        return Some("its inputs without pots and its settings fix its scale".to_owned());
    }
    let is_tied = |other: &usize| {
        let reduced = model.relations.reduced(&Affine::unknown(*other));
        *other != element
            && wiring.kind(*other).output != OutputStage::Passive
            && reduced.terms.keys().any(|unknown| own.terms.contains_key(unknown))
    };
    let largest =
        (0..wiring.len()).filter(is_tied).max_by(|one, other| after[*one].total_cmp(&after[*other]));
    let tied = largest.filter(|other| after[*other] > after[element]).map(|other| {
        format!("its scale is tied to that of {}, which peaks at {:.1} V", wiring.name(other), after[other])
    });
    Some(tied.unwrap_or_else(|| "a gain or a setting of the machine limits its scale".to_owned()))
}
