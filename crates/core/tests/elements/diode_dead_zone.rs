//! The diode network of the dead zone.

use proptest::prelude::*;

use crate::common::{element, random_cases};
use crate::elements::bench::{ANY, computes_in_every_mode, has_exact_derivatives, has_no_lamp, near, output};
use patchcord_core::patch::ElementBuilder;

fn zone(setting: f64) -> ElementBuilder {
    let zone = element("diode-dead-zone").cord("in", "a").cord("bias_plus", "b").cord("bias_minus", "c");
    zone.set("setting", setting)
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, bias in 0.0..100.0f64, r in 0.0..1.0f64, drop in 0.0..5.0f64) {
        let out = |a: f64| output(zone(r).set("drop", drop), &[a, bias, -bias]);
        // The output is 0 while the bias blocks the diodes. Beyond that the slope is 1 - r.
        let excess = (a.abs() * (1.0 - r) - r * bias - drop).max(0.0);
        prop_assert!((out(a) - excess.copysign(a)).abs() < 1e-12, "{} {excess}", out(a));
        prop_assert_eq!(out(-a), -out(a));
    }

    #[test]
    fn each_bias_determines_one_edge(a in ANY, plus in 0.0..100.0f64, minus in -100.0..0.0f64) {
        let (upper, lower) = (0.75 * a + 0.25 * minus, 0.75 * a + 0.25 * plus);
        let expected = upper.max(0.0) + lower.min(0.0);
        prop_assert!(near(output(zone(0.25), &[a, plus, minus]), expected));
    }
}

#[test]
fn overload() {
    // Both diodes conduct if the biases are exchanged: 75 + 25 and 75 - 25 V.
    has_no_lamp(zone(0.25), &[100.0, -100.0, 100.0], 100.0);
    // The same with 110 V: 82.5 + 25 V.
    has_no_lamp(zone(0.25).cord("in", "high"), &[100.0, -100.0, 100.0], 107.5);
}

#[test]
fn modes() {
    let cases: [(&[f64], f64); 3] =
        [(&[60.0, 40.0, -40.0], 20.0), (&[-60.0, 40.0, -40.0], -20.0), (&[20.0, 40.0, -40.0], 0.0)];
    computes_in_every_mode(zone(0.5).set("drop", 0), cases.map(|(volts, out)| (volts, out * 0.5)));
}

#[test]
fn derivatives() {
    let zone = element("diode-dead-zone").cord("in", "a").cord("bias_plus", "b").cord("bias_minus", "ground");
    has_exact_derivatives(zone.set("setting", "r"), 40.0, &[("r", 0.3, "1", [0.0, 1.0])]);
}
