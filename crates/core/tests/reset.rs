//! The reset input of an integrator: while it is closed, the output is the initial value.

use proptest::prelude::*;
use serde_json::json;

use crate::common::{built, element, random_cases, run_for, source, voltage, volts};
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, PatchBuilder};
use patchcord_core::solve::{self, Backend, Machine, RunSettings};

/// The voltages of an element at a time, with equal steps, adaptive steps and every backend. `time` is a whole number
/// of steps of 10 ms.
fn at_end(program: &Program, name: &str, time: f64) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    for step in [1e-3, 0.0137, 0.3] {
        found.push((format!("step {step}"), voltage(&run_for(program, step, time), name)));
    }
    for tolerance in [1e-4, 1e-8] {
        let mut machine = Machine::adaptive(program, tolerance, 1e-3).unwrap();
        machine.operate(time).unwrap();
        found.push((format!("tolerance {tolerance}"), voltage(&machine, name)));
    }
    for backend in Backend::ALL {
        let settings = RunSettings::from_phases([Phase::operate(time)], 1e-2).with_signals([name]);
        let trace = solve::run(program, &settings.with_backend(backend)).unwrap();
        found.push((format!("{backend}"), *trace.tracks[0].volts.last().unwrap()));
    }
    found
}

/// Asserts that an element has a voltage at a time, up to `allowed` volts, with every kind of step and every backend.
fn assert_at_end(program: &Program, name: &str, time: f64, expected: f64, allowed: f64) {
    for (context, found) in at_end(program, name, time) {
        assert!((found - expected).abs() < allowed, "{context} at {time}: {found}, expected {expected}");
    }
}

/// An integrator A1 that is reset by the drive R from b on for 0.2 s. It moves by r V/s.
fn pulsed(integrator: ElementBuilder) -> PatchBuilder {
    let pulse = element("pulse").set("height", 10).set("begin", "b").set("width", 0.2);
    volts("pulsed")
        .parameter("b", 0.3, "s", [0.1, 1.0])
        .parameter("r", 20.0, "V", [-50.0, 50.0])
        .parameter("i", -7.0, "V", [-50.0, 50.0])
        .drive("R", "volt", pulse)
        .drive("u", "volt", element("step").set("height", "-r"))
        .element("A1", integrator.cords("x1", ["u"]).cords("reset", ["R"]).set("initial", "i"))
}

#[test]
fn it_is_initial_while_reset_and_then_integrates_from_there() {
    let program = built(pulsed(element("integrator")));
    let cases = [(0.2, -3.0), (0.31, -7.0), (0.4, -7.0), (0.49, -7.0), (0.6, -5.0), (1.3, 9.0)];
    for (time, expected) in cases {
        assert_at_end(&program, "A1", time, expected, 1e-9);
    }
}

proptest! {
    #![proptest_config(random_cases(24))]

    #[test]
    fn a_sequence_of_reset_voltages(
        threshold in -20.0..20.0f64, start in -20.0..20.0f64,
        moves in proptest::collection::vec((-40.0..40.0f64, -40.0..40.0f64), 1..12),
    ) {
        let drive = |height: &str| element("step").set("height", height);
        let integrator = element("integrator").cords("x1", ["u"]).cords("reset", ["v"]);
        let builder = volts("sequence")
            .parameter("a", 0.0, "V", [-100.0, 100.0])
            .parameter("c", -100.0, "V", [-100.0, 100.0])
            .drive("u", "volt", drive("a"))
            .drive("v", "volt", drive("c"))
            .element("A1", integrator.set("threshold", threshold).set("initial", start));
        let program = built(builder);
        let mut machine = run_for(&program, 1e-3, 0.0);
        let mut expected = start;
        for (a, control) in moves {
            machine.set_parameters([("a", a), ("c", control)]).unwrap();
            machine.operate(0.01).unwrap();
            expected = if control >= threshold { start } else { expected - a * 0.01 };
            let found = voltage(&machine, "A1");
            prop_assert!((found - expected).abs() < 1e-10, "{} {}", found, expected);
        }
    }
}

