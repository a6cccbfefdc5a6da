//! Drive: a step.

use proptest::prelude::*;

use crate::common::{element, random_cases, run_for};
use crate::elements::bench::{ANY, bench_drive, drive_stops_at_100_volts, out, waits_in_hold};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(height in ANY, at in 0.0..1.0f64, time in 0.0..1.0f64) {
        prop_assume!((time - at).abs() > 1e-9);
        let program = bench_drive(element("step").set("height", height).set("at", at));
        prop_assert_eq!(out(&run_for(&program, 0.1, time)), if time >= at { height } else { 0.0 });
    }
}

#[test]
fn overload() {
    drive_stops_at_100_volts(element("step").set("height", 130), 130.0);
}

#[test]
fn modes() {
    waits_in_hold(
        element("step").set("height", 30).set("at", 0.5),
        |time| if time < 0.5 { 0.0 } else { 30.0 },
    );
}
