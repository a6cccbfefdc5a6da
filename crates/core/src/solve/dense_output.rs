//! Interpolation within the step accepted last (dense output).
//!
//! The curve of the states is the cubic through the states and rates at both ends of the step (Hermite), plus a
//! correction of order 4 if the method has one. All voltages are then evaluated for these states.

use super::evaluate::{Scope, trial};
use super::runge_kutta::weighted_sum;
use super::state::Solver;
use super::tableau::{StageWeight, Tableau};

impl Solver<'_> {
    /// Interpolates at a problem time within the last step, its ends included. States and voltages of that instant, and
    /// the slopes by parameters, are then in the buffers. States are clipped to their limits at the end of the step.
    pub(super) fn interpolate(&mut self, time: f64) {
        let Solver { setup, state, delay_lines, buffers, sensitivities } = self;
        let length = state.time - buffers.last.time;
        let curve = Curve::new(setup.method, length, (time - buffers.last.time) / length);
        for (index, interpolated) in buffers.states.iter_mut().enumerate() {
            let ends = [buffers.last.states[index], state.states[index]];
            let value = curve.value(ends, &buffers.stage_rates, index);
            let [low, high] =
                setup.program.lowered.states[index].limits.map(|limit| state.voltages[limit.index()]);
            *interpolated = if value < low {
                low
            } else if value > high {
                high
            } else {
                value
            };
        }
        trial(setup.program, state, delay_lines, buffers, time, Scope::All);
        if let Some(sensitivities) = sensitivities {
            sensitivities.interpolate(setup.program, delay_lines, time, &curve, &buffers.voltages);
        }
    }
}

/// The curve of the states at one instant within a step, as the weights of the states and rates. It serves for all
/// states and, because it is linear, also for their slopes.
#[derive(Debug)]
pub struct Curve {
    /// Weights of the states at the beginning and at the end.
    states: [f64; 2],
    /// Weights of the rates at the beginning and at the end, in seconds.
    rates: [f64; 2],
    /// Weight of the correction, in seconds: length times s^2 (1 - s)^2 after a share s.
    correction: f64,
    /// The weights of the rates of the stages in the correction.
    weights: &'static [StageWeight],
}

impl Curve {
    /// The curve of a method after a share (0 ... 1) of a step of this length.
    pub fn new(method: &Tableau, length: f64, share: f64) -> Self {
        let [states, rates] = hermite(length, share);
        let parabola = share * (1.0 - share);
        Curve { states, rates, correction: length * parabola * parabola, weights: method.dense_correction }
    }

    /// The value of a state, given by its index, from its values at both ends and the rates of the stages. The last of
    /// these rates is the rate at the end of the step.
    pub fn value(&self, [from, to]: [f64; 2], rates: &[Vec<f64>], state: usize) -> f64 {
        self.states[0] * from
            + self.rates[0] * rates[0][state]
            + self.states[1] * to
            + self.rates[1] * rates[rates.len() - 1][state]
            + self.correction * weighted_sum(rates, self.weights, state)
    }
}

/// Weights of the states and of the rates at both ends of a step in the cubic through them (Hermite), after a share (0
/// ... 1) of its length. The result is `[states, rates]`, each at the beginning and the end; the weights of the rates
/// are in seconds.
pub(super) fn hermite(length: f64, share: f64) -> [[f64; 2]; 2] {
    let remaining = 1.0 - share;
    [
        [(1.0 + 2.0 * share) * remaining * remaining, share * share * (3.0 - 2.0 * share)],
        [share * remaining * remaining * length, -share * share * remaining * length],
    ]
}
