//! An integrator at its limit: that of the amplifier, or that of diodes across it.

use std::f64::consts::TAU;

use serde_json::json;

use crate::common::{
    built, check_derivatives, check_derivatives_except, element, patch, program, run_for, voltage, volts,
};
use patchcord_core::document::Code;
use patchcord_core::ir::Program;
use patchcord_core::patch::PatchBuilder;
use patchcord_core::solve::{MachineMode, RunError};

#[test]
fn an_integrator_stops_at_minus_100_volts_and_returns_immediately() {
    let program = program(&patch("integrator-limit"), &[]);
    for (time, volts) in
        [(5.0, -50.0), (10.0, -100.0), (15.0, -100.0), (20.0, -100.0), (20.5, -95.0), (30.0, 0.0)]
    {
        let machine = run_for(&program, 1e-2, time);
        assert!((voltage(&machine, "A1") - volts).abs() < 1e-9, "{time} {}", voltage(&machine, "A1"));
    }
}

#[test]
fn an_integrator_leaves_its_limit_when_the_input_changes_sign() {
    for (u, turn) in [(10.0, 20.0), (13.0, 17.003), (31.0, 11.1111)] {
        let program = program(&patch("integrator-limit"), &[("u", u), ("t_turn", turn)]);
        for step in [1e-2, 0.7] {
            let machine = run_for(&program, step, turn + 2.0);
            assert!(
                (voltage(&machine, "A1") - (-100.0 + 2.0 * u)).abs() < 1e-9,
                "{u} {step} {}",
                voltage(&machine, "A1")
            );
        }
    }
}

