//! Inverting amplifier.

use proptest::prelude::*;

use crate::common::{element, random_cases};
use crate::elements::bench::{
    ANY, computes_in_every_mode, has_exact_derivatives, output, stops_at_100_volts,
};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY) {
        prop_assert_eq!(output(element("inverter").cord("in", "a"), &[a]), -a);
    }
}

#[test]
fn overload() {
    stops_at_100_volts(element("inverter").cord("in", "high"), &[100.0], -110.0);
    stops_at_100_volts(element("inverter").cord("in", "low"), &[-95.0], 105.0);
}

#[test]
fn modes() {
    let inverter = element("inverter").cord("in", "a");
    computes_in_every_mode(inverter, [(&[10.0], -10.0), (&[-7.0], 7.0), (&[100.0], -100.0)]);
}

#[test]
fn derivatives() {
    has_exact_derivatives(element("inverter").cord("in", "a"), 20.0, &[]);
}
