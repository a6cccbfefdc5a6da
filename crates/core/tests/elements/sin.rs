//! Sine of a voltage.

use std::f64::consts::PI;

use proptest::prelude::*;

use crate::common::{element, random_cases};
use crate::elements::bench::{
    ANY, assert_out, at, bench, computes_in_every_mode, has_exact_derivatives, output,
};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, amplitude in ANY, scale in -1.0..1.0f64) {
        let preset = output(element("sin").cord("in", "a"), &[a]);
        prop_assert!((preset - 100.0 * (PI * a / 100.0).sin()).abs() < 1e-12);
        let set = element("sin").cord("in", "a").set("amplitude", amplitude).set("angle_per_volt", scale);
        // The rounding of an angle of 100 rad is 1e-14.
        prop_assert!((output(set, &[a]) - amplitude * (scale * a).sin()).abs() < 1e-11);
    }
}

#[test]
fn overload() {
    for amplitude in [100.0, -100.0] {
        let program = bench(element("sin").cord("in", "a").set("amplitude", amplitude));
        let machine = at(&program, &[50.0]);
        assert_out(&machine, amplitude, "at its amplitude");
        assert!(!machine.is_overloaded());
    }
}

#[test]
fn modes() {
    let wave = element("sin").cord("in", "a").set("amplitude", 40);
    computes_in_every_mode(wave, [(&[50.0], 40.0), (&[-50.0], -40.0), (&[0.0], 0.0)]);
}

#[test]
fn derivatives() {
    let wave = element("sin").cord("in", "a").set("amplitude", "A").set("angle_per_volt", "w");
    let settings = [("A", 60.0, "1", [1.0, 99.0]), ("w", 0.02, "rad/V", [0.0, 1.0])];
    has_exact_derivatives(wave, 40.0, &settings);
}

#[test]
fn the_sine_continues_beyond_100_volts() {
    let program = bench(element("sin").cord("in", "high"));
    assert_out(&at(&program, &[100.0]), -100.0 * (PI * 0.1).sin(), "at 198 degrees");
}
