//! Drive: a sine wave whose frequency sweeps.

use std::f64::consts::TAU;

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, voltage, volts};
use crate::elements::bench::{bench_drive, drive_stops_at_100_volts, out, waits_in_hold};
use patchcord_core::document::Phase;
use patchcord_core::patch::ElementBuilder;
use patchcord_core::solve::{self, Backend, Machine, RunSettings};

/// A chirp of 40 V between two frequencies in Hz, in a time in seconds.
fn chirp(sweep: &str, from: f64, to: f64, time: f64) -> ElementBuilder {
    let wave = element("chirp").set("amplitude", 40).set("from", from).set("to", to).set("time", time);
    wave.set("sweep", sweep)
}

/// The number of cycles since t = 0: the integral of the frequency.
fn cycles(sweep: &str, [from, to]: [f64; 2], length: f64, time: f64) -> f64 {
    let swept = time.min(length);
    let in_sweep = if sweep == "linear" {
        from * swept + 0.5 * (to - from) * swept * swept / length
    } else if from == to {
        from * swept
    } else {
        let logarithm = (to / from).ln();
        from * length / logarithm * (logarithm * swept / length).exp_m1()
    };
    in_sweep + to * (time - swept)
}

/// The voltage of the chirp at a time.
fn wave(sweep: &str, frequencies: [f64; 2], length: f64, time: f64) -> f64 {
    40.0 * (TAU * cycles(sweep, frequencies, length, time)).sin()
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(
        logarithmic: bool, from in 0.1..20.0f64, to in 0.1..20.0f64, length in 0.1..2.0f64,
        phase in -3.0..3.0f64, offset in -50.0..50.0f64, time in 0.0..1.5f64,
    ) {
        let sweep = if logarithmic { "logarithmic" } else { "linear" };
        let program = bench_drive(chirp(sweep, from, to, length).set("phase", phase).set("offset", offset));
        let angle = TAU * cycles(sweep, [from, to], length, time) + phase;
        let (found, expected) = (out(&run_for(&program, 0.1, time)), offset + 40.0 * angle.sin());
        prop_assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

#[test]
fn overload() {
    drive_stops_at_100_volts(chirp("linear", 1.0, 2.0, 1.0).set("offset", 120), 120.0);
}

#[test]
fn modes() {
    for sweep in ["linear", "logarithmic"] {
        waits_in_hold(chirp(sweep, 0.5, 2.0, 0.5), |time| wave(sweep, [0.5, 2.0], 0.5, time));
    }
}

/// Equal frequencies give a sine. Nearly equal ones lose no digits.
#[test]
fn a_sweep_between_equal_frequencies_is_a_sine() {
    for distance in [0.0, 1e-12, 1e-9, 1e-7, 1e-4, -1e-9, -1e-4f64] {
        let [from, to] = [3.0, 3.0 * (1.0 + distance)];
        let program = bench_drive(chirp("logarithmic", from, to, 1.0));
        for time in [0.0, 0.4, 1.0, 1.3] {
            let (found, expected) =
                (out(&run_for(&program, 0.01, time)), wave("linear", [from, to], 1.0, time));
            // A linear and a logarithmic sweep differ by the square of the distance.
            let allowed = if distance.abs() <= 1e-7 { 1e-10 } else { 1e-6 };
            assert!((found - expected).abs() < allowed, "{distance} at {time}: {found} {expected}");
        }
    }
}

#[test]
fn both_frequencies_may_be_in_other_units() {
    let swept = element("chirp").set("amplitude", 40).set("from", "v").set("to", "w").set("time", 1);
    let builder = volts("units")
        .parameter("v", TAU, "rad/s", [0.1, 100.0])
        .parameter("w", 180.0, "rpm", [1.0, 1e4])
        .drive("E", "volt", swept);
    let program = built(builder);
    for time in [0.3, 0.9, 1.2] {
        let (found, expected) = (out(&run_for(&program, 0.01, time)), wave("linear", [1.0, 3.0], 1.0, time));
        assert!((found - expected).abs() < 1e-9, "{time}: {found} {expected}");
    }
}

#[test]
fn backends_agree() {
    for sweep in ["linear", "logarithmic"] {
        let builder = volts("sweep").drive("u", "volt", chirp(sweep, 1.0, 8.0, 0.7));
        let program = built(builder.element("A1", element("integrator").cords("x1", ["u"])));
        let reference = voltage(&run_for(&program, 1e-4, 1.0), "A1");
        for backend in Backend::ALL {
            let settings = RunSettings::from_phases([Phase::operate(1.0)], 1e-3).with_signals(["u", "A1"]);
            let trace = solve::run(&program, &settings.with_backend(backend)).unwrap();
            let last = |track: usize| *trace.tracks[track].volts.last().unwrap();
            assert!((last(0) - wave(sweep, [1.0, 8.0], 0.7, 1.0)).abs() < 1e-9, "{sweep} {backend}");
            assert!((last(1) - reference).abs() < 1e-7, "{sweep} {backend}: {} {reference}", last(1));
        }
        let mut machine = Machine::adaptive(&program, 1e-8, 1e-3).unwrap();
        machine.operate(1.0).unwrap();
        assert!((voltage(&machine, "A1") - reference).abs() < 1e-5, "{sweep} with adaptive steps");
    }
}

#[test]
fn derivatives() {
    for sweep in ["linear", "logarithmic"] {
        let swept = element("chirp").set("amplitude", 40).set("from", "v").set("to", "w").set("time", "T");
        let builder = volts("derivatives")
            .parameter("v", 1.0, "Hz", [0.1, 10.0])
            .parameter("w", 3.0, "Hz", [0.1, 10.0])
            .parameter("T", 0.8, "s", [0.1, 10.0])
            .drive("u", "volt", swept.set("sweep", sweep));
        let program = built(builder);
        let mut machine = Machine::new(&program, 1e-2).unwrap();
        machine.differentiate(["v", "w", "T"]).unwrap();
        for time in [0.5, 1.1] {
            machine.operate(time - machine.time()).unwrap();
            for (index, by) in ["v", "w", "T"].into_iter().enumerate() {
                let at = |change: f64| {
                    let mut values = [1.0, 3.0, 0.8];
                    values[index] += change;
                    wave(sweep, [values[0], values[1]], values[2], time)
                };
                let expected = (at(1e-6) - at(-1e-6)) / 2e-6;
                let found = machine.sensitivity("u", by).unwrap();
                assert!((found - expected).abs() < 1e-5, "{sweep} by {by} at {time}: {found} {expected}");
            }
        }
    }
}
