//! The lessons: one problem for each patch of patches/lessons.

use std::f64::consts::TAU;

use super::closed_form::bouncing_height;
use super::equations::Equations;
use super::{DEFAULTS, ErrorSource, Problem, Solution, heat_rod, stick_slip};

/// The patch's step divided by that of the reference solver. With an order of 4, the reference error is less than a
/// millionth of the patch's error.
const STEP_RATIO: f64 = 50.0;

/// The problems in the order of docs/lessons.md.
pub(crate) static PROBLEMS: [Problem; 13] = [
    Problem {
        name: "mass-and-spring",
        patch: "lessons/mass-and-spring",
        signal: "x",
        duration: 3.0,
        every: 0.037,
        solution: Solution::ClosedForm(mass_and_spring),
        max_error: 3e-10,
        ..DEFAULTS
    },
    Problem {
        name: "driven-oscillator",
        patch: "lessons/driven-oscillator",
        signal: "x",
        duration: 8.0,
        every: 0.037,
        solution: Solution::ClosedForm(driven_oscillator),
        max_error: 2e-9,
        ..DEFAULTS
    },
    Problem {
        name: "two-phase-oscillator",
        patch: "lessons/two-phase-oscillator",
        signal: "cosine",
        duration: 15.0,
        every: 0.05,
        solution: Solution::Integrated(two_phase_oscillator),
        max_error: 2e-8,
        ..DEFAULTS
    },
    Problem {
        name: "van-der-pol",
        patch: "lessons/van-der-pol",
        signal: "x",
        duration: 40.0,
        every: 0.1,
        solution: Solution::Integrated(van_der_pol),
        max_error: 5e-9,
        ..DEFAULTS
    },
    Problem {
        name: "lorenz",
        patch: "lessons/lorenz",
        changes: &[("x0", 10.0), ("y0", 5.0), ("z0", 30.0)],
        signal: "x",
        duration: 5.0,
        every: 0.01,
        solution: Solution::Integrated(lorenz),
        max_error: 4e-8,
        step_factor: 0.125,
        ..DEFAULTS
    },
    Problem {
        name: "mathieu",
        patch: "lessons/mathieu",
        signal: "y",
        duration: 60.0,
        every: 0.1,
        solution: Solution::Integrated(mathieu),
        max_error: 5e-10,
        ..DEFAULTS
    },
    Problem {
        name: "predator-and-prey",
        patch: "lessons/predator-and-prey",
        signal: "hares",
        duration: 40.0,
        every: 0.1,
        solution: Solution::Integrated(predator_and_prey),
        max_error: 2e-10,
        ..DEFAULTS
    },
    Problem {
        name: "bouncing-ball",
        patch: "lessons/bouncing-ball",
        signal: "y",
        duration: 6.0,
        every: 0.037,
        solution: Solution::ClosedForm(bouncing_ball),
        max_error: 2e-14,
        error_source: ErrorSource::Rounding,
        ..DEFAULTS
    },
    Problem {
        name: "projectile",
        patch: "lessons/projectile",
        signal: "x",
        duration: 4.9,
        every: 0.05,
        solution: Solution::Integrated(projectile),
        max_error: 2.5e-7,
        error_source: ErrorSource::Amplification,
        ..DEFAULTS
    },
    Problem {
        name: "square-root-and-division",
        patch: "lessons/square-root-and-division",
        signal: "h",
        duration: 200.0,
        every: 1.0,
        solution: Solution::ClosedForm(square_root_and_division),
        max_error: 6e-7,
        error_source: ErrorSource::Amplification,
        ..DEFAULTS
    },
    Problem {
        name: "heat-rod",
        patch: "lessons/heat-rod",
        signal: "T6",
        duration: 1500.0,
        every: 5.0,
        solution: Solution::ClosedForm(|time| heat_rod::chain(heat_rod::CELLS, time)),
        max_error: 1e-10,
        ..DEFAULTS
    },
    Problem {
        name: "relay-thermostat",
        patch: "lessons/relay-thermostat",
        signal: "T",
        duration: 2000.0,
        every: 7.0,
        solution: Solution::ClosedForm(relay_thermostat),
        max_error: 1.5e-14,
        step_factor: 16.0,
        ..DEFAULTS
    },
    Problem {
        name: "stick-slip",
        patch: "lessons/stick-slip",
        signal: "x",
        duration: 5.0,
        every: 0.037,
        solution: Solution::ClosedForm(stick_slip::stretch),
        max_error: 6e-10,
        step_factor: 0.5,
        ..DEFAULTS
    },
];

/// x'' = -40 x from 80 mm.
fn mass_and_spring(time: f64) -> f64 {
    80.0 * (40f64.sqrt() * time).cos()
}

/// x'' = -2 x' - 40 x + sin(2 pi t) from rest, in mm: the steady oscillation plus a damped free one.
fn driven_oscillator(time: f64) -> f64 {
    let (damping, stiffness) = (2.0, 40.0);
    let (real, imaginary) = (stiffness - TAU * TAU, damping * TAU);
    let size = real * real + imaginary * imaginary;
    let (sine, cosine) = (1e3 * real / size, -1e3 * imaginary / size);
    let (decay, free_frequency) = (0.5 * damping, (stiffness - 0.25 * damping * damping).sqrt());
    let (position, speed) = (-cosine, -TAU * sine);
    let free = position * (free_frequency * time).cos()
        + (speed + decay * position) / free_frequency * (free_frequency * time).sin();
    sine * (TAU * time).sin() + cosine * (TAU * time).cos() + (-decay * time).exp() * free
}

