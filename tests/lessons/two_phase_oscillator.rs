//! Two-phase oscillator: the same amplitude from every start.

use std::f64::consts::{FRAC_2_PI, TAU};

use crate::common::{root, run_for, voltage};
use crate::known_problems::runs::{program, step_of};
use crate::lessons::crossings::next_rise;

const STEM: &str = "lessons/two-phase-oscillator";

/// Amplitude of the sine (at zeros of the cosine) and period, after `settled` seconds.
fn steady(changes: &[(&str, f64)], settled: f64) -> (f64, f64) {
    let program = program(STEM, changes);
    let mut machine = run_for(&program, step_of(STEM), settled);
    let begin = next_rise(&mut machine, |machine| voltage(machine, "A1"));
    let amplitude = voltage(&machine, "A2").abs();
    let period = next_rise(&mut machine, |machine| voltage(machine, "A1")) - begin;
    assert!(!machine.is_overloaded(), "{changes:?}: {:?}", machine.overloads());
    (amplitude, period)
}

/// scipy 1.17, DOP853 at 1e-13: amplitude of the sine and period of x' = -w y + w push x - w damp d(x), y' = w x,
/// d a dead zone of 50 V.
const CYCLES: [(f64, f64, f64, f64); 3] = [
    (0.05, 0.25, 72.830_591_806_5, 1.000_462_961_1),
    (0.02, 0.1, 72.783_919_706_7, 1.000_074_062_9),
    (0.1, 0.5, 72.997_403_243_0, 1.001_852_806_0),
];

#[test]
fn amplitude_and_period_match_an_independent_solver() {
    for (push, damp, amplitude, period) in CYCLES {
        let found = steady(&[("push", push), ("damp", damp), ("start", 70.0)], 5.0 / push);
        assert!(
            (found.0 - amplitude).abs() < AMPLITUDE_TOLERANCE && (found.1 - period).abs() < 1e-6,
            "{found:?}"
        );
    }
}

/// The largest difference of amplitudes, in V.
const AMPLITUDE_TOLERANCE: f64 = 1e-7;

#[test]
fn the_amplitude_is_reached_from_below_and_from_above() {
    let (small, large) = (steady(&[("start", 2.0)], 60.0), steady(&[("start", 90.0)], 60.0));
    let late = steady(&[], 260.0);
    for (found, when) in [(small, "from below"), (large, "from above"), (late, "200 periods later")] {
        assert!((found.0 - CYCLES[0].2).abs() < AMPLITUDE_TOLERANCE, "{when}: {found:?}");
    }
}

#[test]
fn a_weak_drive_gives_the_amplitude_of_the_describing_function() {
    for level in [30.0, 50.0] {
        let ratio = |amplitude: f64| level / amplitude;
        let share = |a: f64| 1.0 - FRAC_2_PI * (ratio(a).asin() + ratio(a) * (1.0 - ratio(a).powi(2)).sqrt());
        let expected = root(|amplitude| 0.05 * share(amplitude) - 0.01, level, 5.0 * level);
        let found =
            steady(&[("push", 0.01), ("damp", 0.05), ("level", level), ("start", 1.4 * level)], 200.0);
        assert!((found.0 / expected - 1.0).abs() < 1e-4, "{found:?} {expected}");
    }
}

#[test]
fn an_oscillator_without_feedback_is_a_circle() {
    let program = program(STEM, &[("push", 0.0), ("damp", 0.0), ("start", 60.0)]);
    for time in [0.3, 1.0, 7.7] {
        let machine = run_for(&program, step_of(STEM), time);
        let (cosine, sine) = (voltage(&machine, "A1"), voltage(&machine, "A2"));
        // Runge-Kutta's phase error: (omega h)^4 / 120 of the angle.
        let allowed = 60.0 * TAU * time * (TAU * 2e-3f64).powi(4) / 100.0;
        assert!((cosine - 60.0 * (TAU * time).cos()).abs() < allowed + 1e-11, "{cosine}");
        assert!((sine - 60.0 * (TAU * time).sin()).abs() < allowed + 1e-11, "{sine}");
    }
}
