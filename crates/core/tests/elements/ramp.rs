//! Drive: a ramp.

use proptest::prelude::*;

use crate::common::{element, random_cases, run_for};
use crate::elements::bench::{ANY, bench_drive, clip, drive_stops_at_100_volts, near, out, waits_in_hold};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(start in ANY, rate in ANY, turn in 0.0..1.0f64, turns: bool, time in 0.0..1.0f64) {
        let ramp = element("ramp").set("start", start).set("rate", rate);
        let program = bench_drive(if turns { ramp.set("turn", turn) } else { ramp });
        let run = if turns && time > turn { 2.0 * turn - time } else { time };
        let found = out(&run_for(&program, 0.1, time));
        prop_assert!(near(found, clip(start + rate * run)), "{found}");
    }
}

#[test]
fn overload() {
    drive_stops_at_100_volts(element("ramp").set("start", -130).set("rate", 10), -130.0);
}

#[test]
fn modes() {
    let ramp = element("ramp").set("start", 20).set("rate", 50).set("turn", 0.4);
    waits_in_hold(ramp, |time| 20.0 + 50.0 * if time > 0.4 { 0.8 - time } else { time });
}
