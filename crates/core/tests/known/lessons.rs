//! The lessons.

use std::f64::consts::TAU;

use super::closed::bounces;
use super::equations::Equations;
use super::{Known, Left, Problem, USUAL, heat_rod, stick_slip};

/// Equations are stepped so many times as finely as the patch: what they err by is less than a millionth of what it does.
const FINER: f64 = 50.0;

pub static PROBLEMS: [Problem; 13] = [
    Problem {
        name: "mass-and-spring",
        patch: "lessons/mass-and-spring",
        signal: "x",
        duration: 3.0,
        every: 0.037,
        known: Known::Closed(mass_and_spring),
        within: 3e-10,
        ..USUAL
    },
    Problem {
        name: "driven-oscillator",
        patch: "lessons/driven-oscillator",
        signal: "x",
        duration: 8.0,
        every: 0.037,
        known: Known::Closed(driven_oscillator),
        within: 2e-9,
        ..USUAL
    },
    Problem {
        name: "two-phase-oscillator",
        patch: "lessons/two-phase-oscillator",
        signal: "cosine",
        duration: 15.0,
        every: 0.05,
        known: Known::Stepped(two_phase_oscillator),
        within: 2e-8,
        ..USUAL
    },
    Problem {
        name: "van-der-pol",
        patch: "lessons/van-der-pol",
        signal: "x",
        duration: 40.0,
        every: 0.1,
        known: Known::Stepped(van_der_pol),
        within: 5e-9,
        ..USUAL
    },
    Problem {
        name: "lorenz",
        patch: "lessons/lorenz",
        changes: &[("x0", 10.0), ("y0", 5.0), ("z0", 30.0)],
        signal: "x",
        duration: 5.0,
        every: 0.01,
        known: Known::Stepped(lorenz),
        within: 4e-8,
        ladder: 0.125,
        ..USUAL
    },
    Problem {
        name: "mathieu",
        patch: "lessons/mathieu",
        signal: "y",
        duration: 60.0,
        every: 0.1,
        known: Known::Stepped(mathieu),
        within: 5e-10,
        ..USUAL
    },
    Problem {
        name: "predator-and-prey",
        patch: "lessons/predator-and-prey",
        signal: "hares",
        duration: 40.0,
        every: 0.1,
        known: Known::Stepped(predator_and_prey),
        within: 2e-10,
        ..USUAL
    },
    Problem {
        name: "bouncing-ball",
        patch: "lessons/bouncing-ball",
        signal: "y",
        duration: 6.0,
        every: 0.037,
        known: Known::Closed(bouncing_ball),
        within: 2e-14,
        left: Left::Rounding,
        ..USUAL
    },
    Problem {
        name: "projectile",
        patch: "lessons/projectile",
        signal: "x",
        duration: 4.9,
        every: 0.05,
        known: Known::Stepped(projectile),
        within: 2.5e-7,
        left: Left::Amplification,
        ..USUAL
    },
    Problem {
        name: "square-root-and-division",
        patch: "lessons/square-root-and-division",
        signal: "h",
        duration: 200.0,
        every: 1.0,
        known: Known::Closed(square_root_and_division),
        within: 6e-7,
        left: Left::Amplification,
        ..USUAL
    },
    Problem {
        name: "heat-rod",
        patch: "lessons/heat-rod",
        signal: "T6",
        duration: 1500.0,
        every: 5.0,
        known: Known::Closed(|time| heat_rod::chain(heat_rod::CELLS, time)),
        within: 1e-10,
        ..USUAL
    },
    Problem {
        name: "relay-thermostat",
        patch: "lessons/relay-thermostat",
        signal: "T",
        duration: 2000.0,
        every: 7.0,
        known: Known::Closed(relay_thermostat),
        within: 1.5e-14,
        ladder: 16.0,
        ..USUAL
    },
    Problem {
        name: "stick-slip",
        patch: "lessons/stick-slip",
        signal: "x",
        duration: 5.0,
        every: 0.037,
        known: Known::Closed(stick_slip::stretch),
        within: 6e-10,
        ladder: 0.5,
        ..USUAL
    },
];

/// x'' = -40 x from 80 mm.
fn mass_and_spring(time: f64) -> f64 {
    80.0 * (40f64.sqrt() * time).cos()
}

/// x'' = -2 x' - 40 x + sin(2 pi t) from rest, in mm: the steady swing, and a damped one that begins with what it lacks.
fn driven_oscillator(time: f64) -> f64 {
    let (damping, stiffness) = (2.0, 40.0);
    let (real, imaginary) = (stiffness - TAU * TAU, damping * TAU);
    let size = real * real + imaginary * imaginary;
    let (sine, cosine) = (1e3 * real / size, -1e3 * imaginary / size);
    let (decay, own) = (0.5 * damping, (stiffness - 0.25 * damping * damping).sqrt());
    let (place, speed) = (-cosine, -TAU * sine);
    let free = place * (own * time).cos() + (speed + decay * place) / own * (own * time).sin();
    sine * (TAU * time).sin() + cosine * (TAU * time).cos() + (-decay * time).exp() * free
}

