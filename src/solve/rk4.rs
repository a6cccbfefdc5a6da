//! The classical Runge-Kutta step of order 4 (Kutta 1901).

use super::machine::Machine;

impl Machine<'_> {
    /// Puts the states one step of this length ahead into `trial`, from the present state and its rates,
    /// which `rates[0]` holds. Modes stay as they are.
    pub(super) fn rk4(&mut self, length: f64) {
        for (stage, share) in [(0, 0.5), (1, 0.5), (2, 1.0)] {
            self.trial_from(stage, share * length);
            self.evaluate_trial(self.time + share * length);
            self.keep_rates(stage + 1);
        }
        let sixth = length / 6.0;
        for (index, trial) in self.trial.iter_mut().enumerate() {
            let [first, second, third, fourth] = [0, 1, 2, 3].map(|stage: usize| self.rates[stage][index]);
            *trial = self.states[index] + sixth * (first + 2.0 * second + 2.0 * third + fourth);
        }
    }

    fn trial_from(&mut self, stage: usize, length: f64) {
        let rates = &self.rates[stage];
        for ((trial, state), rate) in self.trial.iter_mut().zip(&self.states).zip(rates) {
            *trial = state + length * rate;
        }
    }

    fn keep_rates(&mut self, stage: usize) {
        for (rate, state) in self.rates[stage].iter_mut().zip(&self.program.states) {
            *rate = self.trial_registers[state.rate.index()];
        }
    }
}
