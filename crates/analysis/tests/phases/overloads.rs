//! Overloads in runs with phases: their times, and the phases that they skip.

use super::{INITIAL, OPERATE, built, hold, run};
use crate::common::{element, source, volts};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, Phase, RunSettings};
use patchcord_core::trace::{PhaseEnd, PhaseKind, Trace};

/// -100 V/s from 80 V: the limit is reached at 1.8 s.
fn steep() -> Patch {
    let builder = source(volts("steep"), "u", 100.0);
    built(builder.element("A1", element("integrator").cords("x1", ["u"]).set("initial", 80)))
}

#[test]
fn an_overload_skips_phases_until_the_next_initial_condition() {
    let once = [INITIAL, Phase::operate(2.5), hold(1.0), Phase::operate(1.0)];
    let phases = [&once[..], &[INITIAL, Phase::operate(0.5), hold(0.5)]].concat();
    let circuit = Circuit::new(&steep()).unwrap();
    let settings = RunSettings::of(&circuit)
        .unwrap()
        .with_phases(phases)
        .with_sample_interval(0.1)
        .with_hold_on_overload()
        .with_signals(["A1"]);
    let trace = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
    let phases: Vec<_> = trace.phase_records.iter().map(|record| (&record.phase, &record.ended)).collect();
    let (initial, time) = (&PhaseKind::InitialCondition, &PhaseEnd::Time);
    assert_eq!(
        phases,
        [
            (initial, time),
            (&OPERATE, &PhaseEnd::Overload),
            (initial, time),
            (&OPERATE, time),
            (&PhaseKind::Hold, time)
        ]
    );
    assert_eq!(
        trace.repetitions.iter().map(|repetition| repetition.is_held).collect::<Vec<_>>(),
        [true, false]
    );
    assert!((trace.repetitions[0].end - 1.8).abs() < 2e-3, "{}", trace.repetitions[0].end);
}

#[test]
fn the_time_of_an_overload_after_a_hold_includes_the_hold() {
    let trace = run(&steep(), &[Phase::operate(1.0), hold(3.0), Phase::operate(1.0)], 0.1, &["A1"]);
    let overload = &trace.repetitions[0].overloads[0];
    assert!((overload.time - 4.8).abs() < 2e-3, "{overload:?}");
}

/// An amplifier that needs -200 V at initial condition.
fn overloaded() -> Patch {
    let amplifier = element("summer").cords("x2", ["+100"]);
    built(volts("overloaded").element("S", amplifier).signal("s", "S", "volt", 1.0))
}

#[test]
fn an_overload_in_initial_condition_has_the_time_0() {
    for phases in [[hold(3.0), Phase::operate(1.0)], [Phase::operate(1.0), hold(3.0)]] {
        let trace = run(&overloaded(), &phases, 0.1, &["s"]);
        let times: Vec<f64> = trace.repetitions[0].overloads.iter().map(|overload| overload.time).collect();
        assert_eq!(times, [0.0]);
    }
}

/// Runs a patch that is held at the first overload, with a step of 0.1 s.
fn held_on_overload(patch: &Patch, phases: &[Phase]) -> Trace {
    let circuit = Circuit::new(patch).unwrap();
    let base = RunSettings::of(&circuit).unwrap();
    let phases = phases.to_vec();
    let settings = base.with_step(0.1).with_phases(phases).with_sample_interval(0.1).with_hold_on_overload();
    solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap()
}

#[test]
fn an_overload_in_the_last_step_of_a_phase_skips_the_following_hold() {
    let ramp = element("ramp").set("rate", 100.1);
    let builder = volts("last").drive("u", "volt", ramp).element("S", element("inverter").cord("in", "u"));
    let patch = built(builder.signal("s", "S", "volt", 1.0));
    // 100 V are reached at 0.999 s, in the last whole step, with and without a shorter step after it.
    for time in [1.0, 1.05] {
        let trace = held_on_overload(&patch, &[Phase::operate(time), hold(5.0)]);
        let (repetition, last) = (&trace.repetitions[0], trace.phase_records.last().unwrap());
        assert_eq!((&last.phase, &last.ended, repetition.is_held), (&OPERATE, &PhaseEnd::Overload, true));
        assert!((repetition.end - 1.0).abs() < 1e-12, "{}", repetition.end);
    }
}

#[test]
fn a_machine_overloaded_at_initial_condition_skips_the_first_hold() {
    let trace = held_on_overload(&overloaded(), &[hold(3.0), Phase::operate(1.0)]);
    assert_eq!((trace.repetitions[0].is_held, trace.repetitions[0].end, trace.len()), (true, 0.0, 1));
    assert_eq!(trace.repetitions[0].overloads[0].time, 0.0);
    assert_eq!(trace.phase_records.last().map(|record| &record.ended), Some(&PhaseEnd::Overload));
}
