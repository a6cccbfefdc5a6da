//! Adaptive steps: results keep the tolerance across kinks and switching, and a run that cannot keep it is reported.

use std::f64::consts::TAU;

use crate::common::{
    built, convergence_order, dead_zone_oscillator, element, patch, program, slideway, voltage, volts,
};
use patchcord_core::ir::Program;
use patchcord_core::patch::PatchBuilder;
use patchcord_core::solve::{Machine, Phase, RunError, RunSettings, run};

/// Tolerances for a whole run, in machine units.
const TOLERANCES: [f64; 4] = [1e-5, 1e-6, 1e-7, 1e-8];
/// Duration of the runs in seconds.
const LENGTH: f64 = 10.0;

/// A machine after a run of LENGTH seconds with this tolerance for the sum of its errors.
fn run_to_tolerance(program: &Program, tolerance: f64) -> Machine<'_> {
    let mut machine = Machine::adaptive(program, tolerance / LENGTH, 1e-3).unwrap();
    machine.operate(LENGTH).unwrap();
    machine
}

/// Compares an element's last voltage with a closed solution at every tolerance.
fn assert_within_tolerance(program: &Program, name: &str, expected: f64) {
    for tolerance in TOLERANCES {
        let error = (voltage(&run_to_tolerance(program, tolerance), name) - expected).abs() / 100.0;
        assert!(error < tolerance, "{name}: error {error:e} machine units at the tolerance {tolerance:e}");
    }
}

/// An oscillator A2 with 2 rad/s and this amplitude in volts.
fn swinging(amplitude: f64) -> PatchBuilder {
    volts("oscillator")
        .element("A1", element("integrator").cords("x4", ["A2"]))
        .element("S1", element("summer").cords("x1", ["A1"]))
        .element("A2", element("integrator").cords("x1", ["S1"]).set("initial", amplitude))
        .signal("x", "A2", "volt", 1.0)
}

fn oscillator() -> Program {
    built(swinging(50.0))
}

#[test]
fn an_oscillator_keeps_the_tolerance() {
    assert_within_tolerance(&oscillator(), "A2", 50.0 * (2.0 * LENGTH).cos());
}

#[test]
fn an_oscillator_with_a_dead_zone_keeps_the_tolerance() {
    // A straight line of 30 V/s over 20 V, then half a period.
    let half = 20.0 / 30.0 + TAU / 4.0;
    let since = LENGTH + 10.0 / 30.0;
    let in_swing = since % half - 20.0 / 30.0;
    assert!(
        ((since / half) as u32).is_multiple_of(2) && in_swing > 0.0,
        "the last instant is in a positive swing"
    );
    assert_within_tolerance(&dead_zone_oscillator(), "A2", 10.0 + 15.0 * (2.0 * in_swing).sin());
}

#[test]
fn a_larger_tolerance_takes_fewer_steps() {
    let program = oscillator();
    let steps = TOLERANCES.map(|tolerance| run_to_tolerance(&program, tolerance).work().steps as f64);
    // The error per second is proportional to the fourth power of the step.
    let observed = convergence_order(&steps.map(|steps| LENGTH / steps), &TOLERANCES);
    assert!((3.7..=4.3).contains(&observed), "order {observed} from {steps:?}");
}

#[test]
fn a_run_that_takes_more_steps_than_permitted_ends_with_an_error() {
    let settings = RunSettings::from_phases([Phase::operate(1000.0)], 1e-3).with_tolerance(1e-8);
    let mut settings = settings.with_sample_interval(1000.0).with_signals(["A2"]);
    settings.max_steps = 200.0;
    let error = run(&oscillator(), &settings).unwrap_err().error;
    assert_eq!(error, RunError::TooManySteps { steps: 201.0, max: 200.0 });
}

#[test]
fn rejected_steps_are_counted() {
    let program = oscillator();
    let mut machine = Machine::adaptive(&program, 1e-7, 0.2).unwrap();
    // At 50 V the oscillation of A1 would reach its limit and cost further evaluations.
    machine.set_state("A2", 30.0).unwrap();
    let before = machine.work().evaluations;
    machine.operate(LENGTH).unwrap();
    let work = machine.work();
    assert!(work.rejections > 0, "{work:?}");
    assert_eq!(work.evaluations, before + 6 * (work.steps + work.rejections));
}

