//! Open amplifiers in a rescaled patch.
//!
//! Their amplification is finite, so their outputs have small errors. These depend on the scales. To compare a rescaled
//! patch with the old one exactly, the amplification is changed so that the errors are the same. If it were above the
//! largest one that an amplifier can have, the amplifications of both patches are divided by the same number.

use std::collections::BTreeMap;

use patchcord_core::elements::{OutputStage, SettingDefault};
use patchcord_core::patch::Edit;
use serde_json::json;

use super::decision::Decided;

/// The name of the setting.
const NAME: &str = "amplification";

/// The edits of open amplifiers for an exact comparison.
pub(super) struct ExactAmplifications {
    /// Those of the old patch. Empty if it stays.
    pub old: Vec<Edit>,
    /// Those of the rescaled patch. Empty if it stays.
    pub new: Vec<Edit>,
}

/// The amplification of an open amplifier.
struct Amplification {
    /// The place of the setting in the document.
    path: Vec<String>,
    /// The value in the old patch.
    old: f64,
    /// The value with which the voltages are exact multiples of the old ones.
    new: f64,
    /// The largest value that is possible.
    largest: f64,
}

/// The edits of open amplifiers that make all voltages exact multiples of the old ones.
pub(super) fn exact_amplifications(decided: &Decided<'_>) -> ExactAmplifications {
    let wiring = decided.wiring;
    let is_open = |element: &usize| wiring.kind(*element).output == OutputStage::OpenAmplifier;
    let open = (0..wiring.len()).filter(is_open).filter_map(|element| amplification(decided, element));
    // The instances of a macro share their amplifiers.
    let open: BTreeMap<Vec<String>, Amplification> = open.map(|open| (open.path.clone(), open)).collect();
    if open.values().all(|open| open.new == open.old) {
        return ExactAmplifications { old: Vec::new(), new: Vec::new() };
    }
    let divisor = open.values().map(|open| open.new / open.largest).fold(1.0, f64::max);
    let edits = |value: fn(&Amplification) -> f64| -> Vec<Edit> {
        // The quotient can exceed the largest value by rounding.
        let divided = |open: &Amplification| (value(open) / divisor).min(open.largest);
        open.values().map(|open| Edit::at(open.path.clone(), json!(divided(open)))).collect()
    };
    let old = if divisor > 1.0 { edits(|open| open.old) } else { Vec::new() };
    ExactAmplifications { old, new: edits(|open| open.new) }
}

/// The amplification of one open amplifier. `None` if it is not known.
fn amplification(decided: &Decided<'_>, element: usize) -> Option<Amplification> {
    let Decided { wiring, old, decision } = *decided;
    let mut cords = wiring.cords[element].iter().enumerate();
    let (cord, (from, own)) = cords.find(|(_, (from, _))| !wiring.is_ground(*from))?;
    // The sum of the inputs is multiplied by this factor.
    let sum = decided.factor(*from, 0)? * decision.gains[element][cord] / own.gain;
    let kind = wiring.kind(element);
    let row = &kind.settings[kind.setting(NAME)?];
    let present = match (wiring.formula(element, NAME), row.default) {
        (Some(formula), _) => old.value(formula, 0)?,
        (None, SettingDefault::Number(number)) => number,
        (None, _) => return None,
    };
    let new = present * (decision.factors[element] / sum);
    Some(Amplification { path: wiring.path(element, NAME)?, old: present, new, largest: row.range.1 })
}
