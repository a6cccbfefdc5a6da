//! Potentiometer with one end grounded.

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, voltage, volts};
use crate::elements::bench::{
    ANY, assert_out, at, bench, computes_in_every_mode, has_exact_derivatives, has_no_lamp, output,
};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, setting in 0.0..1.0f64) {
        prop_assert_eq!(output(element("pot").cord("in", "a").set("setting", setting), &[a]), setting * a);
    }
}

#[test]
fn overload() {
    has_no_lamp(element("pot").cord("in", "low").set("setting", 1), &[-100.0], -110.0);
}

#[test]
fn modes() {
    let pot = element("pot").cord("in", "a").set("setting", 0.25);
    computes_in_every_mode(pot, [(&[80.0], 20.0), (&[-4.0], -1.0), (&[100.0], 25.0)]);
}

#[test]
fn a_pot_can_be_changed_in_hold() {
    let builder = volts("changed").parameter("s", 0.5, "1", [0.0, 1.0]);
    let pot = element("pot").cord("in", "+100").set("setting", "s");
    let program = built(builder.element("P", pot));
    let mut machine = run_for(&program, 1e-3, 0.1);
    machine.hold();
    machine.set_parameter("s", 0.7).unwrap();
    assert_eq!(voltage(&machine, "P"), 70.0);
}

#[test]
fn derivatives() {
    let pot = element("pot").cord("in", "a").set("setting", "s");
    has_exact_derivatives(pot, 40.0, &[("s", 0.3, "1", [0.0, 1.0])]);
}

#[test]
fn the_settings_0_and_1_are_the_ends_of_the_pot() {
    for (setting, expected) in [(0, 0.0), (1, -63.0)] {
        let program = bench(element("pot").cord("in", "a").set("setting", setting));
        assert_out(&at(&program, &[-63.0]), expected, "at an end");
    }
}
