//! Circuits of the thesis: one problem for each patch of patches/thesis.

use super::slideway::{FrictionLaw, Slideway};
use super::{DEFAULTS, ErrorSource, Problem, Solution};

/// Step of the reference solver in seconds: a twentieth of the patches' steps.
pub(crate) const FINE_STEP: f64 = 1e-6;

/// The problems in the order of docs/problems.md.
pub(crate) static PROBLEMS: [Problem; 14] = [
    Problem {
        name: "Fig 4.7",
        patch: "thesis/fig-4-07",
        signal: "coulomb.v_o",
        solution: Solution::Integrated(|duration, every| {
            fine_velocity(&Slideway::with_friction_drop(), duration, every)
        }),
        max_error: 6e-11,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.4",
        patch: "thesis/fig-8-04",
        solution: Solution::ClosedForm(|time| {
            Slideway::step_response(FrictionLaw::Absent).linear_velocity(time)
        }),
        max_error: 1.5e-12,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.5",
        patch: "thesis/fig-8-05",
        signal: "V_o",
        solution: Solution::ClosedForm(|time| dead_zone_output(10.0 * time - 40.0, 50.0)),
        ..RAMP
    },
    Problem {
        name: "Fig 8.6",
        patch: "thesis/fig-8-06",
        signal: "VB.75",
        solution: Solution::ClosedForm(|time| dead_zone_output(10.0 * time - 40.0, 75.0)),
        ..RAMP
    },
    Problem {
        name: "Fig 8.7",
        patch: "thesis/fig-8-07",
        solution: Solution::Integrated(|duration, every| {
            fine_velocity(&Slideway::step_response(FrictionLaw::Constant), duration, every)
        }),
        max_error: 3e-12,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.9",
        patch: "thesis/fig-8-09",
        signal: "VB",
        solution: Solution::ClosedForm(|time| friction_bias(5.0 * time - 30.0)),
        ..RAMP
    },
    Problem {
        name: "Fig 8.11",
        patch: "thesis/fig-8-11",
        solution: Solution::Integrated(|duration, every| {
            fine_velocity(&Slideway::thesis(FrictionLaw::Linear), duration, every)
        }),
        max_error: 6e-11,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.14",
        patch: "thesis/fig-8-14",
        solution: Solution::Integrated(|duration, every| {
            fine_velocity(&Slideway::thesis(FrictionLaw::Square), duration, every)
        }),
        max_error: 1e-9,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.15",
        patch: "thesis/fig-8-15",
        signal: "out",
        duration: 0.3,
        every: 1e-3,
        solution: Solution::ClosedForm(lagged),
        max_error: 1e-13,
        step_factor: 20.0,
        ..DEFAULTS
    },
    Problem {
        name: "Fig 8.16",
        patch: "thesis/fig-8-16",
        solution: Solution::Integrated(|duration, every| {
            fine_velocity(&Slideway::thesis(FrictionLaw::LagBeforeSquare), duration, every)
        }),
        max_error: 3e-10,
        step_factor: 0.5,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.16, its lag last",
        patch: "thesis/fig-8-16-lag-last",
        solution: Solution::Integrated(|duration, every| {
            fine_velocity(&Slideway::thesis(FrictionLaw::LagAfterSquare), duration, every)
        }),
        max_error: 3e-10,
        step_factor: 0.5,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.17",
        patch: "thesis/fig-8-17",
        solution: Solution::Integrated(|duration, every| {
            fine_velocity(&Slideway::thesis(FrictionLaw::LagBeforeSquare), duration, every)
        }),
        max_error: 3e-10,
        step_factor: 0.5,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.16 with a brake",
        patch: "thesis/fig-8-16-coulomb",
        solution: Solution::Integrated(|duration, every| {
            fine_velocity(
                &Slideway { brake: true, ..Slideway::thesis(FrictionLaw::LagBeforeSquare) },
                duration,
                every,
            )
        }),
        max_error: 2e-11,
        ..SLIDEWAY
    },
    Problem {
        name: "Fig 8.16 twice",
        patch: "thesis/fig-8-16-both",
        signal: "brake.v_o",
        solution: Solution::Integrated(|duration, every| {
            let (v_start, v_rate) = (0.5e-3, 0.0);
            let even =
                Slideway { brake: true, v_start, v_rate, ..Slideway::thesis(FrictionLaw::LagBeforeSquare) };
            fine_velocity(&even, duration, every)
        }),
        max_error: 1e-10,
        ..SLIDEWAY
    },
];

/// Defaults of a slideway problem: the output velocity over the first 0.3 s.
pub(crate) const SLIDEWAY: Problem = Problem { signal: "v_o", duration: 0.3, every: 1e-3, ..DEFAULTS };

impl Slideway {
    /// Friction (c) of Fig 4.7: it falls to 60 % of its value at standstill.
    pub(crate) fn with_friction_drop() -> Self {
        Slideway {
            brake: true,
            constant_part: 0.6 * 771.0,
            vcl: 0.508e-3,
            ..Slideway::thesis(FrictionLaw::LagBeforeSquare)
        }
    }
}

/// Defaults of a network without memory that is driven by a slow ramp.
const RAMP: Problem =
    Problem { duration: 8.0, every: 1e-2, max_error: 1e-15, error_source: ErrorSource::Rounding, ..DEFAULTS };

/// The output of a diode dead zone with the setting 0.254 (eq 18-8) for an input and a bias in V.
fn dead_zone_output(volts: f64, bias: f64) -> f64 {
    (volts.abs() - 0.254 * (volts.abs() + bias)).max(0.0).copysign(volts)
}

/// The bias of Fig 8.9 by the voltage of A3: a straight line from 50 V to 0 V at 10 V, then -0.5 V for every 20 V.
fn friction_bias(volts: f64) -> f64 {
    let beyond = (volts.abs() - 10.0).max(0.0);
    50.0 - 5.0 * (volts.abs() - beyond) - 0.025 * beyond
}

/// Tc out' = 50 + 10 sin(t / Tc) - out from 100: a sine with a phase lag of 45 degrees plus a decaying transient.
fn lagged(time: f64) -> f64 {
    let angle = time / 0.01;
    50.0 + 5.0 * (angle.sin() - angle.cos()) + 55.0 * (-angle).exp()
}

/// The output velocity of a slideway at 0, every, 2 every, ..., integrated with FINE_STEP.
pub(crate) fn fine_velocity(slideway: &Slideway, duration: f64, every: f64) -> Vec<f64> {
    slideway.velocity(duration, every, FINE_STEP)
}
