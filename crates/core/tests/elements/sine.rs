//! Drive: a sine wave.

use std::f64::consts::TAU;

use proptest::prelude::*;

use crate::common::{element, random_cases, run_for};
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
