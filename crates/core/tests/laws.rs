//! Properties of every patch: linearity, time scaling, repeatability, machine modes, overload lamps.

use proptest::prelude::*;
use serde_json::json;

use crate::common::{
    built, convergence_order, element, patch, program, random_cases, run_for, slideway, voltage, volts,
};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, SettingError};
use patchcord_core::patch::{Patch, PatchBuilder};
use patchcord_core::solve::{self, Machine, MachineMode, RunError, RunSettings, StoppedRunError};
use patchcord_core::trace::Trace;

/// A linear damped oscillator driven by a sine. Arguments are in volts.
fn linear(x0: f64, v0: f64, amplitude: f64) -> Program {
    let sine = element("sine").set("amplitude", amplitude).set("frequency", 0.4);
    built(
        volts("linear")
            .drive("u", "volt", sine)
            .element("P1", element("pot").cord("in", "A1").set("setting", 0.7))
            .element(
                "A1",
                element("integrator").cords("x4", ["A2"]).cords("x1", ["P1", "u"]).set("initial", v0),
            )
            .element("S1", element("summer").cords("x1", ["A1"]))
            .element("A2", element("integrator").cords("x1", ["S1"]).set("initial", x0)),
    )
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn responses_to_initial_values_and_drives_superpose(x0 in -20.0..20.0f64, v0 in -20.0..20.0f64, amplitude in -20.0..20.0f64) {
        let out = |program: Program| voltage(&run_for(&program, 1e-2, 3.0), "A2");
        let combined = out(linear(x0, v0, amplitude));
        let summed = out(linear(x0, 0.0, 0.0)) + out(linear(0.0, v0, 0.0)) + out(linear(0.0, 0.0, amplitude));
        prop_assert!((combined - summed).abs() < 1e-11, "{combined} {summed}");
        let doubled = out(linear(2.0 * x0, 2.0 * v0, 2.0 * amplitude));
        prop_assert!((doubled - 2.0 * combined).abs() < 1e-11);
    }

    #[test]
    fn changed_parameters_equal_an_edited_file(m in 180.0..4000.0f64, k in 5e6..178e6f64, tc in 0.001..1.0f64) {
        let slideway = slideway();
        let mut edited = slideway.value().clone();
        for (name, value) in [("M", m), ("K", k), ("Tc", tc)] {
            edited["parameters"][name]["value"] = json!(value);
        }
        let edited = Patch::from_value("edited", &edited).unwrap();
        let run = |program: Program| run_for(&program, 2e-5, 0.02).states().to_vec();
        prop_assert_eq!(run(program(&slideway, &[("M", m), ("K", k), ("Tc", tc)])), run(program(&edited, &[])));
    }
}

#[test]
fn the_energy_of_an_undamped_oscillator_falls_by_the_formula_of_runge_kutta() {
    let oscillator = built(
        volts("oscillator")
            .element("A1", element("integrator").cords("x1", ["A2"]))
            .element("S1", element("summer").cords("x1", ["A1"]))
            .element("A2", element("integrator").cords("x1", ["S1"]).set("initial", 50)),
    );
    for (step, steps) in [(0.1, 1000), (0.05, 4000)] {
        let machine = run_for(&oscillator, step, step * f64::from(steps));
        let energy: f64 = machine.states().iter().map(|volts| volts * volts).sum();
        // |1 + z + z2/2 + z3/6 + z4/24|^2 at z = i h is 1 - h^6/72 + h^8/576.
        let per_step = 1.0 - step.powi(6) / 72.0 + step.powi(8) / 576.0;
        let expected = 2500.0 * per_step.powi(steps);
        assert!((energy / expected - 1.0).abs() < 1e-11, "{step} {energy} {expected}");
    }
}

/// A time-scaled linear patch with a delay. A problem second takes `slow` machine seconds, and gains are per machine
/// second.
fn time_scaled(slow: f64) -> Program {
    let gain = |gain: f64| format!("x{}", gain / slow);
    let sine = element("sine").set("amplitude", 20).set("frequency", 0.4);
    built(
        volts("twin")
            .time_scale(slow)
            .drive("u", "volt", sine)
            .element("D1", element("delay").cord("in", "A2").set("delay", 0.25 * slow))
            .element("A1", element("integrator").cords(&gain(4.0), ["A2"]).cords(&gain(1.0), ["u", "D1"]))
            .element("S1", element("summer").cords("x1", ["A1"]))
            .element("A2", element("integrator").cords(&gain(1.0), ["S1"]).set("initial", 30)),
    )
}

