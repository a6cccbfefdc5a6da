//! Fig 8.15: the lag alone, with a sine in place of X3.

use std::f64::consts::TAU;

use crate::known_problems::runs::run;
use crate::thesis::circuit_readings;
use patchcord_analysis::instruments::harmonic;

/// Corner frequency of the lag in Hz.
fn corner(tc: f64) -> f64 {
    1.0 / (TAU * tc)
}

/// Amplitude of the output, its phase lag in degrees behind the input, and its mean, at a multiple of the corner
/// frequency.
fn response(tc: f64, times: f64) -> (f64, f64, f64) {
    let frequency = times * corner(tc);
    let trace = run("thesis/fig-8-15", &[("Tc", tc), ("times", times)], 30.0 / frequency);
    assert!(circuit_readings::overloaded_elements(&trace).is_empty());
    // The first half contains the transient of the start.
    let half = trace.len() / 2;
    let read = |name| harmonic(&trace.time[half..], &trace.values(name).unwrap()[half..], frequency).unwrap();
    let (input, output) = (read("in"), read("out"));
    (output.amplitude, (input.phase - output.phase).to_degrees(), output.mean)
}

#[test]
fn ten_volts_at_the_corner_give_7_07_volts_45_degrees_late() {
    for tc in [0.0065, 0.01, 0.02] {
        let (amplitude, lag, mean) = response(tc, 1.0);
        assert!((amplitude - 7.07).abs() < 0.005, "{amplitude}");
        assert!((mean - 50.0).abs() < 1e-5, "{mean}");
        assert!((lag - 45.0).abs() < 0.01, "{lag}");
    }
}

#[test]
fn response_is_a_first_order_lag() {
    for times in [0.5, 2.0] {
        let (amplitude, lag, _) = response(0.01, times);
        assert!((amplitude - 10.0 / f64::hypot(1.0, times)).abs() < 0.005, "{amplitude} V at {times}");
        assert!((lag - times.atan().to_degrees()).abs() < 0.01, "{lag} degrees at {times}");
    }
}
