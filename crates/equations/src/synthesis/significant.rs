//! Peaks without rounding: a difference of equal quantities is 0, and not 1e-16 of them.

use super::input::Input;
use crate::graph::{NodeId, Operation, Sum};

/// A sum that is smaller than this share of its terms consists of rounding.
const ROUNDING: f64 = 1e-10;

/// The peak of each node in SI units. It is 0 if the node consists of rounding, or has no finite range.
pub(super) fn significant_peaks(input: &Input<'_>) -> Vec<f64> {
    let peak = |id: NodeId| Some(input.peak(id)).filter(|peak| peak.is_finite()).unwrap_or(0.0);
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

/// Whether a node is a sum of quantities that cancel, or the integral of one that starts at 0.
fn is_rounding(input: &Input<'_>, id: NodeId, peaks: &[f64]) -> bool {
    let peak = peaks[id.0 as usize];
    match input.operation(id) {
        Operation::Sum(sum) | Operation::Limited { sum, .. } => peak <= ROUNDING * size(input, sum, peaks),
        Operation::Integral { initial, rate } => {
            let starts_at_0 = input.expressions.value(initial) == 0.0;
            starts_at_0 && input.rates[id.0 as usize] <= ROUNDING * size(input, rate, peaks)
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
