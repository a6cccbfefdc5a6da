//! The slideway in physical units, written down apart from any wiring.

use crate::bench::{self, Changes};
use crate::dice::Dice;

/// How solid friction depends on velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// None at all.
    Absent,
    /// The same at every velocity.
    Constant,
    /// Straight down to 0 at VcL.
    Straight,
    /// Down to 0 at VcL along a square law.
    Square,
    /// The same, following velocity with the lag Tc.
    Remembered,
}

/// e' = v_in - v, w = K (e + x_step), M v' = dead_zone(w, F) - f v, Tc u' = (1 - min(|v| / VcL, 1)) - u.
#[derive(Debug, Clone)]
pub struct Slideway {
    pub law: Law,
    pub mass: f64,
    pub stiffness: f64,
    pub viscous: f64,
    pub solid: f64,
    pub vcl: f64,
    pub tc: f64,
    pub v_start: f64,
    pub v_rate: f64,
    pub v_turn: f64,
    pub x_step: f64,
}

/// Position error, output velocity, remembered share of friction.
type State = [f64; 3];

const AT_REST: State = [0.0, 0.0, 1.0];

impl Slideway {
    /// The final setting of the thesis (8.4) in a law.
    pub fn thesis(law: Law) -> Self {
        Slideway {
            law,
            mass: 433.0,
            stiffness: 45e6,
            viscous: 10.7e3,
            solid: 771.0,
            vcl: 2.54e-3,
            tc: 0.0065,
            v_start: 0.0,
            v_rate: 1.2e-3,
            v_turn: 3600.0,
            x_step: 0.0,
        }
    }

    /// A setting from the ranges of the patches.
    pub fn random(law: Law, dice: &mut Dice) -> Self {
        Slideway {
            mass: dice.logarithmic(180.0, 4000.0),
            stiffness: dice.logarithmic(5e6, 178e6),
            viscous: dice.logarithmic(100.0, 178e3),
            solid: dice.even(1.0, 2000.0),
            vcl: dice.logarithmic(0.254e-3, 50e-3),
            tc: dice.logarithmic(1e-3, 1.0),
            v_start: dice.even(-0.01, 0.01),
            v_rate: dice.even(-3e-3, 3e-3),
            v_turn: dice.even(0.0, 0.4),
            ..Slideway::thesis(law)
        }
    }

    /// The same setting for the patch of its law.
    pub fn changes(&self) -> Changes {
        let mut changes = bench::changes(&[
            ("M", self.mass),
            ("K", self.stiffness),
            ("f", self.viscous),
            ("v_start", self.v_start),
            ("v_rate", self.v_rate),
            ("v_turn", self.v_turn),
            ("x_step", self.x_step),
        ]);
        if self.law != Law::Absent {
            changes.push(("Fs".into(), self.solid));
        }
        if !matches!(self.law, Law::Absent | Law::Constant) {
            changes.push(("VcL".into(), self.vcl));
        }
        if self.law == Law::Remembered {
            changes.push(("Tc".into(), self.tc));
        }
        changes
    }

    /// Output velocity at 0, every, 2 every, ... by the classical Runge-Kutta method with this step, no part of which
    /// reaches across a kink.
    pub fn velocity(&self, duration: f64, every: f64, step: f64) -> Vec<f64> {
        let (rows, steps) = ((duration / every).round() as usize, (every / step).round() as usize);
        let mut state = AT_REST;
        let mut velocities = vec![state[1]];
        for row in 0..rows {
            for index in 0..steps {
                state = self.stepped_to_turn(state, (row * steps + index) as f64 * step, step);
            }
            velocities.push(state[1]);
        }
        velocities
    }

    /// A step, in two parts where the command turns inside it.
    fn stepped_to_turn(&self, state: State, time: f64, step: f64) -> State {
        let before = self.v_turn - time;
        if before <= 0.0 || before >= step {
            return self.stepped_to_kinks(state, time, step);
        }
        let turning = self.stepped_to_kinks(state, time, before);
        self.stepped_to_kinks(turning, self.v_turn, step - before)
    }

