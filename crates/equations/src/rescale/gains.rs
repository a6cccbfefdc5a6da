//! The gains behind pots, and the gains of cords without pots.

use patchcord_expr::{format_significant, round_significant};

use super::decision::Decided;
use super::values::Values;
use super::wiring::Wiring;

/// The smallest setting of a pot that can be set accurately.
pub(super) const LEAST_SETTING: f64 = 0.1;
/// Rounding of a product of a setting and a gain.
const ROUNDING: f64 = 1e-11;
/// Two gains are equal if they differ by at most this share.
const EQUAL: f64 = 1e-9;
/// Digits of a gain on a machine with all gains.
const DIGITS: usize = 15;
/// Digits of a gain that is easy to read.
const FEW_DIGITS: usize = 3;
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

/// Whether a gain has few digits.
pub(super) fn has_few_digits(gain: f64) -> bool {
    gain == round_significant(gain, FEW_DIGITS)
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

/// The settings of a pot. The same pot in the instances of a macro has the same gain behind it, so it counts with all of
/// its settings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings {
    /// The smallest present setting above 0. 0 if all are 0.
    pub least: f64,
    /// The largest present setting.
    pub now: f64,
    /// The largest setting for any values of the parameters within their ranges.
    pub most: f64,
}

impl Settings {
    /// The settings of a pot.
    pub(super) fn of(wiring: &Wiring<'_>, old: &Values<'_>, pot: usize) -> Self {
        let mut settings = Settings { least: f64::INFINITY, now: 0.0, most: 0.0 };
        for formula in wiring.twins(pot).filter_map(|twin| wiring.formula(twin, "setting")) {
            let now = old.value(formula, 0).unwrap_or(0.0);
            if now > 0.0 {
                settings.least = settings.least.min(now);
            }
            settings.now = settings.now.max(now);
            settings.most = settings.most.max(old.largest(formula).unwrap_or(now));
        }
        settings.least = settings.least.min(settings.now);
        settings
    }

    /// Whether the pot can be set for all values of the parameters.
    pub(super) fn are_possible(self) -> bool {
        self.most <= 1.0 + ROUNDING
    }

    /// Whether the smallest setting times a factor can be set as accurately as now, or is at least 0.1.
    pub(super) fn are_accurate(self, factor: f64) -> bool {
        self.least * factor >= LEAST_SETTING.min(self.least) * (1.0 - ROUNDING)
    }
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
    let settings = Settings::of(wiring, old, pot);
    let gains = gains_behind_pots(wiring, reader, present);
    // The pot becomes setting x factor / gain.
    let factor = present * target / input / time;
    let Some(gain) = chosen_gain(&gains, present, settings, factor) else {
        return Err(missing_gain(wiring, reader, settings.now * factor));
    };
    Ok((gain, target * present / gain / time))
}

/// The gain with which a pot is from 0.1 to 1: the present one if it is possible, otherwise the smallest one that is
/// large enough for all values of the parameters. If the pot would be below 0.1 then, it is still that one, unless the
/// pot could not be set for all values before. `None` if no gain is large enough for the present values.
fn chosen_gain(gains: &[f64], present: f64, settings: Settings, factor: f64) -> Option<f64> {
    let fits = |gain: f64, setting: f64| setting * factor <= gain * (1.0 + ROUNDING);
    let smallest = |setting: f64| gains.iter().copied().find(|gain| fits(*gain, setting));
    if settings.now == 0.0 {
        let is_large = |gain: &f64| *gain >= present && fits(*gain, settings.most);
        return Some(gains.iter().copied().find(is_large).unwrap_or(present));
    }
    let is_good = |gain: &f64| settings.are_accurate(factor / gain) && fits(*gain, settings.most);
    let good = [present].into_iter().chain(gains.iter().copied()).find(is_good);
    let possible = || settings.are_possible().then(|| smallest(settings.most)).flatten();
    good.or_else(possible).or_else(|| smallest(settings.now))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gain for a pot with this present setting and this largest one, if the product of pot and gain is multiplied.
    fn chosen(present: f64, [now, most]: [f64; 2], factor: f64) -> Option<f64> {
        chosen_gain(&[1.0, 10.0, 100.0], present, Settings { least: now, now, most }, present * factor)
    }

    #[test]
    fn a_gain_changes_only_if_the_pot_needs_it() {
        // 0.4 x 10 becomes 0.8 x 10, 0.16 x 100, 0.4 x 1 and 0.2 x 10.
        assert_eq!(chosen(10.0, [0.4, 0.4], 2.0), Some(10.0));
        assert_eq!(chosen(10.0, [0.4, 0.4], 4.0), Some(100.0));
        assert_eq!(chosen(10.0, [0.4, 0.4], 0.1), Some(1.0));
        assert_eq!(chosen(10.0, [0.4, 0.4], 0.5), Some(10.0));
        assert_eq!(chosen(1.0, [0.0, 0.0], 3.0), Some(1.0));
        assert_eq!(chosen(100.0, [0.5, 0.5], 3.0), None);
        // A pot that is below 0.1 may stay so.
        assert_eq!(chosen(10.0, [0.01, 0.01], 1.5), Some(10.0));
    }

    #[test]
    fn a_gain_is_large_enough_for_all_values_of_the_parameters() {
        // The pot could become 1.6 and 1.35, so it becomes 0.08 and 0.09 with the next gain.
        assert_eq!(chosen(1.0, [0.4, 0.8], 2.0), Some(10.0));
        assert_eq!(chosen(1.0, [0.6, 0.9], 1.5), Some(10.0));
        // The machine has no larger gain.
        assert_eq!(chosen(100.0, [0.4, 0.8], 2.0), Some(100.0));
        // The pot could not be set for all values before.
        assert_eq!(chosen(1.0, [0.4, 1.2], 2.0), Some(1.0));
    }

    #[test]
    fn a_gain_is_large_enough_in_all_instances_of_a_macro() {
        let choose = |least: f64, factor: f64| {
            chosen_gain(&[1.0, 10.0, 100.0], 10.0, Settings { least, now: 0.5, most: 0.5 }, 10.0 * factor)
        };
        // 0.2 and 0.5 become 0.8 and 2 with the present gain, so 0.08 and 0.2 with the next one.
        assert_eq!(choose(0.2, 4.0), Some(100.0));
        assert_eq!(choose(0.2, 1.5), Some(10.0));
        // 0.05 and 0.5 would become 0.005 and 0.05 with the present gain, and 0.05 and 0.5 with the smallest one.
        assert_eq!(choose(0.05, 0.1), Some(1.0));
    }
}
