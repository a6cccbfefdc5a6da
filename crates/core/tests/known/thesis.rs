//! The circuits of the thesis.

use super::slideway::{Law, Slideway};
use super::{Known, Left, Problem, USUAL};

/// Equations are stepped so finely, in seconds: a twentieth of the patches' steps.
pub const FINE_STEP: f64 = 1e-6;

pub static PROBLEMS: [Problem; 14] = [
    Problem {
        name: "Fig 4.7",
        patch: "thesis/fig-4-07",
        signal: "coulomb.v_o",
        known: Known::Stepped(|duration, every| finely(&Slideway::dropping(), duration, every)),
        within: 6e-11,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.4",
        patch: "thesis/fig-8-04",
        known: Known::Closed(|time| Slideway::step_response(Law::Absent).linear_velocity(time)),
        within: 1.5e-12,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.5",
        patch: "thesis/fig-8-05",
        signal: "V_o",
        known: Known::Closed(|time| beyond(10.0 * time - 40.0, 50.0)),
        ..RAMP
    },
    Problem {
        name: "Fig 8.6",
        patch: "thesis/fig-8-06",
        signal: "VB.75",
        known: Known::Closed(|time| beyond(10.0 * time - 40.0, 75.0)),
        ..RAMP
    },
    Problem {
        name: "Fig 8.7",
        patch: "thesis/fig-8-07",
        known: Known::Stepped(|duration, every| {
            finely(&Slideway::step_response(Law::Constant), duration, every)
        }),
        within: 3e-12,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.9",
        patch: "thesis/fig-8-09",
        signal: "VB",
        known: Known::Closed(|time| level(5.0 * time - 30.0)),
        ..RAMP
    },
    Problem {
        name: "Fig 8.11",
        patch: "thesis/fig-8-11",
        known: Known::Stepped(|duration, every| finely(&Slideway::thesis(Law::Straight), duration, every)),
        within: 6e-11,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.14",
        patch: "thesis/fig-8-14",
        known: Known::Stepped(|duration, every| finely(&Slideway::thesis(Law::Square), duration, every)),
        within: 1e-9,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.15",
        patch: "thesis/fig-8-15",
        signal: "out",
        duration: 0.3,
        every: 1e-3,
        known: Known::Closed(lagged),
        within: 1e-13,
        ladder: 20.0,
        ..USUAL
    },
    Problem {
        name: "Fig 8.16",
        patch: "thesis/fig-8-16",
        known: Known::Stepped(|duration, every| finely(&Slideway::thesis(Law::Remembered), duration, every)),
        within: 3e-10,
        ladder: 0.5,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.16, its lag last",
        patch: "thesis/fig-8-16-lag-last",
        known: Known::Stepped(|duration, every| finely(&Slideway::thesis(Law::Followed), duration, every)),
        within: 3e-10,
        ladder: 0.5,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.17",
        patch: "thesis/fig-8-17",
        known: Known::Stepped(|duration, every| finely(&Slideway::thesis(Law::Remembered), duration, every)),
        within: 3e-10,
        ladder: 0.5,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.16 with a brake",
        patch: "thesis/fig-8-16-coulomb",
        known: Known::Stepped(|duration, every| {
            finely(&Slideway { brake: true, ..Slideway::thesis(Law::Remembered) }, duration, every)
        }),
        within: 2e-11,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.16 twice",
        patch: "thesis/fig-8-16-both",
        signal: "brake.v_o",
        known: Known::Stepped(|duration, every| {
            let (v_start, v_rate) = (0.5e-3, 0.0);
            let even = Slideway { brake: true, v_start, v_rate, ..Slideway::thesis(Law::Remembered) };
            finely(&even, duration, every)
        }),
        within: 1e-10,
        ..SLIDEWAY
    },
];

/// The output velocity of a slideway, while it sets out.
pub const SLIDEWAY: Problem = Problem { signal: "v_o", duration: 0.3, every: 1e-3, ..USUAL };

impl Slideway {
    /// Friction (c) of Fig 4.7: it drops to a share of what holds at standstill.
    pub fn dropping() -> Self {
        Slideway { brake: true, kept: 0.6 * 771.0, vcl: 0.508e-3, ..Slideway::thesis(Law::Remembered) }
    }
}

/// A network without memory, driven by a slow ramp.
const RAMP: Problem = Problem { duration: 8.0, every: 1e-2, within: 1e-15, left: Left::Rounding, ..USUAL };

/// What of a voltage a diode dead zone at the setting 0.254 lets through (eq 18-8), by its bias.
fn beyond(volts: f64, bias: f64) -> f64 {
    (volts.abs() - 0.254 * (volts.abs() + bias)).max(0.0).copysign(volts)
}

/// The bias of Fig 8.9 by the voltage of A3: straight from 50 V to 0 V at 10 V, then -0.5 V for every 20 V.
fn level(volts: f64) -> f64 {
    let beyond = (volts.abs() - 10.0).max(0.0);
    50.0 - 5.0 * (volts.abs() - beyond) - 0.025 * beyond
}

/// Tc out' = 50 + 10 sin(t / Tc) - out, from 100: 45 degrees late, and what is left of the start.
fn lagged(time: f64) -> f64 {
    let angle = time / 0.01;
    50.0 + 5.0 * (angle.sin() - angle.cos()) + 55.0 * (-angle).exp()
}

/// Its output velocity by fine steps.
pub fn finely(slideway: &Slideway, duration: f64, every: f64) -> Vec<f64> {
    slideway.velocity(duration, every, FINE_STEP)
}
