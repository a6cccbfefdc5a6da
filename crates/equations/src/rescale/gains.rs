//! The gains behind pots, and the gains of cords without pots.

use patchcord_expr::{format_significant, round_significant};

use super::decision::Decided;
use super::values::POINTS;
use super::wiring::Wiring;

/// The smallest setting of a pot that can be set accurately.
pub(super) const LEAST_SETTING: f64 = 0.1;
/// Rounding of a product of a setting and a gain.
const ROUNDING: f64 = 1e-11;
/// Two gains are equal if they differ by at most this share.
const EQUAL: f64 = 1e-9;
/// Digits of a gain on a machine with all gains.
const DIGITS: usize = 15;
/// Digits of a gain in a message.
const SHORT: usize = 4;
/// Decades of the gains behind pots on a machine with all gains.
const DECADES: std::ops::RangeInclusive<i32> = 0..=6;

/// The gain that the machine has for an element and that equals a wanted one.
///
/// # Errors
/// The message if the machine has no such gain.
pub(super) fn nearest_gain(wiring: &Wiring<'_>, element: usize, wanted: f64) -> Result<f64, String> {
    let gains = wiring.gains(element);
    if gains.is_empty() {
        return Ok(round_significant(wanted, DIGITS));
    }
    let found = gains.iter().copied().find(|gain| (gain / wanted - 1.0).abs() <= EQUAL);
    found.ok_or_else(|| missing_gain(wiring, element, wanted))
}

/// The message for a gain that the machine does not have.
fn missing_gain(wiring: &Wiring<'_>, element: usize, wanted: f64) -> String {
    format!(
        "{} would need an input with a gain of {}, which {} does not have: state another \"machine\", or change the \
         scales less",
        wiring.located(element),
        format_significant(wanted, SHORT),
        wiring.circuit.machine().name
    )
}

/// The gains that can be behind a pot, rising.
pub(super) fn gains_behind_pots(wiring: &Wiring<'_>, element: usize, present: f64) -> Vec<f64> {
    let mut gains = wiring.gains(element).to_vec();
    if gains.is_empty() {
        gains.extend(DECADES.map(|decade| 10f64.powi(decade)));
        gains.push(present);
    }
    gains.sort_by(f64::total_cmp);
    gains
}

/// The gain behind a pot, and the factor of the output of the pot. `target` is the factor of what the inputs of the
/// reader are proportional to.
///
/// # Errors
/// The message if the largest gain is too small.
pub(super) fn pot_gain(
    decided: &Decided<'_>,
    pot: usize,
    (reader, cord): (usize, usize),
    target: f64,
) -> Result<(f64, f64), String> {
    let Decided { wiring, old, decision } = *decided;
    let present = wiring.cords[reader][cord].1.gain;
    let time = if wiring.integrates(reader) { decision.time } else { 1.0 };
    let input = wiring.source(pot, "in").and_then(|from| decided.factor(from, 0)).unwrap_or(1.0);
    let setting = |point: usize| old.value(wiring.formula(pot, "setting")?, point);
    let now = setting(0).unwrap_or(0.0);
    let settings = (0..POINTS).filter_map(setting);
    let most = settings.filter(|setting| *setting <= 1.0).fold(now, f64::max);
    let gains = gains_behind_pots(wiring, reader, present);
    // The pot becomes product / gain.
    let product = |setting: f64| setting * present * target / input / time;
    let Some(gain) = chosen_gain(&gains, present, [now, most], &product) else {
        return Err(missing_gain(wiring, reader, product(now)));
    };
    Ok((gain, target * present / gain / time))
}

/// The gain with which a pot is from 0.1 to 1: the present one if it is possible, otherwise the smallest one that is
/// large enough for all values of the parameters, or for the present ones. `None` if no gain is large enough.
fn chosen_gain(
    gains: &[f64],
    present: f64,
    [now, most]: [f64; 2],
    product: &dyn Fn(f64) -> f64,
) -> Option<f64> {
    let fits = |gain: f64, setting: f64| product(setting) <= gain * (1.0 + ROUNDING);
    let is_accurate = |gain: f64| product(now) >= LEAST_SETTING.min(now) * gain * (1.0 - ROUNDING);
    if now == 0.0 {
        return Some(
            gains.iter().copied().find(|gain| *gain >= present && fits(*gain, most)).unwrap_or(present),
        );
    }
    let is_good = |gain: &f64| is_accurate(*gain) && fits(*gain, most);
    let wide = [present].into_iter().chain(gains.iter().copied()).find(is_good);
    wide.or_else(|| gains.iter().copied().find(|gain| fits(*gain, now)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_changes_only_if_the_pot_needs_it() {
        let gains = [1.0, 10.0, 100.0];
        let choose = |present: f64, now: f64, most: f64, factor: f64| {
            chosen_gain(&gains, present, [now, most], &|setting: f64| setting * present * factor)
        };
        // 0.4 x 10 becomes 0.8 x 10, 0.16 x 100, 0.4 x 1 and 0.2 x 10.
        assert_eq!(choose(10.0, 0.4, 0.4, 2.0), Some(10.0));
        assert_eq!(choose(10.0, 0.4, 0.4, 4.0), Some(100.0));
        assert_eq!(choose(10.0, 0.4, 0.4, 0.1), Some(1.0));
        assert_eq!(choose(10.0, 0.4, 0.4, 0.5), Some(10.0));
        // The parameters can double the setting.
        assert_eq!(choose(10.0, 0.4, 0.8, 2.0), Some(10.0));
        assert_eq!(choose(1.0, 0.4, 0.8, 2.0), Some(1.0));
        assert_eq!(choose(1.0, 0.6, 0.9, 1.5), Some(1.0));
        assert_eq!(choose(1.0, 0.0, 0.0, 3.0), Some(1.0));
        assert_eq!(choose(100.0, 0.5, 0.5, 3.0), None);
        // A pot that is below 0.1 may stay so.
        assert_eq!(choose(10.0, 0.01, 0.01, 1.5), Some(10.0));
    }
}