#[test]
fn time_scaling_does_not_change_voltages_over_problem_time() {
    let (plain, slow) = (time_scaled(1.0), time_scaled(10.0));
    for time in [0.1, 0.77, 2.5] {
        let (plain, slow) = (run_for(&plain, 1e-2, time), run_for(&slow, 1e-2, time));
        for name in ["u", "D1", "A1", "A2"] {
            assert!((voltage(&plain, name) - voltage(&slow, name)).abs() < 1e-12, "{name} at {time}");
        }
    }
}

/// The trace of a patch with changed run settings.
fn trace(patch: &Patch, change: impl Fn(RunSettings) -> RunSettings) -> Trace {
    let circuit = Circuit::new(patch).unwrap();
    let settings = change(RunSettings::of(&circuit).unwrap());
    solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap()
}

/// Patches of crates/core/tests/patches that together use every kind of event.
const PATCHES: [&str; 8] = [
    "bouncing-ball",
    "stick-slip-brake",
    "relay-oscillator",
    "delay-line",
    "integrator-limit",
    "summer-loop",
    "loop-lag",
    "memory",
];

#[test]
fn repeated_runs_give_the_same_bytes() {
    for stem in PATCHES {
        let csv = || {
            let mut bytes = Vec::new();
            trace(&patch(stem), |settings| settings).write_csv(&mut bytes).unwrap();
            bytes
        };
        assert!(csv() == csv(), "{stem}");
    }
}

#[test]
fn recording_does_not_change_the_steps() {
    for stem in PATCHES {
        let recorded_every = |steps: f64| {
            trace(&patch(stem), |settings| {
                let every = steps * settings.step;
                settings.with_sample_interval(every)
            })
        };
        let [coarse, fine] = [10.0, 1.0].map(recorded_every);
        for (wide, close) in coarse.tracks.iter().zip(&fine.tracks) {
            let shared: Vec<f64> = close.volts.iter().copied().step_by(10).collect();
            assert_eq!(wide.volts, shared, "{stem} {}", wide.name);
        }
    }
}

/// The error of the cubic between the ends of a step is at most (h^4 / 384) x''''.
#[test]
fn samples_between_steps_have_the_order_of_the_cubic() {
    let steps = [0.08, 0.04, 0.02, 0.01];
    let oscillator = volts("oscillator")
        .element("A1", element("integrator").cords("x1", ["A2"]))
        .element("S1", element("summer").cords("x1", ["A1"]))
        .element("A2", element("integrator").cords("x1", ["S1"]).set("initial", 50))
        .record(["A2"])
        .build()
        .unwrap();
    let errors = steps.map(|step| {
        let trace = trace(&oscillator, |settings| {
            settings.with_duration(6.4).with_step(step).with_sample_interval(0.37 * step)
        });
        let samples = trace.time.iter().zip(&trace.tracks[0].volts);
        samples.map(|(time, volts)| (volts - 50.0 * time.cos()).abs()).fold(0.0, f64::max)
    });
    let observed = convergence_order(&steps, &errors);
    assert!((3.9..4.1).contains(&observed), "{observed} {errors:?}");
    assert!(
        errors[3] < 2.0 * 50.0 * 0.01f64.powi(4) / 384.0 + 50.0 * 6.4 * 0.01f64.powi(4) / 120.0,
        "{errors:?}"
    );
}

#[test]
fn repetitive_operation_gives_identical_repetitions() {
    for stem in PATCHES {
        let trace = trace(&patch(stem), |settings| settings.repeated(3));
        assert_eq!(trace.repetitions.len(), 3);
        let length = trace.len() / 3;
        assert!(trace.tracks.iter().all(|track| {
            let mut repetitions = track.volts.chunks(length);
            let first = repetitions.next();
            repetitions.all(|repetition| Some(repetition) == first)
        }));
        assert_eq!(trace.repetitions[0].overloads, trace.repetitions[2].overloads);
        assert_eq!(trace.repetitions[1].first, length);
    }
}

