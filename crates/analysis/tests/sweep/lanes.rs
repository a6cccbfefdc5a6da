//! Runs that are computed together have the same bits as single runs.

use std::path::PathBuf;

use super::{program, rows, sweep, towards_range_ends};
use crate::common::files::{representative_files, shipped_files};
use crate::common::random::SplitMix64;
use crate::common::traces::bits;
use crate::common::{element, slideway, volts};
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, Backend, RunSettings, StoppedRunError};
use patchcord_core::trace::Trace;

/// The error and the trace of a run.
fn error_and_trace(outcome: &Result<Trace, StoppedRunError>) -> (Option<String>, &Trace) {
    match outcome {
        Ok(trace) => (None, trace),
        Err(stopped) => (Some(stopped.error.to_string()), &stopped.trace),
    }
}

/// Asserts that a batch of runs equals single runs, and returns the number of runs that stopped.
fn stopped_runs(programs: &[Program], settings: &RunSettings, name: &str) -> usize {
    let on = |backend| settings.clone().with_backend(backend);
    let single: Vec<_> =
        programs.iter().map(|program| solve::run(program, &on(Backend::Interpreter))).collect();
    for backend in [Backend::Lanes, Backend::Automatic] {
        let together = solve::run_batch(programs, &on(backend));
        assert_eq!(together.len(), single.len());
        for (index, (together, single)) in together.iter().zip(&single).enumerate() {
            let [(error, trace), (expected, other)] = [error_and_trace(together), error_and_trace(single)];
            assert_eq!(error, expected, "{name} by {backend}: run {index}");
            assert!(trace == other && bits(trace) == bits(other), "{name} by {backend}: run {index}");
        }
    }
    single.iter().filter(|outcome| outcome.is_err()).count()
}

/// The settings shortened to this number of steps, with samples also within steps.
fn shortened(mut settings: RunSettings, steps: f64) -> RunSettings {
    settings.tolerance = None;
    settings.sensitivities = Vec::new();
    let all = settings.total_duration() / settings.step;
    let settings = if all > steps { settings.clone().with_duration(steps * settings.step) } else { settings };
    let every = (7.3 * settings.step).min(settings.duration());
    settings.with_sample_interval(every)
}

#[test]
fn batches_of_representative_patches_equal_single_runs() {
    assert!(runs_stopped_runs(representative_files()) > 30);
}

#[test]
#[ignore = "takes twenty seconds"]
fn batches_of_every_shipped_patch_equal_single_runs() {
    assert!(runs_stopped_runs(shipped_files()) > 120);
}

/// Compares batches of these patches with single runs, and returns the number of runs.
fn runs_stopped_runs(files: Vec<PathBuf>) -> usize {
    let mut runs = 0;
    for file in files {
        let patch = crate::common::patch_of(&file);
        let (circuit, base) = program(&patch, &[]).unwrap();
        let changed = [0.05, 0.3, 0.0, 0.15, 0.02, 0.5].map(|fraction| {
            let (changes, mut program) = (towards_range_ends(&patch, fraction), base.clone());
            let named: Vec<_> = changes.iter().map(|(name, value)| (name.as_str(), *value)).collect();
            program.set_parameters(named).ok().map(|()| program)
        });
        let programs: Vec<_> = changed.into_iter().flatten().collect();
        let settings = shortened(RunSettings::of(&circuit).unwrap(), 6000.0);
        stopped_runs(&programs, &settings, &file.display().to_string());
        runs += programs.len();
    }
    runs
}

/// There are more runs than lanes. The random circuits have curves, switches, stops and elements with memory.
#[test]
fn batches_of_random_circuits_equal_single_runs() {
    let mut random = SplitMix64(32);
    for number in 0..25 {
        let (circuit, base) = program(&crate::common::circuits::random_circuit(&mut random), &[]).unwrap();
        let record = ["A0", "A1", "A2", "N0", "N3", "u", "w"].map(str::to_owned).to_vec();
        let settings = RunSettings::of(&circuit).unwrap().with_step(1.3e-3).with_signals(record);
        let programs: Vec<_> = (0..19).map(|_| with_random_parameters(&base, &mut random)).collect();
        stopped_runs(
            &programs,
            &shortened(settings.with_duration(2.0), f64::INFINITY),
            &format!("circuit {number}"),
        );
    }
}

/// The program with random parameters.
fn with_random_parameters(program: &Program, random: &mut SplitMix64) -> Program {
    let mut changed = program.clone();
    let values = crate::common::circuits::PARAMETERS.map(|name| (name, random.uniform(0.3, 0.9)));
    changed.set_parameters(values).unwrap();
    changed
}

