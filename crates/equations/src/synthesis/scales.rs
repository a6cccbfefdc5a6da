//! The choice of the scales: the peak of a node is between 50 and 95 V, and one volt is a round number.

use std::f64::consts::LN_10;

use patchcord_core::circuit::Circuit;
use patchcord_core::machines::{GOOD_VOLTS, REFERENCE};
use patchcord_core::patch::Problem;

use super::centred::least_volts;
use super::gains::{MOST_CORDS, MOST_SETTING};
use super::input::Input;
use super::reason::ScaleReason;
use super::rescaled::is_forced;
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
/// The peak behind an overload is taken to be larger by this factor.
const OVERLOAD: f64 = 1.5;
/// The largest peak in volts that is demanded for the sake of a product. Scales between this and 94 V have two digits.
const MOST_FOR_PRODUCT: f64 = 85.0;
/// The largest voltage behind an overload that is believed. In a run with overloads, voltages can be far too large.
const BELIEVED_VOLTS: f64 = 300.0;
/// The relative error of the peaks of the solution without scales.
const PEAK_ERROR: f64 = 1e-4;
/// Scales depend on each other through pots and multipliers. They are adjusted this number of times.
const PASSES: usize = 4;
/// Rounding of a measured peak, as a share.
const PEAK_ROUNDING: f64 = 1e-9;
/// Rounding of a ratio of scales.
const ROUNDING: f64 = 1e-12;

/// Chooses the scales of all nodes and the time scale.
///
/// A scale that the problem states is kept: `per_volt`, or a hundredth of a `maximum` that the solution does not exceed.
/// Otherwise the range of the node decides. A node that is 0 during the whole run gets an estimate; see `unknown`. The
/// scales of multipliers, diode networks and delay lines follow from their inputs.
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
    let peaks = significant_peaks(&input);
    let kept: Vec<Option<Chosen>> = input.plan.ids().map(|id| stated(&input, id, &peaks)).collect();
    choose(&input, &peaks, &kept)
}

/// The scale of a node that the problem states. `None` if it states none, or a maximum that the peak exceeds and that need
/// not be kept.
fn stated(input: &Input<'_>, id: NodeId, peaks: &[f64]) -> Option<Chosen> {
    if let Some(per_volt) = input.prescribed_scale(id) {
        return Some(Chosen { per_volt, reason: Some(ScaleReason::Prescribed) });
    }
    let per_volt = input.stated_scale(id)?;
    let is_kept = input.options.keeps_maxima;
    let reason = is_kept.then_some(ScaleReason::KeptMaximum);
    (is_kept || !exceeds_reference(peaks[id.0 as usize], per_volt)).then_some(Chosen { per_volt, reason })
}

/// Whether a peak of the solution without scales is above 100 V, and not only by its error. Both are in one unit.
pub(crate) fn exceeds_reference(peak: f64, per_volt: f64) -> bool {
    peak > REFERENCE * per_volt * (1.0 + PEAK_ERROR)
}

/// Chooses new scales for the nodes whose measured peaks are below 50 V or above 95 V.
///
/// `volts` has the largest magnitudes of outputs in a run of the synthesised patch, by node. A scale that the problem
/// prescribes never changes. With `keeps_maxima`, that of a stated maximum does not change either. A run with an overload
/// does not show how large the other voltages are. So only the scales of outputs at 100 V change after it. The result has
/// the values of `scales` if nothing can be improved.
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
    let present = scales.per_volt.iter().zip(&scales.reasons);
    let mut kept: Vec<Option<Chosen>> =
        present.map(|(per_volt, reason)| Some(Chosen { per_volt: *per_volt, reason: *reason })).collect();
    kept.resize(peaks.len(), None);
    let is_over = |volts: f64| volts >= REFERENCE;
    let has_overload = volts.iter().any(|(_, volts)| is_over(*volts));
    for (id, volts) in volts {
        let index = id.0 as usize;
        let Some(chosen) = kept.get(index).copied().flatten() else { continue };
        if is_kept(&input, *id) {
            continue;
        }
        if is_over(*volts) {
            let believed = OVERLOAD * volts.min(BELIEVED_VOLTS) * chosen.per_volt;
            peaks[index] = peaks[index].max(believed);
            kept[index] = None;
        } else if !has_overload && !is_good_peak(*volts) && peaks[index] > 0.0 {
            peaks[index] = volts * chosen.per_volt;
            kept[index] = None;
        }
    }
    choose(&input, &peaks, &kept)
}

