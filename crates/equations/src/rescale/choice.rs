//! Chooses the factors of a model: round scales with which the goals are reached as far as possible.
//!
//! The free unknowns are improved one after the other, each by trying all round numbers, until nothing improves.

use std::collections::BTreeMap;

use patchcord_expr::round_significant;

use super::decision::{Decided, Decision};
use super::digits::digit_goals;
use super::gains::{has_few_digits, nearest_gain, pot_gain};
use super::goals::{Goal, Limits, goals};
use super::model::Model;
use super::relations::Affine;
use crate::synthesis::GOOD_VOLTS;

/// The mantissas of the roundest numbers.
const ROUNDEST: [u32; 3] = [10, 20, 50];
/// Other round mantissas, times ten.
const ROUND: [u32; 8] = [15, 25, 30, 40, 60, 80, 12, 16];
/// The penalties of the roundest numbers, of other round ones, and of the others with two digits.
const ROUGHNESS: [f64; 3] = [1e-3, 2e-3, 4e-3];
/// The penalty of a scale that is a round multiple of its present value, if that has more digits. It is less than that of
/// a long number in a setting.
const MULTIPLE: f64 = 5e-3;
/// Decades in which round numbers are tried around those with which an output peaks from 50 to 95 V.
const MARGIN: f64 = 0.3;
/// Largest number of decades that are tried at once.
const MOST_DECADES: f64 = 12.0;
/// Passes over all unknowns at most.
const MOST_PASSES: usize = 30;
/// A penalty that is smaller by less than this is equal.
const ROUNDING: f64 = 1e-9;
/// Digits of the value of one volt.
const DIGITS: usize = 14;

/// A number that is tried for an unknown: the logarithm of a factor, and the penalty for its digits.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    value: f64,
    roughness: f64,
}

/// The chosen factors, and how good they are.
pub(super) struct Choice {
    pub decision: Decision,
    /// The number of outputs that peak from 50 to 95 V.
    pub good: usize,
    /// The number of settings outside their ranges.
    pub outside: usize,
}

/// Assignment of the free unknowns, with the penalties for their digits. Other unknowns are 0.
#[derive(Debug, Clone)]
struct Assignment {
    values: Vec<f64>,
    roughness: Vec<f64>,
}

/// Chooses the factors of a model.
///
/// If ranges of settings prevent that one unknown changes alone, several must change together. So the peaks alone are
/// tried first, too.
///
/// # Errors
/// The message if the machine has no gain for a cord, or if a gain would have many digits.
pub(super) fn choose(model: &Model<'_>) -> Result<Choice, String> {
    let mut goals = goals(model);
    goals.extend(digit_goals(model));
    let all: Vec<&Goal> = goals.iter().collect();
    let peaks: Vec<&Goal> = goals.iter().filter(|goal| matches!(goal.limits, Limits::Peak)).collect();
    let count = model.unknowns();
    let start = Assignment { values: vec![0.0; count], roughness: vec![0.0; count] };
    let from_peaks = improved(model, &all, improved(model, &peaks, start.clone()));
    let found = [from_peaks, improved(model, &all, start)];
    let total = |found: &Assignment| penalty(&all, &found.values) + found.roughness.iter().sum::<f64>();
    let [one, other] = found;
    let Assignment { values, .. } = if total(&one) <= total(&other) { one } else { other };
    let is_reached = |goal: &&Goal| goal.penalty(goal.quantity.value(&values)) == 0.0;
    let is_range = |goal: &&Goal| matches!(goal.limits, Limits::Range(..));
    let good = peaks.iter().copied().filter(is_reached).count();
    let outside = goals.iter().filter(is_range).filter(|goal| !is_reached(goal)).count();
    Ok(Choice { decision: decision(model, &values)?, good, outside })
}

/// The sum of the penalties of goals.
fn penalty(goals: &[&Goal], values: &[f64]) -> f64 {
    goals.iter().map(|goal| goal.penalty(goal.quantity.value(values))).sum()
}

/// The values after each unknown was changed alone as long as that improves them.
fn improved(model: &Model<'_>, goals: &[&Goal], start: Assignment) -> Assignment {
    let Assignment { mut values, mut roughness } = start;
    let involved: Vec<Vec<&Goal>> = (0..values.len())
        .map(|unknown| {
            goals.iter().copied().filter(|goal| goal.quantity.terms.contains_key(&unknown)).collect()
        })
        .collect();
    for _ in 0..MOST_PASSES {
        let mut is_changed = false;
        for unknown in (0..values.len()).filter(|unknown| !involved[*unknown].is_empty()) {
            let own = &involved[unknown];
            let mut least = penalty(own, &values) + roughness[unknown];
            let mut trial = values.clone();
            for candidate in candidates(model, unknown, own, &values) {
                trial[unknown] = candidate.value;
                let found = penalty(own, &trial) + candidate.roughness;
                if found < least - ROUNDING {
                    (least, values[unknown], roughness[unknown]) =
                        (found, candidate.value, candidate.roughness);
                    is_changed = true;
                }
            }
        }
        if !is_changed {
            break;
        }
    }
    Assignment { values, roughness }
}

