//! Narrows the ranges of parameters to the part in which all settings of a scaled patch are valid.
//!
//! The scales hold for the present values of the parameters. At other values in the ranges of the problem, a pot would
//! have to be above 1 or negative, or a voltage above 100 V. So the ranges in the patch end where the first setting
//! becomes wrong. If several parameters cause a fault together, all of them move towards their present values by the
//! same share of their ranges.

use std::collections::BTreeSet;

use patchcord_core::circuit::{Circuit, RangeCheck};
use patchcord_core::document::unit_suffix;
use patchcord_core::patch::Patch;
use patchcord_expr::{format_significant, round_significant};
use serde::Serialize;

use super::error::ScaleError;
use super::inventory::unlimited_circuit;
use crate::synthesis::with_ranges;

/// Number of halvings with which the end of a range is found.
const HALVINGS: usize = 30;
/// The end of a range is taken to be a round number if it differs by less than this share from it.
const NEAR: f64 = 1e-6;
/// Significant digits of the ends of ranges: the fewest that keep most of the range.
const DIGITS: [usize; 2] = [2, 3];
/// The share of a range that a rounded end must keep.
const KEPT: f64 = 0.95;
/// Number of steps for one check at most. A formula that is monotonic in n parameters needs at most 2^n.
const MOST_STEPS: usize = 64;
/// All checks are repeated at most this number of times, because the middle of a range moves with its ends.
const MOST_PASSES: usize = 4;
/// Digits of numbers in the text of a range.
const TEXT_DIGITS: usize = 4;

/// A parameter whose range is narrower in the scaled patch than in the problem.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct NarrowedRange {
    /// The name of the parameter.
    pub parameter: String,
    /// The text of its unit.
    pub unit: String,
    /// The smallest and the largest value in the patch, in the unit.
    pub range: [f64; 2],
    /// The smallest and the largest value in the problem, in the unit.
    pub in_problem: [f64; 2],
}

impl NarrowedRange {
    /// The ranges as a sentence: `range of k: 1 ... 1.9 1/s, where all settings are valid (problem: 1 ... 3 1/s)`.
    pub fn text(&self) -> String {
        let unit = unit_suffix(&self.unit);
        let ends = |range: [f64; 2]| {
            let [low, high] = range.map(|end| format_significant(end, TEXT_DIGITS));
            format!("{low} ... {high}{unit}")
        };
        let [range, in_problem] = [self.range, self.in_problem].map(ends);
        format!("range of {}: {range}, where all settings are valid (problem: {in_problem})", self.parameter)
    }
}

/// A patch with narrower ranges, in which all settings are valid, and the ranges that differ.
///
/// # Errors
/// If the patch cannot be wired.
pub(super) fn with_narrowed_ranges(patch: &Patch) -> Result<(Patch, Vec<NarrowedRange>), ScaleError> {
    let circuit = unlimited_circuit(patch)?;
    let mut changes = Vec::new();
    for ((name, parameter), range) in patch.parameters.iter().zip(valid_ranges(&circuit)) {
        if let (Some(before), Some(after)) = (parameter.range, range)
            && before != after
        {
            changes.push(NarrowedRange {
                parameter: name.clone(),
                unit: parameter.unit.text().to_owned(),
                range: after.into(),
                in_problem: before.into(),
            });
        }
    }
    let ranges: Vec<_> = changes.iter().map(|change| (change.parameter.as_str(), change.range)).collect();
    Ok((with_ranges(patch, &ranges).map_err(ScaleError::Circuit)?, changes))
}

/// The ranges of all parameters of a patch in which no setting is wrong, in declared units.
///
/// Settings with few parameters come first, so that parameters that also occur in others keep more of their ranges.
fn valid_ranges(circuit: &Circuit) -> Bounds {
    let parameters = circuit.patch().parameters.values();
    let (present, ranges) = parameters.map(|parameter| (parameter.value, parameter.range)).unzip();
    let mut narrowing = Narrowing { present, ranges };
    let mut checks = circuit.range_checks();
    checks.sort_by_key(|check| check.parameters().len());
    for _ in 0..MOST_PASSES {
        let mut is_changed = false;
        for check in &checks {
            if check.fault(&narrowing.ranges).is_some() {
                narrowing.narrow(check);
                is_changed = true;
            }
        }
        if !is_changed {
            return narrowing.ranges;
        }
    }
    for check in &checks {
        if check.fault(&narrowing.ranges).is_some() {
            narrowing.ranges = narrowing.with_ends(&all_ends(check), 0.0);
        }
    }
    narrowing.ranges
}