/// Whether the scale of a node stays for every peak: the problem prescribes it, or its stated maximum is kept.
fn is_kept(input: &Input<'_>, id: NodeId) -> bool {
    let stated = if input.options.keeps_maxima { input.stated_scale(id) } else { input.prescribed_scale(id) };
    stated.is_some()
}

/// Whether a peak in a run without overloads uses the range of its amplifier, except for rounding.
pub(crate) fn is_good_peak(volts: f64) -> bool {
    let [low, high] = GOOD_VOLTS;
    (low * (1.0 - PEAK_ROUNDING)..=high * (1.0 + PEAK_ROUNDING)).contains(&volts)
}

/// The round number that is suitable as the scale of a peak: the peak is between 51 and 94 V.
pub(crate) fn suitable_scale(peak: f64) -> f64 {
    roundest(peak / CHOSEN_VOLTS[1], peak / CHOSEN_VOLTS[0])
}

/// The least peak of each node in volts with which the products that have it as a factor peak above 50 V. A multiplier
/// divides by 100 V, so its factors must be large. It is 0 for other nodes, and for factors of products that stay low
/// because their factors peak at different times.
fn factor_volts(input: &Input<'_>, peaks: &[f64]) -> Vec<f64> {
    let mut volts = vec![0.0_f64; peaks.len()];
    // A factor of a factor gets its volts one pass later.
    for _ in 0..PASSES {
        for id in input.plan.ids() {
            let Operation::Product(factors) = input.operation(id) else { continue };
            let [product, one, other] = [id, factors[0], factors[1]].map(|node| peaks[node.0 as usize]);
            let wanted = volts[id.0 as usize].max(CHOSEN_VOLTS[0]);
            let needed = (wanted * REFERENCE * one * other / product).sqrt();
            for factor in factors.iter().filter(|_| needed <= MOST_FOR_PRODUCT) {
                let own = &mut volts[factor.0 as usize];
                *own = own.max(needed);
            }
        }
    }
    volts
}

/// A chosen scale.
#[derive(Debug, Clone, Copy)]
struct Chosen {
    /// The value of one volt in SI units.
    per_volt: f64,
    /// What determines it. `None` if the peak does.
    reason: Option<ScaleReason>,
}

/// Chooses the scales that are not kept.
fn choose(input: &Input<'_>, peaks: &[f64], kept: &[Option<Chosen>]) -> Scales {
    let factor_volts = &factor_volts(input, peaks);
    let choice = Choice { input, peaks, kept, factor_volts };
    let first: Vec<Option<Chosen>> = input.plan.ids().map(|id| choice.first(id)).collect();
    let reason = |chosen: &Option<Chosen>| chosen.map_or(Some(ScaleReason::Zero), |chosen| chosen.reason);
    let mut reasons: Vec<Option<ScaleReason>> = first.iter().map(reason).collect();
    let mut chosen: Vec<Option<f64>> = first.iter().map(|chosen| Some((*chosen)?.per_volt)).collect();
    fill_unknown(input, &mut chosen);
    let filled = |(id, scale): (NodeId, Option<f64>)| match (first[id.0 as usize], scale) {
        (None, Some(estimate)) => choice.within(id, estimate),
        (_, scale) => scale.unwrap_or(f64::NAN),
    };
    let mut per_volt: Vec<f64> = input.plan.ids().zip(chosen).map(filled).collect();
    for _ in 0..PASSES {
        per_volt = table(input, &per_volt).values();
        for id in input.plan.ids().filter(|id| kept[id.0 as usize].is_none()) {
            choice.adjust(id, &mut per_volt, &mut reasons);
        }
    }
    per_volt = table(input, &per_volt).values();
    for id in input.plan.ids().filter(|id| !is_chosen(input, *id)) {
        reasons[id.0 as usize] = choice.forced_reason(id, &per_volt);
    }
    let time_scale = time_scale(input, &per_volt);
    Scales { per_volt, reasons, time_scale }
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
    /// The scales that stay, by node.
    kept: &'c [Option<Chosen>],
    /// The least peaks that products need, in volts by node; see [`factor_volts`].
    factor_volts: &'c [f64],
}