/// A1 rises by r V/s, and the comparator K resets it to 0 V at h volts: a sawtooth.
fn sawtooth(integrator: ElementBuilder) -> Program {
    built(
        volts("sawtooth")
            .parameter("h", 10.0, "V", [1.0, 90.0])
            .parameter("r", 50.0, "V", [1.0, 90.0])
            .drive("u", "volt", element("step").set("height", "-r"))
            .element("K", element("comparator").cord("in", "A1").set("threshold", "h"))
            .element("A1", integrator.cords("x1", ["u"]).cords("reset", ["K"]))
            .record(["A1", "K"]),
    )
}

#[test]
fn an_integrator_and_a_comparator_make_a_sawtooth() {
    let program = sawtooth(element("integrator"));
    for (time, expected) in [(0.15, 7.5), (0.25, 2.5), (1.03, 1.5), (5.19, 9.5)] {
        assert_at_end(&program, "A1", time, expected, 1e-9);
    }
    // The limit is reached at the same instant as the threshold. The reset has priority.
    let limited = sawtooth(element("integrator").set("limit", json!({"upper": 10, "lower": 0})));
    assert_at_end(&limited, "A1", 1.03, 1.5, 1e-9);
}

#[test]
fn specialised_backends_give_the_same_bits() {
    let program = sawtooth(element("integrator"));
    let settings = RunSettings::from_phases([Phase::operate(2.9)], 1.3e-3).with_sample_interval(7.3e-3);
    let run = |backend: Backend| {
        let settings = settings.clone().with_signals(["A1", "K"]).with_backend(backend);
        solve::run(&program, &settings).unwrap()
    };
    let interpreted = run(Backend::Interpreter);
    for backend in [Backend::Lanes, Backend::Native, Backend::Automatic] {
        assert_eq!(interpreted, run(backend), "{backend}");
    }
    let reference = run(Backend::Reference);
    let pairs = interpreted.tracks[0].volts.iter().zip(&reference.tracks[0].volts);
    assert!(pairs.clone().count() > 300);
    assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9));
}

#[test]
fn an_open_reset_input_never_resets() {
    let alone = element("integrator").cords("x1", ["u"]).set("threshold", -100);
    let program = built(source(volts("open"), "u", -10.0).element("A1", alone));
    assert_at_end(&program, "A1", 0.5, 5.0, 1e-9);
    // A cord to 0 V is below the default threshold.
    let grounded = element("integrator").cords("x1", ["u"]).cords("reset", ["ground"]);
    let program = built(source(volts("grounded"), "u", -10.0).element("A1", grounded));
    assert_at_end(&program, "A1", 0.5, 5.0, 1e-9);
}

#[test]
fn it_resets_in_initial_condition_and_in_hold() {
    let integrator = element("integrator").cords("x1", ["u"]).cords("reset", ["v"]).set("initial", "i");
    let builder = source(volts("by hand"), "u", -10.0)
        .parameter("c", 50.0, "V", [-100.0, 100.0])
        .parameter("i", 3.0, "V", [-100.0, 100.0])
        .drive("v", "volt", element("step").set("height", "c"))
        .element("A1", integrator);
    let program = built(builder);
    let mut machine = run_for(&program, 1e-2, 0.3);
    assert_eq!(voltage(&machine, "A1"), 3.0, "closed from the beginning");
    machine.set_parameter("i", -4.0).unwrap();
    assert_eq!(voltage(&machine, "A1"), -4.0, "it follows its initial value while it is reset");
    machine.set_state("A1", 20.0).unwrap();
    assert_eq!(voltage(&machine, "A1"), -4.0, "it cannot be set by hand while it is reset");
    machine.set_parameter("c", 0.0).unwrap();
    machine.operate(0.5).unwrap();
    assert!((voltage(&machine, "A1") - 1.0).abs() < 1e-10);
    machine.hold();
    machine.set_parameter("i", 9.0).unwrap();
    assert!((voltage(&machine, "A1") - 1.0).abs() < 1e-10, "an open reset changes nothing");
    machine.set_parameter("c", 1.0).unwrap();
    assert_eq!(voltage(&machine, "A1"), 9.0, "the threshold is 1 V");
}

