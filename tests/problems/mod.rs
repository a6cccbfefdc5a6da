//! Problems whose solutions are known, for tests and for the measurements of benches/performance; told in
//! docs/problems.md. The solutions are written down apart from any wiring.

#![allow(dead_code, reason = "tests and measurements take what they need")]

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use patchcord::circuit::Circuit;
use patchcord::patch::Patch;
use patchcord::program::Program;
use patchcord::solve::{self, RunSettings};

/// A patch, and what one of its signals does.
#[derive(Debug)]
pub struct Problem {
    /// What it is called in docs/problems.md.
    pub name: &'static str,
    /// The patch, from the root.
    pub patch: &'static str,
    /// Parameters that are set otherwise than in the patch.
    pub changes: &'static [(&'static str, f64)],
    /// The signal whose solution is known.
    pub signal: &'static str,
    /// How long it is looked at, in seconds, and how often.
    pub duration: f64,
    pub every: f64,
    /// The signal's voltage at a time; at multiples of `every` at least.
    pub exact: fn(f64) -> f64,
    /// Equal steps of this length, in seconds, err by less than that, in machine units.
    pub step: f64,
    pub within: f64,
    /// Whether the error goes with the fourth power of the step; else it is rounding at any step.
    pub fourth_order: bool,
}

/// All of them.
pub const PROBLEMS: [Problem; 6] = [
    Problem {
        name: "Dry friction",
        patch: "patches/problems/dry-friction.json",
        changes: &[],
        signal: "x",
        duration: 8.0,
        every: 0.037,
        exact: dry_friction,
        step: 5e-3,
        within: 2e-10,
        fourth_order: true,
    },
    Problem {
        name: "Bouncing ball",
        patch: "patches/problems/bouncing-ball.json",
        changes: &[],
        signal: "h",
        duration: 12.0,
        every: 0.037,
        exact: bouncing_ball,
        step: 1e-2,
        within: 1e-13,
        fourth_order: false,
    },
    Problem {
        name: "Saturated integrator",
        patch: "patches/problems/saturated-integrator.json",
        changes: &[],
        signal: "x",
        duration: 12.0,
        every: 0.037,
        exact: saturated_integrator,
        step: 1e-2,
        within: 3e-10,
        fourth_order: true,
    },
    Problem {
        name: "Relay oscillator",
        patch: "patches/problems/relay-oscillator.json",
        changes: &[],
        signal: "x",
        duration: 12.0,
        every: 0.037,
        exact: relay_oscillator,
        step: 1e-2,
        within: 1e-9,
        fourth_order: true,
    },
    Problem {
        name: "Van der Pol's period",
        patch: "patches/lessons/van-der-pol.json",
        changes: &[("mu", 1.0), ("x0", 2.008_619_860_9)],
        signal: "v",
        duration: 3.0 * VAN_DER_POL_PERIOD,
        every: VAN_DER_POL_PERIOD,
        exact: van_der_pol,
        step: 5e-3,
        within: 1e-9,
        fourth_order: true,
    },
    Problem {
        name: "Three masses",
        patch: "patches/problems/three-masses.json",
        changes: &[],
        signal: "x1",
        duration: 10.0,
        every: 0.037,
        exact: three_masses,
        step: 1e-2,
        within: 8e-8,
        fourth_order: true,
    },
];

/// x'' = -4 x - 20 sign(x') from 42: half swings of 2 radians a second about +5 and -5 in turn, each smaller by
/// 10, until a turning point lies within 5 of 0 (J. P. Den Hartog, Mechanical Vibrations, 1934).
fn dry_friction(time: f64) -> f64 {
    let (halves, last) = ((time / FRAC_PI_2).floor(), 4.0);
    if halves >= last {
        return 2.0;
    }
    let sign = if halves % 2.0 == 0.0 { 1.0 } else { -1.0 };
    sign * (5.0 + (37.0 - 10.0 * halves) * (2.0 * (time - halves * FRAC_PI_2)).cos())
}