#[test]
fn the_lamp_reports_the_time_at_which_the_limit_was_reached() {
    for u in [10.0, 13.0, 31.0] {
        let program = program(&patch("integrator-limit"), &[("u", u)]);
        for step in [1e-2, 0.7] {
            let overloads = run_for(&program, step, 15.0).overloads();
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

/// An integrator with a cosine input stays at its limit until the cosine changes sign, and then follows the sine.
#[test]
fn an_integrator_leaves_its_limit_when_a_smooth_input_changes_sign() {
    let frequency = 0.05;
    let cosine = element("sine").set("amplitude", -40).set("frequency", frequency).set("phase", TAU / 4.0);
    let program = built(
        volts("cosine").drive("u", "volt", cosine).element("A1", element("integrator").cords("x1", ["u"])),
    );
    let omega = TAU * frequency;
    let swing = 40.0 / omega;
    for step in [1e-2, 1e-3] {
        assert_eq!(voltage(&run_for(&program, step, 4.99), "A1"), 100.0);
        let back = voltage(&run_for(&program, step, 8.0), "A1");
        let expected = 100.0 - swing * (1.0 - (omega * 8.0).sin());
        assert!((back - expected).abs() < 1e-9, "{step} {:e}", back - expected);
    }
}

#[test]
fn derivatives_agree_before_at_and_after_the_limit() {
    let program = program(&patch("integrator-limit"), &[]);
    check_derivatives(&program, 1e-2, &[5.0, 25.0]);
    check_derivatives_except(&program, 1e-2, &[15.0], &["A1"]);
}

#[test]
fn a_small_input_at_the_limit_lights_the_lamp_at_every_step() {
    // 1 V in holds the integrator at -100 V from 0.1 s on.
    let builder = volts("weak push").drive("u", "volt", element("step").set("height", 1));
    let program =
        built(builder.element("A1", element("integrator").cords("x1", ["u"]).set("initial", -99.9)));
    for step in [2e-5, 1e-3, 0.03] {
        let overloads = run_for(&program, step, 2.0).overloads();
        assert_eq!(overloads.len(), 1, "{step}");
        assert!((overloads[0].time - 0.1).abs() <= step + 2e-4, "{step} {overloads:?}");
        assert!((overloads[0].peak().unwrap() - 101.9).abs() < 1e-6, "{step} {overloads:?}");
    }
}

/// The input is the derivative of 101 V sin(w t): the integrator is at its limit for less than a 20th of the period.
#[test]
fn a_time_at_100_volts_within_one_step_lights_the_lamp() {
    let frequency = 0.1;
    let amplitude = -101.0 * TAU * frequency;
    let cosine = element("sine").set("amplitude", amplitude).set("frequency", frequency);
    let builder = volts("peak").drive("u", "volt", cosine.set("phase", TAU / 4.0));
    let program = built(builder.element("A1", element("integrator").cords("x1", ["u"])));
    for step in [1e-2, 0.47, 0.5] {
        let overloads = run_for(&program, step, 5.0).overloads();
        assert_eq!(overloads.len(), 1, "{step}");
        // The drive differs from a straight line by (8 degrees)^2 / 12.
        assert!((overloads[0].peak().unwrap() - 101.0).abs() < 2e-3, "{step} {overloads:?}");
    }
}

/// An integrator with the input u in V and diode limits at -20 V - 0.5 V and `top` + 0.5 V.
fn limited() -> PatchBuilder {
    let limit = json!({"upper": "top", "lower": -20, "drop": 0.5});
    volts("limited")
        .parameter("u", 0.0, "V", [-100.0, 100.0])
        .parameter("top", 30.0, "V", [0.0, 100.0])
        .drive("u", "volt", element("step").set("height", "u"))
        .element("A1", element("integrator").cords("x1", ["u"]).set("initial", 10).set("limit", limit))
}

/// The limited integrator with another input.
fn driven(u: f64) -> Program {
    program(&limited().build().unwrap(), &[("u", u)])
}

#[test]
fn a_diode_limit_lights_no_lamp() {
    for (u, time, volts) in [(-10.0, 1.0, 20.0), (-10.0, 5.0, 30.5), (10.0, 2.0, -10.0), (10.0, 5.0, -20.5)] {
        let program = driven(u);
        for step in [1e-2, 0.3] {
            let machine = run_for(&program, step, time);
            assert!(
                (voltage(&machine, "A1") - volts).abs() < 1e-11,
                "{u} {time}: {}",
                voltage(&machine, "A1")
            );
            assert!(!machine.is_overloaded(), "a diode limit is no overload");
        }
    }
}

#[test]
fn an_integrator_leaves_a_diode_limit_immediately() {
    let program = driven(-10.0);
    for step in [1e-2, 0.3] {
        let mut machine = run_for(&program, step, 4.321);
        machine.set_parameter("u", 7.0).unwrap();
        machine.operate(1.0).unwrap();
        assert!((voltage(&machine, "A1") - 23.5).abs() < 1e-11, "{step}");
    }
}

#[test]
fn an_integrator_leaves_a_diode_limit_after_a_hold() {
    let program = driven(-10.0);
    let mut machine = run_for(&program, 1e-2, 5.0);
    machine.hold();
    machine.set_parameter("u", 7.0).unwrap();
    assert_eq!((machine.mode(), voltage(&machine, "A1")), (MachineMode::Hold, 30.5));
    machine.operate(0.5).unwrap();
    assert!((voltage(&machine, "A1") - 27.0).abs() < 1e-11, "{}", voltage(&machine, "A1"));
}

/// d out / dt = -40 cos(w t): the output falls to its lower limit and returns along the sine.
#[test]
fn a_smooth_input_drives_an_integrator_to_a_diode_limit_and_back() {
    let cosine = element("sine").set("amplitude", 40).set("frequency", 0.05).set("phase", TAU / 4.0);
    let integrator = element("integrator").cords("x1", ["u"]).set("limit", json!({"lower": -50}));
    let program = built(volts("cosine").drive("u", "volt", cosine).element("A1", integrator));
    let omega = TAU * 0.05;
    for step in [1e-2, 0.1] {
        assert_eq!(voltage(&run_for(&program, step, 4.99), "A1"), -50.0);
        let back = voltage(&run_for(&program, step, 8.0), "A1");
        let expected = -50.0 + 40.0 / omega * (1.0 - (omega * 8.0).sin());
        assert!((back - expected).abs() < 1e-6 * step, "{step} {:e}", back - expected);
    }
}

#[test]
fn a_changed_limit_moves_or_releases_the_voltage() {
    let program = driven(-10.0);
    let mut machine = run_for(&program, 1e-2, 5.0);
    machine.set_parameter("top", 12.0).unwrap();
    assert_eq!(voltage(&machine, "A1"), 12.5, "moved with the limit");
    machine.set_parameter("top", 20.0).unwrap();
    machine.operate(0.5).unwrap();
    assert!((voltage(&machine, "A1") - 17.5).abs() < 1e-11, "released: {}", voltage(&machine, "A1"));
    machine.set_parameter("top", 10.0).unwrap();
    assert_eq!(voltage(&machine, "A1"), 10.5, "moved to a limit below the voltage");
}

#[test]
fn the_amplifier_limit_applies_inside_a_wider_diode_limit() {
    let integrator =
        element("integrator").cords("x10", ["-100"]).set("limit", json!({"upper": 98, "drop": 5}));
    let program = built(volts("wide limit").element("A1", integrator));
    let machine = run_for(&program, 1e-2, 1.0);
    assert_eq!(voltage(&machine, "A1"), 100.0);
    assert!((machine.overloads()[0].time - 0.1).abs() < 1e-9);
}

#[test]
fn a_state_outside_its_limits_cannot_be_set() {
    let program = driven(0.0);
    let mut machine = run_for(&program, 1e-2, 0.0);
    machine.set_state("A1", 30.5).unwrap();
    let refused = machine.set_state("A1", 31.0);
    assert!(
        matches!(refused, Err(RunError::StateOutsideRange { low: -20.5, high: 30.5, .. })),
        "{refused:?}"
    );
    assert_eq!(voltage(&machine, "A1"), 30.5);
}

#[test]
fn an_initial_condition_outside_its_limits_is_reported() {
    let codes = |initial: Option<f64>, limit: serde_json::Value| {
        let integrator = element("integrator").cords("x1", ["+100"]).set("limit", limit);
        let integrator =
            initial.into_iter().fold(integrator, |integrator, volts| integrator.set("initial", volts));
        let patch = volts("outside").element("A1", integrator).record(["A1"]).build().unwrap();
        let circuit = patchcord_core::circuit::Circuit::new(&patch);
        let findings = circuit.map_or_else(|report| report.findings, |circuit| circuit.warnings().findings);
        let found = findings.iter().map(|finding| finding.code).filter(|code| *code != Code::UNSCALED_SIGNAL);
        found.collect::<Vec<_>>()
    };
    assert_eq!(codes(Some(31.0), json!({"upper": 30})), [Code::BAD_NUMBER]);
    assert_eq!(codes(Some(-31.0), json!({"lower": -30, "upper": 30})), [Code::BAD_NUMBER]);
    assert_eq!(codes(None, json!({"lower": 10})), [Code::BAD_NUMBER], "the default is 0 V");
    assert_eq!(codes(Some(30.0), json!({"lower": -30, "upper": 30})), []);
}

#[test]
fn a_parameter_that_reverses_the_order_of_settings_is_refused() {
    let limited = |limit| element("integrator").cords("x1", ["+100"]).set("limit", limit).set("initial", "a");
    let relay = element("relay").set("pull_in", "a").set("drop_out", "b").cord("in", "+100");
    let program = built(
        volts("ordered")
            .parameter("a", 10.0, "V", [-100.0, 100.0])
            .parameter("b", 0.0, "V", [-100.0, 100.0])
            .element("R", relay.cord("on", "+100").cord("off", "-100"))
            .element("I", limited(json!({"upper": 30, "lower": "-20"})))
            .element(
                "S",
                element("summer").cords("x1", ["R"]).set("limit", json!({"upper": 60, "lower": "b"})),
            ),
    );
    let mut machine = run_for(&program, 1e-2, 0.0);
    let mut refusal =
        |changes: &[(&str, f64)]| machine.set_parameters(changes.iter().copied()).unwrap_err().to_string();
    assert_eq!(refusal(&[("b", 10.0)]), "R drop_out is 10, not below R pull_in at 10");
    assert_eq!(refusal(&[("a", 31.0)]), "I initial is 31, above I limit.upper at 30");
    assert_eq!(refusal(&[("a", -21.0), ("b", -50.0)]), "I initial is -21, below I limit.lower at -20");
    assert_eq!(refusal(&[("a", 80.0), ("b", 70.0)]), "I initial is 80, above I limit.upper at 30");
    machine.set_parameters([("a", 30.0), ("b", 29.0)]).unwrap();
    machine.initial_condition().unwrap();
    assert_eq!(voltage(&machine, "I"), 30.0);
}

#[test]
fn derivatives_agree_between_and_at_diode_limits() {
    let sine = element("sine").set("amplitude", "u").set("frequency", 0.1).set("phase", TAU / 2.0);
    let builder = volts("held")
        .parameter("u", 40.0, "V", [0.0, 100.0])
        .drive("u", "volt", sine)
        .element("A1", element("integrator").cords("x1", ["u"]).set("limit", json!({"upper": 30})))
        .element("A2", element("integrator").cords("x1", ["u", "A1", "A2"]));
    let program = built(builder);
    check_derivatives(&program, 1e-2, &[0.5, 6.0]);
    // A1 is at its limit from 1.6 s to 5 s.
    check_derivatives_except(&program, 1e-2, &[3.0], &["A1"]);
}