/// An end of the range of a parameter: its index, and whether it is the upper end.
type End = (usize, bool);

/// The ranges of all parameters, in declared units.
type Bounds = Vec<Option<(f64, f64)>>;

/// Ranges while they are narrowed.
struct Narrowing {
    /// The present values of all parameters, in declared units.
    present: Vec<f64>,
    /// The ranges.
    ranges: Bounds,
}

/// Faults of a check on one side: the parameters are on the same sides of their present values, and the value of the
/// check is too small, or too large.
struct RangeFault<'f, 'c> {
    /// The check.
    check: &'f RangeCheck<'c>,
    /// The ends on the sides of the parameters.
    ends: Vec<End>,
    /// Whether the value is too small.
    is_below: bool,
}

impl Narrowing {
    /// Narrows ranges until a check has no fault.
    fn narrow(&mut self, check: &RangeCheck<'_>) {
        for _ in 0..MOST_STEPS {
            let mut combinations = check.combinations(&self.ranges).into_iter();
            let Some(wrong) = combinations.find(|values| check.excess(values) != 0.0) else { return };
            self.remove(check, &wrong);
        }
    }

    /// Narrows ranges so that this combination of values, and those beyond it, have no fault of the same kind.
    fn remove(&mut self, check: &RangeCheck<'_>, wrong: &[(usize, f64)]) {
        let sides = wrong.iter().filter(|(parameter, value)| *value != self.present[*parameter]);
        let ends = sides.map(|(parameter, value)| (*parameter, *value > self.present[*parameter])).collect();
        let fault = RangeFault { check, ends, is_below: check.excess(wrong) < 0.0 };
        if self.is_valid(&fault, &self.ranges) {
            // Only the middle of a range is wrong, so the range ends there.
            self.cut(wrong);
        }
        let mut ends = self.harmful_ends(&fault);
        if !self.is_valid(&fault, &self.with_ends(&ends, 0.0)) {
            ends.clone_from(&fault.ends);
        }
        let share = self.valid_share(&fault, &ends);
        let round = |present, far| snapped(between(present, far, share), present, far);
        let inside = |present, far| rounded_inwards(between(present, far, share), present);
        let rounded = self.changed(&ends, &round);
        self.ranges = if self.is_valid(&fault, &rounded) { rounded } else { self.changed(&ends, &inside) };
    }

    /// Ends the ranges of parameters at these values.
    fn cut(&mut self, values: &[(usize, f64)]) {
        for (parameter, value) in values {
            if let Some((low, high)) = &mut self.ranges[*parameter] {
                let present = self.present[*parameter];
                if *value > present {
                    *high = *value;
                } else if *value < present {
                    *low = *value;
                }
            }
        }
    }

