//! Ideal dead zone.

use proptest::prelude::*;

use crate::common::{element, random_cases};
use crate::elements::bench::{
    ANY, clip, computes_in_every_mode, has_exact_derivatives, near, output, stops_at_100_volts,
};
use patchcord_core::patch::ElementBuilder;

fn zone(lower: f64, upper: f64) -> ElementBuilder {
    element("dead-zone").cord("in", "a").set("lower", lower).set("upper", upper)
}

proptest! {
    #![proptest_config(random_cases(96))]

    #[test]
    fn law(a in ANY, lower in -100.0..99.0f64, width in 0.01..1.0f64, slope in 0.0..5.0f64) {
        let upper = lower + width * (100.0 - lower);
        let excess = if a > upper { a - upper } else if a < lower { a - lower } else { 0.0 };
        prop_assert!(near(output(zone(lower, upper), &[a]), clip(excess)));
        prop_assert!(near(output(zone(lower, upper).set("slope", slope), &[a]), clip(slope * excess)));
    }
}

#[test]
fn overload() {
    stops_at_100_volts(zone(-10.0, 20.0).set("slope", 2), &[90.0], 140.0);
    stops_at_100_volts(zone(-10.0, 20.0).set("slope", 2), &[-90.0], -160.0);
}

#[test]
fn modes() {
    computes_in_every_mode(zone(-10.0, 20.0), [(&[50.0], 30.0), (&[-9.0], 0.0), (&[-100.0], -90.0)]);
}

#[test]
fn derivatives() {
    let zone = || element("dead-zone").cord("in", "a").set("lower", "l").set("upper", "u").set("slope", "s");
    let settings =
        [("l", -8.0, "1", [-50.0, 0.0]), ("u", 5.0, "1", [0.0, 50.0]), ("s", 0.7, "1", [0.0, 3.0])];
    for start in [40.0, 0.5, -40.0] {
        has_exact_derivatives(zone(), start, &settings);
    }
}
