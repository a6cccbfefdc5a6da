//! An integrator at its limit.

mod common;

use std::f64::consts::TAU;

use common::{built, check_derivatives, check_derivatives_but, element, patch, program, ran, voltage, volts};

#[test]
fn it_stops_at_minus_100_volts_and_comes_back_at_once() {
    let program = program(&patch("integrator-limit"), &[]);
    for (time, volts) in
        [(5.0, -50.0), (10.0, -100.0), (15.0, -100.0), (20.0, -100.0), (20.5, -95.0), (30.0, 0.0)]
    {
        let machine = ran(&program, 1e-2, time);
        assert!((voltage(&machine, "A1") - volts).abs() < 1e-9, "{time} {}", voltage(&machine, "A1"));
    }
}

#[test]
fn the_way_back_starts_exactly_when_the_input_turns() {
    for (u, turn) in [(10.0, 20.0), (13.0, 17.003), (31.0, 11.1111)] {
        let program = program(&patch("integrator-limit"), &[("u", u), ("t_turn", turn)]);
        for step in [1e-2, 0.7] {
            let machine = ran(&program, step, turn + 2.0);
            assert!(
                (voltage(&machine, "A1") - (-100.0 + 2.0 * u)).abs() < 1e-9,
                "{u} {step} {}",
                voltage(&machine, "A1")
            );
        }
    }
}

#[test]
fn the_lamp_tells_when_it_came_to_the_limit() {
    for u in [10.0, 13.0, 31.0] {
        let program = program(&patch("integrator-limit"), &[("u", u)]);
        for step in [1e-2, 0.7] {
            let overloads = ran(&program, step, 15.0).overloads();
            assert_eq!((overloads.len(), overloads[0].element.as_str()), (1, "A1"));
            let expected = 100.0 / u;
            assert!(
                (overloads[0].time - expected).abs() < 1e-12,
                "{u} {step} {:e}",
                overloads[0].time - expected
            );
        }
    }
}

/// A cosine into an integrator: at its limit until the cosine turns, and back along the sine.
#[test]
fn an_integrator_leaves_its_limit_when_a_smooth_input_turns() {
    let frequency = 0.05;
    let cosine = element("sine").set("amplitude", -40).set("frequency", frequency).set("phase", TAU / 4.0);
    let program = built(
        volts("cosine").drive("u", "volt", cosine).element("A1", element("integrator").cords("x1", ["u"])),
    );
    let omega = TAU * frequency;
    let swing = 40.0 / omega;
    for step in [1e-2, 1e-3] {
        assert_eq!(voltage(&ran(&program, step, 4.99), "A1"), 100.0);
        let back = voltage(&ran(&program, step, 8.0), "A1");
        let expected = 100.0 - swing * (1.0 - (omega * 8.0).sin());
        assert!((back - expected).abs() < 1e-9, "{step} {:e}", back - expected);
    }
}

#[test]
fn derivatives_agree_inside_at_the_limit_and_on_the_way_back() {
    let program = program(&patch("integrator-limit"), &[]);
    check_derivatives(&program, 1e-2, &[5.0, 25.0]);
    check_derivatives_but(&program, 1e-2, &[15.0], &["A1"]);
}

#[test]
fn a_weak_push_lights_the_lamp_whatever_the_step() {
    // 1 V in holds the integrator at -100 V from 0.1 s on.
    let builder = volts("weak push").drive("u", "volt", element("step").set("height", 1));
    let program =
        built(builder.element("A1", element("integrator").cords("x1", ["u"]).set("initial", -99.9)));
    for step in [2e-5, 1e-3, 0.03] {
        let overloads = ran(&program, step, 2.0).overloads();
        assert_eq!(overloads.len(), 1, "{step}");
        assert!((overloads[0].time - 0.1).abs() <= step + 2e-4, "{step} {overloads:?}");
        assert!((overloads[0].peak - 101.9).abs() < 1e-6, "{step} {overloads:?}");
    }
}