    /// The largest share of the way from the present values to these ends without a fault.
    fn valid_share(&self, fault: &RangeFault<'_, '_>, ends: &[End]) -> f64 {
        let (mut valid, mut wrong) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(valid, wrong);
            if self.is_valid(fault, &self.with_ends(ends, middle)) {
                valid = middle;
            } else {
                wrong = middle;
            }
        }
        valid
    }

    /// The ends that cause a fault: those of parameters whose present value removes it from a combination. If no single
    /// parameter does, those of all parameters whose present value makes it smaller.
    fn harmful_ends(&self, fault: &RangeFault<'_, '_>) -> Vec<End> {
        let mut ends = BTreeSet::new();
        for values in fault.check.combinations(&self.part(fault, &self.ranges)) {
            let size = fault.size(&values);
            let others = fault.ends.iter().map(|end| (*end, self.size_without(fault, &values, end.0)));
            let smaller: Vec<(End, f64)> = others.filter(|(_, other)| *other < size).collect();
            let is_removed = smaller.iter().any(|(_, other)| *other == 0.0);
            let harmful = smaller.into_iter().filter(|(_, other)| *other == 0.0 || !is_removed);
            ends.extend(harmful.map(|(end, _)| end));
        }
        ends.into_iter().collect()
    }

    /// The size of a fault at a combination of values in which one parameter has its present value.
    fn size_without(&self, fault: &RangeFault<'_, '_>, values: &[(usize, f64)], parameter: usize) -> f64 {
        let present = |(index, value): &(usize, f64)| {
            (*index, if *index == parameter { self.present[*index] } else { *value })
        };
        fault.size(&values.iter().map(present).collect::<Vec<_>>())
    }

    /// Whether ranges have no fault of this kind.
    fn is_valid(&self, fault: &RangeFault<'_, '_>, ranges: &[Option<(f64, f64)>]) -> bool {
        fault.check.combinations(&self.part(fault, ranges)).iter().all(|values| fault.size(values) == 0.0)
    }

    /// The part of ranges on the sides of a fault. The other sides end at the present values.
    fn part(&self, fault: &RangeFault<'_, '_>, ranges: &[Option<(f64, f64)>]) -> Bounds {
        let mut part = ranges.to_vec();
        for parameter in fault.check.parameters() {
            let present = self.present[*parameter];
            if let Some((low, high)) = &mut part[*parameter] {
                *low = if fault.ends.contains(&(*parameter, false)) { *low } else { present };
                *high = if fault.ends.contains(&(*parameter, true)) { *high } else { present };
            }
        }
        part
    }

    /// The ranges with these ends at a share of the way from the present value to the present end.
    fn with_ends(&self, ends: &[End], share: f64) -> Bounds {
        self.changed(ends, &|present, far| between(present, far, share))
    }

    /// The ranges with other values of these ends. `end` gives them for the present value of the parameter and for the
    /// present end.
    fn changed(&self, ends: &[End], end: &dyn Fn(f64, f64) -> f64) -> Bounds {
        let mut ranges = self.ranges.clone();
        for (parameter, is_upper) in ends {
            let present = self.present[*parameter];
            if let Some((low, high)) = &mut ranges[*parameter] {
                let far = if *is_upper { high } else { low };
                *far = end(present, *far);
            }
        }
        ranges
    }
}

impl RangeFault<'_, '_> {
    /// The size of the fault at a combination of values. 0 if there is none, or one of the other kind.
    fn size(&self, values: &[(usize, f64)]) -> f64 {
        let excess = self.check.excess(values);
        if (excess < 0.0) == self.is_below { excess.abs() } else { 0.0 }
    }
}

/// Both ends of the ranges of all parameters of a check.
fn all_ends(check: &RangeCheck<'_>) -> Vec<End> {
    check.parameters().iter().flat_map(|parameter| [(*parameter, false), (*parameter, true)]).collect()
}

/// A value at a share of the way from a present value to the end of a range. Between values of one sign, equal shares are
/// equal ratios, because settings are usually products.
fn between(present: f64, far: f64, share: f64) -> f64 {
    if present * far > 0.0 {
        present * (far / present).powf(share)
    } else {
        present + share * (far - present)
    }
}

/// The end of a range as 0 or as a round number, if it is nearly that; otherwise rounded towards the present value.
fn snapped(end: f64, present: f64, far: f64) -> f64 {
    let round = round_significant(end, DIGITS[1]);
    let is_inside = |value: f64| (present.min(far)..=present.max(far)).contains(&value);
    if is_inside(0.0) && end.abs() <= NEAR * (far - present).abs() {
        0.0
    } else if is_inside(round) && (round - end).abs() <= NEAR * end.abs() {
        round
    } else {
        rounded_inwards(end, present)
    }
}

/// The end of a range with 2 or 3 digits, rounded towards the present value but not past it.
fn rounded_inwards(end: f64, present: f64) -> f64 {
    let rounded = DIGITS.map(|digits| towards(end, present, digits));
    let is_inside = |value: &f64| (present.min(end)..=present.max(end)).contains(value);
    let is_good = |value: &f64| is_inside(value) && (value - present).abs() >= KEPT * (end - present).abs();
    let finest = Some(rounded[1]).filter(is_inside);
    rounded.into_iter().find(is_good).or(finest).unwrap_or(present)
}

/// A number rounded to some digits, towards another number.
fn towards(number: f64, goal: f64, digits: usize) -> f64 {
    let nearest = round_significant(number, digits);
    let is_past = (nearest - number) * (goal - number) < 0.0;
    if !is_past {
        return nearest;
    }
    let step = 10f64.powi(number.abs().log10().floor() as i32 + 1 - digits as i32);
    round_significant(nearest + step.copysign(goal - number), digits)
}

#[cfg(test)]
mod tests;
