//! Goals for short numbers: what changes in the document is multiplied by numbers with few digits.
//!
//! A setting that is a formula of scales changes with them, so it only takes the rest of its factor.

use std::collections::BTreeSet;

use patchcord_expr::Formula;

use super::goals::{Goal, Limits, powers, reduced};
use super::model::Model;
use super::values::Values;

/// Factors of scales with which their exponents in formulas are measured.
const TRIED: [f64; 2] = [2.0, 8.0];
/// Two exponents are equal if they differ by at most this.
const ROUNDING: f64 = 1e-9;
/// Goals at most. Together they count less than one peak.
const MOST_GOALS: usize = 100;

/// A number or formula of the document that changes with factors.
struct Written<'c> {
    formula: &'c Formula,
    /// Whether the document has a number. A formula can also be divided by a short number.
    is_number: bool,
    /// The factors by which its value is multiplied, as unknowns with exponents.
    powers: Vec<(usize, f64)>,
}

/// The goals that numbers have few digits. Equal ones count once.
pub(super) fn digit_goals(model: &Model<'_>) -> Vec<Goal> {
    let mut goals: Vec<Goal> = Vec::new();
    for goal in setting_goals(model).into_iter().chain(signal_goals(model)).chain(point_goals(model)) {
        let is_new = goals.iter().all(|known| known.quantity != goal.quantity);
        if is_new && !goal.quantity.terms.is_empty() && goals.len() < MOST_GOALS {
            goals.push(goal);
        }
    }
    goals
}

/// The goal that a product of powers of unknowns has few digits.
fn goal(model: &Model<'_>, powers: &[(usize, f64)], can_divide: bool) -> Goal {
    Goal { quantity: reduced(model, powers, 1.0), limits: Limits::FewDigits { can_divide } }
}

/// The goals of settings.
fn setting_goals(model: &Model<'_>) -> Vec<Goal> {
    let written: Vec<Written<'_>> =
        (0..model.evidence.wiring.len()).flat_map(|element| written(model, element)).collect();
    let exponents = scale_exponents(model, &written);
    let goals = written.iter().zip(exponents).filter_map(|(written, exponents)| {
        let powers = [written.powers.clone(), exponents?].concat();
        Some(goal(model, &powers, !written.is_number))
    });
    goals.collect()
}

/// The settings of an element that change with factors.
fn written<'c>(model: &Model<'c>, element: usize) -> Vec<Written<'c>> {
    let wiring = model.evidence.wiring;
    let settings = wiring.kind(element).settings.iter().filter_map(|setting| {
        let formula = wiring.formula(element, setting.name)?;
        let powers = match setting.name == "setting" && wiring.is_pot(element) {
            true => pot_powers(model, element)?,
            false => powers(model, element, setting.name)?,
        };
        let is_number = wiring.written(element, setting.name)?.is_number();
        Some(Written { formula, is_number, powers })
    });
    settings.collect()
}

/// The factor of a pot, apart from the gain behind it. `None` behind a network whose setting follows its input.
fn pot_powers(model: &Model<'_>, pot: usize) -> Option<Vec<(usize, f64)>> {
    let wiring = model.evidence.wiring;
    let from = wiring.source(pot, "in").filter(|from| !model.adapting.contains(from))?;
    let output = wiring.gain_behind(pot).map_or(pot, |(reader, _)| model.target(reader));
    Some(vec![(output, 1.0), (from, -1.0)])
}

/// For each formula: the scales of signals and drives in it, as unknowns with their exponents. `None` if it is no product
/// of powers of scales.
fn scale_exponents(model: &Model<'_>, written: &[Written<'_>]) -> Vec<Option<Vec<(usize, f64)>>> {
    let wiring = model.evidence.wiring;
    let used: BTreeSet<usize> = wiring.scales.values().flatten().copied().collect();
    let mut values = Values::of(wiring.circuit);
    for scale in &used {
        set_scale(model, &mut values, *scale, 1.0);
    }
    let present = all_values(&values, written);
    let mut found: Vec<Option<Vec<(usize, f64)>>> =
        present.iter().map(|value| value.filter(|value| *value != 0.0).map(|_| Vec::new())).collect();
    for scale in used {
        let changed = TRIED.map(|factor| {
            set_scale(model, &mut values, scale, factor);
            all_values(&values, written)
        });
        set_scale(model, &mut values, scale, 1.0);
        for (index, own) in found.iter_mut().enumerate() {
            let values = changed.each_ref().map(|values| values[index]);
            match (own.as_mut(), exponent(present[index], values)) {
                (Some(own), Some(exponent)) if exponent.abs() > ROUNDING => {
                    own.push((model.scale(scale), exponent));
                }
                (_, Some(_)) => (),
                (_, None) => *own = None,
            }
        }
    }
    found
}

/// Makes one volt of a scale a number that is its present value times a factor.
fn set_scale(model: &Model<'_>, values: &mut Values<'_>, scale: usize, factor: f64) {
    let circuit = model.evidence.wiring.circuit;
    if let Some(per_volt) = circuit.per_volt(scale) {
        let (name, _) = circuit.derived(scale);
        values.scales.insert(name.to_owned(), Formula::constant(per_volt * factor));
    }
}

/// The values of formulas at the present values of the parameters.
fn all_values(values: &Values<'_>, written: &[Written<'_>]) -> Vec<Option<f64>> {
    written.iter().map(|written| values.value(written.formula, 0)).collect()
}

/// The exponent of a scale in a formula, from the present value of the formula and those for the tried factors. `None` if
/// these do not agree.
fn exponent(present: Option<f64>, changed: [Option<f64>; 2]) -> Option<f64> {
    let [Some(first), Some(second)] = changed else { return None };
    let exponents = [(first, TRIED[0]), (second, TRIED[1])];
    let present = present?;
    let [one, other] = exponents.map(|(value, factor)| (value / present).ln() / factor.ln());
    ((one - other).abs() <= ROUNDING).then_some(one)
}

/// The goals of the factors of signals without a scale.
fn signal_goals(model: &Model<'_>) -> Vec<Goal> {
    let circuit = model.evidence.wiring.circuit;
    let signals = circuit.signals()[..circuit.patch().signals.len()].iter();
    let unscaled = signals.filter(|signal| signal.scale.is_none());
    unscaled.map(|signal| goal(model, &[(signal.element, -1.0)], false)).collect()
}

/// The goals of the points of function generators.
fn point_goals(model: &Model<'_>) -> Vec<Goal> {
    let wiring = model.evidence.wiring;
    let has_points = |element: &usize| {
        wiring.kind(*element).name == "function-generator" && wiring.written(*element, "points").is_some()
    };
    let outputs = (0..wiring.len()).filter(has_points).flat_map(|element| {
        let input = wiring.source(element, "in").map(|from| model.estimate(from));
        input.into_iter().chain([element])
    });
    outputs.map(|output| goal(model, &[(output, 1.0)], false)).collect()
}
