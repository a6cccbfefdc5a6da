//! Undefined derivatives are reported as errors and never given as numbers.

use crate::common::{built, element, patch, program, volts};
use patchcord_core::patch::PatchBuilder;
use patchcord_core::solve::{Machine, RunError};

/// The derivative of A1 by a parameter after `length` seconds, or the error of the run.
fn outcome(builder: PatchBuilder, by: &str, length: f64) -> Result<f64, RunError> {
    let program = built(builder);
    let mut machine = Machine::new(&program, 1e-2).unwrap();
    machine.differentiate([by])?;
    machine.operate(length)?;
    machine.sensitivity("A1", by)
}

/// Asserts that the derivative is refused with this message.
fn assert_refused(builder: PatchBuilder, by: &str, expected: &str) {
    let error = outcome(builder, by, 2.0).unwrap_err();
    assert!(error.to_string().contains(expected), "{error}");
    assert!(["no-derivative", "derivative-lost"].contains(&error.code()));
}

fn relay(pull_in: &str) -> patchcord_core::patch::ElementBuilder {
    element("relay").cord("on", "+100").cord("off", "-100").set("drop_out", -90).set("pull_in", pull_in)
}

/// 50 t (2 - t) has its maximum of 50 V at t = 1. `pull_in` is the relay's threshold in V.
fn touching(pull_in: f64) -> PatchBuilder {
    volts("touching")
        .parameter("mark", pull_in, "V", [1.0, 90.0])
        .drive("u", "volt", element("ramp").set("start", -100).set("rate", 100))
        .element("A0", element("integrator").cords("x1", ["u"]))
        .element("K1", relay("mark / volt").cord("in", "A0"))
        .element("P1", element("pot").cord("in", "K1").set("setting", 0.1))
        .element("A1", element("integrator").cords("x1", ["P1"]))
}

#[test]
fn a_signal_that_only_touches_a_threshold_has_no_derivative() {
    assert_refused(touching(50.0 - 1e-11), "mark", "K1 only touches its switching threshold");
    // With a threshold 1 V lower the relay switches at 1 - sqrt(0.02), and the slope of A1 changes by 20 V/s there.
    let found = outcome(touching(49.0), "mark", 2.0).unwrap();
    assert!((found - 20.0 / (100.0 * 0.02f64.sqrt())).abs() < 1e-8, "{found}");
}

#[test]
fn simultaneous_switchings_have_a_derivative_only_if_they_move_together() {
    let two = |second: &str| {
        volts("two")
            .parameter("mark", 50.0, "V", [1.0, 90.0])
            .drive("u", "volt", element("ramp").set("rate", 50))
            .element("K1", relay("mark / volt").cord("in", "u"))
            .element("K2", relay(second).cord("in", "u"))
            .element("P1", element("pot").cord("in", "K1").set("setting", 0.1))
            .element("P2", element("pot").cord("in", "K2").set("setting", 0.2))
            .element("A1", element("integrator").cords("x1", ["P1", "P2"]))
    };
    assert_refused(two("50"), "mark", "switch at the same instant");
    // The slope changes by 60 V/s, and that instant moves by 1/50 s per volt.
    let found = outcome(two("mark / volt"), "mark", 1.9).unwrap();
    assert!((found - 60.0 / 50.0).abs() < 1e-9, "{found}");
}

#[test]
fn noise_has_no_derivative_by_its_seed_and_interval() {
    let noise = |unit: &str, seed: &str, every: &str, rms: &str| {
        let noise = element("noise").set("seed", seed).set("every", every).set("rms", rms);
        volts("noise")
            .parameter("p", 1.0, unit, [1.0, 90.0])
            .drive("n", "volt", noise)
            .element("A1", element("integrator").cords("x1", ["n"]))
    };
    assert_refused(noise("1", "p", "0.1", "3"), "p", "n draws different numbers for every value");
    assert_refused(noise("s", "1", "p / 10", "3"), "p", "n draws different numbers");
    let found = outcome(noise("V", "1", "0.1", "3 * p"), "p", 1.0).unwrap();
    assert!(found.abs() > 1e-3);
}

