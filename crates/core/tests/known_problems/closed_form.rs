//! Six problems with closed solutions, each with a section of docs/problems.md.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{DEFAULTS, ErrorSource, Problem, Solution};

/// The problems in the order of their sections.
pub(crate) static PROBLEMS: [Problem; 6] = [
    Problem {
        name: "Dry friction",
        patch: "problems/dry-friction",
        signal: "x",
        duration: 8.0,
        every: 0.037,
        solution: Solution::ClosedForm(dry_friction),
        max_error: 2e-10,
        ..DEFAULTS
    },
    Problem {
        name: "Bouncing ball",
        patch: "problems/bouncing-ball",
        signal: "h",
        duration: 12.0,
        every: 0.037,
        solution: Solution::ClosedForm(bouncing_ball),
        max_error: 1e-13,
        error_source: ErrorSource::Rounding,
        ..DEFAULTS
    },
    Problem {
        name: "Saturated integrator",
        patch: "problems/saturated-integrator",
        signal: "x",
        duration: 12.0,
        every: 0.037,
        solution: Solution::ClosedForm(saturated_integrator),
        max_error: 3e-10,
        ..DEFAULTS
    },
    Problem {
        name: "Relay oscillator",
        patch: "problems/relay-oscillator",
        signal: "x",
        duration: 12.0,
        every: 0.037,
        solution: Solution::ClosedForm(relay_oscillator),
        max_error: 1e-9,
        ..DEFAULTS
    },
    Problem {
        name: "Van der Pol's period",
        patch: "lessons/van-der-pol",
        changes: &[("mu", 1.0), ("x0", 2.008_619_860_9)],
        signal: "v",
        duration: 3.0 * VAN_DER_POL_PERIOD,
        every: VAN_DER_POL_PERIOD,
        solution: Solution::ClosedForm(van_der_pol),
        max_error: 1e-9,
        ..DEFAULTS
    },
    Problem {
        name: "Three masses",
        patch: "problems/three-masses",
        signal: "x1",
        duration: 10.0,
        every: 0.037,
        solution: Solution::ClosedForm(three_masses),
        max_error: 8e-8,
        ..DEFAULTS
    },
];

/// x'' = -4 x - 20 sign(x') from 42: half swings of 2 rad/s about +5 and -5 in turn. The amplitude falls by 10 from one
/// to the next, until a turning point is within 5 of 0 (J. P. Den Hartog, Mechanical Vibrations, 1934).
fn dry_friction(time: f64) -> f64 {
    let (halves, last) = ((time / FRAC_PI_2).floor(), 4.0);
    if halves >= last {
        return 2.0;
    }
    let sign = if halves % 2.0 == 0.0 { 1.0 } else { -1.0 };
    sign * (5.0 + (37.0 - 10.0 * halves) * (2.0 * (time - halves * FRAC_PI_2)).cos())
}

/// h'' = -50 from 81. Each bounce returns 0.8 of the velocity.
fn bouncing_ball(time: f64) -> f64 {
    bouncing_height(81.0, 50.0, 0.8, time)
}

/// The height of a ball that falls from `height` and bounces with `restitution`. It consists of parabolas (Galilei).
/// The n-th takes 2 `restitution`^n times as long as the fall.
pub(crate) fn bouncing_height(height: f64, gravity: f64, restitution: f64, time: f64) -> f64 {
    let mut begin = (2.0 * height / gravity).sqrt();
    let mut velocity = restitution * gravity * begin;
    if time < begin {
        return height - 0.5 * gravity * time * time;
    }
    while time > begin + 2.0 * velocity / gravity {
        begin += 2.0 * velocity / gravity;
        velocity *= restitution;
    }
    let elapsed = time - begin;
    velocity * elapsed - 0.5 * gravity * elapsed * elapsed
}

/// x' = -80 sin(2 t) between -60 and 10: the integral of the sine since its last zero crossing, up to the limit.
fn saturated_integrator(time: f64) -> f64 {
    let (halves, cosine) = ((time / FRAC_PI_2).floor(), (2.0 * time).cos());
    let from = if halves == 0.0 { 0.0 } else { 10.0 };
    if halves % 2.0 == 0.0 {
        (from + 40.0 * (cosine - 1.0)).max(-60.0)
    } else {
        (-60.0 + 40.0 * (cosine + 1.0)).min(10.0)
    }
}

/// x' = -x - 50 until x falls to -30, x' = -x + 50 until it rises to 30. The solution consists of exponentials, and
/// half a period takes ln(80 / 20) s (A. A. Andronov, A. A. Vitt, S. E. Khaikin, Theory of Oscillators, 1966). x rises
/// first.
fn relay_oscillator(time: f64) -> f64 {
    let (half, first) = ((80.0f64 / 20.0).ln(), (50.0f64 / 20.0).ln());
    let halves = ((time - first) / half).floor();
    let sign = if halves.rem_euclid(2.0) == 0.0 { -1.0 } else { 1.0 };
    sign * (50.0 - 80.0 * (-(time - first - halves * half)).exp())
}

/// The period of the limit cycle for mu = 1, in seconds (C. M. Andersen, J. F. Geer, SIAM Journal on Applied
/// Mathematics 42 (1982) 678).
const VAN_DER_POL_PERIOD: f64 = 6.663_286_859_3;

/// x'' = (1 - x^2) x' - x from the top of its limit cycle. The velocity is 0 after every period.
fn van_der_pol(_time: f64) -> f64 {
    0.0
}

/// x_j'' = 4 (x_(j-1) - 2 x_j + x_(j+1)) with walls at both ends, from x_1 = 30 at rest. The mode with the shape
/// sin(j k pi / 4) oscillates with 4 sin(k pi / 8) rad/s (J. L. Lagrange, Mecanique analytique, 1788).
fn three_masses(time: f64) -> f64 {
    let mode = |k: f64| 15.0 * (k * PI / 4.0).sin().powi(2) * (4.0 * (k * PI / 8.0).sin() * time).cos();
    mode(1.0) + mode(2.0) + mode(3.0)
}
