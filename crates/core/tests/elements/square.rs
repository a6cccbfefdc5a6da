//! Drive: a square wave.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, voltage, volts};
use crate::elements::bench::{bench_drive, drive_stops_at_100_volts, near, out, waits_in_hold};
use patchcord_core::circuit::Circuit;
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::solve::{self, Backend, Machine, RunError, RunSettings};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(
        amplitude in -50.0..50.0f64, frequency in 0.1..20.0f64, duty in 0.0..=1.0f64, phase in -10.0..10.0f64,
        offset in -50.0..50.0f64, time in 0.0..1.0f64,
    ) {
        let square = element("square").set("amplitude", amplitude).set("frequency", frequency);
        let program = bench_drive(square.set("duty", duty).set("phase", phase).set("offset", offset));
        let fraction = (frequency * time + phase / TAU).rem_euclid(1.0);
        prop_assume!([0.0, duty, 1.0].iter().all(|edge| (fraction - edge).abs() > 1e-7));
        let expected = if fraction < duty { offset + amplitude } else { offset - amplitude };
        let found = out(&run_for(&program, 0.1, time));
        prop_assert!(near(found, expected), "{found} {expected}");
    }
}

#[test]
fn overload() {
    let square = element("square").set("amplitude", 40).set("frequency", 2).set("offset", 80);
    drive_stops_at_100_volts(square, 120.0);
}

#[test]
fn modes() {
    let square = element("square").set("amplitude", 40).set("frequency", 2.5).set("offset", 5);
    waits_in_hold(square, |time| if (2.5 * time).fract() < 0.5 { 45.0 } else { -35.0 });
}

#[test]
fn it_has_the_value_after_an_edge_at_the_edge() {
    let square = element("square").set("amplitude", 10).set("frequency", 10).set("duty", 0.25);
    let program = bench_drive(square);
    for (time, expected) in [(0.0, 10.0), (0.025, -10.0), (0.1, 10.0), (0.3, 10.0), (0.725, -10.0)] {
        for step in [1e-3, 0.04, 1.0] {
            assert_eq!(out(&run_for(&program, step, time)), expected, "{time} with step {step}");
        }
    }
}

/// A frequency in rad/s or rpm is converted, as for a sine.
#[test]
fn the_frequency_may_be_in_other_units() {
    for (value, unit) in [(2.0, "Hz"), (2.0 * TAU, "rad/s"), (120.0, "rpm")] {
        let square = element("square").set("amplitude", 10).set("frequency", "w");
        let builder = volts("units").parameter("w", value, unit, [0.1, 1e4]).drive("E", "volt", square);
        let program = built(builder);
        for (time, expected) in [(0.2, 10.0), (0.3, -10.0), (0.55, 10.0), (0.95, -10.0)] {
            assert_eq!(out(&run_for(&program, 0.07, time)), expected, "{value} {unit} at {time}");
        }
    }
}

/// A square wave of frequency f with a high part of 1/4, integrated by A1 and, behind a delay, by A2.
fn integrated() -> Program {
    let square = element("square").set("amplitude", 20).set("frequency", "f").set("duty", "d");
    built(
        volts("integrated")
            .parameter("f", 10.0, "Hz", [0.1, 1e9])
            .parameter("d", 0.25, "1", [0.0, 1.0])
            .drive("u", "volt", square.set("phase", "p").set("offset", 5))
            .parameter("p", 1.0, "1", [-10.0, 10.0])
            .element("D", element("delay").cord("in", "u").set("delay", 0.25))
            .element("A1", element("integrator").cords("x1", ["u"]))
            .element("A2", element("integrator").cords("x1", ["D"]))
            .record(["A1", "A2"])
            .run(1.0, 1e-3),
    )
}

/// Minus the integral of the wave from 0 to a time: the high part of each period counts 25 V, the rest -15 V.
fn integral(frequency: f64, duty: f64, phase: f64, time: f64) -> f64 {
    let high_until = |cycles: f64| duty * cycles.floor() + (cycles - cycles.floor()).min(duty);
    let start = phase / TAU;
    let high = (high_until(frequency * time + start) - high_until(start)) / frequency;
    -(25.0 * high - 15.0 * (time - high))
}