#[test]
fn hold_keeps_states_and_time() {
    let program = program(&patch("bouncing-ball"), &[]);
    let (mut held, mut straight) = (run_for(&program, 1e-3, 0.7), run_for(&program, 1e-3, 0.7));
    held.hold();
    assert_eq!(held.mode(), MachineMode::Hold);
    let states = held.states().to_vec();
    held.set_parameter("g", 3.0).unwrap();
    assert_eq!((held.states(), held.time()), (&states[..], 0.7));
    held.set_parameter("g", 9.81).unwrap();
    held.operate(0.4).unwrap();
    straight.operate(0.4).unwrap();
    assert_eq!(held.states(), straight.states());
}

#[test]
fn consecutive_short_runs_equal_one_long_run() {
    let program = program(&patch("delay-line"), &[]);
    let mut parts = run_for(&program, 1e-2, 0.0);
    (0..30).for_each(|_| parts.operate(0.123).unwrap());
    let whole = run_for(&program, 1e-2, 30.0 * 0.123);
    assert!((parts.time() - whole.time()).abs() < 1e-12);
    assert!((voltage(&parts, "A1") - voltage(&whole, "A1")).abs() < 1e-8);
}

#[test]
fn a_pot_that_is_changed_during_a_run_acts_from_that_time_on() {
    let program = program(&patch("loop-lag"), &[("back", 0.0)]);
    let mut machine = run_for(&program, 1e-2, 1.0);
    machine.set_parameter("back", 1.0).unwrap();
    machine.operate(1.0).unwrap();
    assert!((voltage(&machine, "A1") - 80.0 * (-1.5f64).exp()).abs() < 1e-8);
}

#[test]
fn a_refused_change_changes_nothing() {
    let program = program(&patch("delay-line"), &[]);
    let mut machine = run_for(&program, 1e-2, 1.5);
    let before = (machine.states().to_vec(), machine.rates().to_vec());
    assert!(
        matches!(machine.set_parameter("T", 5.0), Err(RunError::Setting(SettingError::OutsideRange(_)))),
        "outside its range"
    );
    assert!(
        matches!(machine.set_parameter("T", f64::NAN), Err(RunError::Setting(SettingError::OutsideRange(_)))),
        "not a number"
    );
    assert!(matches!(
        machine.set_parameter("nothing", 1.0),
        Err(RunError::Setting(SettingError::UnknownParameter { .. }))
    ));
    assert!(matches!(machine.set_state("A1", 101.0), Err(RunError::StateOutsideRange { .. })));
    assert!(matches!(machine.set_state("D1", 1.0), Err(RunError::UnknownElement(_))));
    assert_eq!((machine.states(), machine.rates()), (&before.0[..], &before.1[..]));
}

#[test]
fn a_delay_below_the_step_is_refused_without_effect_on_the_run() {
    let program = program(&patch("delay-line"), &[]);
    let (mut refused, mut unchanged) = (run_for(&program, 0.2, 1.0), run_for(&program, 0.2, 1.0));
    assert!(matches!(refused.set_parameter("T", 0.15), Err(RunError::DelayTooShort { .. })));
    refused.operate(3.0).unwrap();
    unchanged.operate(3.0).unwrap();
    assert_eq!(refused.states(), unchanged.states());
}

#[test]
fn a_state_that_is_set_lasts_until_the_next_initial_condition() {
    let program = program(&patch("loop-lag"), &[]);
    let mut machine = run_for(&program, 1e-2, 0.0);
    machine.set_state("A1", 40.0).unwrap();
    assert!((voltage(&machine, "S1") + 40.0 / 1.5).abs() < 1e-12);
    machine.operate(1.5).unwrap();
    assert!((voltage(&machine, "A1") - 40.0 * (-1.0f64).exp()).abs() < 1e-8);
    machine.initial_condition().unwrap();
    assert_eq!(voltage(&machine, "A1"), 80.0);
}

/// A ramp u of 10 V/s. It overloads S1 at 5 s, itself at 10 s, and S3 through a delay at 10.95 s. S2 depends on S1, but
/// its lamp is the first because its voltage is 1.08 times that of S1.
fn chain() -> PatchBuilder {
    volts("chain")
        .drive("u", "volt", element("ramp").set("rate", 10).set("turn", 12))
        .element("S1", element("summer").cords("x2", ["u"]))
        .element("P1", element("pot").cord("in", "S1").set("setting", 0.9))
        .element("S2", element("summer").cords("x1.2", ["P1"]))
        .element("D3", element("delay").cord("in", "u").set("delay", 1))
        .element("S3", element("summer").cords("x1.005", ["D3"]))
        .record(["S1", "S2"])
}