/// With the brake, A1 moves from -5 V by 28 V/s up to 0 V, and from there by 12 V/s.
#[test]
fn a_brake_starts_again_after_a_reset() {
    let braked = element("integrator").cords("brake_x1", ["B"]);
    let builder = source(pulsed(braked), "B", 8.0);
    let mut program = built(builder);
    program.set_parameters([("i", -5.0)]).unwrap();
    let moved = |time: f64| 12.0 * (time - 5.0 / 28.0);
    assert_at_end(&program, "A1", 0.28, moved(0.28), 1e-9);
    assert_at_end(&program, "A1", 0.4, -5.0, 1e-9);
    assert_at_end(&program, "A1", 1.0, moved(0.5), 1e-9);
}

/// While A1 is reset to 10 V, the gap A2 falls from 2 V to -3 V at 0.5 s. When the reset ends, A1 rebounds.
#[test]
fn a_stop_acts_after_the_reset() {
    let closing = element("integrator")
        .cords("x1", ["ground"])
        .cords("gap", ["A2"])
        .cords("reset", ["R"])
        .set("restitution", 0.5)
        .set("initial", 10);
    let builder = volts("stop")
        .drive("R", "volt", element("pulse").set("height", 10).set("width", 0.5))
        .element("A1", closing)
        .element("A2", element("integrator").cords("x1", ["A1"]).set("initial", 2));
    let program = built(builder);
    assert_at_end(&program, "A1", 0.4, 10.0, 1e-9);
    assert_at_end(&program, "A2", 0.4, -2.0, 1e-9);
    assert_at_end(&program, "A1", 0.6, -5.0, 1e-9);
    assert_at_end(&program, "A2", 0.6, -2.5, 1e-9);
}

#[test]
fn derivatives_follow_the_initial_value_and_the_instants() {
    let program = built(pulsed(element("integrator")));
    let mut machine = Machine::new(&program, 1e-2).unwrap();
    machine.differentiate(["b", "r", "i"]).unwrap();
    // Before the reset, while it is closed, and 0.4 s after it: i + r (t - b - 0.2).
    for (length, expected) in [(0.2, [0.0, 0.2, 1.0]), (0.2, [0.0, 0.0, 1.0]), (0.5, [-20.0, 0.4, 1.0])] {
        machine.operate(length).unwrap();
        for (by, expected) in ["b", "r", "i"].into_iter().zip(expected) {
            let found = machine.sensitivity("A1", by).unwrap();
            assert!((found - expected).abs() < 1e-8, "by {by} at {}: {found}, {expected}", machine.time());
        }
    }
}

/// After five teeth A1 is r t - 5 h.
#[test]
fn a_sawtooth_has_derivatives_by_its_height_and_its_rate() {
    let program = sawtooth(element("integrator"));
    let mut machine = Machine::new(&program, 1e-2).unwrap();
    machine.differentiate(["h", "r"]).unwrap();
    machine.operate(1.03).unwrap();
    let found = ["h", "r"].map(|by| machine.sensitivity("A1", by).unwrap());
    assert!((found[0] + 5.0).abs() < 1e-8 && (found[1] - 1.03).abs() < 1e-8, "{found:?}");
}

#[test]
fn the_linear_model_has_the_present_mode() {
    let lag = element("integrator").cords("x1", ["A1"]).cords("reset", ["R"]).set("initial", 10);
    let pulse = element("pulse").set("height", 10).set("begin", 0.3).set("width", 0.2);
    let program = built(volts("linear").drive("R", "volt", pulse).element("A1", lag));
    for (time, expected) in [(0.1, -1.0), (0.4, 0.0), (0.6, -1.0)] {
        let model = run_for(&program, 1e-2, time).linearise();
        assert_eq!(model.by_states[0][0], expected, "at {time}");
    }
}
