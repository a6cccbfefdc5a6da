//! Absolute value.

use proptest::prelude::*;

use crate::common::{element, random_cases};
use crate::elements::bench::{
    ANY, computes_in_every_mode, has_exact_derivatives, output, stops_at_100_volts,
};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY) {
        prop_assert_eq!(output(element("absolute").cord("in", "a"), &[a]), if a < 0.0 { -a } else { a });
    }
}

#[test]
fn overload() {
    stops_at_100_volts(element("absolute").cord("in", "high"), &[100.0], 110.0);
    stops_at_100_volts(element("absolute").cord("in", "low"), &[-100.0], 110.0);
}

#[test]
fn modes() {
    let absolute = element("absolute").cord("in", "a");
    computes_in_every_mode(absolute, [(&[10.0], 10.0), (&[-7.0], 7.0), (&[-100.0], 100.0)]);
}

#[test]
fn derivatives() {
    for start in [-20.0, 20.0] {
        has_exact_derivatives(element("absolute").cord("in", "a"), start, &[]);
    }
}
