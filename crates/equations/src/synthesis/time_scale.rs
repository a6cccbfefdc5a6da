//! The time scale: machine seconds per problem second = plotter frequency / largest frequency of the system (eq. 1-8).

use std::f64::consts::TAU;

use super::input::Input;
use super::round::{nearest_step, step_above};
use crate::graph::{NodeId, Operation};

/// The frequency at which the machine computes the fastest oscillation of a system whose time scale is changed, in Hz.
const PLOTTER_FREQUENCY: f64 = 1.0;
/// The smallest coefficient of an integrator at the time scale 1. Smaller ones need pots below 0.1.
const LEAST_COEFFICIENT: f64 = 0.1;
/// Rounding of a coefficient, as a share of it.
const ROUNDING: f64 = 1e-9;
/// The limits of the time scale of a patch.
const LIMITS: (f64, f64) = (1e-12, 1e12);

/// The time scale for these values of one volt, in SI units by node.
///
/// It is 1 if every integrator then has usable coefficients. Otherwise the fastest oscillation becomes 1 Hz. The time
/// scale is never so small that a coefficient exceeds the largest gain.
pub(super) fn time_scale(input: &Input<'_>, per_volt: &[f64]) -> f64 {
    if let Some(time_scale) = input.options.time_scale {
        return time_scale;
    }
    let coefficients = coefficients(input, per_volt);
    let largest_gain = input.integrator_gains().last().copied().unwrap_or(f64::INFINITY);
    let usable = LEAST_COEFFICIENT * (1.0 - ROUNDING)..=largest_gain * (1.0 + ROUNDING);
    let is_usable = |coefficient: &f64| usable.contains(coefficient);
    if coefficients.iter().all(is_usable) {
        return 1.0;
    }
    let chosen =
        fastest_frequency(input).map_or(1.0, |frequency| nearest_step(frequency / PLOTTER_FREQUENCY));
    let least = coefficients.into_iter().fold(0.0, f64::max) / largest_gain;
    let time_scale = if least > chosen { step_above(least) } else { chosen };
    time_scale.clamp(LIMITS.0, LIMITS.1)
}

/// The coefficients of all inputs of integrators at the time scale 1, without those that are 0.
fn coefficients(input: &Input<'_>, per_volt: &[f64]) -> Vec<f64> {
    let scale = |id: NodeId| per_volt[id.0 as usize];
    let mut coefficients = Vec::new();
    for id in input.plan.ids() {
        if let Operation::Integral { rate, .. } = input.operation(id) {
            let terms = rate.terms.iter();
            coefficients
                .extend(terms.map(|(node, c)| input.expressions.value(c).abs() * scale(*node) / scale(id)));
        }
    }
    coefficients.retain(|coefficient| coefficient.is_finite() && *coefficient > 0.0);
    coefficients
}

/// The largest frequency of the integrals in Hz: the rate of a sine is 2 pi times its frequency and its peak. `None` if
/// no integral changes.
fn fastest_frequency(input: &Input<'_>) -> Option<f64> {
    let integrals = input.plan.ids().filter(|id| matches!(input.operation(*id), Operation::Integral { .. }));
    let frequencies = integrals.map(|id| input.rates[id.0 as usize] / (TAU * input.peak(id)));
    frequencies.filter(|frequency| frequency.is_normal() && *frequency > 0.0).reduce(f64::max)
}
