//! Runs that pass their samples on in blocks: the same tables and readings as from the whole trace.

use std::io::Cursor;
use std::ops::ControlFlow;

use crate::common::{built, dead_zone_oscillator, element, patch, program, volts};
use patchcord_core::ir::Program;
use patchcord_core::solve::{Backend, Phase, RunError, RunSettings, StoppedRunError, run, run_in_blocks};
use patchcord_core::trace::{PhaseEnd, TableWriter, Trace};

/// The trace of a run, or the trace before its error.
fn trace_of(outcome: &Result<Trace, StoppedRunError>) -> &Trace {
    match outcome {
        Ok(trace) => trace,
        Err(stopped) => stopped.trace.as_ref(),
    }
}

/// The error that stopped a run; `None` if there is none.
fn error_of(outcome: &Result<Trace, StoppedRunError>) -> Option<&RunError> {
    outcome.as_ref().err().map(|stopped| &stopped.error)
}

/// The outcome of a run that passes on blocks of this many samples, and its table.
fn in_blocks(
    program: &Program,
    settings: &RunSettings,
    samples: usize,
) -> (Result<Trace, StoppedRunError>, Vec<u8>) {
    let settings = settings.clone().with_blocks(samples);
    let mut table: Option<TableWriter<Cursor<Vec<u8>>>> = None;
    let outcome = run_in_blocks(program, &settings, &mut |_| (), &mut |block| {
        assert!((1..=samples).contains(&block.len()), "{}", block.len());
        let begin = || TableWriter::new(Cursor::new(Vec::new()), &block.tracks).unwrap();
        table.get_or_insert_with(begin).write(block).unwrap();
        ControlFlow::Continue(())
    });
    let table = table.unwrap().finish(trace_of(&outcome), || Ok(Cursor::new(Vec::new())));
    (outcome, table.unwrap().into_inner())
}

/// Asserts that blocks of several sizes give the same table, extremes, repetitions, phases and error as the whole
/// trace. Returns the outcome with the whole trace.
fn check_blocks(program: &Program, settings: &RunSettings) -> Result<Trace, StoppedRunError> {
    let outcome = run(program, settings);
    let whole = trace_of(&outcome);
    let mut expected = Vec::new();
    whole.write_csv(&mut expected).unwrap();
    for samples in [1, 7, 1000] {
        let (found, table) = in_blocks(program, settings, samples);
        assert!(table == expected, "{samples}: {}", String::from_utf8_lossy(&table));
        let trace = trace_of(&found);
        assert!(trace.is_empty());
        assert_eq!((&trace.repetitions, &trace.phase_records), (&whole.repetitions, &whole.phase_records));
        assert_eq!(trace.step_warning, whole.step_warning);
        for (flushed, kept) in trace.tracks.iter().zip(&whole.tracks) {
            assert_eq!((&flushed.extremes, flushed.volts.len()), (&kept.extremes, 0));
        }
        assert_eq!(error_of(&found), error_of(&outcome));
    }
    outcome
}

/// The settings of one initial condition and one operation.
fn plain(seconds: f64, step: f64) -> RunSettings {
    RunSettings::from_phases([Phase::InitialCondition, Phase::operate(seconds)], step)
}

#[test]
fn blocks_give_the_table_of_the_whole_trace_with_every_backend() {
    let program = dead_zone_oscillator();
    for backend in [Backend::default(), Backend::Interpreter, Backend::Reference] {
        for every in [1e-3, 7e-4, 0.013] {
            let settings = plain(2.5, 1e-3).with_sample_interval(every).with_backend(backend);
            let settings = settings.with_signals(["A2", "DZ"]);
            assert!(check_blocks(&program, &settings).is_ok());
            assert!(check_blocks(&program, &settings.repeated(3)).is_ok());
        }
    }
}

#[test]
fn blocks_end_at_any_place_of_phases() {
    let program = program(&patch("relay-oscillator"), &[]);
    let phases = [
        Phase::InitialCondition,
        Phase::operate_until(1.0, "K1", None),
        Phase::Hold { time: 0.1 },
        Phase::operate(0.05),
        Phase::InitialCondition,
        Phase::operate_until(1.0, "K1", None),
        Phase::operate_until(0.01, "K1", None),
    ];
    let settings = RunSettings::from_phases(phases, 1e-3).with_signals(["A1", "K1"]).repeated(2);
    let trace = check_blocks(&program, &settings).unwrap();
    assert!(trace.has_phases() && trace.repetitions.len() == 4);
}

