//! Interpolation within the step accepted last (dense output).
//!
//! The curve of the states is the cubic through the states and rates at both ends of the step (Hermite), plus a
//! correction of order 4 if the method has one. All voltages are then evaluated for these states.

use super::evaluate::{Scope, trial};
use super::runge_kutta::weighted_sum;
use super::state::Solver;
use super::tableau::{Share, Tableau};

impl Solver<'_> {
    /// Interpolates at a problem time within the last step. States and voltages of that instant are then in the
    /// buffers. Limited states are clipped to the limits at the end of the step.
    pub fn interpolate(&mut self, time: f64) {
        let Solver { setup, state, delay_lines, buffers, sensitivities } = self;
        let length = state.time - buffers.last.time;
        let curve = Curve::new(setup.method, length, (time - buffers.last.time) / length);
        for (index, inner) in buffers.states.iter_mut().enumerate() {
            let ends = [buffers.last.states[index], state.states[index]];
            let value = curve.value(ends, &buffers.stage_rates, index);
            let [low, high] = setup.program.states[index].limits.map(|limit| state.voltages[limit.index()]);
            *inner = if value < low {
                low
            } else if value > high {
                high
            } else {
                value
            };
        }
        trial(setup.program, state, delay_lines, buffers, time, Scope::All);
        if let Some(own) = sensitivities {
            own.interpolate(setup.program, delay_lines, time, &curve, &buffers.voltages);
        }
    }
}

/// The curve within a step at one instant: the weights of the states and rates.
pub(super) struct Curve {
    /// Weights of the states at both ends.
    states: [f64; 2],
    /// Weights of the rates at both ends, in seconds.
    rates: [f64; 2],
    /// Weight of the correction, in seconds.
    correction: f64,
    /// The correction as shares of the rates of the stages.
    shares: &'static [Share],
}

impl Curve {
    /// The curve of a method after a share (0 ... 1) of a step of this length.
    fn new(method: &Tableau, length: f64, share: f64) -> Self {
        let [states, rates] = hermite(length, share);
        let middle = share * (1.0 - share);
        Curve { states, rates, correction: length * middle * middle, shares: method.correction }
    }

    /// The value of a state, given by its index, from its values at both ends and the rates of the stages. The last of
    /// these rates is the rate at the end of the step.
    pub fn value(&self, [from, to]: [f64; 2], rates: &[Vec<f64>], state: usize) -> f64 {
        self.states[0] * from
            + self.rates[0] * rates[0][state]
            + self.states[1] * to
            + self.rates[1] * rates[rates.len() - 1][state]
            + self.correction * weighted_sum(rates, self.shares, state)
    }
}

/// Weights of the states and of the rates at both ends of a step in the cubic through them (Hermite), after a share
/// (0 ... 1) of its length. The weights of the rates are in seconds.
pub(super) fn hermite(length: f64, share: f64) -> [[f64; 2]; 2] {
    let rest = 1.0 - share;
    [
        [(1.0 + 2.0 * share) * rest * rest, share * share * (3.0 - 2.0 * share)],
        [share * rest * rest * length, -share * share * rest * length],
    ]
}
