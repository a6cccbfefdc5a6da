//! Comparator with a relay. crates/core/tests/relay.rs tests the times of switching.

use proptest::prelude::*;

use crate::common::{element, random_cases};
use crate::elements::bench::{ANY, apply, assert_out, at, bench, has_no_lamp, output};
use patchcord_core::patch::ElementBuilder;

fn relay(pull_in: f64, drop_out: f64) -> ElementBuilder {
    let relay = element("relay").cord("in", "a").cord("on", "b").cord("off", "c");
    relay.set("pull_in", pull_in).set("drop_out", drop_out)
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(a in ANY, low in ANY, width in 0.1..50.0f64, closed: bool) {
        let high = (low + width).min(100.0);
        let is_on = if a >= high { true } else if a <= low { false } else { closed };
        let out = output(relay(high, low).set("closed", closed), &[a, 7.0, -3.0]);
        prop_assert_eq!(out, if is_on { 7.0 } else { -3.0 });
    }
}

#[test]
fn a_relay_compares_two_voltages() {
    let relay = element("relay").cord("in", "a").cord("against", "b").cord("on", "+100").cord("off", "c");
    let program = bench(relay.set("pull_in", 2).set("drop_out", -2));
    let mut machine = at(&program, &[50.0, 50.0, -3.0]);
    for (a, b, expected) in [(50.0, 50.0, -3.0), (52.0, 50.0, 100.0), (52.0, 53.9, 100.0), (52.0, 54.0, -3.0)]
    {
        apply(&mut machine, &[a, b]);
        machine.operate(1e-3).unwrap();
        assert_out(&machine, expected, &format!("{a} against {b}"));
    }
}

#[test]
fn overload() {
    has_no_lamp(relay(5.0, -5.0).cord("on", "high"), &[100.0], 110.0);
}

#[test]
fn modes() {
    let program = bench(relay(5.0, -5.0).set("closed", true));
    let mut machine = at(&program, &[0.0, 7.0, -3.0]);
    assert_out(&machine, 7.0, "in initial condition, as \"closed\" says");
    machine.operate(2e-3).unwrap();
    apply(&mut machine, &[-6.0]);
    assert_out(&machine, -3.0, "in operation");
    apply(&mut machine, &[0.0]);
    machine.hold();
    apply(&mut machine, &[0.0, 9.0, -4.0]);
    assert_out(&machine, -4.0, "in hold it keeps its position and follows the connected voltage");
    machine.operate(2e-3).unwrap();
    assert_out(&machine, -4.0, "after hold");
}