/// x' = -w y + 0.05 w x - 0.25 w d(x), y' = w x from 20 V, with w = 2 pi and a dead zone d of 50 V.
struct TwoPhaseOscillator;

impl Equations<2, 2> for TwoPhaseOscillator {
    fn rates(&self, [x, y]: [f64; 2], _: f64, [above, below]: [f64; 2]) -> [f64; 2] {
        let over = if above >= 0.0 { x - 50.0 } else { 0.0 };
        let under = if below >= 0.0 { 0.0 } else { x + 50.0 };
        [TAU * (-y + 0.05 * x - 0.25 * (over + under)), TAU * x]
    }

    fn kinks(&self, [x, _]: [f64; 2]) -> [f64; 2] {
        [x - 50.0, x + 50.0]
    }
}

/// The samples of x.
fn two_phase_oscillator(duration: f64, every: f64) -> Vec<f64> {
    first_states(TwoPhaseOscillator.integrate([20.0, 0.0], duration, every, 2e-3 / STEP_RATIO))
}

/// x'' = (1 - x^2) x' - x from 0.2.
fn van_der_pol(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[x, v]: [f64; 2], _: f64| [v, (1.0 - x * x) * v - x];
    first_states(rates.integrate([0.2, 0.0], duration, every, 5e-3 / STEP_RATIO))
}

/// x' = 10 (y - x), y' = 28 x - y - x z, z' = x y - 8/3 z from (10, 5, 30).
fn lorenz(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[x, y, z]: [f64; 3], _: f64| [10.0 * (y - x), 28.0 * x - y - x * z, x * y - 8.0 / 3.0 * z];
    first_states(rates.integrate([10.0, 5.0, 30.0], duration, every, 2e-3 / STEP_RATIO))
}

/// y'' = -(1.3 - 0.4 cos 2t) y from 0.5.
fn mathieu(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[y, v]: [f64; 2], time: f64| [v, -(1.3 - 0.4 * (2.0 * time).cos()) * y];
    first_states(rates.integrate([0.5, 0.0], duration, every, 5e-3 / STEP_RATIO))
}

/// x' = 0.55 x - 2.8e-5 x y, y' = 2.4e-5 x y - 0.8 y from 34000 and 6000.
fn predator_and_prey(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[x, y]: [f64; 2], _: f64| [0.55 * x - 2.8e-5 * x * y, 2.4e-5 * x * y - 0.8 * y];
    first_states(rates.integrate([34_000.0, 6_000.0], duration, every, 1e-2 / STEP_RATIO))
}

/// A fall from 1.8 m. Each bounce returns 0.85 of the velocity.
fn bouncing_ball(time: f64) -> f64 {
    bouncing_height(1.8, 9.81, 0.85, time)
}

/// A throw at 45 m/s and 40 degrees: 0.145 v' = 0.145 g - 8.8e-4 |v| v.
fn projectile(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[_, across, _, upward]: [f64; 4], _: f64| {
        let drag = 8.8e-4 / 0.145 * across.hypot(upward);
        [across, -drag * across, upward, -drag * upward - 9.81]
    };
    let (sine, cosine) = 40f64.to_radians().sin_cos();
    first_states(rates.integrate([0.0, 45.0 * cosine, 0.0, 45.0 * sine], duration, every, 5e-3 / STEP_RATIO))
}

/// 0.05 h' = -1e-4 sqrt(2 g h) from 1 m (Torricelli).
fn square_root_and_division(time: f64) -> f64 {
    torricelli(1e-4, 1.0, time)
}

/// Height of the water in m above a hole of `hole` m2, from an initial height in m.
pub(crate) fn torricelli(hole: f64, height: f64, time: f64) -> f64 {
    (height.sqrt() - hole / 0.05 * (0.5 * 9.81f64).sqrt() * time).powi(2)
}

/// 2090 T' = P - 2 T with P = 100 W or 0, between 15 and 19 K: exponentials towards 50 K and 0.
fn relay_thermostat(time: f64) -> f64 {
    let (end, low, high) = (50.0, 15.0, 19.0);
    let [first, off, on] = thermostat(2.0, 100.0, low, high);
    if time < first {
        return end * (1.0 - (-time / 1045.0).exp());
    }
    let elapsed = (time - first).rem_euclid(off + on);
    if elapsed < off {
        high * (-elapsed / 1045.0).exp()
    } else {
        end - (end - low) * (-(elapsed - off) / 1045.0).exp()
    }
}

/// The time in s at which a heater of `power` W is first switched off, and how long it is off and on after that. `loss`
/// is in W/K, the thresholds `low` and `high` in K.
pub(crate) fn thermostat(loss: f64, power: f64, low: f64, high: f64) -> [f64; 3] {
    let (time_constant, end) = (2090.0 / loss, power / loss);
    [(end / (end - high)).ln(), (high / low).ln(), ((end - low) / (end - high)).ln()]
        .map(|log| time_constant * log)
}

/// The first state at every sample.
fn first_states<const STATES: usize>(trajectory: Vec<[f64; STATES]>) -> Vec<f64> {
    trajectory.into_iter().map(|state| state[0]).collect()
}