/// Without overload lamps, beyond ±100 V: every lane leaves and re-enters the range at a different step.
#[test]
fn batches_beyond_full_scale_equal_single_runs() {
    let sine = element("sine").set("amplitude", 60).set("frequency", 1);
    let patch = volts("beyond its range")
        .parameter("g", 0.5, "1", [0.0, 1.0])
        .drive("u", "volt", sine)
        .element("P", element("pot").cord("in", "u").set("setting", "g"))
        .element("S", element("summer").cords("x4", ["P"]))
        .element("A", element("integrator").cords("x1", ["S"]).cords("x10", ["P"]))
        .run(2.0, 1e-3)
        .build()
        .unwrap();
    let (circuit, base) = program(&patch, &[]).unwrap();
    let record = ["S", "A"].map(str::to_owned).to_vec();
    let settings = RunSettings::of(&circuit).unwrap().without_lamps().with_signals(record);
    let programs: Vec<_> = (0..19).map(|run| set(&base, &[("g", f64::from(run) / 18.0)])).collect();
    assert_eq!(stopped_runs(&programs, &settings, "beyond its range"), 0);
}

/// All lanes cross the corners of the tables at the same time.
#[test]
fn batches_with_table_drives_equal_single_runs() {
    let (circuit, base) = program(&crate::common::driven_by_points("L"), &[]).unwrap();
    let record = ["u", "S", "A1", "A2"].map(str::to_owned).to_vec();
    let programs: Vec<_> = (0..19).map(|run| set(&base, &[("g", f64::from(run) / 20.0)])).collect();
    for every in [1e-3, 2.3e-3] {
        let settings =
            RunSettings::of(&circuit).unwrap().with_signals(record.clone()).with_sample_interval(every);
        assert_eq!(stopped_runs(&programs, &settings, "driven by points"), 0);
    }
    // Some programs have other points and share the kernel of the rest.
    let mut other = base.clone();
    solve::set_drive_table(
        &mut other,
        "u",
        (0..200).map(|index| [0.005 * f64::from(index), 0.3 * f64::from(index)]).collect(),
    )
    .unwrap();
    let some =
        |run: u32| set(if run.is_multiple_of(3) { &other } else { &base }, &[("g", f64::from(run) / 20.0)]);
    let programs: Vec<_> = (0..19).map(some).collect();
    assert_eq!(
        stopped_runs(&programs, &RunSettings::of(&circuit).unwrap().with_signals(record), "replaced table"),
        0
    );
}

/// Delays of whole and of fractional steps, short and long, different in every lane.
#[test]
fn batches_with_delays_equal_single_runs() {
    let (circuit, base) = program(&crate::common::delay_loop_with_diode(), &[]).unwrap();
    let record = ["D1", "D2", "S", "A2"].map(str::to_owned).to_vec();
    for (step, every) in [(1e-3, 1e-3), (2.5e-3, 1e-2), (7e-4, 2.3e-3)] {
        let settings = RunSettings::of(&circuit)
            .unwrap()
            .with_step(step)
            .with_sample_interval(every)
            .with_signals(record.clone());
        let times =
            |run: u32| [1.0 + 0.31 * f64::from(run), 1.0 + f64::from(run * run)].map(|steps| steps * step);
        let all: Vec<_> = (0..19).map(times).map(|[t, f]| set(&base, &[("T", t), ("F", f)])).collect();
        assert_eq!(stopped_runs(&all, &settings, "delays"), 0);
        // Tiny differences, as in the finite differences of a fit.
        let slightly_different = |run: u32| set(&base, &[("T", 0.0123 + 1e-7 * f64::from(run)), ("F", 0.01)]);
        let all: Vec<_> = (0..16).map(slightly_different).collect();
        assert_eq!(stopped_runs(&all, &settings, "nearly equal delays"), 0);
    }
}

/// An integrator that a relay reverses, and a second integrator of its output. With hysteresis the first oscillates;
/// without, the relay chatters.
fn relay_controlled() -> Patch {
    let relay = element("relay").cord("in", "A1").cord("on", "+100").cord("off", "-100");
    let builder = volts("controlled by a relay")
        .parameter("start", 40.0, "1", [-90.0, 90.0])
        .parameter("hysteresis", 1.0, "1", [1e-9, 10.0])
        .element("K1", relay.set("pull_in", "hysteresis").set("drop_out", "-hysteresis"))
        .element("A1", element("integrator").cords("x1", ["K1"]).set("initial", "start"))
        .element("A2", element("integrator").cords("x10", ["A1"]));
    builder.build().unwrap()
}

/// The program with these parameter values.
fn set(program: &Program, values: &[(&str, f64)]) -> Program {
    let mut program = program.clone();
    program.set_parameters(values.iter().copied()).unwrap();
    program
}

