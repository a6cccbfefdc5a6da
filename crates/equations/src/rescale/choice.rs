//! Chooses the factors of a model: round scales with which the goals are reached as far as possible.
//!
//! The free unknowns are improved one after the other, each by trying all round numbers, until nothing improves.

use std::collections::BTreeMap;

use patchcord_expr::round_significant;

use super::decision::{Decided, Decision};
use super::gains::{nearest_gain, pot_gain};
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
/// Decades in which round numbers are tried around those with which an output peaks from 50 to 95 V.
const MARGIN: f64 = 0.3;
/// Largest number of decades that are tried at once.
const MOST_DECADES: f64 = 12.0;
/// Passes over all unknowns at most.
const MOST_PASSES: usize = 30;
/// A penalty that is smaller by less than this is equal.
const ROUNDING: f64 = 1e-9;
/// Digits of the value of one volt.
const DIGITS: usize = 12;

/// A number that is tried for an unknown: the logarithm of a factor, and the penalty for its digits.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    value: f64,
    roughness: f64,
}

/// The chosen factors, and how many outputs then peak from 50 to 95 V.
pub(super) struct Choice {
    pub decision: Decision,
    pub good: usize,
}

/// Chooses the factors of a model.
///
/// # Errors
/// The message if the machine has no gain for a cord.
pub(super) fn choose(model: &Model<'_>) -> Result<Choice, String> {
    let goals = goals(model);
    let values = improved(model, &goals);
    let is_good = |goal: &&Goal| {
        matches!(goal.limits, Limits::Peak) && goal.penalty(goal.quantity.value(&values)) == 0.0
    };
    let good = goals.iter().filter(is_good).count();
    Ok(Choice { decision: decision(model, &values)?, good })
}

/// The free unknowns with the smallest penalty that was found. Others are 0.
fn improved(model: &Model<'_>, goals: &[Goal]) -> Vec<f64> {
    let count = goals.iter().flat_map(|goal| goal.quantity.terms.keys()).max().map_or(0, |last| last + 1);
    let mut values = vec![0.0; count.max(model.evidence.wiring.len())];
    let mut roughness = vec![0.0; values.len()];
    let involved: Vec<Vec<&Goal>> = (0..values.len())
        .map(|unknown| goals.iter().filter(|goal| goal.quantity.terms.contains_key(&unknown)).collect())
        .collect();
    for _ in 0..MOST_PASSES {
        let mut is_changed = false;
        for unknown in (0..values.len()).filter(|unknown| !involved[*unknown].is_empty()) {
            let own = &involved[unknown];
            let penalty = |values: &[f64]| {
                own.iter().map(|goal| goal.penalty(goal.quantity.value(values))).sum::<f64>()
            };
            let mut least = penalty(&values) + roughness[unknown];
            let mut trial = values.clone();
            for candidate in candidates(model, unknown, own, &values) {
                trial[unknown] = candidate.value;
                let found = penalty(&trial) + candidate.roughness;
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
    values
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
    found
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
    let mut padded = values.to_vec();
    padded.resize(model.unknowns(), 0.0);
    let factor = |unknown: usize| {
        let logarithm = model.relations.reduced(&Affine::unknown(unknown)).value(&padded);
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
        decision.gains[element][cord] = nearest_gain(wiring, element, wanted)?;
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
