//! Delay line. crates/core/tests/delay.rs tests sines, jumps and feedback through it.

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, volts};
use crate::elements::bench::{ANY, apply, assert_out, at, bench, has_no_lamp, out};

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(start in ANY, rate in -30.0..30.0f64, delay in 0.01..1.0f64, initial in ANY, time in 0.0..2.0f64) {
        let ramp = element("ramp").set("start", start * 0.3).set("rate", rate);
        let line = element("delay").cord("in", "u").set("delay", delay).set("initial", initial);
        let program = built(volts("delayed").drive("u", "volt", ramp).element("E", line));
        let delayed_time = time - delay;
        prop_assume!(delayed_time.abs() > 1e-6);
        let expected = if delayed_time < 0.0 { initial } else { start * 0.3 + rate * delayed_time };
        let found = out(&run_for(&program, 7e-3, time));
        prop_assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

#[test]
fn overload() {
    has_no_lamp(element("delay").cord("in", "high").set("delay", 1e-3), &[100.0], 110.0);
}

#[test]
fn modes() {
    let program = bench(element("delay").cord("in", "a").set("delay", 0.1).set("initial", 12));
    let mut machine = at(&program, &[40.0]);
    assert_out(&machine, 12.0, "in initial condition");
    machine.operate(0.15).unwrap();
    machine.hold();
    apply(&mut machine, &[-80.0]);
    assert_out(&machine, 40.0, "in hold");
    machine.operate(0.09).unwrap();
    assert_out(&machine, 40.0, "the input before hold");
    machine.operate(0.02).unwrap();
    assert_out(&machine, -80.0, "the input during hold");
    machine.initial_condition().unwrap();
    assert_out(&machine, 12.0, "in initial condition again");
}
