//! Derivatives that there are not are told by name, and never given as numbers.

use crate::common::{built, element, patch, program, volts};
use patchcord_core::patch::PatchBuilder;
use patchcord_core::solve::{Machine, RunError};

/// What comes of a second of a patch, differentiated by one of its parameters.
fn outcome(builder: PatchBuilder, by: &str, length: f64) -> Result<f64, RunError> {
    let program = built(builder);
    let mut machine = Machine::new(&program, 1e-2).unwrap();
    machine.differentiate(&[by])?;
    machine.operate(length)?;
    machine.sensitivity("A1", by)
}

fn refused(builder: PatchBuilder, by: &str, wanted: &str) {
    let error = outcome(builder, by, 2.0).unwrap_err();
    assert!(error.to_string().contains(wanted), "{error}");
    assert!(["no-derivative", "derivative-lost"].contains(&error.code()));
}

fn relay(pull_in: &str) -> patchcord_core::patch::ElementBuilder {
    element("relay").cord("on", "+100").cord("off", "-100").set("drop_out", -90).set("pull_in", pull_in)
}

/// 50 t (2 - t) comes up to 50 V at t = 1, and no farther.
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
fn what_only_touches_its_mark_has_no_derivative() {
    refused(touching(50.0 - 1e-11), "mark", "K1 only touches its switching threshold");
    // A volt below, the relay switches at 1 - sqrt(0.02): 20 V/s more or less from there on.
    let found = outcome(touching(49.0), "mark", 2.0).unwrap();
    assert!((found - 20.0 / (100.0 * 0.02f64.sqrt())).abs() < 1e-8, "{found}");
}

#[test]
fn two_that_switch_at_once_must_move_together() {
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
    refused(two("50"), "mark", "switch at the same instant");
    // 60 V/s later by 1/50 s for every volt.
    let found = outcome(two("mark / volt"), "mark", 1.9).unwrap();
    assert!((found - 60.0 / 50.0).abs() < 1e-9, "{found}");
}

#[test]
fn noise_has_no_derivative_by_what_draws_it() {
    let noise = |unit: &str, seed: &str, every: &str, rms: &str| {
        let noise = element("noise").set("seed", seed).set("every", every).set("rms", rms);
        volts("noise")
            .parameter("p", 1.0, unit, [1.0, 90.0])
            .drive("n", "volt", noise)
            .element("A1", element("integrator").cords("x1", ["n"]))
    };
    refused(noise("1", "p", "0.1", "3"), "p", "n draws other numbers for every other value");
    refused(noise("s", "1", "p / 10", "3"), "p", "n draws other numbers");
    let found = outcome(noise("V", "1", "0.1", "3 * p"), "p", 1.0).unwrap();
    assert!(found.abs() > 1e-3);
}

#[test]
fn what_stands_at_its_mark_from_the_start_has_no_derivative() {
    let late = volts("late")
        .parameter("at", 0.0, "s", [0.0, 1.0])
        .drive("u", "volt", element("step").set("height", 10).set("at", "at"))
        .element("A1", element("integrator").cords("x1", ["u"]));
    refused(late, "at", "u is exactly at its switching threshold in initial condition");
}

#[test]
fn what_grows_beyond_all_numbers_has_no_derivative() {
    // A1' = 1000 A1 + 1000 p stays at 0 for p = 0; beside it S = 1000 A1.
    let growing = volts("growing")
        .parameter("p", 0.0, "V", [0.0, 1.0])
        .element("P1", element("pot").cord("in", "-100").set("setting", "p / (100 * volt)"))
        .element("I1", element("inverter").cord("in", "A1"))
        .element("A1", element("integrator").cords("x1000", ["I1", "P1"]))
        .element("S1", element("summer").cords("x1000", ["A1"]));
    let program = built(growing);
    let grown = |length: f64| {
        let mut machine = Machine::new(&program, 1e-4).unwrap();
        machine.differentiate(&["p"]).unwrap();
        machine.operate(length).map(|()| machine.sensitivity("A1", "p").unwrap())
    };
    let found = grown(0.1).unwrap();
    assert!((found / 100f64.exp_m1() - 1.0).abs() < 1e-4, "{found}");
    // e^705 is 1.5e306: a number, but not for the summer.
    for length in [0.705, 0.8] {
        let lost = grown(length).unwrap_err();
        assert!(lost.to_string().contains("it is not a finite number"), "{lost}");
    }
}

#[test]
fn a_root_at_0_is_as_steep_as_its_amplifier() {
    // out = -A (out^2 / 100 V - u): near 0 it is A u, and so is what small differences tell.
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
    machine.differentiate(&["p"]).unwrap();
    let slope = machine.sensitivity("OA", "p").unwrap();
    machine_program.set_parameters([("p", 1e-16)]).unwrap();
    let beside = Machine::new(&machine_program, 1e-2).unwrap().voltage("OA").unwrap() / 1e-16;
    assert!((slope / 1e8 - 1.0).abs() < 1e-9 && (beside / slope - 1.0).abs() < 1e-3, "{slope} {beside}");
}

#[test]
fn unknown_parameters_are_told() {
    let program = program(&patch("bouncing-ball"), &[]);
    let mut machine = Machine::new(&program, 1e-2).unwrap();
    assert!(machine.differentiate(&["mass"]).unwrap_err().to_string().contains("there is no such parameter"));
    machine.differentiate(&["g"]).unwrap();
    assert!(machine.sensitivity("B1", "e").unwrap_err().to_string().contains("none is carried along"));
    assert!(machine.sensitivity("B9", "g").is_err());
    // A signal in its own unit, an element in volts: 0.02 m a volt.
    machine.operate(0.3).unwrap();
    let [height, volts] = ["height", "B1"].map(|name| machine.sensitivity(name, "g").unwrap());
    assert!((height + 0.5 * 0.09).abs() < 1e-12 && (volts - height / 0.02).abs() < 1e-9, "{height} {volts}");
    let states = machine.state_sensitivities("g").unwrap();
    assert!((states[1] + volts).abs() < 1e-12 && states.len() == 2, "{states:?}");
}
