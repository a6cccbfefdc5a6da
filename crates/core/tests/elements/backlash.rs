//! Backlash, also called the play operator.

use std::f64::consts::TAU;

use proptest::prelude::*;

use crate::common::{built, element, random_cases, run_for, source, volts};
use crate::elements::bench::{ANY, apply, assert_out, at, bench, has_exact_derivatives, near, out};
use patchcord_core::ir::Program;
use patchcord_core::patch::ElementBuilder;

/// A backlash of this width in V.
fn backlash(width: f64, initial: f64) -> ElementBuilder {
    element("backlash").cord("in", "a").set("width", width).set("initial", initial)
}

/// A sine of 50 V and 1 Hz through a backlash of 20 V.
fn sine() -> Program {
    let sine = element("sine").set("amplitude", 50).set("frequency", 1);
    built(volts("sine").drive("a", "volt", sine).element("E", backlash(20.0, 0.0)))
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(width in 0.0..80.0f64, initial in ANY, moves in proptest::collection::vec(ANY, 1..20)) {
        let program = bench(backlash(width, initial));
        let mut machine = at(&program, &[0.0]);
        let mut expected = initial.clamp(-0.5 * width, 0.5 * width);
        prop_assert!(near(out(&machine), expected));
        machine.operate(1e-3).unwrap();
        for a in moves {
            apply(&mut machine, &[a]);
            expected = expected.clamp(a - 0.5 * width, a + 0.5 * width);
            prop_assert!(near(out(&machine), expected), "{a}: {} {expected}", out(&machine));
            machine.operate(1e-3).unwrap();
            prop_assert!(near(out(&machine), expected), "{a}: {} {expected}", out(&machine));
        }
    }
}

#[test]
fn overload() {
    let pair = element("diode-lower-of").set("in", serde_json::json!(["u", "u"])).set("drop", 10);
    let builder = source(volts("high"), "u", 100.0).element("a", pair).element("E", backlash(6.0, 0.0));
    let program = built(builder);
    let machine = run_for(&program, 1e-3, 0.01);
    assert_eq!((out(&machine), machine.overloads()[0].peak()), (100.0, Some(107.0)));
}

#[test]
fn modes() {
    let program = bench(backlash(20.0, 5.0));
    let mut machine = at(&program, &[0.0]);
    assert_out(&machine, 5.0, "in initial condition");
    machine.operate(2e-3).unwrap();
    apply(&mut machine, &[40.0]);
    assert_out(&machine, 30.0, "pushed in operate");
    machine.hold();
    apply(&mut machine, &[21.0]);
    assert_out(&machine, 30.0, "in hold, moved back within the width");
    apply(&mut machine, &[15.0]);
    assert_out(&machine, 25.0, "in hold, pushed back");
    machine.operate(2e-3).unwrap();
    assert_out(&machine, 25.0, "after hold");
    machine.initial_condition().unwrap();
    assert_out(&machine, 5.0, "in initial condition again");
}

#[test]
fn a_sine_whose_peaks_are_at_ends_of_steps_is_exact() {
    let program = sine();
    for step in [1.0 / 8.0, 1.0 / 100.0] {
        // Up to 50 - 10 V, constant until the sine has fallen by 20 V, down to -50 + 10 V, constant again.
        let level = (0.6f64).acos() / TAU;
        assert!(0.25 + level < 0.45);
        for (time, expected) in
            [(0.26, 40.0), (0.25 + level - 1e-3, 40.0), (0.75, -40.0), (0.76, -40.0), (1.25, 40.0)]
        {
            let found = out(&run_for(&program, step, time));
            assert!((found - expected).abs() < 1e-11, "{step} {time} {found}");
        }
        let found = out(&run_for(&program, step, 0.45));
        assert!((found - (50.0 * (TAU * 0.45).sin() + 10.0)).abs() < 1e-11, "{found}");
    }
}

/// The peak of the sine at 0.25 s is in the middle of a step.
#[test]
fn a_peak_within_a_step_is_reached() {
    let program = sine();
    for step in [1.0 / 22.0, 1.0 / 42.0, 1.0 / 82.0, 1.0 / 162.0] {
        let found = out(&run_for(&program, step, 0.3));
        assert!((found - 40.0).abs() < 1e-9, "{step}: {found}");
    }
}

/// In a loop without an integrator a backlash is a linear piece.
#[test]
fn a_loop_through_a_backlash_is_solved() {
    let builder = source(volts("loop"), "u", 30.0)
        .element("S", element("summer").cords("x1", ["u"]).cords("x0.5", ["E"]))
        .element("a", element("summer").cords("x1", ["S"]))
        .element("E", backlash(10.0, 0.0));
    // E = 30 + E / 2 - 5.
    assert_out(&run_for(&built(builder), 1e-2, 0.1), 50.0, "pushed up");
}

#[test]
fn derivatives() {
    has_exact_derivatives(backlash(90.0, 0.0), 30.0, &[]);
}
