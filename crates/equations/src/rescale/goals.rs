//! What factors are good for: peaks from 50 to 95 V, settings within their ranges, pots that can be set accurately.
//! `digits` adds short numbers.

use patchcord_core::elements::{OutputStage, SettingDefault, SettingQuantity};
use patchcord_core::machines::REFERENCE;
use serde_json::Value;

use super::gains::{LEAST_SETTING, Settings};
use super::laws::{Size, necessary_input, size};
use super::model::Model;
use super::relations::Affine;
use crate::synthesis::GOOD_VOLTS;

/// Rounding of a logarithm of a voltage or a setting.
const ROUNDING: f64 = 1e-10;
/// The penalty of a peak below 50 V, and that of each decade below.
const LOW_PEAK: [f64; 2] = [1.0, 1.0];
/// The penalty of a peak above 95 V, and that of each decade above.
const HIGH_PEAK: [f64; 2] = [100.0, 1000.0];
/// The penalty of a setting outside its range, and that of each decade.
const OUTSIDE: [f64; 2] = [200.0, 2000.0];
/// The penalty of a pot that cannot be set for all values of the parameters, and that of each decade above 1.
const VARIED: [f64; 2] = [0.1, 0.2];
/// The penalty for each decade of a pot below the smallest accurate setting.
const INACCURATE: f64 = 0.1;
/// The penalty of a number with many digits. It is larger than that of a scale that is less round.
const MANY_DIGITS: f64 = 6e-3;
/// A number has two digits if it differs from them by at most this share.
const DIGITS_ROUNDING: f64 = 1e-9;

/// A quantity that factors change, and what it should be.
pub(super) struct Goal {
    /// Its logarithm to base 10, in free unknowns.
    pub quantity: Affine,
    pub limits: Limits,
}

/// The limits of a quantity. Numbers are logarithms to base 10.
#[derive(Debug, Clone, Copy)]
pub(super) enum Limits {
    /// The peak of an output in volts.
    Peak,
    /// The quantity must be from the first number to the second one.
    Range(f64, f64),
    /// A pot that should not be above the number for any values of the parameters.
    Varied(f64),
    /// A pot that should not be below the number.
    Accurate(f64),
    /// A factor of a number in the document that should have two digits. If the factor can divide, its reciprocal may have
    /// them instead.
    FewDigits { can_divide: bool },
}

impl Goal {
    /// How bad a value of the quantity is: 0 if it is good.
    pub(super) fn penalty(&self, value: f64) -> f64 {
        let outside = |excess: f64, [base, slope]: [f64; 2]| {
            if excess > ROUNDING { base + slope * excess } else { 0.0 }
        };
        match self.limits {
            Limits::Peak => {
                let [low, high] = GOOD_VOLTS.map(f64::log10);
                outside(low - value, LOW_PEAK) + outside(value - high, HIGH_PEAK)
            }
            Limits::Range(low, high) => outside(low - value, OUTSIDE) + outside(value - high, OUTSIDE),
            Limits::Varied(high) => outside(value - high, VARIED),
            Limits::Accurate(low) => outside(low - value, [0.0, INACCURATE]),
            Limits::FewDigits { can_divide } => {
                let is_short = has_two_digits(value) || (can_divide && has_two_digits(-value));
                if is_short { 0.0 } else { MANY_DIGITS }
            }
        }
    }
}

/// Whether a number with this logarithm has at most two digits.
fn has_two_digits(logarithm: f64) -> bool {
    let number = 10f64.powf(logarithm - logarithm.floor() + 1.0);
    (number - number.round()).abs() <= DIGITS_ROUNDING * number
}

/// The goals of a model.
pub(super) fn goals(model: &Model<'_>) -> Vec<Goal> {
    let wiring = model.evidence.wiring;
    let mut goals = Vec::new();
    for element in 0..wiring.len() {
        let peak = model.evidence.peaks[element];
        if wiring.kind(element).output != OutputStage::Passive && peak > 0.0 {
            let quantity = reduced(model, &[(element, 1.0)], peak);
            goals.push(Goal { quantity, limits: Limits::Peak });
        }
        if wiring.is_pot(element) {
            goals.extend(pot_goals(model, element));
        }
        goals.extend(largest_voltage(model, element).map(|volts| {
            let quantity = reduced(model, &[(element, 1.0)], volts);
            Goal { quantity, limits: Limits::Range(f64::NEG_INFINITY, REFERENCE.log10()) }
        }));
        goals.extend(setting_goals(model, element));
        goals.extend(curve_goals(model, element));
    }
    goals
}

/// The logarithm of number x product of powers of factors, in free unknowns.
pub(super) fn reduced(model: &Model<'_>, powers: &[(usize, f64)], number: f64) -> Affine {
    model.relations.reduced(&Affine::sum(powers)).plus_constant(number.abs().log10())
}

