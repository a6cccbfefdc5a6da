//! The harmonic of a recorded signal, compared with the response of a first-order lag.

use std::f64::consts::TAU;

use crate::common::{circuit, element, program, volts};
use patchcord_analysis::instruments::harmonic;
use patchcord_core::solve::{self, RunSettings};

#[test]
fn a_lag_at_its_corner_frequency_gives_0_7071_and_45_degrees() {
    for time in [0.0065, 0.01, 0.02] {
        let corner = 1.0 / (TAU * time);
        let sine = element("sine").set("amplitude", 10).set("offset", -50).set("frequency", corner);
        let lag = element("lag").cords("x1", ["u"]).set("time", time).set("initial", 50);
        let builder = volts("Fig 8.15").drive("u", "volt", sine).element("E", lag);
        let patch = builder.run(30.0 / corner, 2e-5).record(["u", "E"]).build().unwrap();
        let settings = RunSettings::of(&circuit(&patch, &[])).unwrap();
        let trace = solve::run(&program(&patch, &[]), &settings).unwrap();
        // The first half contains the transient.
        let half = trace.len() / 2;
        let harmonic_of =
            |name| harmonic(&trace.time[half..], &trace.values(name).unwrap()[half..], corner).unwrap();
        let (input, output) = (harmonic_of("u"), harmonic_of("E"));
        assert!((output.amplitude / input.amplitude - 0.5f64.sqrt()).abs() < 1e-5, "{output:?}");
        assert!((output.mean - 50.0).abs() < 1e-6, "{output:?}");
        // The lag inverts, which adds half a turn.
        let phase_lag = (input.phase - output.phase).to_degrees().rem_euclid(360.0) - 180.0;
        assert!((phase_lag - 45.0).abs() < 1e-3, "{phase_lag}");
    }
}
