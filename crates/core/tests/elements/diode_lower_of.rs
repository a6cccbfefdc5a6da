//! A diode pair that passes on the lower of two voltages.

use proptest::prelude::*;
use serde_json::json;

use crate::common::{element, random_cases};
use crate::elements::bench::{ANY, computes_in_every_mode, has_exact_derivatives, has_no_lamp, output};
use patchcord_core::patch::ElementBuilder;

fn pair(drop: f64) -> ElementBuilder {
    element("diode-lower-of").set("in", json!(["a", "b"])).set("drop", drop)
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, b in ANY, drop in 0.0..5.0f64) {
        prop_assert_eq!(output(pair(drop), &[a, b]), a.min(b) + drop);
    }
}

#[test]
fn overload() {
    has_no_lamp(pair(5.0), &[100.0, 100.0], 105.0);
}

#[test]
fn modes() {
    let cases: [(&[f64], f64); 3] = [(&[60.0, 40.0], 42.0), (&[-60.0, 40.0], -58.0), (&[7.0, 9.0], 9.0)];
    computes_in_every_mode(pair(2.0), cases);
}

#[test]
fn derivatives() {
    let pair = element("diode-lower-of").set("in", json!(["a", "b"])).set("drop", "d");
    has_exact_derivatives(pair, -30.0, &[("d", 0.5, "1", [0.0, 1.0])]);
}