#[test]
fn no_step_reaches_across_an_edge() {
    let program = integrated();
    let expected = [integral(10.0, 0.25, 1.0, 1.0), integral(10.0, 0.25, 1.0, 0.75)];
    let assert_near = |found: &[f64], context: &str| {
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-10, "{context}: {found}, expected {expected}");
        }
    };
    for step in [1e-3, 0.0373, 0.25] {
        let machine = run_for(&program, step, 1.0);
        assert_near(&["A1", "A2"].map(|name| voltage(&machine, name)), &format!("step {step}"));
    }
    let mut machine = Machine::adaptive(&program, 1e-3, 1e-3).unwrap();
    machine.operate(1.0).unwrap();
    assert_near(&[voltage(&machine, "A1")], "adaptive steps");
    for backend in Backend::ALL {
        let settings = RunSettings::from_phases([Phase::operate(1.0)], 0.0125).with_signals(["A1", "A2"]);
        let trace = solve::run(&program, &settings.with_backend(backend)).unwrap();
        assert_near(&[0, 1].map(|track| *trace.tracks[track].volts.last().unwrap()), &format!("{backend}"));
    }
}

#[test]
fn derivatives() {
    let program = integrated();
    let mut machine = Machine::new(&program, 1e-2).unwrap();
    machine.differentiate(["f", "d", "p"]).unwrap();
    machine.operate(0.93).unwrap();
    let difference = |by: &str| {
        let at = |change: f64| {
            let [mut f, mut d, mut p] = [10.0, 0.25, 1.0];
            match by {
                "f" => f += change,
                "d" => d += change,
                _ => p += change,
            }
            integral(f, d, p, 0.93)
        };
        (at(1e-5) - at(-1e-5)) / 2e-5
    };
    for by in ["f", "d", "p"] {
        let (found, expected) = (machine.sensitivity("A1", by).unwrap(), difference(by));
        assert!((found - expected).abs() < 1e-5, "by {by}: {found}, expected {expected}");
    }
}

#[test]
fn an_edge_exactly_at_the_start_has_no_derivative_by_the_phase() {
    let square = element("square").set("amplitude", 20).set("frequency", 1).set("phase", "p");
    let builder = volts("start").parameter("p", 0.0, "1", [-PI, PI]).drive("u", "volt", square);
    let program = built(builder.element("A1", element("integrator").cords("x1", ["u"])));
    let mut machine = Machine::new(&program, 1e-2).unwrap();
    let error = machine.differentiate(["p"]).unwrap_err();
    assert_eq!(error.code(), "no-derivative");
    assert!(error.to_string().contains("u has an edge exactly at t = 0"), "{error}");
}

#[test]
fn the_frequency_can_be_changed_during_a_run() {
    let program = integrated();
    let mut machine = run_for(&program, 0.01, 0.11);
    for (frequency, time) in [(3.0, 0.11), (40.0, 0.2), (0.5, 0.5)] {
        machine.set_parameter("f", frequency).unwrap();
        let is_high = (frequency * time + 1.0 / TAU).fract() < 0.25;
        assert_eq!(voltage(&machine, "u"), if is_high { 25.0 } else { -15.0 }, "{frequency} Hz at {time}");
        machine.operate(if time < 0.2 { 0.09 } else { 0.3 }).unwrap();
    }
}

#[test]
fn too_many_edges_in_a_run_are_refused() {
    let square = element("square").set("amplitude", 1).set("frequency", 1e9);
    let patch = volts("fast").drive("u", "volt", square).record(["u"]).build().unwrap();
    let circuit = Circuit::new(&patch).unwrap();
    let settings = RunSettings::of(&circuit).unwrap().with_step(1.0).with_sample_interval(1.0);
    let program = Program::new(&circuit).unwrap();
    let stopped = solve::run(&program, &settings.with_duration(200.0)).unwrap_err();
    assert!(matches!(&stopped.error, RunError::PulsesTooFast { element, .. } if element == "u"), "{stopped}");
    assert_eq!(stopped.error.code(), "pulses-too-fast");
}
