//! Peaks without rounding: a difference of equal quantities is 0, and not 1e-16 of them. What follows from it is 0, too.

use patchcord_core::machines::REFERENCE;

use super::centred::angle_scale;
use super::input::Input;
use crate::graph::{FunctionKind, NodeId, Operation, Sum};

/// A sum that is smaller than this share of its terms consists of rounding. So does an angle that is smaller than this
/// share of 1 rad.
const ROUNDING: f64 = 1e-10;

/// A peak below this, in SI units, counts as 0. No unit is so small, but the far end of a long chain of lags is.
pub(super) const LEAST_PEAK: f64 = 1e-60;

/// The peak of each node in SI units. It is 0 if the node consists of rounding, is far below every unit, or has no finite
/// range.
pub(super) fn significant_peaks(input: &Input<'_>) -> Vec<f64> {
    let is_significant = |peak: &f64| peak.is_finite() && *peak >= LEAST_PEAK;
    let peak = |id: NodeId| Some(input.peak(id)).filter(is_significant).unwrap_or(0.0);
    let mut peaks: Vec<f64> = input.plan.ids().map(peak).collect();
    let mut is_changed = true;
    while is_changed {
        is_changed = false;
        for id in input.plan.ids() {
            let index = id.0 as usize;
            if peaks[index] > 0.0 && is_rounding(input, id, &peaks) {
                peaks[index] = 0.0;
                is_changed = true;
            }
        }
    }
    peaks
}

/// Whether a node is a sum of quantities that cancel or consist of rounding, the integral of one that starts at 0, a
/// function of rounding that is 0 at 0, or an angle near 0.
fn is_rounding(input: &Input<'_>, id: NodeId, peaks: &[f64]) -> bool {
    let (peak, is_zero) = (peaks[id.0 as usize], |node: &NodeId| peaks[node.0 as usize] == 0.0);
    let cancels = |peak: f64, sum: &Sum| {
        let size = size(input, sum, peaks);
        size == 0.0 || peak <= ROUNDING * size
    };
    match input.operation(id) {
        Operation::Sum(sum) => cancels(peak, sum),
        Operation::Limited { sum, .. } => peak <= ROUNDING * size(input, sum, peaks),
        Operation::Integral { initial, rate } => {
            input.expressions.value(initial) == 0.0 && cancels(input.rates[id.0 as usize], rate)
        }
        Operation::Product(factors) => factors.iter().any(is_zero),
        Operation::Quotient { dividend, .. } => size(input, dividend, peaks) == 0.0,
        Operation::Absolute(node) => is_zero(node),
        Operation::Function { kind: FunctionKind::Sin, argument } => is_zero(&argument.node),
        Operation::Zero(_) => {
            angle_scale(&input.plan, id).is_some_and(|scale| peak <= ROUNDING * REFERENCE * scale)
        }
        _ => false,
    }
}

/// The sum of the sizes of the terms of a sum.
fn size(input: &Input<'_>, sum: &Sum, peaks: &[f64]) -> f64 {
    let terms = sum.terms.iter();
    let sizes = terms.map(|(node, c)| input.expressions.value(c).abs() * peaks[node.0 as usize]);
    sizes.sum()
}
