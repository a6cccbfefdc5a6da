//! Drive: a triangular wave.

use proptest::prelude::*;

use crate::common::{element, random_cases, run_for};
use crate::elements::bench::{bench_drive, drive_stops_at_100_volts, out, waits_in_hold};

/// From 0 up to 1, down to -1 and back to 0 in one period: the arcsine of the sine.
fn tri(periods: f64) -> f64 {
    (std::f64::consts::TAU * periods).sin().asin() / std::f64::consts::FRAC_PI_2
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(amplitude in 0.0..50.0f64, frequency in 0.1..5.0f64, offset in -50.0..50.0f64, time in 0.0..1.0f64) {
        let triangle = element("triangle").set("amplitude", amplitude).set("frequency", frequency);
        let program = bench_drive(triangle.set("offset", offset));
        let (found, expected) = (out(&run_for(&program, 0.1, time)), offset + amplitude * tri(frequency * time));
        // The arcsine loses half of the digits near ±1.
        prop_assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}

#[test]
fn overload() {
    let triangle = element("triangle").set("amplitude", 10).set("frequency", 1).set("offset", 120);
    drive_stops_at_100_volts(triangle, 120.0);
}

#[test]
fn modes() {
    let triangle = element("triangle").set("amplitude", 40).set("frequency", 0.5).set("offset", 5);
    waits_in_hold(triangle, |time| 5.0 + 40.0 * if time < 0.5 { 2.0 * time } else { 2.0 - 2.0 * time });
}
