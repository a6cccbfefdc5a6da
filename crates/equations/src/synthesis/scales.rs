//! The choice of the scales: the peak of a node is between 50 and 95 V, and one volt is a round number.

use std::f64::consts::LN_10;

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Problem;

use super::centred::least_volts;
use super::gains::{MOST_CORDS, MOST_SETTING};
use super::input::Input;
use super::round::roundest;
use super::scale_table::ScaleTable;
use super::significant::significant_peaks;
use super::time_scale::time_scale;
use super::unknown::{fill_unknown, is_chosen};
use super::{ScaleOptions, Scales};
use crate::graph::{FunctionKind, NodeId, Operation, Plan, Sum};
use crate::peaks::Ranges;
use crate::symbolic::Fraction;

/// Voltages of a peak after a choice. They are within those that need a new choice, because measured peaks differ a
/// little from computed ones.
const CHOSEN_VOLTS: [f64; 2] = [51.0, 94.0];
/// A measured peak within these voltages uses the range of its amplifier. Another one needs a new scale.
pub(crate) const GOOD_VOLTS: [f64; 2] = [50.0, 95.0];
/// The largest voltage of an amplifier. Of a larger peak nothing is known.
const MOST_VOLTS: f64 = 100.0;
/// The peak behind an overload is taken to be larger by this factor.
const OVERLOAD: f64 = 1.5;
/// Scales depend on each other through pots and multipliers. They are adjusted this number of times.
const PASSES: usize = 4;
/// Rounding of a ratio of scales.
const ROUNDING: f64 = 1e-12;

/// Chooses the scales of all nodes and the time scale.
///
/// A scale that the problem states is kept: `per_volt`, or a hundredth of the `maximum`. Otherwise the range of the node
/// decides. A node that is 0 during the whole run gets an estimate; see `unknown`. The scales of multipliers, diode
/// networks and delay lines follow from their inputs.
///
/// The scales are by the index of the node. Those of nodes that the synthesis adds are at the end.
pub(crate) fn choose_scales(
    plan: &Plan,
    problem: &Problem,
    circuit: &Circuit,
    ranges: &Ranges,
    options: &ScaleOptions,
) -> Scales {
    let input = Input::new(plan, problem, circuit, ranges, options);
    let kept: Vec<Option<f64>> = input.plan.ids().map(|id| input.stated_scale(id)).collect();
    choose(&input, &significant_peaks(&input), &kept)
}

/// Chooses new scales for the nodes whose measured peaks are below 50 V or above 95 V.
///
/// `volts` has the largest magnitudes of outputs in a run of the synthesised patch, by node. A scale that the problem
/// prescribes is only changed after an overload, and with `keeps_maxima` also that of a stated maximum. The result equals
/// `scales` if nothing can be improved.
pub(crate) fn improved_scales(
    plan: &Plan,
    problem: &Problem,
    circuit: &Circuit,
    ranges: &Ranges,
    options: &ScaleOptions,
    scales: &Scales,
    volts: &[(NodeId, f64)],
) -> Scales {
    let input = Input::new(plan, problem, circuit, ranges, options);
    let mut peaks = significant_peaks(&input);
    let mut kept: Vec<Option<f64>> = scales.per_volt.iter().copied().map(Some).collect();
    kept.resize(peaks.len(), None);
    for (id, volts) in volts {
        let index = id.0 as usize;
        let Some(scale) = kept.get(index).copied().flatten() else { continue };
        let is_over = *volts >= MOST_VOLTS;
        let is_good = (GOOD_VOLTS[0]..=GOOD_VOLTS[1]).contains(volts) || peaks[index] == 0.0;
        let is_kept = match options.keeps_maxima {
            true => input.stated_scale(*id).is_some(),
            false => input.prescribed_scale(*id).is_some(),
        };
        if is_over || !(is_good || is_kept) {
            peaks[index] = if is_over { peaks[index].max(OVERLOAD * volts * scale) } else { volts * scale };
            kept[index] = None;
        }
    }
    choose(&input, &peaks, &kept)
}

/// Chooses the scales that are not kept.
fn choose(input: &Input<'_>, peaks: &[f64], kept: &[Option<f64>]) -> Scales {
    let choice = Choice { input, peaks, kept };
    let mut chosen: Vec<Option<f64>> = input.plan.ids().map(|id| choice.first(id)).collect();
    fill_unknown(input, &mut chosen);
    let mut per_volt: Vec<f64> = chosen.into_iter().map(|scale| scale.unwrap_or(f64::NAN)).collect();
    for _ in 0..PASSES {
        per_volt = table(input, &per_volt).values();
        for id in input.plan.ids().filter(|id| kept[id.0 as usize].is_none()) {
            choice.adjust(id, &mut per_volt);
        }
    }
    per_volt = table(input, &per_volt).values();
    let time_scale = time_scale(input, &per_volt);
    Scales { per_volt, time_scale }
}

/// The table of all scales for these chosen ones. Their names do not occur in a patch.
fn table<'a>(input: &Input<'a>, per_volt: &[f64]) -> ScaleTable<'a> {
    ScaleTable::new(input, per_volt, &|id| is_chosen(input, id).then(|| format!("s{}", id.0)))
}

/// The choice of the scales of one plan.
struct Choice<'c, 'a> {
    /// The plan and the problem.
    input: &'c Input<'a>,
    /// The peaks in SI units by node; 0 if a peak is not known.
    peaks: &'c [f64],
    /// The scales that stay, in SI units by node.
    kept: &'c [Option<f64>],
}