#[test]
fn stick_slip_of_fig_8_16_agrees_with_equal_short_steps() {
    let program = program(&slideway(), &[]);
    let samples = |mut machine: Machine<'_>| -> Vec<f64> {
        let sample = |tenth: i32| {
            machine.operate(f64::from(tenth) / 10.0 - machine.time()).unwrap();
            voltage(&machine, "B3")
        };
        (1..=20).map(sample).collect()
    };
    let equal = samples(Machine::new(&program, 5e-6).unwrap());
    let adaptive = samples(Machine::adaptive(&program, 1e-9 / 2.0, 2e-5).unwrap());
    let peak = 24.47;
    for (one, other) in equal.iter().zip(&adaptive) {
        assert!((one - other).abs() < 1e-8 * peak, "{one} and {other}");
    }
}

#[test]
fn the_sampling_interval_does_not_change_the_run() {
    let circuit = crate::common::circuit(&slideway(), &[]);
    let program = Program::new(&circuit).unwrap();
    let own = RunSettings::of(&circuit).unwrap().with_duration(0.5);
    let [coarse, fine] = [0.1, 1e-4]
        .map(|every| run(&program, &own.clone().with_tolerance(1e-6).with_sample_interval(every)).unwrap());
    let work = |trace: &patchcord_core::trace::Trace| {
        (trace.repetitions[0].work.steps, trace.repetitions[0].work.crossings)
    };
    assert_eq!(work(&coarse), work(&fine));
    for (coarse, fine) in coarse.tracks.iter().zip(&fine.tracks) {
        for (tenth, volts) in coarse.volts.iter().enumerate() {
            assert_eq!(volts, &fine.volts[1000 * tenth], "{} at {tenth} tenths", coarse.name);
        }
    }
}

/// The oscillator's samples between the ends of steps are as accurate as those at the ends.
#[test]
fn samples_within_steps_keep_twice_the_tolerance() {
    let patch = swinging(50.0).build().unwrap();
    let circuit = crate::common::circuit(&patch, &[]);
    let own = RunSettings::of(&circuit).unwrap().with_duration(LENGTH).with_sample_interval(0.01);
    let program = Program::new(&circuit).unwrap();
    for tolerance in TOLERANCES {
        let trace = run(&program, &own.clone().with_tolerance(tolerance)).unwrap();
        for (time, volts) in trace.time.iter().zip(trace.values("x").unwrap()) {
            let error = (volts - 50.0 * (2.0 * time).cos()).abs() / 100.0;
            assert!(error < 2.0 * tolerance, "{error:e} at {time} s, at {tolerance:e}");
        }
    }
}

#[test]
fn delay_lines_keep_the_tolerance() {
    let program = program(&patch("delay-line"), &[]);
    let (end, delayed) = (5.37, 4.37);
    // x' = -x(t - 1), by the method of steps: the sum of (1 - t + k)^k / k! up to t; 50 V before.
    let term = |k: i32| (f64::from(k) - 1.0 - end).powi(k) / (1..=k).map(f64::from).product::<f64>();
    let expected =
        [("D1", 80.0 * (0.4 * TAU * delayed).sin()), ("A1", 50.0 * (0..=6).map(term).sum::<f64>())];
    for tolerance in WIDE_TOLERANCES {
        let mut machine = Machine::adaptive(&program, tolerance / end, 6e-3).unwrap();
        machine.operate(end).unwrap();
        for (name, expected) in expected {
            let error = (voltage(&machine, name) - expected).abs() / 100.0;
            assert!(
                error < tolerance,
                "{name}: error {error:e} machine units at the tolerance {tolerance:e}"
            );
        }
    }
}

