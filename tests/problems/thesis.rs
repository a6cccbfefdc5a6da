//! The circuits of the thesis.

use super::slideway::{Law, Slideway};
use super::{Known, Problem, USUAL};

/// Equations are stepped so finely, in seconds: a twentieth of the patches' steps.
pub const FINE_STEP: f64 = 1e-6;

pub static PROBLEMS: [Problem; 8] = [
    Problem {
        name: "Fig 8.4",
        patch: "thesis/fig-8-04",
        known: Known::Closed(|time| Slideway::step_response(Law::Absent).linear_velocity(time)),
        within: 1.5e-12,
        ..SLIDEWAY
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
        name: "Fig 8.16",
        patch: "thesis/fig-8-16",
        known: Known::Stepped(|duration, every| finely(&Slideway::thesis(Law::Remembered), duration, every)),
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
const SLIDEWAY: Problem = Problem { signal: "v_o", duration: 0.3, every: 1e-3, ..USUAL };

fn finely(slideway: &Slideway, duration: f64, every: f64) -> Vec<f64> {
    slideway.velocity(duration, every, FINE_STEP)
}
