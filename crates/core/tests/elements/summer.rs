//! Summing amplifier.

use proptest::prelude::*;
use serde_json::json;

use crate::common::{element, random_cases};
use crate::elements::bench::{
    ANY, clip, computes_in_every_mode, has_exact_derivatives, near, output, stops_at_100_volts,
};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, b in ANY, c in ANY) {
        let summer = element("summer").cords("x1", ["a"]).cords("x10", ["b"]).cords("x0.5", ["c"]);
        prop_assert!(near(output(summer, &[a, b, c]), clip(-(a + 10.0 * b + 0.5 * c))));
    }

    #[test]
    fn soft_limits_follow_their_formula(
        a in ANY, upper in 0.0..90.0f64, lower in -90.0..-1.0f64, slope in 0.0..1.0f64, drop in 0.0..5.0f64,
    ) {
        let limit = json!({"upper": upper, "lower": lower, "slope": slope, "drop": drop});
        let out = output(element("summer").cords("x1", ["a"]).set("limit", limit), &[a]);
        let (high, low) = (upper + drop, lower - drop);
        let soft_limit = |limit: f64| limit + slope * (-a - limit);
        let expected = if -a > high { soft_limit(high) } else if -a < low { soft_limit(low) } else { -a };
        prop_assert!(near(out, expected), "{out} {expected}");
    }
}

#[test]
fn overload() {
    let summer = || element("summer").cords("x2", ["a"]);
    stops_at_100_volts(summer(), &[70.0], -140.0);
    stops_at_100_volts(summer(), &[-51.0], 102.0);
}

#[test]
fn modes() {
    let summer = element("summer").cords("x2", ["a"]).cords("x1", ["b"]);
    computes_in_every_mode(summer, [(&[10.0, 5.0], -25.0), (&[-7.0, 0.0], 14.0), (&[3.0, 30.0], -36.0)]);
}

#[test]
fn derivatives() {
    let limit = json!({"upper": "level", "slope": 0.3});
    let summer = element("summer").cords("x2", ["a"]).cords("x1", ["b"]).set("limit", limit);
    has_exact_derivatives(summer, -20.0, &[("level", 15.0, "1", [1.0, 50.0])]);
}
