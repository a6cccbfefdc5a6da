//! Exponential of a voltage. The module log tests that it is the inverse of the logarithm.

use proptest::prelude::*;
use serde_json::json;

use crate::common::{built, element, random_cases, run_for, source, voltage, volts};
use crate::elements::bench::{
    ANY, clip, computes_in_every_mode, has_exact_derivatives, near, output, stops_at_100_volts,
};

proptest! {
    #![proptest_config(random_cases(96))]

    #[test]
    fn law(a in ANY, reference in 0.01..100.0f64, per_decade in 1.0..100.0f64) {
        prop_assert!(near(output(element("exp").cord("in", "a"), &[a]), clip((a / 50.0 * 10f64.ln()).exp())));
        let set = element("exp").cord("in", "a").set("reference", reference).set("per_decade", per_decade);
        let expected = clip(reference * (a / per_decade * 10f64.ln()).exp());
        prop_assert!((output(set, &[a]) - expected).abs() <= 1e-12 * (1.0 + expected));
    }
}

#[test]
fn overload() {
    let exp = || element("exp").cord("in", "a");
    stops_at_100_volts(exp().set("reference", 2), &[100.0], 200.0);
    // The smallest permitted "per_decade".
    stops_at_100_volts(exp().set("per_decade", 1), &[100.0], 1e100);
    stops_at_100_volts(exp().set("per_decade", 1).set("reference", 100), &[100.0], 1e102);
}

#[test]
fn modes() {
    computes_in_every_mode(
        element("exp").cord("in", "a"),
        [(&[50.0], 10.0), (&[0.0], 1.0), (&[-100.0], 0.01)],
    );
}

#[test]
fn derivatives() {
    let exp = element("exp").cord("in", "a").set("reference", "r").set("per_decade", "d");
    has_exact_derivatives(exp, 20.0, &[("r", 2.0, "1", [0.1, 10.0]), ("d", 20.0, "1", [1.0, 50.0])]);
}

#[test]
fn an_exponential_that_overflows_stops_at_100_volts() {
    // 40 diode pairs of 10 V raise 100 V to 500 V, and 10^500 is not a finite number.
    let builder = source(volts("high"), "D0", 100.0);
    let builder = (1..=40).fold(builder, |builder, index| {
        let from = format!("D{}", index - 1);
        let pair = element("diode-lower-of").set("in", json!([from, from])).set("drop", 10);
        builder.element(&format!("D{index}"), pair)
    });
    let program = built(builder.element("E", element("exp").cord("in", "D40").set("per_decade", 1)));
    assert_eq!(voltage(&run_for(&program, 1e-3, 1e-2), "E"), 100.0);
}
