//! Fig 8.15: the lag alone, with a sine in the place of X3.

use std::f64::consts::TAU;

use crate::known::runs::run;
use crate::thesis::bench;
use patchcord_analysis::instruments::harmonic;

fn corner(tc: f64) -> f64 {
    1.0 / (TAU * tc)
}

/// Size and lateness in degrees of the output beside the input, at so many times the corner; and the output's mean.
fn followed(tc: f64, times: f64) -> (f64, f64, f64) {
    let frequency = times * corner(tc);
    let trace = run("thesis/fig-8-15", &[("Tc", tc), ("times", times)], 30.0 / frequency);
    assert!(bench::lit(&trace).is_empty());
    // The first half holds what is left of the start.
    let half = trace.len() / 2;
    let read = |name| harmonic(&trace.time[half..], &trace.values(name).unwrap()[half..], frequency).unwrap();
    let (input, output) = (read("in"), read("out"));
    (output.amplitude, (input.phase - output.phase).to_degrees(), output.mean)
}

#[test]
fn ten_volts_at_the_corner_come_out_as_7_07_and_45_degrees_late() {
    for tc in [0.0065, 0.01, 0.02] {
        let (amplitude, late, mean) = followed(tc, 1.0);
        assert!((amplitude - 7.07).abs() < 0.005, "{amplitude}");
        assert!((mean - 50.0).abs() < 1e-5, "{mean}");
        assert!((late - 45.0).abs() < 0.01, "{late}");
    }
}

#[test]
fn above_and_below_the_corner_it_is_a_lag_of_first_order() {
    for times in [0.5, 2.0] {
        let (amplitude, late, _) = followed(0.01, times);
        assert!((amplitude - 10.0 / f64::hypot(1.0, times)).abs() < 0.005, "{amplitude} V at {times}");
        assert!((late - times.atan().to_degrees()).abs() < 0.01, "{late} degrees at {times}");
    }
}
