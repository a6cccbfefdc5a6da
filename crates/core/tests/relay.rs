//! A relay oscillator: a triangle wave with exactly known corners.

use crate::common::{built, check_derivatives, element, patch, program, run_for, source, voltage, volts};

/// Slope of the triangle in V/s.
const SLOPE: f64 = 80.0;
/// Upper threshold in V.
const HIGH: f64 = 20.0;
/// Lower threshold in V.
const LOW: f64 = -10.0;
/// Period of the triangle in s.
const PERIOD: f64 = 2.0 * (HIGH - LOW) / SLOPE;

/// The triangle wave that rises from 0 at t = 0.
fn triangle(time: f64) -> f64 {
    let phase = (time - LOW / SLOPE).rem_euclid(PERIOD) * SLOPE;
    let rise = HIGH - LOW;
    if phase < rise { LOW + phase } else { HIGH - (phase - rise) }
}

#[test]
fn the_triangle_keeps_its_period_for_a_thousand_corners() {
    let program = program(&patch("relay-oscillator"), &[]);
    let mut machine = run_for(&program, 1e-2, 0.0);
    for _ in 0..3000 {
        machine.operate(0.1237).unwrap();
        let expected = triangle(machine.time());
        // Straight lines are exact. Every corner is located to 1e-13 of a step and to the rounding of time.
        assert!((voltage(&machine, "A1") - expected).abs() < 1e-9, "{}", voltage(&machine, "A1") - expected);
    }
}

#[test]
fn the_relay_switches_at_its_thresholds() {
    let program = program(&patch("relay-oscillator"), &[]);
    for (time, contact) in [(0.2499, -10.0), (0.2501, 10.0), (0.6249, 10.0), (0.6251, -10.0), (0.9999, -10.0)]
    {
        assert_eq!(voltage(&run_for(&program, 1e-2, time), "K1"), contact, "{time}");
    }
}

#[test]
fn corners_at_the_end_of_a_step_are_located_there() {
    // 0.25 s and 0.625 s are steps of 1/8 s.
    let program = program(&patch("relay-oscillator"), &[]);
    let machine = run_for(&program, 0.125, 10.0 * PERIOD + 0.25);
    assert_eq!((voltage(&machine, "A1"), voltage(&machine, "K1")), (HIGH, 10.0));
}

#[test]
fn several_corners_within_one_step_are_located() {
    let program = program(&patch("relay-oscillator"), &[]);
    for length in [0.5, 1.1, 2.3] {
        let machine = run_for(&program, length, length);
        assert!((voltage(&machine, "A1") - triangle(length)).abs() < 1e-10, "{length}");
    }
}

#[test]
fn the_initial_position_of_a_relay_follows_its_input() {
    let standard = program(&patch("relay-oscillator"), &[]);
    let mut machine = run_for(&standard, 1e-2, 0.0);
    machine.set_state("A1", HIGH).unwrap();
    assert_eq!(voltage(&machine, "K1"), 10.0, "pulled in at its threshold");
    machine.set_state("A1", 0.0).unwrap();
    assert_eq!(voltage(&machine, "K1"), 10.0, "unchanged between the thresholds");
    machine.set_state("A1", LOW).unwrap();
    assert_eq!(voltage(&machine, "K1"), -10.0, "released at its threshold");
    let low = program(&patch("relay-oscillator"), &[("a_high", 0.0)]);
    assert_eq!(voltage(&run_for(&low, 1e-2, 0.0), "K1"), 10.0, "its input starts at the threshold");
}

#[test]
fn simultaneous_switching_of_relays_is_symmetric() {
    let relay = |input: &str| {
        element("relay")
            .cord("in", input)
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
    let mut machine = run_for(&program, 0.1, 0.0);
    for _ in 0..200 {
        machine.operate(0.77).unwrap();
        let states = machine.states();
        assert!(states.iter().all(|volts| *volts == states[0]), "{states:?}");
    }
}

#[test]
fn derivatives_agree_on_rising_and_falling_edges() {
    check_derivatives(&program(&patch("relay-oscillator"), &[]), 1e-2, &[0.1, 0.4]);
}

#[test]
fn many_simultaneous_switchings_are_not_chatter() {
    let builder = (0..1500).fold(volts("many"), |builder, index| {
        builder.drive(&format!("d{index}"), "volt", element("step").set("height", 1).set("at", 0.05))
    });
    let program = built(builder);
    let machine = run_for(&program, 0.1, 0.1);
    assert_eq!(machine.work().changes, 1500);
    assert_eq!(voltage(&machine, "d1499"), 1.0);
}

#[test]
fn a_loop_that_is_open_from_the_start_runs() {
    // A released relay would close a latch. In initial condition its input pulls it in.
    let builder = source(volts("opened"), "u", 10.0);
    let builder = builder.element("B1", element("summer").cords("x1", ["K1"]));
    let builder = builder.element("B2", element("summer").cords("x10", ["B1"]));
    let relay = element("relay").cord("in", "u").cord("on", "ground").cord("off", "B2");
    let program = built(builder.element("K1", relay.set("pull_in", 5).set("drop_out", 1)));
    assert_eq!(voltage(&run_for(&program, 1e-2, 0.1), "B2"), 0.0);
}
