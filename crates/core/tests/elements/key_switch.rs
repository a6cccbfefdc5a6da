//! Key switch.

use proptest::prelude::*;

use crate::common::{element, random_cases};
use crate::elements::bench::{ANY, computes_in_every_mode, has_exact_derivatives, has_no_lamp, output};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, closed: bool) {
        let switch = element("key-switch").cord("in", "a").set("closed", closed);
        prop_assert_eq!(output(switch, &[a]), if closed { a } else { 0.0 });
    }
}

#[test]
fn overload() {
    has_no_lamp(element("key-switch").cord("in", "high"), &[100.0], 110.0);
}

#[test]
fn modes() {
    let switch = || element("key-switch").cord("in", "a");
    computes_in_every_mode(switch(), [(&[80.0], 80.0), (&[-4.0], -4.0), (&[7.0], 7.0)]);
    let open = switch().set("closed", false);
    computes_in_every_mode(open, [(&[80.0], 0.0), (&[-4.0], 0.0), (&[7.0], 0.0)]);
}

#[test]
fn derivatives() {
    has_exact_derivatives(element("key-switch").cord("in", "a"), 40.0, &[]);
}
