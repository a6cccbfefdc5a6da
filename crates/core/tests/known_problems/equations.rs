//! A reference solver for equations in the units of their problem, independent of patches and of the engine.

/// Equations with STATES states. Their rates have a kink where any of KINKS quantities passes 0.
pub(crate) trait Equations<const STATES: usize, const KINKS: usize> {
    /// The rates at a time. The signs of `sides` select the branch at every kink.
    fn rates(&self, state: [f64; STATES], time: f64, sides: [f64; KINKS]) -> [f64; STATES];

    /// The quantities whose zero crossings are kinks of the rates.
    fn kinks(&self, state: [f64; STATES]) -> [f64; KINKS];

    /// The time at which the drive has a corner, in seconds.
    fn drive_corner(&self) -> f64 {
        f64::INFINITY
    }

    /// The state just after a kink, or the state in which a brake or limit holds it.
    fn held_at_kink(&self, state: [f64; STATES]) -> [f64; STATES] {
        state
    }

    /// The states at 0, every, 2 every, ... by the classical Runge-Kutta method with equal steps. A step across a kink
    /// is divided at the kink.
    fn integrate(&self, begin: [f64; STATES], duration: f64, every: f64, step: f64) -> Vec<[f64; STATES]> {
        let (rows, steps) = ((duration / every).round() as usize, (every / step).round() as usize);
        let mut state = begin;
        let mut trajectory = vec![state];
        for row in 0..rows {
            for index in 0..steps {
                state = self.step_across_corner(state, (row * steps + index) as f64 * step, step);
            }
            trajectory.push(state);
        }
        trajectory
    }

    /// One step, divided in two if the drive has a corner inside it.
    fn step_across_corner(&self, state: [f64; STATES], time: f64, step: f64) -> [f64; STATES] {
        let before = self.drive_corner() - time;
        if before <= 0.0 || before >= step {
            return self.step_across_kinks(state, time, step);
        }
        let at_corner = self.step_across_kinks(state, time, before);
        self.step_across_kinks(at_corner, self.drive_corner(), step - before)
    }

    /// One step, divided at every kink inside it. Bisection locates the kinks.
    fn step_across_kinks(&self, state: [f64; STATES], time: f64, step: f64) -> [f64; STATES] {
        let before = self.kinks(state);
        let crosses = |state: [f64; STATES]| {
            before.iter().zip(self.kinks(state)).any(|(before, after)| before * after < 0.0)
        };
        let whole = self.smooth_step(state, time, step);
        if !crosses(whole) {
            return whole;
        }
        let (mut low, mut high) = (0.0, step);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if crosses(self.smooth_step(state, time, middle)) { high = middle } else { low = middle }
        }
        self.step_across_kinks(
            self.held_at_kink(self.smooth_step(state, time, high)),
            time + high,
            step - high,
        )
    }

    /// One step with fixed branches: those at its beginning, or at its end for a kink that is at 0 at the beginning.
    fn smooth_step(&self, state: [f64; STATES], time: f64, step: f64) -> [f64; STATES] {
        let with_kinks = self.runge_kutta_step(state, time, step, |stage| self.kinks(stage));
        let (before, after) = (self.kinks(state), self.kinks(with_kinks));
        let sides = std::array::from_fn(|kink| if before[kink] == 0.0 { after[kink] } else { before[kink] });
        self.runge_kutta_step(state, time, step, |_| sides)
    }

    /// One classical Runge-Kutta step. `sides` gives the branches at a stage.
    fn runge_kutta_step(
        &self,
        state: [f64; STATES],
        time: f64,
        step: f64,
        sides: impl Fn([f64; STATES]) -> [f64; KINKS],
    ) -> [f64; STATES] {
        let rates = |stage: [f64; STATES], time: f64| self.rates(stage, time, sides(stage));
        let first = rates(state, time);
        let second = rates(euler_step(state, first, step / 2.0), time + step / 2.0);
        let third = rates(euler_step(state, second, step / 2.0), time + step / 2.0);
        let fourth = rates(euler_step(state, third, step), time + step);
        std::array::from_fn(|index| {
            let sum = first[index] + 2.0 * second[index] + 2.0 * third[index] + fourth[index];
            state[index] + step / 6.0 * sum
        })
    }
}

/// The state after an Euler step.
fn euler_step<const STATES: usize>(state: [f64; STATES], rates: [f64; STATES], step: f64) -> [f64; STATES] {
    std::array::from_fn(|index| state[index] + step * rates[index])
}

/// A function of state and time is a system without kinks.
impl<const STATES: usize, F: Fn([f64; STATES], f64) -> [f64; STATES]> Equations<STATES, 0> for F {
    fn rates(&self, state: [f64; STATES], time: f64, _: [f64; 0]) -> [f64; STATES] {
        self(state, time)
    }

    fn kinks(&self, _: [f64; STATES]) -> [f64; 0] {
        []
    }
}