#[test]
fn lamps_latch_and_distinguish_causes_from_consequences() {
    let program = built(chain());
    let mut machine = run_for(&program, 1e-3, 4.9);
    let lamps = machine.overloads();
    assert_eq!(lamps.iter().map(|lamp| lamp.element.as_str()).collect::<Vec<_>>(), ["S2"]);
    assert!((lamps[0].time - 100.0001 / 21.6).abs() < 1e-9 && lamps[0].caused_by.is_none());
    machine.operate(17.1).unwrap();
    let lamps = machine.overloads();
    let names: Vec<_> = lamps.iter().map(|lamp| (lamp.element.as_str(), lamp.caused_by.as_deref())).collect();
    assert_eq!(names, [("S2", None), ("S1", None), ("u", None), ("S3", Some("u"))]);
    assert!((lamps[1].peak().unwrap() - 200.0).abs() < 1e-9, "{lamps:?}");
    assert!((lamps[2].time - 10.00001).abs() < 1e-9, "a drive above 100 V lights its lamp");
    assert!(
        voltage(&machine, "S1").abs() < 100.0 && machine.is_overloaded(),
        "the lamp stays lit after the voltage has returned"
    );
    machine.initial_condition().unwrap();
    assert!(!machine.is_overloaded());
}

#[test]
fn a_jump_lights_its_lamp_at_the_time_of_the_jump() {
    let jump = built(volts("jump").drive("u", "volt", element("step").set("height", 130).set("at", 0.55)));
    let lamps = run_for(&jump, 0.2, 2.0).overloads();
    assert!((lamps[0].time - 0.55).abs() < 1e-12 && lamps[0].peak() == Some(130.0), "{lamps:?}");
}

#[test]
fn hold_on_overload_stops_in_the_step_that_lights_the_lamp() {
    let patch = chain().build().unwrap();
    let trace = trace(&patch, |settings| {
        settings.with_duration(20.0).with_step(0.1).with_sample_interval(0.1).with_hold_on_overload()
    });
    let repetition = &trace.repetitions[0];
    assert!(repetition.is_held);
    assert!(
        (repetition.end - 4.7).abs() < 1e-12,
        "expected the end of the step in which S2 exceeds 100 V, got {}",
        repetition.end
    );
    assert_eq!(trace.len(), 48);
}

#[test]
fn hold_on_overload_runs_to_the_end_without_an_overload() {
    let patch = chain().build().unwrap();
    let trace = trace(&patch, |settings| settings.with_duration(1.05).with_step(0.1).with_hold_on_overload());
    assert_eq!((trace.repetitions[0].is_held, trace.repetitions[0].end), (false, 1.05));
}

#[test]
fn a_voltage_that_is_not_a_number_stops_the_run_and_is_named() {
    let sine = element("sine").set("amplitude", 10).set("frequency", 1e308);
    let builder =
        volts("too fast").drive("u", "volt", sine).element("A1", element("integrator").cords("x1", ["u"]));
    let builder = builder.element("S1", element("summer").cords("x1", ["u"])).record(["A1"]);
    let circuit = Circuit::new(&builder.build().unwrap()).unwrap();
    let program = Program::new(&circuit).unwrap();
    let settings = RunSettings::of(&circuit).unwrap().with_duration(2.0);
    let settings = settings.with_step(0.1).with_sample_interval(0.1);
    let Err(StoppedRunError { error: RunError::NotANumber { element, time }, trace }) =
        solve::run(&program, &settings)
    else {
        panic!("a sine of 1e308 Hz has no value")
    };
    // Its angle exceeds the largest number at 0.29 s.
    assert_eq!((element.as_str(), time), ("u", 0.3));
    assert_eq!(trace.time, [0.0, 0.1, 0.2]);
}

#[test]
fn a_step_that_is_not_positive_and_finite_is_refused() {
    let program = program(&patch("loop-lag"), &[]);
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Machine::new(&program, step), Err(RunError::NotATime { .. })), "{step}");
    }
}

#[test]
fn the_slideway_has_exact_derivatives() {
    // From 4 s on there is no friction, and the multiplier is at its kink at 0 V.
    crate::common::check_derivatives(&program(&slideway(), &[]), 2e-5, &[0.5, 1.0, 3.3]);
}