impl Choice<'_, '_> {
    /// The kept scale of a node, or that for its peak. `None` if it is not known, and if it follows from others.
    fn first(&self, id: NodeId) -> Option<f64> {
        if !is_chosen(self.input, id) {
            return None;
        }
        let peak = self.peak(id);
        let round = || (peak > 0.0).then(|| self.within(id, self.round(id, peak)));
        self.kept[id.0 as usize].or_else(round)
    }

    /// The peak of a node in SI units, at least the bounds of a limiter and the values of a comparator.
    fn peak(&self, id: NodeId) -> f64 {
        let value = |bound: &Fraction| self.input.expressions.value(bound).abs();
        let bounds = match self.input.operation(id) {
            Operation::Limited { lower, upper, .. } => [lower.as_ref(), upper.as_ref()],
            Operation::Switch { at_least_0, below_0, .. } => [Some(at_least_0), Some(below_0)],
            _ => [None, None],
        };
        bounds.into_iter().flatten().map(value).fold(self.peaks[id.0 as usize], f64::max)
    }

    /// The round scale with which a peak is between 51 and 94 V.
    fn round(&self, id: NodeId, peak: f64) -> f64 {
        let unit = self.input.unit(id).factor();
        let [lowest, highest] = CHOSEN_VOLTS;
        let lowest = least_volts(&self.input.plan, id, peak).clamp(lowest, highest);
        roundest(peak / unit / highest, peak / unit / lowest) * unit
    }

    /// A scale within the range that the settings of a function generator allow; see docs/elements.md.
    fn within(&self, id: NodeId, scale: f64) -> f64 {
        let Operation::Function { kind, .. } = self.input.operation(id) else { return scale };
        match kind {
            // The amplitude 1 / S is at most 100 V.
            FunctionKind::Sin | FunctionKind::Cos => scale.max(0.01),
            // The reference 1 / S is from 1e-6 to 100 V.
            FunctionKind::Exp => scale.clamp(0.01, 1e6),
            // The output per decade, ln(10) / S, is from 1 to 100 V.
            FunctionKind::Ln if scale < LN_10 / 100.0 => 0.025,
            FunctionKind::Ln => scale.min(2.0),
        }
    }

    /// Adjusts the scale of a sum to those of its inputs.
    fn adjust(&self, id: NodeId, per_volt: &mut [f64]) {
        let index = id.0 as usize;
        match self.input.operation(id) {
            Operation::Sum(sum) if sum.terms.len() == 1 => {
                if let Some(scale) = self.share_scale(id, sum, per_volt) {
                    per_volt[index] = scale;
                }
            }
            Operation::Sum(sum) | Operation::Limited { sum, .. } => {
                per_volt[index] = self.scale_for_gains(id, sum, per_volt);
            }
            _ => {}
        }
    }

    /// The scale of a sum with one term for which no amplifier is necessary. `None` if its peak would be too low.
    ///
    /// With the coefficient 1 or -1 it is the scale of the input, and no part is necessary. Otherwise a pot is enough if
    /// the scale is not smaller than that of the input times the coefficient. If the peak permits it, this is so for all
    /// values of the parameters in their ranges.
    fn share_scale(&self, id: NodeId, sum: &Sum, per_volt: &[f64]) -> Option<f64> {
        let (node, coefficient) = sum.terms.first_key_value()?;
        let expressions = &self.input.expressions;
        let factor = expressions.value(coefficient).abs();
        let (direct, peak) = (factor * per_volt[node.0 as usize], self.peak(id));
        let is_large = |scale: f64| peak >= CHOSEN_VOLTS[0] * scale && scale > 0.0;
        if !is_large(direct) || peak > MOST_VOLTS * direct {
            return None;
        }
        let has_parameters = expressions.has_parameters(coefficient);
        if factor == 1.0 && !has_parameters {
            return Some(direct);
        }
        let most = expressions.largest(coefficient) * per_volt[node.0 as usize];
        // A pot that is nearly fully open could not follow a parameter.
        let most = if has_parameters { most.max(direct / MOST_SETTING) } else { most };
        let least = if is_large(most) { most } else { direct };
        if per_volt[id.0 as usize] >= least {
            return None;
        }
        let unit = self.input.unit(id).factor();
        Some(roundest(least / unit * (1.0 - ROUNDING), peak / unit / CHOSEN_VOLTS[0]) * unit)
    }

    /// The scale of a sum, increased if the gain for one of its terms would be too large.
    fn scale_for_gains(&self, id: NodeId, sum: &Sum, per_volt: &[f64]) -> f64 {
        let scale = per_volt[id.0 as usize];
        let largest_gain = self.input.summer_gains().last().copied().unwrap_or(1.0);
        let contribution = |(node, c): (&NodeId, &Fraction)| {
            self.input.expressions.value(c).abs() * per_volt[node.0 as usize]
        };
        let largest = sum.terms.iter().map(contribution).fold(0.0, f64::max);
        let least = largest / (largest_gain * f64::from(MOST_CORDS));
        if scale >= least || !least.is_normal() {
            return scale;
        }
        let unit = self.input.unit(id).factor();
        roundest(least / unit, least / unit * CHOSEN_VOLTS[1] / CHOSEN_VOLTS[0]) * unit
    }
}
