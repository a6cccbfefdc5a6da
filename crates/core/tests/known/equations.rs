//! Equations in the units of their problem, stepped apart from any wiring.

/// Equations of so many states, bent where any of so many quantities passes 0.
pub trait Equations<const STATES: usize, const KINKS: usize> {
    /// The rates at a time, with what the signs of the kinks choose.
    fn rates(&self, state: [f64; STATES], time: f64, sides: [f64; KINKS]) -> [f64; STATES];

    /// What turns a corner in the rates where it passes 0.
    fn kinks(&self, state: [f64; STATES]) -> [f64; KINKS];

    /// When what drives them turns a corner.
    fn turn(&self) -> f64 {
        f64::INFINITY
    }

    /// A state just past a kink, brought to where it stays if something holds it there.
    fn settled(&self, state: [f64; STATES]) -> [f64; STATES] {
        state
    }

    /// The states at 0, every, 2 every, ... by the classical Runge-Kutta method with this step, no part of which
    /// reaches across a kink.
    fn course(&self, begin: [f64; STATES], duration: f64, every: f64, step: f64) -> Vec<[f64; STATES]> {
        let (rows, steps) = ((duration / every).round() as usize, (every / step).round() as usize);
        let mut state = begin;
        let mut course = vec![state];
        for row in 0..rows {
            for index in 0..steps {
                state = self.stepped_to_turn(state, (row * steps + index) as f64 * step, step);
            }
            course.push(state);
        }
        course
    }

    /// A step, in two parts where the drive turns inside it.
    fn stepped_to_turn(&self, state: [f64; STATES], time: f64, step: f64) -> [f64; STATES] {
        let before = self.turn() - time;
        if before <= 0.0 || before >= step {
            return self.stepped_to_kinks(state, time, step);
        }
        let turning = self.stepped_to_kinks(state, time, before);
        self.stepped_to_kinks(turning, self.turn(), step - before)
    }

    /// A step, in as many parts as there are kinks inside it, each found by halving.
    fn stepped_to_kinks(&self, state: [f64; STATES], time: f64, step: f64) -> [f64; STATES] {
        let before = self.kinks(state);
        let crosses = |state: [f64; STATES]| {
            before.iter().zip(self.kinks(state)).any(|(before, after)| before * after < 0.0)
        };
        let whole = self.stepped(state, time, step);
        if !crosses(whole) {
            return whole;
        }
        let (mut low, mut high) = (0.0, step);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if crosses(self.stepped(state, time, middle)) { high = middle } else { low = middle }
        }
        self.stepped_to_kinks(self.settled(self.stepped(state, time, high)), time + high, step - high)
    }

    /// A step along curves that no kink bends: on the sides on which it begins, or where it begins on a kink, ends.
    fn stepped(&self, state: [f64; STATES], time: f64, step: f64) -> [f64; STATES] {
        let bent = self.stepped_on(state, time, step, |stage| self.kinks(stage));
        let (before, after) = (self.kinks(state), self.kinks(bent));
        let sides = std::array::from_fn(|kink| if before[kink] == 0.0 { after[kink] } else { before[kink] });
        self.stepped_on(state, time, step, |_| sides)
    }

    fn stepped_on(
        &self,
        state: [f64; STATES],
        time: f64,
        step: f64,
        sides: impl Fn([f64; STATES]) -> [f64; KINKS],
    ) -> [f64; STATES] {
        let rates = |stage: [f64; STATES], time: f64| self.rates(stage, time, sides(stage));
        let first = rates(state, time);
        let second = rates(ahead(state, first, step / 2.0), time + step / 2.0);
        let third = rates(ahead(state, second, step / 2.0), time + step / 2.0);
        let fourth = rates(ahead(state, third, step), time + step);
        std::array::from_fn(|index| {
            let sum = first[index] + 2.0 * second[index] + 2.0 * third[index] + fourth[index];
            state[index] + step / 6.0 * sum
        })
    }
}

fn ahead<const STATES: usize>(state: [f64; STATES], rates: [f64; STATES], step: f64) -> [f64; STATES] {
    std::array::from_fn(|index| state[index] + step * rates[index])
}

/// Rates without kinks, by state and time.
impl<const STATES: usize, F: Fn([f64; STATES], f64) -> [f64; STATES]> Equations<STATES, 0> for F {
    fn rates(&self, state: [f64; STATES], time: f64, _: [f64; 0]) -> [f64; STATES] {
        self(state, time)
    }

    fn kinks(&self, _: [f64; STATES]) -> [f64; 0] {
        []
    }
}
