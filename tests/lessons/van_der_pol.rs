//! Van der Pol: period and amplitude of the limit cycle.

use std::f64::consts::TAU;

use crate::common::{run_for, voltage};
use crate::known_problems::runs::{program, step_of};
use crate::lessons::crossings::next_rise;

const STEM: &str = "lessons/van-der-pol";
const POSITION: f64 = 0.025;

/// Period and amplitude of the limit cycle.
fn cycle(mu: f64, settled: f64) -> (f64, f64) {
    let program = program(STEM, &[("mu", mu), ("x0", 2.0)]);
    let mut machine = run_for(&program, step_of(STEM), settled);
    // The position is largest when the velocity falls through 0.
    let top = next_rise(&mut machine, |machine| -voltage(machine, "A1"));
    let amplitude = voltage(&machine, "B1") * POSITION;
    (next_rise(&mut machine, |machine| -voltage(machine, "A1")) - top, amplitude)
}

#[test]
fn period_and_amplitude_match_the_literature() {
    // mu = 1: Andersen and Geer, SIAM Journal on Applied Mathematics 42 (1982) 678; the others and the
    // amplitudes: scipy 1.17, DOP853 at 1e-13.
    let known = [
        (0.5, 6.380_675_801_8, 2.002_487_930_4),
        (1.0, 6.663_286_859_3, 2.008_619_860_9),
        (1.5, 7.096_373_589_7, 2.015_226_501_9),
    ];
    for (mu, period, amplitude) in known {
        let found = cycle(mu, 60.0);
        assert!((found.0 - period).abs() < 1e-8 && (found.1 - amplitude).abs() < 1e-8, "{mu}: {found:?}");
    }
}

#[test]
fn with_small_mu_the_cycle_is_nearly_a_sine_of_amplitude_2() {
    let mu = 0.1;
    let (period, amplitude) = cycle(mu, 150.0);
    // The next terms of the series are of order mu^4 (at most 5 / 3072).
    assert!((period - TAU * (1.0 + mu * mu / 16.0)).abs() < TAU * 2e-3 * mu.powi(4), "{period}");
    assert!((amplitude - (2.0 + mu * mu / 96.0)).abs() < 2e-3 * mu.powi(4), "{amplitude}");
}

#[test]
fn every_start_except_rest_ends_on_the_same_cycle() {
    let late = |x0: f64| {
        let program = program(STEM, &[("x0", x0)]);
        let mut machine = run_for(&program, step_of(STEM), 60.0);
        next_rise(&mut machine, |machine| -voltage(machine, "A1"));
        voltage(&machine, "B1")
    };
    let one = late(0.01);
    assert!([2.2, -1.0].iter().all(|x0| (late(*x0) - one).abs() < 1e-8));
}