#[test]
fn runs_that_stop_do_not_affect_the_others() {
    let (circuit, base) = program(&relay_controlled(), &[]).unwrap();
    let record = vec!["A1".to_owned(), "K1".to_owned()];
    let settings = RunSettings::of(&circuit)
        .unwrap()
        .with_signals(record)
        .with_sample_interval(0.013)
        .with_duration(1.0);
    // Every third run chatters, each from a different time, one of them from the start.
    let programs: Vec<_> = (0..16)
        .map(|run| {
            let hysteresis = if run % 3 == 0 { 1e-9 } else { 0.5 + f64::from(run) / 10.0 };
            set(&base, &[("start", f64::from(5 * run)), ("hysteresis", hysteresis)])
        })
        .collect();
    assert_eq!(stopped_runs(&programs, &settings, "controlled by a relay"), 6);
}

/// Phases that end at a different time in every run, by a relay or by an overload.
#[test]
fn batches_in_different_phases_equal_single_runs() {
    let (circuit, base) = program(&relay_controlled(), &[]).unwrap();
    let phases = vec![
        Phase::operate_until(0.6, "K1", None),
        Phase::Hold { time: 0.1 },
        Phase::operate(0.3),
        Phase::set("hysteresis", 2.0),
        Phase::operate(0.2),
        Phase::Repeat { times: 2, phases: vec![Phase::InitialCondition, Phase::operate(0.15)] },
    ];
    let record = ["A1", "A2", "K1"].map(str::to_owned).to_vec();
    let settings = RunSettings::of(&circuit)
        .unwrap()
        .with_signals(record)
        .with_sample_interval(0.01)
        .with_phases(phases);
    let start = |run: u32| [("start", f64::from(6 * run) - 20.0)];
    let programs: Vec<_> = (0..16).map(|run| set(&base, &start(run))).collect();
    for hold_on_overload in [false, true] {
        let mut settings = settings.clone();
        settings.hold_on_overload = hold_on_overload;
        assert_eq!(stopped_runs(&programs, &settings, "phases"), 0);
        let traces = programs.iter().map(|program| solve::run(program, &settings).unwrap());
        let overloaded = traces.filter(|trace| trace.overloads().next().is_some()).count();
        assert!((4..12).contains(&overloaded), "{overloaded}");
    }
}

/// Tiny states are flushed to 0 at the same step as in a single run.
#[test]
fn tiny_voltages_are_flushed_at_the_same_step_in_a_batch() {
    let decaying = element("integrator").cords("x10", ["A1"]).set("initial", "start");
    let builder = volts("decay").parameter("start", 1.0, "1", [-100.0, 100.0]).element("A1", decaying);
    let (circuit, base) = program(&builder.build().unwrap(), &[]).unwrap();
    let record = vec!["A1".to_owned()];
    let settings =
        RunSettings::of(&circuit).unwrap().with_step(0.02).with_sample_interval(0.02).with_signals(record);
    let programs: Vec<_> = (0..16).map(|run| set(&base, &[("start", 10f64.powi(run) * 1e-14)])).collect();
    let settings = settings.with_duration(40.0);
    assert_eq!(stopped_runs(&programs, &settings, "decay"), 0);
    let trace = solve::run(&programs[0], &settings).unwrap();
    assert!(trace.tracks[0].volts.last().is_some_and(|volts| volts.abs() < 1e-110));
}

#[test]
fn rows_do_not_depend_on_backend_or_threads() {
    let sweep_on = |backend| {
        sweep(
            &slideway(),
            &["VcL=1.27e-3:25.4e-3:5:log", "Tc=0.006:0.025:9"],
            &["peak:v_o", "stick_end", "frequency:v_o,last=0.1"],
            |base| base.with_duration(0.25).with_backend(backend),
        )
    };
    let single = rows(&sweep_on(Backend::Interpreter), 1);
    assert_eq!(single.len(), 45);
    for backend in [Backend::Lanes, Backend::Automatic] {
        for threads in [1, 2, 3, 20] {
            assert_eq!(rows(&sweep_on(backend), threads), single, "{backend}, {threads} threads");
        }
    }
}

/// Whether a sample is taken at the end of a step does not depend on the other runs.
#[test]
fn samples_near_the_ends_of_steps_do_not_depend_on_other_runs() {
    let lesson = crate::common::shipped("lessons/mass-and-spring");
    let sweep_on = |backend| {
        sweep(&lesson, &["k=5:8:16"], &["frequency:x,last=12"], |base| {
            let settings = base.with_duration(12.0).with_step(1e-3).with_backend(backend);
            settings.with_sample_interval(0.149_999_999_999_81)
        })
    };
    let single = rows(&sweep_on(Backend::Interpreter), 1);
    for backend in [Backend::Interpreter, Backend::Native, Backend::Lanes, Backend::Automatic] {
        for threads in [1, 2, 8, 16] {
            assert_eq!(rows(&sweep_on(backend), threads), single, "{backend}, {threads} threads");
        }
    }
}