#[test]
fn a_signal_at_its_threshold_in_initial_condition_has_no_derivative() {
    let late = volts("late")
        .parameter("at", 0.0, "s", [0.0, 1.0])
        .drive("u", "volt", element("step").set("height", 10).set("at", "at"))
        .element("A1", element("integrator").cords("x1", ["u"]));
    assert_refused(late, "at", "u is exactly at its switching threshold in initial condition");
}

#[test]
fn a_derivative_that_overflows_is_refused() {
    // A1' = 1000 A1 + 1000 p stays at 0 for p = 0, and S = 1000 A1.
    let growing = volts("growing")
        .parameter("p", 0.0, "V", [0.0, 1.0])
        .element("P1", element("pot").cord("in", "-100").set("setting", "p / (100 * volt)"))
        .element("I1", element("inverter").cord("in", "A1"))
        .element("A1", element("integrator").cords("x1000", ["I1", "P1"]))
        .element("S1", element("summer").cords("x1000", ["A1"]));
    let program = built(growing);
    let grown = |length: f64| {
        let mut machine = Machine::new(&program, 1e-4).unwrap();
        machine.differentiate(["p"]).unwrap();
        machine.operate(length).map(|()| machine.sensitivity("A1", "p").unwrap())
    };
    let found = grown(0.1).unwrap();
    assert!((found / 100f64.exp_m1() - 1.0).abs() < 1e-4, "{found}");
    // e^705 is 1.5e306, a finite number, but a thousand times that is not.
    for length in [0.705, 0.8] {
        let lost = grown(length).unwrap_err();
        assert!(lost.to_string().contains("it is not a finite number"), "{lost}");
    }
}

#[test]
fn the_slope_of_a_root_at_0_is_its_amplification() {
    // out = -A (out^2 / 100 V - u) is A u near 0, and small differences agree.
    let root = volts("root")
        .parameter("p", 0.0, "1", [0.0, 1.0])
        .element("P1", element("pot").cord("in", "-100").set("setting", "p"))
        .element("OA", element("open-amplifier").cords("x1", ["P1", "M1"]))
        .element(
            "M1",
            element("multiplier").set("mode", "sum-of-squares").cord("a", "OA").cord("b", "ground"),
        );
    let mut machine_program = built(root);
    let mut machine = Machine::new(&machine_program, 1e-2).unwrap();
    machine.differentiate(["p"]).unwrap();
    let slope = machine.sensitivity("OA", "p").unwrap();
    machine_program.set_parameters([("p", 1e-16)]).unwrap();
    let difference = Machine::new(&machine_program, 1e-2).unwrap().voltage("OA").unwrap() / 1e-16;
    assert!(
        (slope / 1e8 - 1.0).abs() < 1e-9 && (difference / slope - 1.0).abs() < 1e-3,
        "{slope} {difference}"
    );
}

#[test]
fn unknown_parameters_are_refused_by_name() {
    let program = program(&patch("bouncing-ball"), &[]);
    let mut machine = Machine::new(&program, 1e-2).unwrap();
    assert!(
        machine
            .differentiate(["mass"])
            .unwrap_err()
            .to_string()
            .contains("the patch declares no such parameter")
    );
    machine.differentiate(["g"]).unwrap();
    assert!(
        machine.sensitivity("B1", "e").unwrap_err().to_string().contains("it is not computed in this run")
    );
    assert!(machine.sensitivity("B9", "g").is_err());
    // The derivative of a signal is in its unit, that of an element in volts: 0.02 m per volt.
    machine.operate(0.3).unwrap();
    let [height, volts] = ["height", "B1"].map(|name| machine.sensitivity(name, "g").unwrap());
    assert!((height + 0.5 * 0.09).abs() < 1e-12 && (volts - height / 0.02).abs() < 1e-9, "{height} {volts}");
    let states = machine.state_sensitivities("g").unwrap();
    assert!((states[1] + volts).abs() < 1e-12 && states.len() == 2, "{states:?}");
}
