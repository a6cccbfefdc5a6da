//! The values of one volt of all scales after a decision.

use std::collections::BTreeMap;

use patchcord_expr::{Formula, format_significant, round_significant};
use serde_json::Value;

use super::decision::Decision;
use super::formulas::{Retuned, Retuning};
use super::values::{PointValues, Values, agree};
use super::wiring::Wiring;

/// Significant digits of the time scale.
const DIGITS: usize = 14;
/// Significant digits of a factor in a message.
const SHORT: usize = 4;

/// The new values of one volt.
pub(super) struct NewScales<'c> {
    /// The values of all formulas under the new scales.
    pub values: Values<'c>,
    /// The scales whose value of one volt changes, with what the document has before and after.
    pub changed: BTreeMap<&'c str, [Value; 2]>,
}

/// The new value of one volt of each scale.
///
/// A scale can be a formula of other scales, so all are changed again until they agree.
///
/// # Errors
/// The message if a scale cannot have the value that it needs.
pub(super) fn new_scales<'c>(
    wiring: &Wiring<'c>,
    old: &Values<'c>,
    decision: &Decision,
) -> Result<NewScales<'c>, String> {
    let circuit = wiring.circuit;
    let mut values = Values::of(circuit);
    values.time_scale = round_significant(circuit.time_scale() * decision.time, DIGITS);
    let mut changed: BTreeMap<&'c str, [Value; 2]> = BTreeMap::new();
    let scales = &circuit.patch().scales;
    for _ in 0..=scales.len() {
        let mut is_changed = false;
        for (index, name) in scales.keys().enumerate() {
            let factor = decision.scale_factors.get(&index).copied().unwrap_or(1.0);
            let wanted: PointValues = old.per_volt(name).map(|value| Some(value? / factor));
            if wanted[0].is_none() || agree(&values.per_volt(name), &wanted) {
                continue;
            }
            let written = &circuit.patch().value()["scales"][name.as_str()]["per_volt"];
            let Some(value) = new_scale(wiring, &values, index, written, wanted) else {
                let factor = format_significant(1.0 / factor, SHORT);
                return Err(format!(
                    "the \"per_volt\" of the scale {name} cannot be multiplied by {factor}: write it as a number"
                ));
            };
            let formula = match &value {
                Value::String(text) => Formula::parse(text).map_err(|error| error.to_string())?,
                number => Formula::constant(number.as_f64().unwrap_or(f64::NAN)),
            };
            values.scales.insert(name.clone(), formula);
            changed.insert(name, [written.clone(), value]);
            is_changed = true;
        }
        if !is_changed {
            return Ok(NewScales { values, changed });
        }
    }
    Err("the scales depend on each other, so they cannot change".to_owned())
}

/// What the document must have for a scale, so that one volt has the wanted values in SI units.
fn new_scale(
    wiring: &Wiring<'_>,
    values: &Values<'_>,
    scale: usize,
    written: &Value,
    wanted: PointValues,
) -> Option<Value> {
    let circuit = wiring.circuit;
    let (_, own) = circuit.derived(scale);
    let unit = circuit.derived_unit(scale);
    // A bare number is in the unit of the scale.
    let wanted = match circuit.is_literal(own) {
        true => wanted.map(|value| value.map(|value| unit.out_of_si(value))),
        false => wanted,
    };
    let factors = BTreeMap::new();
    let retuning =
        Retuning { circuit, new: values, scale_factors: &factors, time_divides: None, instance: None };
    match retuning.retuned(written, &wanted) {
        Retuned::Changed(value) => Some(value),
        Retuned::Same | Retuned::Impossible => None,
    }
}
