//! Steps as long as a tolerance allows: right to it, whatever kinks and switchings come, and named where it cannot be.

mod common;

use std::f64::consts::TAU;

use common::{built, element, order, patch, play, program, slideway, voltage, volts};
use patchcord::program::Program;
use patchcord::solve::{Machine, RunError, RunSettings, run};

const TOLERANCES: [f64; 4] = [1e-5, 1e-6, 1e-7, 1e-8];
/// Seconds of every run here.
const LENGTH: f64 = 10.0;

/// A machine after a run whose errors may add up to so much.
fn ran(program: &Program, tolerance: f64) -> Machine<'_> {
    let mut machine = Machine::adaptive(program, tolerance / LENGTH, 1e-3).unwrap();
    machine.operate(LENGTH).unwrap();
    machine
}

/// Holds an element's last voltage against a closed solution, down the tolerances.
fn assert_within_tolerance(program: &Program, name: &str, expected: f64) {
    for tolerance in TOLERANCES {
        let error = (voltage(&ran(program, tolerance), name) - expected).abs() / 100.0;
        assert!(error < tolerance, "{name} is {error:e} machine units off at {tolerance:e}");
    }
}

/// A1 and A2 swing with 2 radians a second and 50 V.
fn oscillator() -> Program {
    let builder = volts("oscillator")
        .element("A1", element("integrator").cords("x4", ["A2"]))
        .element("S1", element("summer").cords("x1", ["A1"]))
        .element("A2", element("integrator").cords("x1", ["S1"]).set("initial", 50));
    built(builder)
}

#[test]
fn an_oscillator_is_right_to_the_tolerance() {
    assert_within_tolerance(&oscillator(), "A2", 50.0 * (2.0 * LENGTH).cos());
}

#[test]
fn half_swings_about_a_dead_zone_are_right_to_the_tolerance() {
    // Level flight at 30 V/s over 20 V, then half a period.
    let half = 20.0 / 30.0 + TAU / 4.0;
    let since = LENGTH + 10.0 / 30.0;
    let gone = since % half - 20.0 / 30.0;
    assert!(((since / half) as u32).is_multiple_of(2) && gone > 0.0, "the last instant is a positive swing");
    assert_within_tolerance(&play(), "A2", 10.0 + 15.0 * (2.0 * gone).sin());
}

#[test]
fn fewer_steps_do_where_less_is_asked() {
    let program = oscillator();
    let steps = TOLERANCES.map(|tolerance| ran(&program, tolerance).work().steps as f64);
    // The error for each second goes with the fourth power of the step.
    let reached = order(&steps.map(|steps| LENGTH / steps), &TOLERANCES);
    assert!((3.7..=4.3).contains(&reached), "order {reached} from {steps:?}");
}

#[test]
fn stick_slip_of_fig_8_16_agrees_with_equal_short_steps() {
    let program = program(&slideway(), &[]);
    let course = |mut machine: Machine<'_>| -> Vec<f64> {
        let at = |tenth: i32| {
            machine.operate(f64::from(tenth) / 10.0 - machine.time()).unwrap();
            voltage(&machine, "B3")
        };
        (1..=20).map(at).collect()
    };
    let equal = course(Machine::new(&program, 5e-6).unwrap());
    let adaptive = course(Machine::adaptive(&program, 1e-9 / 2.0, 2e-5).unwrap());
    let peak = 24.47;
    for (one, other) in equal.iter().zip(&adaptive) {
        assert!((one - other).abs() < 1e-8 * peak, "{one} against {other}");
    }
}

#[test]
fn recording_finely_changes_nothing() {
    let circuit = common::circuit(&slideway(), &[]);
    let program = Program::new(&circuit).unwrap();
    let own = RunSettings::of(&circuit).unwrap().lasting(0.5);
    let [coarse, fine] = [0.1, 1e-4]
        .map(|every| run(&program, &RunSettings { tolerance: Some(1e-6), every, ..own.clone() }).unwrap());
    let work = |trace: &patchcord::trace::Trace| (trace.sweeps[0].work.steps, trace.sweeps[0].work.crossings);
    assert_eq!(work(&coarse), work(&fine));
    for (coarse, fine) in coarse.tracks.iter().zip(&fine.tracks) {
        for (tenth, volts) in coarse.volts.iter().enumerate() {
            assert_eq!(volts, &fine.volts[1000 * tenth], "{} at {tenth} tenths", coarse.name);
        }
    }
}

/// What is drawn between the ends of steps is as right as the steps: samples of the oscillator.
#[test]
fn samples_within_steps_are_right() {
    let patch = volts("oscillator")
        .element("A1", element("integrator").cords("x4", ["A2"]))
        .element("S1", element("summer").cords("x1", ["A1"]))
        .element("A2", element("integrator").cords("x1", ["S1"]).set("initial", 50))
        .signal("x", "A2", "volt", 1.0)
        .build()
        .unwrap();
    let circuit = common::circuit(&patch, &[]);
    let own = RunSettings { every: 0.01, ..RunSettings::of(&circuit).unwrap().lasting(LENGTH) };
    let program = Program::new(&circuit).unwrap();
    for tolerance in TOLERANCES {
        let trace = run(&program, &RunSettings { tolerance: Some(tolerance), ..own.clone() }).unwrap();
        for (time, volts) in trace.time.iter().zip(trace.values("x").unwrap()) {
            let error = (volts - 50.0 * (2.0 * time).cos()).abs() / 100.0;
            assert!(error < 2.0 * tolerance, "{error:e} at {time} s, at {tolerance:e}");
        }
    }
}

#[test]
fn a_delay_is_followed_however_long_steps_could_be() {
    let program = program(&patch("delay-line"), &[]);
    let name = program.outlets().iter().find(|outlet| outlet.name.starts_with('A')).unwrap().name.clone();
    let fine = common::ran(&program, 1e-4, 1.0);
    let mut machine = Machine::adaptive(&program, 1e-6, 1e-3).unwrap();
    machine.operate(1.0).unwrap();
    assert!((voltage(&machine, &name) - voltage(&fine, &name)).abs() < 1e-4);
}

/// A sine of 30.05 V passes the relay's threshold of 30 V for 0.018 of a period, within one step of either kind.
#[test]
fn a_relay_that_is_passed_in_the_middle_of_a_step_switches() {
    let builder = volts("brief")
        .drive("u", "volt", element("sine").set("amplitude", 30.05).set("frequency", 0.25))
        .element(
            "K1",
            element("relay")
                .cord("in", "u")
                .cord("on", "+100")
                .cord("off", "-100")
                .set("pull_in", 30)
                .set("drop_out", -30),
        );
    let program = built(builder);
    let mut machine = Machine::new(&program, 0.4).unwrap();
    machine.operate(1.5).unwrap();
    assert_eq!(voltage(&machine, "K1"), 100.0);
}

#[test]
fn what_is_no_tolerance_is_refused() {
    let program = oscillator();
    for tolerance in [0.0, -1e-6, 1e-14, f64::NAN, f64::INFINITY] {
        let refused = Machine::adaptive(&program, tolerance, 1e-3);
        assert!(matches!(refused, Err(RunError::NotATolerance { .. })), "{tolerance}");
    }
}

#[test]
fn a_step_far_below_the_first_one_tried_is_told() {
    let program = oscillator();
    let mut machine = Machine::adaptive(&program, 1e-13, 1e8).unwrap();
    match machine.operate(1.0) {
        Err(RunError::StepTooShort { element, .. }) => assert!(["A1", "A2"].contains(&element.as_str())),
        outcome => panic!("{outcome:?}"),
    }
}
