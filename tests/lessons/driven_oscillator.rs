//! Driven oscillator: steady amplitude and phase by the textbook formulas.

use std::f64::consts::TAU;

use crate::known_problems::runs::{run, values};
use patchcord::instruments::harmonic;

const STEM: &str = "lessons/driven-oscillator";

#[test]
fn steady_amplitude_and_phase_follow_the_formulas() {
    // Below, at and above resonance; with little and with much damping.
    for (f, d) in [(0.3, 2.0), (0.8, 0.7), (1.0, 2.0), (1.00658, 2.0), (1.5, 6.0), (3.0, 2.0)] {
        let (m, k, force) = (1.0, 40.0, 0.5);
        let settled = 40.0 / d + 10.0 / f;
        let trace = run(STEM, &[("f", f), ("d", d), ("F", force)], settled);
        let from = trace.time.partition_point(|time| *time < settled - 10.0 / f - 1e-9);
        let read = |signal| harmonic(&trace.time[from..], &values(&trace, signal)[from..], f).unwrap();
        let (push, x) = (read("push"), read("x"));
        let omega = TAU * f;
        let (real, imaginary): (f64, f64) = (k - m * omega * omega, d * omega);
        let amplitude = 1e3 * force / real.hypot(imaginary);
        // The free oscillation has decayed to e^-20 of its initial value.
        assert!((x.amplitude / amplitude - 1.0).abs() < 1e-7, "{f} Hz: {} {amplitude}", x.amplitude);
        let lag = (push.phase - x.phase).rem_euclid(TAU);
        assert!((lag - imaginary.atan2(real)).abs() < 1e-7, "{f} Hz: {lag} {}", imaginary.atan2(real));
    }
}

#[test]
fn without_damping_at_resonance_the_amplitude_grows_linearly() {
    // x = F / (2 k) (sin w t - w t cos w t) at w = sqrt(k / m).
    let f = 40.0f64.sqrt() / TAU;
    let trace = run(STEM, &[("f", f), ("d", 0.0), ("F", 0.5)], 2.0);
    for (time, x) in trace.time.iter().zip(values(&trace, "x")) {
        let angle = TAU * f * time;
        let expected = 1e3 * 0.5 / 80.0 * (angle.sin() - angle * angle.cos());
        assert!((x - expected).abs() < 1e-6, "{x} mm at {time} s, not {expected}");
    }
}
