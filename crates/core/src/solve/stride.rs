//! A step of any Runge-Kutta method, and the curve within it.

use super::machine::{Machine, Wanted};
use super::tableau::{Share, Tableau};
use crate::machines::REFERENCE;

/// States smaller than this, in volts, are 0: processors are slow on the smallest numbers.
pub(super) const SMALLEST: f64 = 1e-100;

impl Machine<'_> {
    /// Looks ahead by a step of this length, from the present states and their rates: states and voltages at its
    /// end. Modes stay as they are.
    pub(super) fn step_ahead(&mut self, length: f64) {
        self.scratch.faults.clear();
        self.work.evaluations += self.method.rates() as u64 - 1;
        self.rates[0].copy_from_slice(&self.slopes);
        for (stage, row) in self.method.stages.iter().enumerate() {
            self.trial_from(row.from, length);
            let glance = self.method.glances.iter().position(|own| *own == stage);
            let wanted = if glance.is_some() { Wanted::Ahead } else { Wanted::Rates };
            self.evaluate_trial(self.time + row.at * length, wanted);
            self.keep_rates(stage + 1);
            if let Some(glance) = glance {
                self.glances[glance].copy_from_slice(&self.trial_registers);
            }
        }
        self.trial_from(self.method.end, length / self.method.parts);
        without_dust(&mut self.trial);
        self.evaluate_trial(self.time + length, Wanted::Ahead);
        self.keep_rates(self.method.rates() - 1);
        self.hint = self.suspicion();
    }

    pub(super) fn trial_from(&mut self, shares: &[Share], length: f64) {
        for (index, (trial, state)) in self.trial.iter_mut().zip(&self.states).enumerate() {
            *trial = state + length * combined(&self.rates, shares, index);
        }
    }

    fn keep_rates(&mut self, stage: usize) {
        for (rate, state) in self.rates[stage].iter_mut().zip(&self.program.states) {
            *rate = self.trial_registers[state.rate.index()];
        }
    }

    /// The state in which two orders differ most over the step looked at, and by how many machine units (100 V).
    pub(super) fn worst_error(&self, length: f64) -> (usize, f64) {
        let error = |state| length * combined(&self.rates, self.method.difference, state).abs() / REFERENCE;
        let larger = |worst: (usize, f64), state| {
            let error = error(state);
            if error > worst.1 || error.is_nan() { (state, error) } else { worst }
        };
        (0..self.states.len()).fold((0, 0.0), larger)
    }

    /// Works out the voltages of an instant within the last stretch: by the cubic through the states and rates at
    /// its ends (Hermite), and what the method knows beyond it.
    pub(super) fn look_back(&mut self, time: f64) {
        let length = self.time - self.last.time;
        let curve = Curve::new(self.method, length, (time - self.last.time) / length);
        for (index, trial) in self.trial.iter_mut().enumerate() {
            let value = curve.value([self.last.states[index], self.states[index]], &self.rates, index);
            let [low, high] = self.program.states[index].limits.map(|limit| self.registers[limit.index()]);
            *trial = if value < low {
                low
            } else if value > high {
                high
            } else {
                value
            };
        }
        self.evaluate_trial(time, Wanted::Ahead);
        self.beside(|own, machine| own.look_back(machine, time, &curve));
    }
}

/// The curve within a stretch, at one place: shares of states and rates.
pub(super) struct Curve {
    states: [f64; 2],
    rates: [f64; 2],
    bulge: f64,
    shares: &'static [Share],
}

impl Curve {
    /// That of a method, after a share of a stretch of this length.
    fn new(method: &Tableau, length: f64, share: f64) -> Self {
        let [states, rates] = cubic(length, share);
        let middle = share * (1.0 - share);
        Curve { states, rates, bulge: length * middle * middle, shares: method.bulge }
    }

    /// A state by its values at both ends and the rates of the stages, of which the last is that at the end.
    pub fn value(&self, [from, to]: [f64; 2], rates: &[Vec<f64>], state: usize) -> f64 {
        self.states[0] * from
            + self.rates[0] * rates[0][state]
            + self.states[1] * to
            + self.rates[1] * rates[rates.len() - 1][state]
            + self.bulge * combined(rates, self.shares, state)
    }
}

/// Shares of the states and of the rates at both ends of a stretch in the cubic through them (Hermite), after a share of
/// its length.
pub(super) fn cubic(length: f64, share: f64) -> [[f64; 2]; 2] {
    let rest = 1.0 - share;
    [
        [(1.0 + 2.0 * share) * rest * rest, share * share * (3.0 - 2.0 * share)],
        [share * rest * rest * length, -share * share * rest * length],
    ]
}

/// States too small to matter are 0.
pub(super) fn without_dust(states: &mut [f64]) {
    states.iter_mut().filter(|volts| volts.abs() < SMALLEST).for_each(|volts| *volts = 0.0);
}

/// Rates of a state, each times its share.
pub(super) fn combined(rates: &[Vec<f64>], shares: &[Share], state: usize) -> f64 {
    shares.iter().map(|(stage, share)| share * rates[*stage][state]).sum()
}
