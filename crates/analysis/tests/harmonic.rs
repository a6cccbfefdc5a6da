//! The harmonic of a recorded signal against the response of a first-order lag.

use std::f64::consts::TAU;

use crate::common::{circuit, element, program, volts};
use patchcord_analysis::instruments::harmonic;
use patchcord_core::solve::{self, RunSettings};

#[test]
fn a_sine_at_its_corner_comes_out_as_0_7071_and_45_degrees_late() {
    for time in [0.0065, 0.01, 0.02] {
        let corner = 1.0 / (TAU * time);
        let sine = element("sine").set("amplitude", 10).set("offset", -50).set("frequency", corner);
        let lag = element("lag").cords("x1", ["u"]).set("time", time).set("initial", 50);
        let builder = volts("Fig 8.15").drive("u", "volt", sine).element("E", lag);
        let patch = builder.run(30.0 / corner, 2e-5).record(["u", "E"]).build().unwrap();
        let settings = RunSettings::of(&circuit(&patch, &[])).unwrap();
        let trace = solve::run(&program(&patch, &[]), &settings).unwrap();
        // The first half holds what is left of the start.
        let half = trace.len() / 2;
        let read =
            |name| harmonic(&trace.time[half..], &trace.values(name).unwrap()[half..], corner).unwrap();
        let (input, output) = (read("u"), read("E"));
        assert!((output.amplitude / input.amplitude - 0.5f64.sqrt()).abs() < 1e-5, "{output:?}");
        assert!((output.mean - 50.0).abs() < 1e-6, "{output:?}");
        // Inverted, it is half a turn away besides.
        let late = (input.phase - output.phase).to_degrees().rem_euclid(360.0) - 180.0;
        assert!((late - 45.0).abs() < 1e-3, "{late}");
    }
}