/// The minimum and maximum of an oscillation keep the tolerance wherever steps end. So do those of a recorded
/// rectifier, whose kinks are not located.
#[test]
fn the_minimum_and_maximum_keep_the_tolerance() {
    let rectifier = element("absolute").cord("in", "A2");
    let patch = swinging(30.0).element("AB", rectifier).signal("size", "AB", "volt", 1.0).build().unwrap();
    let circuit = crate::common::circuit(&patch, &[]);
    let own = RunSettings::of(&circuit).unwrap().with_duration(LENGTH).with_sample_interval(1.0);
    let program = Program::new(&circuit).unwrap();
    for tolerance in WIDE_TOLERANCES {
        let trace = run(&program, &own.clone().with_tolerance(tolerance)).unwrap();
        let [x, size] = [0, 1].map(|track| trace.tracks[track].extremes[0]);
        let bound = 100.0 * tolerance;
        assert!(
            (x.most.volts - 30.0).abs() < bound && (x.least.volts + 30.0).abs() < bound,
            "{x:?} at {tolerance:e}"
        );
        assert!(
            size.least.volts.abs() < 0.01 + bound && size.most.volts < 30.0 + bound,
            "{size:?} at {tolerance:e}"
        );
    }
}

#[test]
fn a_lamp_lights_at_the_right_time_if_nothing_uses_the_element() {
    for amplitude in [120.0, 101.0] {
        let sine = element("sine").set("amplitude", 0.5 * amplitude).set("frequency", 1);
        let builder =
            volts("lamp").drive("u", "volt", sine).element("S", element("summer").cords("x2", ["u"]));
        let program =
            built(builder.element("A1", element("integrator").cords("x1", ["S"]).set("initial", 1)));
        let expected = (100.0001_f64 / amplitude).asin() / TAU;
        let equal = crate::common::run_for(&program, 0.05, 1.0).overloads();
        assert!((equal[0].time - expected).abs() < 1e-9, "{equal:?}");
        for tolerance in WIDE_TOLERANCES {
            let lamp = &run_to_tolerance(&program, tolerance).overloads()[0];
            assert!((lamp.time - expected).abs() < 1e-9, "{lamp:?} at {tolerance:e}");
            assert!((lamp.peak().unwrap() - amplitude).abs() < 1e-6, "{lamp:?} at {tolerance:e}");
        }
    }
}

/// A sine of 30.05 V exceeds the relay's threshold of 30 V for 0.018 of a period, within one equal or adaptive step.
#[test]
fn a_relay_switches_if_its_threshold_is_exceeded_within_a_step() {
    let sine = element("sine").set("amplitude", 30.05).set("frequency", 0.25);
    let program = built(relay(volts("brief").drive("u", "volt", sine), "u", 30.0, -30.0));
    let equal = Machine::new(&program, 0.4).unwrap();
    let adaptive =
        [1e-2, 1e-3, 1e-6, 1e-9].map(|tolerance| Machine::adaptive(&program, tolerance, 0.4).unwrap());
    for mut machine in adaptive.into_iter().chain([equal]) {
        machine.operate(1.5).unwrap();
        assert_eq!(voltage(&machine, "K1"), 100.0);
    }
}

/// A ramp of 5 V/s crosses a spike of a function generator, 0.2 V wide, or the peak of a sine exceeds a dead zone.
#[test]
fn a_short_pulse_in_a_slow_signal_switches_a_relay() {
    let ramp = volts("spike").drive("u", "volt", element("ramp").set("rate", 5));
    let points = serde_json::json!([[0.0, 0.0], [31.1, 0.0], [31.2, 60.0], [31.3, 0.0], [90.0, 0.0]]);
    let spike = ramp.element("F", element("function-generator").cord("in", "u").set("points", points));
    let sine = volts("peak").drive("u", "volt", element("sine").set("amplitude", 60.1).set("frequency", 0.1));
    let peak = sine.element("F", element("dead-zone").cord("in", "u").set("lower", -70).set("upper", 50));
    for (builder, level) in [(spike, 50.0), (peak, 10.0)] {
        let program = built(relay(builder, "F", level, level - 5.0));
        for tolerance in WIDE_TOLERANCES {
            assert_eq!(run_to_tolerance(&program, tolerance).work().changes, 2, "at {tolerance:e}");
        }
    }
}

/// Adds a relay K1 that switches between -100 V and 100 V.
fn relay(builder: PatchBuilder, input: &str, pull_in: f64, drop_out: f64) -> PatchBuilder {
    let relay = element("relay").cord("in", input).cord("on", "+100").cord("off", "-100");
    builder.element("K1", relay.set("pull_in", pull_in).set("drop_out", drop_out))
}

