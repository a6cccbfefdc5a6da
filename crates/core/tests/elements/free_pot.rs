//! Potentiometer with both ends free.

use proptest::prelude::*;
use serde_json::Value;

use crate::common::{element, random_cases};
use crate::elements::bench::{ANY, computes_in_every_mode, has_exact_derivatives, has_no_lamp, near, output};
use patchcord_core::patch::ElementBuilder;

fn pot(setting: impl Into<Value>) -> ElementBuilder {
    element("free-pot").cord("in", "a").cord("end", "b").set("setting", setting)
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, b in ANY, setting in 0.0..1.0f64) {
        prop_assert!(near(output(pot(setting), &[a, b]), setting * a + (1.0 - setting) * b));
    }
}

#[test]
fn overload() {
    has_no_lamp(pot(0.5).cord("in", "high").cord("end", "high"), &[100.0], 110.0);
}

#[test]
fn modes() {
    computes_in_every_mode(pot(0.25), [(&[80.0, 40.0], 50.0), (&[-4.0, 0.0], -1.0), (&[0.0, 100.0], 75.0)]);
}

#[test]
fn a_free_end_at_ground_makes_it_a_pot() {
    let grounded = pot(0.3).cord("end", "ground");
    let pot = element("pot").cord("in", "a").set("setting", 0.3);
    assert_eq!(output(grounded, &[61.0]), output(pot, &[61.0]));
}

#[test]
fn derivatives() {
    has_exact_derivatives(pot("s"), 40.0, &[("s", 0.3, "1", [0.0, 1.0])]);
}