/// x' = -w y + 0.05 w x - 0.25 w d(x), y' = w x, w = 2 pi, d a dead zone of 50 V, from 20 V.
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

fn two_phase_oscillator(duration: f64, every: f64) -> Vec<f64> {
    first(TwoPhaseOscillator.course([20.0, 0.0], duration, every, 2e-3 / FINER))
}

/// x'' = (1 - x^2) x' - x from 0.2.
fn van_der_pol(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[x, v]: [f64; 2], _: f64| [v, (1.0 - x * x) * v - x];
    first(rates.course([0.2, 0.0], duration, every, 5e-3 / FINER))
}

/// x' = 10 (y - x), y' = 28 x - y - x z, z' = x y - 8/3 z from (10, 5, 30).
fn lorenz(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[x, y, z]: [f64; 3], _: f64| [10.0 * (y - x), 28.0 * x - y - x * z, x * y - 8.0 / 3.0 * z];
    first(rates.course([10.0, 5.0, 30.0], duration, every, 2e-3 / FINER))
}

/// y'' = -(1.3 - 0.4 cos 2t) y from 0.5.
fn mathieu(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[y, v]: [f64; 2], time: f64| [v, -(1.3 - 0.4 * (2.0 * time).cos()) * y];
    first(rates.course([0.5, 0.0], duration, every, 5e-3 / FINER))
}

/// x' = 0.55 x - 2.8e-5 x y, y' = 2.4e-5 x y - 0.8 y from 34000 and 6000.
fn predator_and_prey(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[x, y]: [f64; 2], _: f64| [0.55 * x - 2.8e-5 * x * y, 2.4e-5 * x * y - 0.8 * y];
    first(rates.course([34_000.0, 6_000.0], duration, every, 1e-2 / FINER))
}

/// A fall from 1.8 m, and blows that throw back 0.85 of the velocity.
fn bouncing_ball(time: f64) -> f64 {
    bounces(1.8, 9.81, 0.85, time)
}

/// Thrown at 45 m/s and 40 degrees: 0.145 v' = 0.145 g - 8.8e-4 |v| v.
fn projectile(duration: f64, every: f64) -> Vec<f64> {
    let rates = |[_, across, _, upward]: [f64; 4], _: f64| {
        let drag = 8.8e-4 / 0.145 * across.hypot(upward);
        [across, -drag * across, upward, -drag * upward - 9.81]
    };
    let (sine, cosine) = 40f64.to_radians().sin_cos();
    first(rates.course([0.0, 45.0 * cosine, 0.0, 45.0 * sine], duration, every, 5e-3 / FINER))
}

/// 0.05 h' = -1e-4 sqrt(2 g h) from 1 m (Torricelli).
fn square_root_and_division(time: f64) -> f64 {
    torricelli(1e-4, 1.0, time)
}

/// Height of the water above a hole of so many m2, beginning at a height.
pub fn torricelli(hole: f64, height: f64, time: f64) -> f64 {
    (height.sqrt() - hole / 0.05 * (0.5 * 9.81f64).sqrt() * time).powi(2)
}

/// 2090 T' = P - 2 T, P 100 W or nothing, between 15 and 19 K: exponentials towards 50 K and 0.
fn relay_thermostat(time: f64) -> f64 {
    let (end, low, high) = (50.0, 15.0, 19.0);
    let [first, off, on] = thermostat(2.0, 100.0, low, high);
    if time < first {
        return end * (1.0 - (-time / 1045.0).exp());
    }
    let gone = (time - first).rem_euclid(off + on);
    if gone < off {
        high * (-gone / 1045.0).exp()
    } else {
        end - (end - low) * (-(gone - off) / 1045.0).exp()
    }
}

/// When a heater of so many W is first switched off, and how long it is off and on after that, with a loss of so many W/K.
pub fn thermostat(loss: f64, power: f64, low: f64, high: f64) -> [f64; 3] {
    let (time_constant, end) = (2090.0 / loss, power / loss);
    [(end / (end - high)).ln(), (high / low).ln(), ((end - low) / (end - high)).ln()]
        .map(|log| time_constant * log)
}

fn first<const STATES: usize>(course: Vec<[f64; STATES]>) -> Vec<f64> {
    course.into_iter().map(|state| state[0]).collect()
}
