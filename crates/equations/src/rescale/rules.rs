//! The gain rule (eq. 4-8) in numbers: how the product of gain and pot in a cord follows from the scales.

use patchcord_expr::format_significant;

use super::decision::Decided;

/// Significant digits of a number.
const DIGITS: usize = 4;

/// The gain rule for a pot in front of a gain. `None` for other elements.
pub(super) fn pot_rule(decided: &Decided<'_>, pot: usize) -> Option<String> {
    let (reader, cord) = decided.wiring.gain_behind(pot)?;
    Some(cord_rule(decided, reader, cord))
}

/// The gain rule for a cord with a gain, with the pot in front of it if it has one:
/// `gain * pot = 4 * 2 / 5 = 1.6`, with the old product, the factor of the output and that of the input. A changed time
/// scale is a further divisor.
pub(super) fn cord_rule(decided: &Decided<'_>, element: usize, cord: usize) -> String {
    let Decided { wiring, old, decision } = *decided;
    let (from, own) = wiring.cords[element][cord];
    let has_pot = wiring.gain_behind(from) == Some((element, cord));
    let setting = if has_pot {
        wiring.formula(from, "setting").and_then(|formula| old.value(formula, 0))
    } else {
        None
    };
    let input = if has_pot { wiring.source(from, "in").unwrap_or(from) } else { from };
    let number = |value: f64| format_significant(value, DIGITS);
    let before = setting.unwrap_or(1.0) * own.gain;
    let pot = if has_pot {
        decided.factor(from, 0).unwrap_or(1.0) / decided.factor(input, 0).unwrap_or(1.0)
    } else {
        1.0
    };
    let added = decision.added.get(&(element, cord)).copied().unwrap_or(1.0);
    let after = setting.unwrap_or(1.0) * pot * added * decision.gains[element][cord];
    let time = if wiring.integrates(element) { decision.time } else { 1.0 };
    let input_factor = decided.factor(input, 0).unwrap_or(1.0);
    let output_factor = if before == 0.0 { 1.0 } else { after / before * input_factor * time };
    let mut text = format!("gain * pot = {}", number(before));
    for (sign, factor) in [(" * ", output_factor), (" / ", input_factor), (" / ", time)] {
        if number(factor) != "1" {
            text += &format!("{sign}{}", number(factor));
        }
    }
    format!("{text} = {}", number(after))
}
