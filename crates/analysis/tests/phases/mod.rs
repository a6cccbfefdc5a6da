//! Runs with phases, compared with closed solutions, with new patches, and with equivalent runs.

mod errors;
mod overloads;

use crate::common::{element, patch, volts};
use patchcord_analysis::instruments::unmet_condition;
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Patch, PatchBuilder};
use patchcord_core::solve::{self, ParameterChange, Phase, RunSettings, StoppedRunError};
use patchcord_core::trace::{PhaseEnd, PhaseKind, PhaseRecord, Trace};
use patchcord_expr::Formula;

/// The kind of an operate phase without a condition.
const OPERATE: PhaseKind = PhaseKind::Operate { until: None };

/// Runs a patch with a step of 1 ms.
fn try_run(patch: &Patch, phases: &[Phase], every: f64, record: &[&str]) -> Result<Trace, StoppedRunError> {
    let circuit = Circuit::new(patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let base = RunSettings::of(&circuit).unwrap();
    solve::run(
        &program,
        &base.with_phases(phases.to_vec()).with_sample_interval(every).with_signals(record.iter().copied()),
    )
}

/// The trace of a run that must succeed.
fn run(patch: &Patch, phases: &[Phase], every: f64, record: &[&str]) -> Trace {
    try_run(patch, phases, every, record).unwrap_or_else(|stopped| panic!("{stopped}"))
}

fn built(builder: PatchBuilder) -> Patch {
    builder.build().unwrap_or_else(|report| panic!("{report}"))
}

fn repeat(times: u64, phases: &[Phase]) -> Phase {
    Phase::Repeat { times, phases: phases.to_vec() }
}

fn hold(time: f64) -> Phase {
    Phase::Hold { time }
}

/// A phase of initial condition.
const INITIAL: Phase = Phase::InitialCondition;

/// A decay from 80 V with the rate `a`. The relay K1 releases at 20 V.
fn decay() -> Patch {
    built(
        volts("decay")
            .parameter("a", 1.0, "1/s", [0.1, 10.0])
            .parameter("start", 80.0, "V", [1.0, 99.0])
            .element("A1", element("integrator").cords("x10", ["P1"]).set("initial", "start"))
            .element("P1", element("pot").cord("in", "A1").set("setting", "a / 10"))
            .element("K1", relay("A1", 20.0, 30.0))
            .signal("level", "A1", "volt", 1.0),
    )
}

/// A relay between -100 V and 100 V.
fn relay(input: &str, drop_out: f64, pull_in: f64) -> patchcord_core::patch::ElementBuilder {
    let thresholds = element("relay").set("drop_out", drop_out).set("pull_in", pull_in);
    thresholds.cord("in", input).cord("on", "+100").cord("off", "-100")
}

/// A sine of 1 Hz and its integral.
fn driven() -> Patch {
    let sine = element("sine").set("amplitude", 30).set("frequency", 1);
    let builder = volts("driven").drive("u", "volt", sine);
    built(builder.element("A1", element("integrator").cords("x1", ["u"])))
}

/// Kind, start and end of every phase.
fn phases_of(trace: &Trace) -> Vec<(PhaseKind, f64, f64)> {
    trace.phase_records.iter().map(|record| (record.phase.clone(), record.begin, record.end)).collect()
}

/// The samples of the first signal that belong to a phase.
fn samples_of(trace: &Trace, phase: usize) -> Vec<(f64, f64)> {
    let samples = (0..trace.len()).filter(|sample| trace.phase_of(*sample) == phase);
    samples.map(|sample| (trace.time[sample], trace.tracks[0].volts[sample])).collect()
}

#[test]
fn a_phase_ends_when_its_relay_switches() {
    for step in [1e-3, 1e-2] {
        let circuit = Circuit::new(&decay()).unwrap();
        let settings = RunSettings::of(&circuit)
            .unwrap()
            .with_step(step)
            .with_phases([Phase::operate_until(10.0, "K1", None)])
            .with_sample_interval(0.1);
        let trace = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
        let record = &trace.phase_records[1];
        // 80 e^-t = 20. The method has an error of 1e-9 s at a step of 1e-2 s.
        assert!((record.end - 4.0_f64.ln()).abs() < 1e-9, "{step}: {}", record.end - 4.0_f64.ln());
        assert_eq!(record.ended, PhaseEnd::Switched("released".to_owned()));
        let (time, volts) = *samples_of(&trace, 1).last().unwrap();
        assert!(time == record.end && (volts - 20.0).abs() < 1e-9, "{volts} at {time}");
    }
}

#[test]
fn a_phase_can_wait_for_either_position_of_a_relay() {
    // A triangle from 0 that switches at 0.25 s, at 20 V, and at 0.625 s, at -10 V.
    let oscillator = patch("relay-oscillator");
    for (becomes, time, position) in [
        (None, 0.25, "pulled-in"),
        (Some("pulled-in"), 0.25, "pulled-in"),
        (Some("released"), 0.625, "released"),
    ] {
        let trace = run(&oscillator, &[Phase::operate_until(5.0, "K1", becomes)], 1e-2, &["triangle"]);
        assert!((trace.phase_records[1].end - time).abs() < 1e-12, "{:?}", trace.phase_records[1]);
        assert_eq!(trace.phase_records[1].ended, PhaseEnd::Switched(position.to_owned()));
    }
    let twice = [Phase::operate_until(5.0, "K1", None), Phase::operate_until(5.0, "K1", None)];
    let trace = run(&oscillator, &twice, 1e-2, &["triangle"]);
    assert!((trace.phase_records[2].end - 0.625).abs() < 1e-12, "each phase waits for the next switching");
}

#[test]
fn a_jump_that_switches_a_relay_ends_the_phase() {
    let jump = element("step").set("height", 50).set("at", 0.55);
    let builder = volts("jump").drive("u", "volt", jump).element("K1", relay("u", 20.0, 30.0));
    let trace = run(&built(builder), &[Phase::operate_until(2.0, "K1", None)], 0.1, &["u"]);
    assert!((trace.phase_records[1].end - 0.55).abs() < 1e-12, "{:?}", trace.phase_records);
}

#[test]
fn a_jump_at_the_end_of_a_phase_is_recorded_before_and_after() {
    let until = || Phase::operate_until(5.0, "K1", None);
    // The relay switches from -10 V to 10 V at 0.25 s, with and without a sample due at that time.
    for every in [0.25, 0.1] {
        let trace = run(&patch("relay-oscillator"), &[until(), hold(0.1)], every, &["K1"]);
        let (end, begin) = (*samples_of(&trace, 1).last().unwrap(), samples_of(&trace, 2)[0]);
        assert_eq!((end.1, begin.1), (-10.0, 10.0), "{every}");
        assert!((end.0 - 0.25).abs() < 1e-12 && (begin.0 - 0.25).abs() < 1e-12, "{end:?} {begin:?}");
        let alone = run(&patch("relay-oscillator"), &[until()], every, &["K1"]);
        assert_eq!(alone.tracks[0].volts[alone.len() - 2..], [-10.0, 10.0], "{every}");
        assert_eq!(alone.tracks[0].extremes[0].end, 10.0);
    }
}

#[test]
fn a_phase_without_a_switching_lasts_its_full_time() {
    let trace = run(&decay(), &[Phase::operate_until(0.5, "K1", None), hold(0.1)], 0.1, &["level"]);
    let record = &trace.phase_records[1];
    assert_eq!((record.end, &record.ended, record.has_timed_out()), (0.5, &PhaseEnd::Time, true));
    assert_eq!(unmet_condition(record).unwrap(), "K1 did not switch within 0.5 s");
    assert_eq!(
        (trace.phase_records[2].has_timed_out(), unmet_condition(&trace.phase_records[2])),
        (false, None)
    );
}

#[test]
fn hold_keeps_all_voltages_and_drives_while_record_time_continues() {
    let phases = [Phase::operate(0.4), hold(0.35), Phase::operate(0.4)];
    let trace = run(&driven(), &phases, 0.1, &["u", "A1"]);
    assert_eq!(
        phases_of(&trace)[1..],
        [(OPERATE, 0.0, 0.4), (PhaseKind::Hold, 0.4, 0.75), (OPERATE, 0.75, 1.15)]
    );
    assert_eq!(trace.phase_records[3].problem_time, 0.4);
    let held = trace.phase_records[2].sample..=trace.phase_records[3].sample;
    assert_eq!(trace.time[held.clone()], [0.4, 0.5, 0.6, 0.7, 0.75]);
    for track in &trace.tracks {
        assert!(track.volts[held.clone()].iter().all(|volts| *volts == track.volts[*held.start()]));
    }
    let plain = run(&driven(), &[Phase::operate(0.4), Phase::operate(0.4)], 0.05, &["u", "A1"]);
    for (track, plain) in trace.tracks.iter().zip(&plain.tracks) {
        // 0.8 s of record time are 0.45 s of problem time. The end of the run at 1.15 s is recorded, too.
        let after = &track.volts[*held.end() + 1..];
        assert_eq!(after, [9, 11, 13, 15, 16].map(|sample| plain.volts[sample]), "{}", track.name);
    }
}

#[test]
fn a_hold_does_not_change_the_steps() {
    let halves = [Phase::operate(0.5), Phase::operate(0.5)];
    let held = [Phase::operate(0.5), hold(1.0), Phase::operate(0.5)];
    let [plain, held] = [&halves[..], &held].map(|phases| run(&driven(), phases, 0.5, &["u", "A1"]));
    assert_eq!(plain.repetitions[0].work, held.repetitions[0].work);
    for (plain, held) in plain.tracks.iter().zip(&held.tracks) {
        assert_eq!(plain.extremes[0].end, held.extremes[0].end);
    }
}

#[test]
fn initial_condition_starts_an_identical_run() {
    let once = [INITIAL, Phase::operate(0.3), hold(0.2)];
    let trace = run(&driven(), &[&once[..], &once].concat(), 0.1, &["u", "A1"]);
    let half = trace.len() / 2;
    assert_eq!((trace.repetitions.len(), trace.repetitions[1].first), (2, half));
    assert_eq!(trace.time[..half], trace.time[half..]);
    assert!(trace.tracks.iter().all(|track| track.volts[..half] == track.volts[half..]));
}

#[test]
fn initial_condition_is_the_default_start_of_a_run() {
    let phases = [Phase::operate(0.3)];
    let explicit = [&[INITIAL][..], &phases].concat();
    assert_eq!(run(&driven(), &phases, 0.1, &["A1"]), run(&driven(), &explicit, 0.1, &["A1"]));
    let settings = RunSettings::of(&Circuit::new(&driven()).unwrap()).unwrap().with_duration(0.3);
    assert_eq!(settings.phases, explicit);
}

#[test]
fn a_parameter_set_in_initial_condition_equals_one_of_the_patch() {
    let circuit = Circuit::with_parameters(&decay(), [("start", 60.0), ("a", 2.5)]).unwrap();
    let settings = RunSettings::of(&circuit).unwrap().with_sample_interval(0.1);
    let fresh = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
    let phases = [INITIAL, Phase::set("start", 60.0), Phase::set("a", 2.5), Phase::operate(1.0)];
    let set = run(&decay(), &phases, 0.1, &["level"]);
    assert_eq!((&set.time, &set.tracks), (&fresh.time, &fresh.tracks));
    assert_eq!(set.repetitions, fresh.repetitions);
}

#[test]
fn a_pot_set_during_the_run_changes_the_slope_but_not_the_level() {
    let phases = [Phase::operate(0.5), Phase::set("a", 4.0), Phase::operate(0.5)];
    let trace = run(&decay(), &phases, 0.25, &["level"]);
    // The trace has two samples at the time of the change, before and after it.
    assert_eq!(trace.time, [0.0, 0.25, 0.5, 0.5, 0.75, 1.0]);
    let closed = [0.0, 0.25, 0.5, 0.5, 1.5, 2.5].map(|power: f64| 80.0 * (-power).exp());
    for (found, closed) in trace.values("level").unwrap().iter().zip(closed) {
        assert!((found - closed).abs() < 1e-9, "{found}, expected {closed}");
    }
    assert_eq!(trace.phase_records[2].sample, 3);
}

#[test]
fn formulas_use_parameters_and_signals_from_before_the_change() {
    let builder = volts("exchange")
        .parameter("p", 10.0, "V", [0.0, 90.0])
        .parameter("q", 40.0, "V", [0.0, 90.0])
        .element("A1", element("integrator").cords("x1", ["ground"]).set("initial", "p"))
        .element("A2", element("integrator").cords("x1", ["ground"]).set("initial", "q"))
        .signal("a", "A1", "volt", 1.0)
        .signal("twice", "A2", "volt", 2.0);
    let by = |name: &str, formula: &str| ParameterChange::new(name, Formula::parse(formula).unwrap());
    let exchange = Phase::Set { changes: vec![by("p", "q"), by("q", "p")] };
    let read = Phase::Set { changes: vec![by("p", "twice / 2 + a"), by("q", "a + volt * 5")] };
    let once = [INITIAL, Phase::operate(0.1)];
    let phases = [&once[..], &[exchange], &once, &[read], &once].concat();
    let trace = run(&built(builder), &phases, 0.1, &["A1", "A2"]);
    let starts: Vec<_> = trace
        .repetitions
        .iter()
        .map(|repetition| [0, 1].map(|track| trace.tracks[track].volts[repetition.first]))
        .collect();
    assert_eq!(starts, [[10.0, 40.0], [40.0, 10.0], [50.0, 45.0]]);
}

#[test]
fn a_set_parameter_keeps_its_value_until_the_run_ends() {
    let increase = Phase::set_by("a", "2 * a").unwrap();
    let trace = run(&decay(), &[repeat(3, &[INITIAL, increase, Phase::operate(0.5)])], 0.5, &["level"]);
    let ends: Vec<f64> = trace.tracks[0].volts.iter().skip(1).step_by(2).copied().collect();
    for (end, rate) in ends.iter().zip([2.0, 4.0, 8.0]) {
        let closed = 80.0 * f64::exp(-0.5 * rate);
        assert!((end - closed).abs() < 1e-7, "{end}, expected {closed}");
    }
    assert_eq!(ends.len(), 3);
}

#[test]
fn a_repetition_equals_the_explicit_phases() {
    let increase = Phase::set_by("a", "1.25 * a").unwrap();
    let inner = [Phase::operate_until(3.0, "K1", None), hold(0.07), increase];
    let body = [&[INITIAL][..], &inner, &inner, &[Phase::operate(0.123)]].concat();
    let repeated = [repeat(3, &[INITIAL, repeat(2, &inner), Phase::operate(0.123)])];
    let explicit = [&body[..], &body, &body].concat();
    let [short, long] =
        [&repeated[..], &explicit].map(|phases| run(&decay(), phases, 0.05, &["level", "K1"]));
    assert_eq!(short, long);
    assert_eq!(short.repetitions.len(), 3);
}

#[test]
fn the_sampling_interval_changes_neither_phases_nor_steps() {
    let increase = Phase::set_by("a", "1.5 * a").unwrap();
    let phases =
        [repeat(2, &[Phase::operate_until(3.0, "K1", None), hold(0.3), increase, Phase::operate(0.4)])];
    let [coarse, fine] = [0.5, 0.003].map(|every| run(&decay(), &phases, every, &["level"]));
    assert_eq!(phases_of(&coarse), phases_of(&fine));
    assert_eq!(coarse.repetitions[0].work, fine.repetitions[0].work);
    assert_eq!(coarse.tracks[0].extremes, fine.tracks[0].extremes);
    let sample_at = |trace: &Trace, record: &PhaseRecord| trace.tracks[0].volts.get(record.sample).copied();
    for (wide, close) in coarse.phase_records.iter().zip(&fine.phase_records) {
        assert_eq!(sample_at(&coarse, wide), sample_at(&fine, close), "{wide:?}");
    }
}

#[test]
fn repeat_in_a_patch_repeats_initial_condition_and_operate() {
    let csv = |run: &str| {
        let text = driven().text().replace("\"for\": 1.0,", run);
        let circuit = Circuit::new(&Patch::parse("p.json", &text).unwrap()).unwrap();
        let program = Program::new(&circuit).unwrap();
        let trace = solve::run(&program, &RunSettings::of(&circuit).unwrap()).unwrap();
        let mut bytes = Vec::new();
        trace.write_csv(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    };
    let short = csv("\"for\": 0.0123, \"repeat\": 3,");
    let long = csv(
        "\"phases\": [{\"repeat\": 3, \"phases\": [{\"initial_condition\": true}, {\"operate\": 0.0123}]}],",
    );
    assert_eq!(short, long);
    assert!(short.contains("u,A1,run\n") && short.lines().count() == 4 + 3 * 14, "{short}");
    assert_eq!(short.matches("\n0.0123,").count(), 3, "{short}");
}

#[test]
fn every_phase_that_takes_time_ends_with_a_sample() {
    let first = [INITIAL, Phase::operate(0.25), hold(0.12)];
    let second = [INITIAL, Phase::operate(0.13), Phase::operate(0.07)];
    let trace = run(&driven(), &[first, second].concat(), 0.1, &["A1"]);
    let expected = [0.0, 0.1, 0.2, 0.25, 0.3, 0.37, 0.0, 0.1, 0.13, 0.2];
    assert_eq!(trace.len(), expected.len(), "{:?}", trace.time);
    let is_near = |(time, expected): (&f64, &f64)| (time - expected).abs() < 1e-12;
    assert!(trace.time.iter().zip(&expected).all(is_near), "{:?}", trace.time);
    let last = trace.tracks[0].extremes.iter().map(|extremes| extremes.end);
    assert!(last.eq([trace.tracks[0].volts[5], trace.tracks[0].volts[9]]));
}

/// A change of a parameter at the end of a run adds no sample, because no time follows in which it has an effect.
#[test]
fn a_parameter_set_at_the_end_adds_no_sample() {
    let phases = [INITIAL, Phase::operate(0.25), Phase::set("a", 4.0)];
    let trace = run(&decay(), &[repeat(2, &phases)], 0.1, &["level"]);
    assert_eq!(trace.time, [0.0, 0.1, 0.2, 0.25, 0.0, 0.1, 0.2, 0.25]);
}

#[test]
fn a_run_that_stops_has_no_sample_of_the_error() {
    let pole = Phase::set_by("start", "level * level / (level - level)").unwrap();
    let stopped = try_run(&decay(), &[Phase::operate(0.25), pole], 0.1, &["level"]).unwrap_err();
    assert_eq!(stopped.trace.time, [0.0, 0.1, 0.2, 0.25]);
}

/// The grid of samples and the length of the run are computed in different ways, with differences of rounding.
#[test]
fn an_end_on_the_grid_is_recorded_once() {
    for (length, every, count) in [(0.3, 0.1, 4), (0.7, 0.007, 101), (1.0, 1.0 / 3.0, 4), (0.9, 0.3, 4)] {
        let trace = run(&driven(), &[Phase::operate(length)], every, &["A1"]);
        assert_eq!(trace.len(), count, "{length} s every {every} s: {:?}", trace.time);
    }
}

/// An end 0.1 ms after a sample is not the same instant, however late it is.
#[test]
fn a_late_end_just_after_a_sample_is_recorded() {
    let end = 1e6 + 1e-4;
    let trace = run(&decay(), &[INITIAL, hold(end)], 10.0, &["level"]);
    assert_eq!((trace.len(), trace.time.last()), (100_002, Some(&end)));
}

/// Shooting method: y'' = -y, y(0) = 0, y(1 s) = 30 V. Each run corrects the initial slope by its error.
#[test]
fn an_iteration_finds_the_boundary_value() {
    let builder = volts("shooting")
        .parameter("v0", 10.0, "V", [-90.0, 90.0])
        .parameter("target", 30.0, "V", [0.0, 90.0])
        .element("A1", element("integrator").cords("x1", ["B1"]).set("initial", "-v0"))
        .element("A2", element("integrator").cords("x1", ["A1"]))
        .element("B1", element("summer").cords("x1", ["A2"]))
        .signal("y", "A2", "volt", 1.0);
    let correct = Phase::set_by("v0", "v0 - (y - target)").unwrap();
    let shots = repeat(25, &[INITIAL, Phase::operate(1.0), correct]);
    let trace = run(&built(builder), &[shots, INITIAL, Phase::operate(1.0)], 1.0, &["y", "A1"]);
    let found = -trace.tracks[1].volts[trace.repetitions[25].first];
    // The step of 1 ms gives a relative error of h^4 / 120; the iteration reduces its error by 0.16 per shot.
    assert!((found - 30.0 / 1.0_f64.sin()).abs() < 1e-11, "{found}");
    assert!((trace.tracks[0].volts.last().unwrap() - 30.0).abs() < 1e-12);
}
