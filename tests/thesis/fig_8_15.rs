//! Fig 8.15: the lag alone, with a sine in the place of X3.

use std::f64::consts::TAU;

use patchcord::instruments::harmonic;
use patchcord::patch::{ElementBuilder, Patch, PatchBuilder};

use crate::bench;

fn corner(tc: f64) -> f64 {
    1.0 / (TAU * tc)
}

fn lag(tc: f64) -> Patch {
    let sine =
        ElementBuilder::new("sine").set("amplitude", 10).set("offset", -50).set("frequency", corner(tc));
    let error = ElementBuilder::new("summer").cords("x10", ["PA2"]).cords("x1", ["X3", "B1"]);
    let memory = ElementBuilder::new("integrator").cords("x1000", ["PA1"]).set("initial", 100);
    PatchBuilder::new("Fig 8.15")
        .machine("solartron-1451")
        .scale("volts", 1, "V")
        .drive("X3", "volts", sine)
        .element("KS1", ElementBuilder::new("key-switch").cord("in", "+100").set("closed", true))
        .element("PA2", ElementBuilder::new("pot").cord("in", "KS1").set("setting", 0.1))
        .element("A2", error)
        .element("PA1", ElementBuilder::new("pot").cord("in", "A2").set("setting", 0.001 / tc))
        .element("A1", memory)
        .element("B1", ElementBuilder::new("summer").cords("x1", ["A1"]))
        .signal("out", "A1", "volts", 1.0)
        .run(30.0 / corner(tc), 2e-5)
        .record(["X3", "out"])
        .build()
        .unwrap()
}

#[test]
fn ten_volts_at_the_corner_come_out_as_7_07_and_45_degrees_late() {
    for tc in [0.0065, 0.01, 0.02] {
        let trace = bench::run_patch(&lag(tc));
        // The first half holds what is left of the start.
        let half = trace.len() / 2;
        let read =
            |name| harmonic(&trace.time[half..], &trace.values(name).unwrap()[half..], corner(tc)).unwrap();
        let (input, output) = (read("X3"), read("out"));
        let late = (input.phase - output.phase).to_degrees();
        assert!((output.amplitude - 7.07).abs() < 0.005, "{output:?}");
        assert!((output.mean - 50.0).abs() < 1e-6, "{output:?}");
        assert!((late - 45.0).abs() < 0.01, "{late}");
    }
}