    /// A step, in as many parts as there are kinks inside it, each found by halving.
    fn stepped_to_kinks(&self, state: State, time: f64, step: f64) -> State {
        let before = self.kinks(state);
        let crosses =
            |state: State| before.iter().zip(self.kinks(state)).any(|(before, after)| before * after < 0.0);
        let whole = self.stepped(state, time, step);
        if !crosses(whole) {
            return whole;
        }
        let (mut low, mut high) = (0.0, step);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if crosses(self.stepped(state, time, middle)) { high = middle } else { low = middle }
        }
        self.stepped_to_kinks(self.stepped(state, time, high), time + high, step - high)
    }

    /// What turns a corner in the rates where it passes 0: edges of the dead zone, the velocity's sign, VcL, and the
    /// memory's end.
    fn kinks(&self, [error, velocity, memory]: State) -> [f64; 6] {
        let spring = self.stiffness * (error + self.x_step);
        let friction = self.friction(self.share(velocity), memory.max(0.0));
        [spring - friction, spring + friction, velocity, velocity - self.vcl, velocity + self.vcl, memory]
    }

    /// A step along curves that no kink bends: on the sides on which it begins, or where it begins on a kink, ends.
    fn stepped(&self, state: State, time: f64, step: f64) -> State {
        let bent = self.stepped_on(state, time, step, |stage| self.kinks(stage));
        let (before, after) = (self.kinks(state), self.kinks(bent));
        let sides = std::array::from_fn(|kink| if before[kink] == 0.0 { after[kink] } else { before[kink] });
        self.stepped_on(state, time, step, |_| sides)
    }

    fn stepped_on(&self, state: State, time: f64, step: f64, sides: impl Fn(State) -> [f64; 6]) -> State {
        let rates = |stage: State, time: f64| self.rates(stage, time, sides(stage));
        let first = rates(state, time);
        let second = rates(ahead(state, first, step / 2.0), time + step / 2.0);
        let third = rates(ahead(state, second, step / 2.0), time + step / 2.0);
        let fourth = rates(ahead(state, third, step), time + step);
        std::array::from_fn(|index| {
            let sum = first[index] + 2.0 * second[index] + 2.0 * third[index] + fourth[index];
            state[index] + step / 6.0 * sum
        })
    }

    /// The rates, with what the signs of the kinks choose.
    fn rates(&self, [error, velocity, memory]: State, time: f64, sides: [f64; 6]) -> State {
        let [above, below, forward, fast, back, remembered] = sides.map(|side| side >= 0.0);
        let spring = self.stiffness * (error + self.x_step);
        let speed = if forward { velocity } else { -velocity };
        let share = if fast || !back { 0.0 } else { 1.0 - speed / self.vcl };
        let friction = self.friction(share, if remembered { memory } else { 0.0 });
        // What of the force lies beyond the dead zone.
        let above = if above { spring - friction } else { 0.0 };
        let below = if below { 0.0 } else { spring + friction };
        let accelerating = above + below - self.viscous * velocity;
        let commanded = self.v_start + self.v_rate * time.min(2.0 * self.v_turn - time);
        [commanded - velocity, accelerating / self.mass, (share - memory) / self.tc]
    }

    /// What is left of friction at a velocity, before the law's own curve.
    fn share(&self, velocity: f64) -> f64 {
        1.0 - (velocity.abs() / self.vcl).min(1.0)
    }

    fn friction(&self, share: f64, memory: f64) -> f64 {
        self.solid
            * match self.law {
                Law::Absent => 0.0,
                Law::Constant => 1.0,
                Law::Straight => share,
                Law::Square => share * share,
                Law::Remembered => memory * memory,
            }
    }
}

fn ahead(state: State, rates: State, step: f64) -> State {
    std::array::from_fn(|index| state[index] + step * rates[index])
}

/// Compared over this time, in seconds, at instants this far apart, against equations with this step.
const COMPARED: f64 = 0.2;
const EVERY: f64 = 1e-3;
const FINE_STEP: f64 = 1e-6;
/// Wiring at its own step and equations at the fine one may differ by this share of the peak velocity;
/// they come to 6.1e-7 at the worst of the settings here.
const TOLERANCE: f64 = 2e-6;

/// Output velocity of the wiring at its own step, unless a lamp lit.
pub fn wired(stem: &str, slideway: &Slideway, duration: f64) -> Option<Vec<f64>> {
    let trace = bench::run(stem, &slideway.changes(), duration, EVERY, &["v_o"]);
    bench::lit(&trace).is_empty().then(|| trace.values("v_o").unwrap())
}

/// Holds the wiring against what the output velocity should be; tells whether it could, no lamp being lit.
fn agrees(stem: &str, slideway: &Slideway, expected: impl Fn() -> Vec<f64>) -> bool {
    let Some(found) = wired(stem, slideway, COMPARED) else { return false };
    let off = bench::difference(&found, &expected());
    assert!(off < TOLERANCE, "{stem} is {off:.1e} off at {slideway:?}");
    true
}

/// Holds the wiring at its own step against the equations at a fine one.
pub fn agrees_at(stem: &str, slideway: &Slideway) -> bool {
    agrees(stem, slideway, || slideway.velocity(COMPARED, EVERY, FINE_STEP))
}

/// The same at 20 random settings at which no lamp lights; few may be lost to overload.
pub fn agrees_at_random_settings(stem: &str, law: Law, check: impl Fn(&str, &Slideway) -> bool) {
    let mut dice = Dice(816);
    let (mut compared, mut skipped) = (0, 0);
    while compared < 20 {
        let could = check(stem, &Slideway::random(law, &mut dice));
        compared += usize::from(could);
        skipped += usize::from(!could);
        assert!(skipped <= 5, "{stem} cannot be compared at {skipped} settings");
    }
}

/// Holds the wiring against the equations at the wiring's own step: nothing but rounding differs.
pub fn equals_at_own_step(stem: &str, slideway: &Slideway, duration: f64) -> bool {
    let Some(found) = wired(stem, slideway, duration) else { return false };
    let off = bench::difference(&found, &slideway.velocity(duration, EVERY, 2e-5));
    assert!(off < 1e-9, "{stem} is {off:.1e} off at {slideway:?}");
    true
}

/// The same at random settings, for a short time: there are some at which the last bit of K comes to 2e-9
/// after 2 s of stick-slip.
pub fn equals_at_random_settings(stem: &str, law: Law) {
    agrees_at_random_settings(stem, law, |stem, slideway| equals_at_own_step(stem, slideway, COMPARED));
}
