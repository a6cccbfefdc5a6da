//! Random variants of a patch, with other scales and other values of its parameters.

use patchcord_core::patch::{Edit, Parameter, Patch};
use patchcord_expr::round_significant;
use serde_json::json;

use crate::random::SplitMix64;

/// Factors of scales, and of parameters without a range.
const FACTORS: [f64; 5] = [0.5, 0.8, 1.0, 1.25, 2.0];
/// Significant digits of a changed scale.
const SCALE_DIGITS: usize = 12;
/// Significant digits of a random value of a parameter.
const VALUE_DIGITS: usize = 3;

/// A copy of a patch with other numbers. Each scale and each parameter changes with the probability `share`. `None` if
/// nothing changes.
pub(crate) fn varied(patch: &Patch, share: f64, random: &mut SplitMix64) -> Option<Patch> {
    let mut edits = Vec::new();
    for name in patch.scales.keys() {
        // A scale with a formula follows the parameters.
        let Some(present) = patch.value()["scales"][name]["per_volt"].as_f64() else { continue };
        let factor = if random.uniform(0.0, 1.0) < share { random.choose(&FACTORS) } else { 1.0 };
        if factor != 1.0 {
            let per_volt = round_significant(factor * present, SCALE_DIGITS);
            edits.push(Edit::at(["scales", name.as_str(), "per_volt"], json!(per_volt)));
        }
    }
    for (name, parameter) in &patch.parameters {
        if random.uniform(0.0, 1.0) < share {
            let value = random_value(parameter, random);
            edits.push(Edit::at(["parameters", name.as_str(), "value"], json!(value)));
        }
    }
    if edits.is_empty() { None } else { patch.with_edits(patch.file(), &edits).ok() }
}

/// A random value of a parameter within its range.
fn random_value(parameter: &Parameter, random: &mut SplitMix64) -> f64 {
    match parameter.range {
        Some((low, high)) => {
            let value = round_significant(random.uniform(low, high), VALUE_DIGITS);
            value.clamp(low, high)
        }
        None => round_significant(parameter.value * random.choose(&FACTORS), SCALE_DIGITS),
    }
}