/// The goals of a pot: its setting is from 0.1 to 1, with the gain behind it if the gain can change. If that is so for all
/// values of the parameters, it stays so.
fn pot_goals(model: &Model<'_>, pot: usize) -> Vec<Goal> {
    let wiring = model.evidence.wiring;
    let Some(setting) = model.setting(pot).filter(|setting| *setting > 0.0) else { return Vec::new() };
    let Some(from) = wiring.source(pot, "in").map(|from| model.estimate(from)) else { return Vec::new() };
    let settings = Settings::of(wiring, model.evidence.old, pot);
    let within = |powers: &[(usize, f64)], gain: f64, largest: f64| {
        let quantity = |setting: f64| reduced(model, powers, setting * gain);
        let range = Limits::Range(f64::NEG_INFINITY, largest.log10());
        let varied = Goal { quantity: quantity(settings.most), limits: Limits::Varied(largest.log10()) };
        let varied = settings.are_possible().then_some(varied);
        varied.into_iter().chain([Goal { quantity: quantity(setting), limits: range }]).collect::<Vec<Goal>>()
    };
    let Some((reader, cord)) = wiring.gain_behind(pot) else {
        let powers = [(pot, 1.0), (from, -1.0)];
        let least = LEAST_SETTING.min(setting).log10();
        let accurate = Goal { quantity: reduced(model, &powers, setting), limits: Limits::Accurate(least) };
        return within(&powers, 1.0, 1.0).into_iter().chain([accurate]).collect();
    };
    let gain = wiring.cords[reader][cord].1.gain;
    let powers = [(model.target(reader), 1.0), (from, -1.0)];
    let largest = wiring.gains(reader).iter().copied().reduce(f64::max);
    largest.map_or_else(Vec::new, |largest| within(&powers, gain, largest))
}

/// The largest voltage of a free pot between two references, for any values of the parameters. `None` for other elements,
/// and if it is 0 V.
fn largest_voltage(model: &Model<'_>, element: usize) -> Option<f64> {
    let [top, end] = model.evidence.wiring.reference_ends(element)?;
    let settings = model.evidence.old.all(model.evidence.wiring.formula(element, "setting")?);
    let volts = settings.into_iter().flatten().map(|setting| (end + setting * (top - end)).abs());
    volts.reduce(f64::max).filter(|volts| *volts > 0.0)
}

/// The factors by which a setting is multiplied, as unknowns with exponents. `None` if it stays, and for pots.
pub(super) fn powers(model: &Model<'_>, element: usize, setting: &str) -> Option<Vec<(usize, f64)>> {
    let wiring = model.evidence.wiring;
    let input = |name: &str| wiring.source(element, name).map(|from| model.estimate(from));
    match size(wiring.kind(element).name, setting) {
        Size::Fixed | Size::Time => None,
        Size::Output => Some(vec![(element, 1.0)]),
        Size::Input(name) => Some(vec![(input(name)?, 1.0)]),
        Size::PerInput(name) => Some(vec![(input(name)?, -1.0)]),
        Size::OutputPerInput(name) => Some(vec![(element, 1.0), (input(name)?, -1.0)]),
    }
}

/// The goals of settings in volts and of others that change with a factor: they stay within their ranges.
fn setting_goals(model: &Model<'_>, element: usize) -> Vec<Goal> {
    let wiring = model.evidence.wiring;
    let kind = wiring.kind(element);
    let goals = kind.settings.iter().filter_map(|setting| {
        let is_used = necessary_input(kind.name, setting.name)
            .is_none_or(|input| wiring.source(element, input).is_some());
        let value = match (wiring.formula(element, setting.name), setting.default) {
            (Some(formula), _) => model.evidence.old.value(formula, 0)?,
            (None, SettingDefault::Number(number)) if is_used => number,
            _ => return None,
        };
        let powers = powers(model, element, setting.name)?;
        // A value of 0 stays 0. A range of a voltage includes both signs.
        let is_volts = setting.quantity == SettingQuantity::Volts;
        let low = if setting.range.0 > 0.0 { setting.range.0.log10() } else { f64::NEG_INFINITY };
        let limits = Limits::Range(low, setting.range.1.log10());
        (value != 0.0 && (is_volts || low.is_finite()))
            .then(|| Goal { quantity: reduced(model, &powers, value), limits })
    });
    goals.collect()
}

/// The goals of a curve: its points are within 100 V.
fn curve_goals(model: &Model<'_>, element: usize) -> Vec<Goal> {
    let wiring = model.evidence.wiring;
    let Some(points) = wiring.written(element, "points").and_then(Value::as_array) else { return Vec::new() };
    if wiring.kind(element).name != "function-generator" {
        return Vec::new();
    }
    let largest = |index: usize| {
        let numbers = points.iter().filter_map(|point| point.get(index)?.as_f64());
        numbers.fold(0.0, |largest: f64, number| largest.max(number.abs()))
    };
    let ends = [(wiring.source(element, "in"), largest(0)), (Some(element), largest(1))];
    let goal = |(output, largest): (Option<usize>, f64)| {
        let quantity = reduced(model, &[(output?, 1.0)], largest);
        (largest > 0.0)
            .then_some(Goal { quantity, limits: Limits::Range(f64::NEG_INFINITY, REFERENCE.log10()) })
    };
    ends.into_iter().filter_map(goal).collect()
}