/// dx/dt = -k x, from 50 V.
fn decay() -> Program {
    let builder = volts("decay")
        .parameter("k", 0.5, "1", [0.0, 1.0])
        .element("A1", element("integrator").cords("x1", ["P1"]).set("initial", 50))
        .element("P1", element("pot").cord("in", "A1").set("setting", "k"));
    built(builder)
}

#[test]
fn the_samples_before_an_error_are_passed_on() {
    let program = decay();
    let (first, second) = (Phase::operate(1.5), Phase::operate(0.5));
    let phases = [Phase::InitialCondition, first, Phase::set("k", 0.7), second, Phase::set("k", 2.0)];
    let settings = RunSettings::from_phases(phases, 1e-3).with_signals(["A1"]);
    let stopped = check_blocks(&program, &settings).unwrap_err();
    assert_eq!((stopped.error.code(), stopped.trace.time.last()), ("outside-range", Some(&2.0)));
    // The error is in the first of two runs, so the table has no column of runs.
    let stopped = check_blocks(&program, &settings.repeated(2)).unwrap_err();
    assert_eq!(stopped.trace.repetitions.len(), 1);
}

#[test]
fn derivatives_are_passed_on() {
    let settings = plain(1.0, 1e-3).with_signals(["A1", "P1"]).with_sensitivities(["k"]);
    assert_eq!(check_blocks(&decay(), &settings).unwrap().tracks.len(), 4);
}

#[test]
fn steps_that_are_too_long_give_the_same_warning() {
    // F' = -1000 F, from 50 V.
    let builder = volts("stiff").element("F", element("integrator").cords("x1000", ["F"]).set("initial", 50));
    let settings = plain(1.0, 3e-3).with_signals(["F"]).with_step_checks();
    assert!(check_blocks(&built(builder), &settings).unwrap().step_warning.is_some());
}

#[test]
fn a_run_that_cannot_begin_passes_on_no_samples() {
    let settings = plain(1.0, 1e-3).with_signals(["no such signal"]).with_blocks(7);
    let mut blocks = 0;
    let outcome = run_in_blocks(&decay(), &settings, &mut |_| (), &mut |_| {
        blocks += 1;
        ControlFlow::Continue(())
    });
    assert_eq!((outcome.unwrap_err().error.code(), blocks), ("unknown-signal", 0));
}

#[test]
fn a_consumer_ends_a_run_early() {
    let phases = [Phase::InitialCondition, Phase::operate(100.0), Phase::Hold { time: 100.0 }];
    let equal = RunSettings::from_phases(phases, 1e-3).with_signals(["A1"]).with_step_checks();
    let backends = [Backend::default(), Backend::Interpreter, Backend::Reference];
    let adaptive = equal.clone().with_tolerance(1e-6);
    for settings in backends.map(|backend| equal.clone().with_backend(backend)).into_iter().chain([adaptive])
    {
        let (mut blocks, mut seconds) = (0, 0.0);
        let settings = settings.with_sample_interval(1e-3).with_blocks(10).repeated(2);
        let outcome = run_in_blocks(&decay(), &settings, &mut |recorded| seconds = recorded, &mut |_| {
            blocks += 1;
            if blocks < 2 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        let trace = outcome.unwrap();
        assert_eq!((blocks, trace.repetitions.len(), trace.step_warning.is_some()), (2, 1, false));
        assert!(seconds < 50.0 && trace.phase_records.len() == 2, "{seconds} {:?}", trace.phase_records);
        assert_eq!(trace.phase_records[1].ended, PhaseEnd::Stopped);
    }
}

#[test]
fn samples_that_are_passed_on_do_not_count_as_memory() {
    // 3e8 numbers.
    let settings = plain(1.5, 1e-3).with_signals(["A1"]).with_sample_interval(1e-8);
    assert_eq!(settings.check().unwrap_err().code(), "too-many-numbers");
    let settings = settings.with_blocks(1000);
    assert_eq!(settings.check(), Ok(()));
    let error = settings.clone().with_sample_interval(1e-10).check().unwrap_err();
    assert!(error.to_string().ends_with("at most 1e10 are allowed"), "{error}");
    // The extremes of 1e8 repetitions stay in memory.
    let settings = plain(1e-3, 1e-3).with_signals(["A1"]).repeated(100_000_000).with_blocks(1000);
    let error = settings.check().unwrap_err();
    assert!(error.to_string().ends_with("at most 2e8 are allowed"), "{error}");
}
