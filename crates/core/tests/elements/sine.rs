//! Drive: a sine wave.

use std::f64::consts::TAU;

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, volts};
use crate::elements::bench::{bench_drive, drive_stops_at_100_volts, out, waits_in_hold};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(
        amplitude in 0.0..50.0f64, frequency in 0.1..5.0f64, phase in -3.0..3.0f64, offset in -50.0..50.0f64,
        time in 0.0..1.0f64,
    ) {
        let sine = element("sine").set("amplitude", amplitude).set("frequency", frequency).set("phase", phase);
        let program = bench_drive(sine.set("offset", offset));
        let expected = offset + amplitude * (TAU * frequency * time + phase).sin();
        let found = out(&run_for(&program, 0.1, time));
        prop_assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

/// Each pair of value and unit is 2 Hz.
#[test]
fn a_frequency_is_converted_to_cycles_per_second() {
    let cases = [
        (2.0, "Hz", "w"),
        (2.0, "1/s", "w"),
        (2e-3, "kHz", "w"),
        (2e3, "mHz", "w"),
        (120.0, "1/min", "w"),
        (2.0 * TAU, "rad/s", "w"),
        (120.0, "rpm", "w"),
        (720.0, "deg/s", "w"),
        (4.0 * TAU, "rad/s", "0.5 * w"),
        (2.0 * TAU, "rad/s", "sqrt(w^2)"),
        (2.0 * TAU, "rad/s", "w / (2 * pi)"),
        (120.0, "rpm", "w / 2 / pi"),
        (1.0 / TAU, "Hz", "4 * pi * w"),
    ];
    for (value, unit, formula) in cases {
        let sine = element("sine").set("amplitude", 40).set("frequency", formula);
        let builder = volts("two cycles").parameter("w", value, unit, [0.0, 1e6]).drive("E", "volt", sine);
        let program = built(builder);
        for time in [0.05, 0.3] {
            let (found, expected) = (out(&run_for(&program, 0.01, time)), 40.0 * (TAU * 2.0 * time).sin());
            assert!((found - expected).abs() < 1e-11, "{value} {unit} {formula}: {found} {expected}");
        }
    }
}

#[test]
fn overload() {
    let sine = element("sine").set("amplitude", 30).set("frequency", 1).set("offset", -120);
    drive_stops_at_100_volts(sine, -120.0);
}

#[test]
fn modes() {
    let sine = element("sine").set("amplitude", 40).set("frequency", 0.5).set("phase", 1).set("offset", 5);
    waits_in_hold(sine, |time| 5.0 + 40.0 * (TAU * 0.5 * time + 1.0).sin());
}