/// Tolerances from those whose steps can be much longer than a pulse to the smallest.
const WIDE_TOLERANCES: [f64; 9] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10];

/// Adds the integral A3 of the part of `input` above 50 V. A3 is constant most of the time.
fn peaks_above_50_volts(builder: PatchBuilder, input: &str) -> Program {
    let zone = element("dead-zone").cord("in", input).set("lower", -70).set("upper", 50);
    built(builder.element("DZ", zone).element("A3", element("integrator").cords("x1", ["DZ"])))
}

/// The area above 50 V of one period of centre + amplitude sin(angle), with the angle in radians.
fn peak_area(centre: f64, amplitude: f64) -> f64 {
    let start = ((50.0 - centre) / amplitude).asin();
    2.0 * (amplitude * start.cos() - (50.0 - centre) * (TAU / 4.0 - start))
}

/// Asserts that the integral A3 keeps every tolerance.
fn assert_peak_area(program: &Program, expected: f64) {
    for tolerance in WIDE_TOLERANCES {
        let error = (voltage(&run_to_tolerance(program, tolerance), "A3") - expected).abs() / 100.0;
        assert!(error < tolerance, "error {error:e} machine units at the tolerance {tolerance:e}");
    }
}

#[test]
fn no_peak_of_a_sine_is_stepped_over() {
    let sine = element("sine").set("amplitude", 60).set("frequency", 1);
    assert_peak_area(
        &peaks_above_50_volts(volts("peaks").drive("u", "volt", sine), "u"),
        -LENGTH * peak_area(0.0, 60.0) / TAU,
    );
    // The same sine made by a sine element from a ramp.
    let ramp = volts("peaks of a ramp's sine").drive("u", "volt", element("ramp").set("rate", 5));
    let sine = element("sin").cord("in", "u").set("amplitude", 60).set("angle_per_volt", TAU / 5.0);
    assert_peak_area(
        &peaks_above_50_volts(ramp.element("S", sine), "S"),
        -LENGTH * peak_area(0.0, 60.0) / TAU,
    );
}

#[test]
fn no_peak_is_stepped_over_after_a_time_at_rest() {
    // At 5 s a step starts an oscillator that is at rest: A2 = 30 V (1 - cos(4 pi (t - 5 s))).
    let push = element("step").set("height", 30).set("at", 5);
    let builder = volts("peaks after rest")
        .drive("u", "volt", push)
        .element("B1", element("summer").cords("x1", ["u"]))
        .element("D1", element("summer").cords("x1", ["B1", "A2"]))
        .element("P1", element("pot").cord("in", "D1").set("setting", 0.02 * TAU))
        .element("A1", element("integrator").cords("x100", ["P1"]))
        .element("P2", element("pot").cord("in", "A1").set("setting", 0.02 * TAU))
        .element("A2", element("integrator").cords("x100", ["P2"]));
    assert_peak_area(&peaks_above_50_volts(builder, "A2"), -10.0 * peak_area(30.0, 30.0) / (2.0 * TAU));
}

#[test]
fn a_relay_in_a_slow_circuit_switches_every_time() {
    let sine = element("sine").set("amplitude", 60).set("frequency", 1);
    let builder = relay(volts("relay in a calm").drive("u", "volt", sine), "u", 50.0, 40.0)
        .element("P1", element("pot").cord("in", "K1").set("setting", 0.001))
        .element("A1", element("integrator").cords("x1", ["P1"]));
    let program = built(builder);
    let on = (TAU / 2.0 - (40.0_f64 / 60.0).asin() - (50.0_f64 / 60.0).asin()) / TAU;
    for tolerance in WIDE_TOLERANCES {
        let machine = run_to_tolerance(&program, tolerance);
        let error = voltage(&machine, "A1") - LENGTH * 0.1 * (1.0 - 2.0 * on);
        assert!(
            error.abs() < 1e-9 && machine.work().changes == 20,
            "error {error:e} V at the tolerance {tolerance:e}"
        );
    }
}

