//! A relay oscillator: a triangle wave whose corners are known exactly.

use crate::common::{built, check_derivatives, element, patch, program, ran, source, voltage, volts};

const SLOPE: f64 = 80.0;
const HIGH: f64 = 20.0;
const LOW: f64 = -10.0;
const PERIOD: f64 = 2.0 * (HIGH - LOW) / SLOPE;

/// The triangle that starts at 0 and rises.
fn triangle(time: f64) -> f64 {
    let phase = (time - LOW / SLOPE).rem_euclid(PERIOD) * SLOPE;
    let rise = HIGH - LOW;
    if phase < rise { LOW + phase } else { HIGH - (phase - rise) }
}

#[test]
fn the_triangle_keeps_its_period_for_a_thousand_corners() {
    let program = program(&patch("relay-oscillator"), &[]);
    let mut machine = ran(&program, 1e-2, 0.0);
    for _ in 0..3000 {
        machine.operate(0.1237).unwrap();
        let expected = triangle(machine.time());
        // Straight lines are exact; every corner is met to 1e-13 of a step and to the rounding of time.
        assert!((voltage(&machine, "A1") - expected).abs() < 1e-9, "{}", voltage(&machine, "A1") - expected);
    }
}

#[test]
fn the_relay_switches_at_its_thresholds() {
    let program = program(&patch("relay-oscillator"), &[]);
    for (time, contact) in [(0.2499, -10.0), (0.2501, 10.0), (0.6249, 10.0), (0.6251, -10.0), (0.9999, -10.0)]
    {
        assert_eq!(voltage(&ran(&program, 1e-2, time), "K1"), contact, "{time}");
    }
}

#[test]
fn corners_that_fall_on_a_step_are_met_there() {
    // 0.25 s and 0.625 s are steps of 1/8 s.
    let program = program(&patch("relay-oscillator"), &[]);
    let machine = ran(&program, 0.125, 10.0 * PERIOD + 0.25);
    assert_eq!((voltage(&machine, "A1"), voltage(&machine, "K1")), (HIGH, 10.0));
}

#[test]
fn several_corners_in_one_step_are_all_met() {
    let program = program(&patch("relay-oscillator"), &[]);
    for length in [0.5, 1.1, 2.3] {
        let machine = ran(&program, length, length);
        assert!((voltage(&machine, "A1") - triangle(length)).abs() < 1e-10, "{length}");
    }
}

#[test]
fn a_relay_starts_as_its_input_says() {
    let usual = program(&patch("relay-oscillator"), &[]);
    let mut machine = ran(&usual, 1e-2, 0.0);
    machine.set_state("A1", HIGH).unwrap();
    assert_eq!(voltage(&machine, "K1"), 10.0, "pulled in at its threshold");
    machine.set_state("A1", 0.0).unwrap();
    assert_eq!(voltage(&machine, "K1"), 10.0, "between the thresholds it stays");
    machine.set_state("A1", LOW).unwrap();
    assert_eq!(voltage(&machine, "K1"), -10.0, "released at its threshold");
    let low = program(&patch("relay-oscillator"), &[("a_high", 0.0)]);
    assert_eq!(voltage(&ran(&low, 1e-2, 0.0), "K1"), 10.0, "its input starts at the threshold");
}

#[test]
fn relays_that_switch_at_the_same_instant_do_not_disturb_each_other() {
    let relay = |own: &str| {
        element("relay")
            .cord("in", own)
            .cord("on", "P1")
            .cord("off", "P2")
            .set("pull_in", 20)
            .set("drop_out", -20)
    };
    let mut builder = volts("twins")
        .element("P1", element("pot").cord("in", "+100").set("setting", 0.13))
        .element("P2", element("pot").cord("in", "-100").set("setting", 0.13));
    for (integrator, switch) in [("A1", "K1"), ("A2", "K2"), ("A3", "K3")] {
        builder = builder
            .element(switch, relay(integrator))
            .element(integrator, element("integrator").cords("x1", [switch]));
    }
    let program = built(builder);
    let mut machine = ran(&program, 0.1, 0.0);
    for _ in 0..200 {
        machine.operate(0.77).unwrap();
        let states = machine.states();
        assert!(states.iter().all(|volts| *volts == states[0]), "{states:?}");
    }
}

#[test]
fn derivatives_agree_on_both_flanks() {
    check_derivatives(&program(&patch("relay-oscillator"), &[]), 1e-2, &[0.1, 0.4]);
}

#[test]
fn many_relays_that_switch_once_do_not_chatter() {
    let builder = (0..1500).fold(volts("many"), |builder, index| {
        builder.drive(&format!("d{index}"), "volt", element("step").set("height", 1).set("at", 0.05))
    });
    let program = built(builder);
    let machine = ran(&program, 0.1, 0.1);
    assert_eq!(machine.work().changes, 1500);
    assert_eq!(voltage(&machine, "d1499"), 1.0);
}

#[test]
fn a_loop_that_a_relay_opens_at_the_start_is_no_loop() {
    // Released, the relay would close a latch; its input pulls it in before anything else happens.
    let builder = source(volts("opened"), "u", 10.0);
    let builder = builder.element("B1", element("summer").cords("x1", ["K1"]));
    let builder = builder.element("B2", element("summer").cords("x10", ["B1"]));
    let relay = element("relay").cord("in", "u").cord("on", "ground").cord("off", "B2");
    let program = built(builder.element("K1", relay.set("pull_in", 5).set("drop_out", 1)));
    assert_eq!(voltage(&ran(&program, 1e-2, 0.1), "B2"), 0.0);
}