/// The round numbers for an unknown with which at least one output peaks from about 50 to 95 V, and no change.
fn candidates(model: &Model<'_>, unknown: usize, goals: &[&Goal], values: &[f64]) -> Vec<Candidate> {
    let mut found = vec![Candidate { value: 0.0, roughness: 0.0 }];
    let bounds = goals.iter().filter(|goal| matches!(goal.limits, Limits::Peak)).flat_map(|goal| {
        let (coefficient, now) = (goal.quantity.terms[&unknown], goal.quantity.value(values));
        GOOD_VOLTS.map(|volts| values[unknown] + (volts.log10() - now) / coefficient)
    });
    let bounds: Vec<f64> = bounds.collect();
    let least = bounds.iter().copied().fold(f64::INFINITY, f64::min) - MARGIN;
    let most = bounds.iter().copied().fold(f64::NEG_INFINITY, f64::max) + MARGIN;
    if !(least.is_finite() && most.is_finite() && most - least <= MOST_DECADES) {
        return found;
    }
    // A scale is round itself, and another factor is.
    let one_volt = one_volt(model, unknown);
    let (low, high) = match one_volt {
        Some(one_volt) => (one_volt.log10() - most, one_volt.log10() - least),
        None => (least, most),
    };
    for decade in low.floor() as i32..=high.ceil() as i32 {
        for mantissa in 10..100 {
            let number = f64::from(decade - 1) + f64::from(mantissa).log10();
            if (low..=high).contains(&number) {
                let value = one_volt.map_or(number, |one_volt| one_volt.log10() - number);
                found.push(Candidate { value, roughness: roughness(mantissa) });
            }
        }
    }
    if let Some(present) = one_volt.filter(|one_volt| *one_volt != round_significant(*one_volt, 2)) {
        found.extend(multiples((low - present.log10(), high - present.log10())));
    }
    found
}

/// The round multiples of a scale in a range of logarithms.
fn multiples((low, high): (f64, f64)) -> impl Iterator<Item = Candidate> {
    let mantissas = move |decade: i32| {
        let round = ROUNDEST.into_iter().chain(ROUND);
        round.map(move |mantissa| f64::from(decade - 1) + f64::from(mantissa).log10())
    };
    let all = (low.floor() as i32..=high.ceil() as i32).flat_map(mantissas);
    let within = all.filter(move |number| (low..=high).contains(number));
    within.map(|number| Candidate { value: -number, roughness: MULTIPLE })
}

/// The penalty of a number by its first two digits.
fn roughness(mantissa: u32) -> f64 {
    let rank = if ROUNDEST.contains(&mantissa) {
        0
    } else if ROUND.contains(&mantissa) {
        1
    } else {
        2
    };
    ROUGHNESS[rank]
}

/// The value of one volt of the scale that an unknown is, in its unit. `None` if the unknown is none, or if the value is
/// a formula.
fn one_volt(model: &Model<'_>, unknown: usize) -> Option<f64> {
    let circuit = model.evidence.wiring.circuit;
    let scale = unknown.checked_sub(model.evidence.wiring.len())?;
    let (name, _) = circuit.patch().scales.get_index(scale)?;
    let is_number = circuit.patch().value()["scales"][name.as_str()]["per_volt"].is_number();
    circuit.per_volt(scale).filter(|value| is_number && *value > 0.0)
}

/// The decision with these values of the free unknowns.
///
/// # Errors
/// The message if the machine has no gain for a cord.
fn decision(model: &Model<'_>, values: &[f64]) -> Result<Decision, String> {
    let wiring = model.evidence.wiring;
    let factor = |unknown: usize| {
        let logarithm = model.relations.reduced(&Affine::unknown(unknown)).value(values);
        if logarithm == 0.0 { 1.0 } else { 10f64.powf(logarithm) }
    };
    let mut decision = Decision::none(wiring);
    decision.factors = (0..wiring.len()).map(factor).collect();
    decision.adapting.clone_from(&model.adapting);
    let used: BTreeMap<usize, f64> = wiring
        .scales
        .values()
        .flatten()
        .map(|scale| (*scale, exact_factor(model, *scale, factor(model.scale(*scale)))))
        .collect();
    decision.scale_factors = used;
    for (element, cord) in model.direct_cords() {
        let (from, own) = wiring.cords[element][cord];
        let wanted = own.gain * factor(model.target(element)) / decision.factors[from];
        let gain = nearest_gain(wiring, element, wanted)?;
        if model.is_free(element) && gain != own.gain && !has_few_digits(gain) {
            return Err(format!("a gain of {} would have many digits", wiring.name(element)));
        }
        decision.gains[element][cord] = gain;
    }
    for pot in 0..wiring.len() {
        if let Some((reader, cord)) = wiring.gain_behind(pot) {
            let target = factor(model.target(reader));
            let decided = Decided { wiring, old: model.evidence.old, decision: &decision };
            let (gain, own) = pot_gain(&decided, pot, (reader, cord), target)?;
            decision.gains[reader][cord] = gain;
            decision.factors[pot] = own;
        }
    }
    Ok(decision)
}

/// The factor of a scale with which the value of one volt has few digits.
fn exact_factor(model: &Model<'_>, scale: usize, factor: f64) -> f64 {
    match one_volt(model, model.scale(scale)) {
        Some(one_volt) if factor != 1.0 => one_volt / round_significant(one_volt / factor, DIGITS),
        _ => factor,
    }
}