/// A relay that drives A1 from an initial voltage to 0 and keeps it there within its hysteresis in volts.
fn kept_by_a_relay(hysteresis: f64, initial: f64) -> Program {
    let integrator = element("integrator").cords("x1", ["K1"]).set("initial", initial);
    built(relay(volts("kept by a relay"), "A1", hysteresis, -hysteresis).element("A1", integrator))
}

#[test]
fn frequent_switching_after_a_long_step_is_not_chatter() {
    // The relay switches in initial condition, after 0.901 s, and then every 2 ms.
    let program = kept_by_a_relay(0.1, 90.0);
    for tolerance in [1e-3, 1e-6, 1e-9] {
        assert_eq!(run_to_tolerance(&program, tolerance).work().changes, 4551, "at {tolerance:e}");
    }
}

#[test]
fn chatter_is_reported_with_equal_and_adaptive_steps() {
    // A function generator with 1200 corners, crossed in 7 ms.
    let points: Vec<[f64; 2]> = (0..1200).map(|k| [f64::from(k) / 6.0 - 100.0, f64::from(k % 2)]).collect();
    let sawtooth = element("function-generator").cord("in", "u").set("points", serde_json::json!(points));
    let kinks = volts("kinks")
        .drive("u", "volt", element("ramp").set("start", -100).set("rate", 3e4))
        .element("F", sawtooth)
        .element("A1", element("integrator").cords("x1", ["F"]));
    let ball = program(&patch("bouncing-ball"), &[("v_rest", 0.0), ("e", 0.5)]);
    let cases = [
        ("K1", kept_by_a_relay(1e-9, 1.0), 1e-3, "hysteresis"),
        ("F", built(kinks), 1.0, "its input oscillates"),
        ("A1", ball, 1e-3, "a larger \"rest\""),
    ];
    for (name, program, step, remedy) in &cases {
        let machines = [Machine::new(program, *step), Machine::adaptive(program, 1e-6, *step)];
        for mut machine in machines.map(Result::unwrap) {
            match machine.operate(LENGTH) {
                Err(RunError::Chatter { element, advice, .. }) => {
                    assert!(element == *name && advice.contains(remedy), "{element}: {advice}");
                    let suggests_shorter_step = advice.contains("shorter step");
                    assert!(!(suggests_shorter_step && *name == "A1"), "no step is short enough: {advice}");
                }
                outcome => panic!("{name}: {outcome:?}"),
            }
        }
    }
}

#[test]
fn a_tolerance_out_of_range_is_refused() {
    let program = oscillator();
    for tolerance in [0.0, -1e-6, 1e-14, 2.0, 1e300, f64::NAN, f64::INFINITY] {
        let refused = Machine::adaptive(&program, tolerance, 1e-3);
        assert!(matches!(refused, Err(RunError::NotATolerance { .. })), "{tolerance}");
        let settings = RunSettings::from_phases([Phase::operate(1.0)], 1e-3).with_tolerance(tolerance);
        let message = settings.check().unwrap_err().to_string();
        assert!(message.starts_with("the tolerance must be from 1e-13 to 1, got "), "{message}");
    }
}

/// The range concerns the tolerance of the whole run, not its share of a second.
#[test]
fn the_range_of_tolerances_does_not_depend_on_the_duration() {
    let program = oscillator();
    for (duration, tolerance) in [(3.0, 1e-13), (0.01, 1.0)] {
        let settings = RunSettings::from_phases([Phase::operate(duration)], 1e-3).with_tolerance(tolerance);
        let trace = run(&program, &settings.with_signals(["A2"])).unwrap();
        let last = trace.values("A2").and_then(|values| values.last().copied()).unwrap();
        let error = (last - 50.0 * (2.0 * duration).cos()).abs() / 100.0;
        // Rounding may add to an error of 1e-13.
        assert!(error < tolerance.max(1e-12), "{duration} s: {error:e}");
    }
}

#[test]
fn a_step_far_below_the_initial_step_is_reported() {
    let program = oscillator();
    let mut machine = Machine::adaptive(&program, 1e-13, 1e8).unwrap();
    match machine.operate(1.0) {
        Err(RunError::StepTooShort { element, .. }) => assert!(["A1", "A2"].contains(&element.as_str())),
        outcome => panic!("{outcome:?}"),
    }
}
