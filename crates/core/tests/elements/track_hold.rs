//! Track-and-hold amplifier.

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, source, voltage, volts};
use crate::elements::bench::{ANY, apply, assert_out, at, bench, has_exact_derivatives, near, out};
use patchcord_core::patch::ElementBuilder;

/// A track-and-hold that follows a while b is at least 5 V.
fn track_hold() -> ElementBuilder {
    element("track-hold").cord("in", "a").cord("track", "b").set("threshold", 5).set("initial", 12)
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(start in (ANY, ANY), moves in proptest::collection::vec((ANY, -10.0..20.0f64), 1..20)) {
        let program = bench(track_hold());
        let mut machine = at(&program, &[start.0, start.1]);
        let mut expected = if start.1 >= 5.0 { -start.0 } else { 12.0 };
        prop_assert_eq!(out(&machine), expected);
        machine.operate(1e-3).unwrap();
        // A control that falls below its threshold keeps the input at the time of the crossing.
        for (a, b) in moves {
            let was_tracking = voltage(&machine, "b") >= 5.0;
            apply(&mut machine, &[a, b]);
            expected = if was_tracking || b >= 5.0 { -a } else { expected };
            prop_assert_eq!(out(&machine), expected);
            machine.operate(1e-3).unwrap();
            prop_assert_eq!(out(&machine), expected);
        }
    }
}

#[test]
fn overload() {
    let pair = element("diode-lower-of").set("in", serde_json::json!(["a", "a"])).set("drop", 5);
    let tracked = element("track-hold").cord("in", "D").cord("track", "+100");
    let program = built(source(volts("high"), "a", 100.0).element("D", pair).element("E", tracked));
    let machine = run_for(&program, 1e-3, 0.01);
    assert_eq!((out(&machine), machine.overloads()[0].peak()), (-100.0, Some(105.0)));
}

#[test]
fn modes() {
    let program = bench(track_hold());
    let mut machine = at(&program, &[40.0, 0.0]);
    assert_out(&machine, 12.0, "in initial condition, holding");
    machine.operate(2e-3).unwrap();
    apply(&mut machine, &[40.0, 10.0]);
    assert_out(&machine, -40.0, "tracking");
    machine.hold();
    apply(&mut machine, &[30.0, 0.0]);
    apply(&mut machine, &[70.0]);
    assert_out(&machine, -30.0, "in hold it switches as in operate");
    machine.operate(2e-3).unwrap();
    assert_out(&machine, -30.0, "after hold");
    machine.initial_condition().unwrap();
    assert_out(&machine, 12.0, "in initial condition again");
}

#[test]
fn a_ramp_is_held_from_the_instant_of_the_crossing() {
    // The control falls through 0 at 0.8326 s and rises through it at 1.6652 s.
    let control = element("triangle").set("amplitude", 8.326).set("frequency", "1 / 1.6652");
    let builder = volts("ramp")
        .drive("u", "volt", element("ramp").set("start", -20).set("rate", 31))
        .drive("c", "volt", control)
        .element("E", element("track-hold").cord("in", "u").cord("track", "c"));
    let program = built(builder);
    let held_volts = 20.0 - 31.0 * 0.8326;
    for step in [0.1, 0.0373] {
        for (time, expected) in
            [(0.5, 20.0 - 31.0 * 0.5), (0.9, held_volts), (1.6, held_volts), (1.7, 20.0 - 31.0 * 1.7)]
        {
            let found = out(&run_for(&program, step, time));
            assert!((found - expected).abs() < 1e-10, "{step} {time} {found} {expected}");
        }
    }
}

#[test]
fn the_voltage_before_a_simultaneous_jump_is_held() {
    let builder = source(volts("jump"), "one", 1.0)
        .drive("u", "volt", element("step").set("height", 50).set("at", 0.37))
        .drive("d", "volt", element("step").set("height", -2).set("at", 0.37))
        .element("C", element("summer").cords("x1", ["one", "d"]))
        .element("B", element("summer").cords("x1", ["C"]))
        .element("E", element("track-hold").cord("in", "u").cord("track", "B"));
    let program = built(builder);
    for (step, time) in [(0.1, 0.36), (0.1, 0.37), (0.1, 1.0), (0.01, 0.37), (0.01, 1.0)] {
        assert_out(&run_for(&program, step, time), 0.0, &format!("{step} {time}"));
    }
}

#[test]
fn two_track_holds_in_a_ring_count_clock_periods() {
    let memory = |signal: &str, clock: &str| {
        element("track-hold").cord("in", signal).cord("track", clock).set("threshold", 1)
    };
    let builder = volts("counter")
        .drive("c", "volt", element("sine").set("amplitude", 10).set("frequency", 5))
        .element("N", element("summer").cords("x1", ["c"]))
        .element("S", element("summer").cords("x1", ["B"]).cords("x0.1", ["+100"]))
        .element("A", memory("S", "c"))
        .element("R", element("summer").cords("x1", ["A"]))
        .element("B", memory("R", "N"));
    let program = built(builder);
    for step in [1e-3, 0.013] {
        let machine = run_for(&program, step, 7.0 * 0.2);
        assert!(near(voltage(&machine, "B"), 70.0), "{step}: {}", voltage(&machine, "B"));
    }
}

#[test]
fn derivatives() {
    let tracking = element("track-hold").cord("in", "a").cord("track", "+100").set("threshold", "h");
    has_exact_derivatives(tracking, 30.0, &[("h", 5.0, "V", [0.0, 10.0])]);
    let holding = element("track-hold").cord("in", "a").cord("track", "-100");
    has_exact_derivatives(holding, 30.0, &[]);
}
