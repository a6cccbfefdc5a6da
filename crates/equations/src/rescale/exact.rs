//! Open amplifiers in a rescaled patch.
//!
//! Their amplification is finite, so their outputs have small errors. These depend on the scales. To compare a rescaled
//! patch with the old one exactly, the amplification is changed so that the errors are the same.

use std::collections::BTreeMap;

use patchcord_core::elements::{OutputStage, SettingDefault};
use patchcord_core::patch::Edit;
use serde_json::json;

use super::decision::Decided;

/// The edits of open amplifiers that make all voltages exact multiples of the old ones.
pub(super) fn exact_amplifications(decided: &Decided<'_>) -> Vec<Edit> {
    let wiring = decided.wiring;
    let is_open = |element: &usize| wiring.kind(*element).output == OutputStage::OpenAmplifier;
    let open = (0..wiring.len()).filter(is_open).filter_map(|element| exact_amplification(decided, element));
    // The instances of a macro share their amplifiers.
    let edits: BTreeMap<Vec<String>, Edit> = open.map(|edit| (edit.path().to_vec(), edit)).collect();
    edits.into_values().collect()
}

/// The edit of one open amplifier. `None` if it keeps its amplification.
fn exact_amplification(decided: &Decided<'_>, element: usize) -> Option<Edit> {
    const NAME: &str = "amplification";
    let Decided { wiring, old, decision } = *decided;
    let mut cords = wiring.cords[element].iter().enumerate();
    let (cord, (from, own)) = cords.find(|(_, (from, _))| !wiring.is_ground(*from))?;
    // The sum of the inputs is multiplied by this factor.
    let sum = decided.factor(*from, 0)? * decision.gains[element][cord] / own.gain;
    let kind = wiring.kind(element);
    let amplification = match (wiring.formula(element, NAME), kind.settings[kind.setting(NAME)?].default) {
        (Some(formula), _) => old.value(formula, 0)?,
        (None, SettingDefault::Number(number)) => number,
        (None, _) => return None,
    };
    let factor = decision.factors[element] / sum;
    (factor != 1.0).then(|| Some(Edit::at(wiring.path(element, NAME)?, json!(amplification * factor))))?
}