impl Choice<'_, '_> {
    /// The kept scale of a node, or that for its peak. `None` if it is not known, and if it follows from others.
    fn first(&self, id: NodeId) -> Option<Chosen> {
        if !is_chosen(self.input, id) {
            return None;
        }
        if let Some(kept) = self.kept[id.0 as usize] {
            return Some(kept);
        }
        let peak = self.peak(id);
        if peak <= 0.0 {
            return None;
        }
        let round = self.round(id, peak);
        let per_volt = self.within(id, round);
        let of_bounds = (peak > self.peaks[id.0 as usize]).then_some(ScaleReason::Bounds);
        let reason = if per_volt == round { of_bounds } else { Some(ScaleReason::Generator) };
        Some(Chosen { per_volt, reason })
    }

    /// The reason for the scale of a node without a chosen one. `None` for the reference.
    fn forced_reason(&self, id: NodeId, per_volt: &[f64]) -> Option<ScaleReason> {
        if self.peaks[id.0 as usize] == 0.0 && is_forced(self.input.operation(id)) {
            return Some(ScaleReason::Zero);
        }
        let operation = self.input.operation(id);
        let volts = |node: NodeId| self.peaks[node.0 as usize] / per_volt[node.0 as usize];
        let inputs: Vec<f64> = operation.inputs().into_iter().map(volts).collect();
        ScaleReason::of_forced(operation, volts(id), &inputs)
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
        let lowest = lowest.max(self.factor_volts[id.0 as usize]);
        roundest(peak / unit / highest, peak / unit / lowest) * unit
    }

    /// A scale within the range that the settings of a function generator allow; see docs/elements.md.
    fn within(&self, id: NodeId, scale: f64) -> f64 {
        let Operation::Function { kind, .. } = self.input.operation(id) else { return scale };
        match kind {
            // The amplitude 1 / S is at most 100 V.
            FunctionKind::Sin | FunctionKind::Cos => scale.max(0.01),
            // The reference is from 1e-6 to 100 V. It is 1 / S, times the exponential of the offset.
            FunctionKind::Exp => {
                let at_offset = f64::from(self.input.exponent_offset(id)).exp();
                scale.clamp(0.01 * at_offset, 1e6 * at_offset)
            }
            // The output per decade, ln(10) / S, is from 1 to 100 V.
            FunctionKind::Ln if scale < LN_10 / 100.0 => 0.025,
            FunctionKind::Ln => scale.min(2.0),
        }
    }

    /// Adjusts the scale of a sum to those of its inputs.
    fn adjust(&self, id: NodeId, per_volt: &mut [f64], reasons: &mut [Option<ScaleReason>]) {
        let index = id.0 as usize;
        match self.input.operation(id) {
            Operation::Sum(sum) if sum.terms.len() == 1 => {
                if let Some(scale) = self.share_scale(id, sum, per_volt) {
                    per_volt[index] = scale;
                }
            }
            Operation::Sum(sum) | Operation::Limited { sum, .. } => {
                let scale = self.scale_for_gains(id, sum, per_volt);
                if scale != per_volt[index] {
                    per_volt[index] = scale;
                    reasons[index] = Some(ScaleReason::LargestGain);
                }
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
        if !is_large(direct) || peak > REFERENCE * direct {
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