/// h'' = -50 from 81, each blow throws back 0.8 of the velocity: parabolas (Galilei); it falls for 1.8 s, and flies for
/// 0.8^n x 3.6 s after the n-th blow.
fn bouncing_ball(time: f64) -> f64 {
    let (mut begin, mut velocity) = (1.8, 72.0);
    if time < begin {
        return 81.0 - 25.0 * time * time;
    }
    while time > begin + velocity / 25.0 {
        begin += velocity / 25.0;
        velocity *= 0.8;
    }
    let gone = time - begin;
    velocity * gone - 25.0 * gone * gone
}

/// x' = -80 sin(2 t) between -60 and 10: the integral of the sine since it last turned, up to the limit.
fn saturated_integrator(time: f64) -> f64 {
    let (halves, cosine) = ((time / FRAC_PI_2).floor(), (2.0 * time).cos());
    let from = if halves == 0.0 { 0.0 } else { 10.0 };
    if halves % 2.0 == 0.0 {
        (from + 40.0 * (cosine - 1.0)).max(-60.0)
    } else {
        (-60.0 + 40.0 * (cosine + 1.0)).min(10.0)
    }
}

/// x' = -x - 50 until x falls to -30, x' = -x + 50 until it rises to 30: exponentials, half a period ln(80 / 20)
/// (A. A. Andronov, A. A. Vitt, S. E. Khaikin, Theory of Oscillators, 1966). The relay begins on the side from which x rises.
fn relay_oscillator(time: f64) -> f64 {
    let (half, first) = ((80.0f64 / 20.0).ln(), (50.0f64 / 20.0).ln());
    let halves = ((time - first) / half).floor();
    let sign = if halves.rem_euclid(2.0) == 0.0 { -1.0 } else { 1.0 };
    sign * (50.0 - 80.0 * (-(time - first - halves * half)).exp())
}

/// The period at mu = 1 (C. M. Andersen, J. F. Geer, SIAM Journal on Applied Mathematics 42 (1982) 678).
const VAN_DER_POL_PERIOD: f64 = 6.663_286_859_3;

/// x'' = (1 - x^2) x' - x from the top of its limit cycle: the velocity is 0 again after every period.
fn van_der_pol(_time: f64) -> f64 {
    0.0
}

/// x_j'' = 4 (x_(j-1) - 2 x_j + x_(j+1)) with walls at both ends, x_1 = 30 at rest: each mode of sin(j k pi / 4) swings with
/// 4 sin(k pi / 8) radians a second (J. L. Lagrange, Mecanique analytique, 1788).
fn three_masses(time: f64) -> f64 {
    let mode = |k: f64| 15.0 * (k * PI / 4.0).sin().powi(2) * (4.0 * (k * PI / 8.0).sin() * time).cos();
    mode(1.0) + mode(2.0) + mode(3.0)
}

impl Problem {
    /// The program, and a run of it over the problem's time.
    pub fn program(&self) -> (Program, RunSettings) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(self.patch);
        let patch = Patch::read(&file).unwrap_or_else(|error| panic!("{error}"));
        let changes: Vec<_> = self.changes.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        let circuit = Circuit::new(&patch, &changes).unwrap_or_else(|report| panic!("{report}"));
        let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
        let own = RunSettings::of(&circuit).unwrap_or_else(|error| panic!("{error}"));
        let settings = RunSettings {
            step: self.step,
            every: self.every,
            record: vec![self.signal.to_owned()],
            ..own.lasting(self.duration)
        };
        (program, settings)
    }

    /// The largest error of a run over all samples, in machine units.
    pub fn error(&self, program: &Program, settings: &RunSettings) -> f64 {
        let trace = solve::run(program, settings).unwrap_or_else(|error| panic!("{}: {error}", self.name));
        let off = |(time, volts): (&f64, &f64)| (volts - (self.exact)(*time)).abs() / 100.0;
        trace.time.iter().zip(&trace.tracks[0].volts).map(off).fold(0.0, f64::max)
    }
}
