//! The table of sweeps: 1000 runs of 2 s, VcL 1.27 ... 25.4 mm/s by Tc 6 ... 25 ms.
//!
//! Each solver uses the largest equal step at which 95 % of the runs have an error of at most 1e-5 of their peak
//! velocity.

use std::{io, thread};

use crate::backends::{self, BACKENDS_OF_SWEEPS, BackendChoice, Fig816, SAMPLES, Steps};
use crate::peers::{Peers, RUNS};
use crate::timing::{Work, format_digits, format_seconds, in_turns, timed};
use crate::{Outcome, page, threads};
use patchcord::instruments::Measure;
use patchcord::solve::{self, RunSettings};
use patchcord::sweep::{Axis, Plan, Sweep};

/// The required share of accurate runs.
const REQUIRED_SHARE: f64 = 0.95;
/// The largest error of an accurate run, as a share of its peak velocity.
const MAX_ERROR: f64 = 1e-5;
/// Only every tenth run is made during the selection of the step, to save time.
const RUN_INTERVAL: usize = 10;
/// Step of the reference in s. The reference is C with located kinks.
const REFERENCE_STEP: f64 = 5e-6;

/// The axis of VcL: 40 values in m/s.
const VCL: &str = "VcL=1.27e-3:25.4e-3:40";

/// Measurements of each work, in turns.
const ROUNDS: usize = 2;

/// The table.
pub(crate) fn table(peers: &Peers, fig: &Fig816, quick: bool) -> Outcome<String> {
    let reference = peers.sweep_in_c("fig_8_16_located", REFERENCE_STEP)?.velocity;
    let thread_counts = threads::up_to(thread::available_parallelism()?.get());
    let (mut entries, mut works): (Vec<SweepEntry>, Vec<Work<'_>>) = (Vec::new(), Vec::new());
    for (stem, name) in [("fig_8_16", "C, kinks stepped over"), ("fig_8_16_located", "C, kinks located")] {
        let (step, share) = longest_c_step(peers, stem, &reference)?;
        entries.push(SweepEntry { name: name.to_owned(), step, share, threads: None });
        works.push(Box::new(move || Ok(peers.sweep_in_c(stem, step)?.seconds)));
    }
    for backend in BACKENDS_OF_SWEEPS {
        let step = longest_step(fig, backend, &reference)?;
        let share = accurate_share(fig, backend, step, &reference, if quick { RUN_INTERVAL } else { 1 })?;
        for &threads in &thread_counts {
            let name =
                format!("patchcord, {}, {threads} thread{}", backend.0, if threads == 1 { "" } else { "s" });
            entries.push(SweepEntry { name, step, share, threads: Some(threads) });
            works.push(Box::new(move || sweep_seconds(fig, backend, step, threads, quick)));
        }
    }
    let seconds = in_turns(ROUNDS, works)?;
    let mut one_thread = f64::NAN;
    let rows = entries.iter().zip(&seconds).map(|(entry, duration)| {
        one_thread = if entry.threads == Some(1) { *duration } else { one_thread };
        entry.row(*duration, seconds[0], one_thread)
    });
    let rows: Vec<_> = rows.collect();
    let head = [
        "",
        "step",
        "right to 1e-5",
        "1000 runs",
        "runs a second",
        "times C's throughput",
        "times one thread's",
    ];
    Ok(page::table(&head, &rows))
}

/// A row of the table: a solver with its step.
struct SweepEntry {
    name: String,
    /// In s.
    step: f64,
    /// Share of accurate runs.
    share: f64,
    /// Threads of patchcord. `None` for C.
    threads: Option<usize>,
}

impl SweepEntry {
    /// The cells, from the durations in s of this sweep, of the first entry, and of the same backend on one thread.
    fn row(&self, seconds: f64, base: f64, one_thread: f64) -> Vec<String> {
        vec![
            self.name.clone(),
            format!("{:.1} µs", self.step * 1e6),
            format!("{:.1} %", self.share * 100.0),
            format_seconds(seconds),
            format!("{:.0}", RUNS as f64 / seconds),
            format_digits(base / seconds),
            self.threads.map_or(String::new(), |_| format_digits(one_thread / seconds)),
        ]
    }
}

/// The share of accurate runs among pairs of found and reference velocities.
fn share_of_accurate<'a>(runs: impl Iterator<Item = (&'a [f64], &'a [f64])>) -> f64 {
    let errors: Vec<f64> = runs.map(|(velocity, reference)| backends::error(velocity, reference)).collect();
    errors.iter().filter(|error| **error <= MAX_ERROR).count() as f64 / errors.len() as f64
}

/// The longest tried step in s at which enough runs of a C program are accurate, and their share.
fn longest_c_step(peers: &Peers, stem: &str, reference: &[f64]) -> Outcome<(f64, f64)> {
    for count in backends::steps_per_millisecond() {
        let step = 1e-3 / f64::from(count);
        let solved = peers.sweep_in_c(stem, step)?;
        let share = share_of_accurate(solved.velocity.chunks(SAMPLES).zip(reference.chunks(SAMPLES)));
        if share >= REQUIRED_SHARE {
            return Ok((step, share));
        }
    }
    Err(format!("{stem}: no step is accurate enough").into())
}

/// The longest tried step in s at which enough runs of a backend are accurate.
fn longest_step(fig: &Fig816, backend: BackendChoice, reference: &[f64]) -> Outcome<f64> {
    for count in backends::steps_per_millisecond() {
        let step = 1e-3 / f64::from(count);
        if accurate_share(fig, backend, step, reference, RUN_INTERVAL)? >= REQUIRED_SHARE {
            return Ok(step);
        }
    }
    Err("no step is accurate enough".into())
}

/// The parameters of a run of the sweep, in SI units. The same as in benches/peers/slideway.h.
fn values(run: usize) -> [(&'static str, f64); 2] {
    let along = |low: f64, high: f64, index: usize, count: usize| {
        low + (high - low) * index as f64 / (count - 1) as f64
    };
    [("VcL", along(1.27e-3, 25.4e-3, run / 25, 40)), ("Tc", along(6e-3, 25e-3, run % 25, 25))]
}

/// The share of accurate runs of a backend among every `interval`-th run, on two threads.
fn accurate_share(
    fig: &Fig816,
    backend: BackendChoice,
    step: f64,
    reference: &[f64],
    interval: usize,
) -> Outcome<f64> {
    let chosen: Vec<usize> = (0..RUNS).step_by(interval).collect();
    let velocities = thread::scope(|scope| {
        let halves = chosen.chunks(chosen.len().div_ceil(2));
        let threads: Vec<_> = halves
            .map(|runs| {
                scope.spawn(move || {
                    runs.iter().map(|run| velocity(fig, backend, step, *run)).collect::<Vec<_>>()
                })
            })
            .collect();
        let halves = threads.into_iter().map(|thread| thread.join().map_err(|_| "a thread has panicked"));
        halves.collect::<Result<Vec<_>, _>>()
    })?;
    let velocities = velocities.concat();
    let expected = chosen.iter().map(|run| &reference[run * SAMPLES..(run + 1) * SAMPLES]);
    Ok(share_of_accurate(velocities.iter().map(Vec::as_slice).zip(expected)))
}

/// The output velocity of a run. NaN, which counts as not accurate, if the run fails.
fn velocity(fig: &Fig816, backend: BackendChoice, step: f64, run: usize) -> Vec<f64> {
    let mut program = fig.program.clone();
    let settings = backend.1(fig.compared_settings(Steps::Equal(step)));
    let trace = program.set_parameters(values(run)).ok().and_then(|()| solve::run(&program, &settings).ok());
    trace.map_or_else(|| vec![f64::NAN; SAMPLES], |trace| backends::velocity(&trace))
}

/// The whole sweep on a backend, with equal steps in s.
pub(crate) fn sweep(fig: &Fig816, backend: solve::Backend, step: f64) -> Outcome<Sweep> {
    sweep_of(fig, fig.compared_settings(Steps::Equal(step)).with_backend(backend), VCL)
}

/// The sweep with some settings and values of VcL.
fn sweep_of(fig: &Fig816, settings: RunSettings, vcl: &str) -> Outcome<Sweep> {
    let axes = vec![Axis::parse(vcl)?, Axis::parse("Tc=0.006:0.025:25")?];
    let plan = Plan::new(axes, &fig.program)?;
    let measures = vec![Measure::parse("peak:v_o", fig.program.signals())?];
    Ok(Sweep::new(fig.circuit.patch(), fig.program.clone(), settings, plan, measures)?)
}

/// Duration of the whole sweep in s. The rows are made as by `patchcord sweep` and discarded.
///
/// The quick measurement makes a tenth of the runs and multiplies.
fn sweep_seconds(
    fig: &Fig816,
    backend: BackendChoice,
    step: f64,
    threads: usize,
    quick: bool,
) -> Outcome<f64> {
    let vcl = if quick { "VcL=1.27e-3:25.4e-3:4" } else { VCL };
    let sweep = sweep_of(fig, backend.1(fig.compared_settings(Steps::Equal(step))), vcl)?;
    let share = RUNS as f64 / sweep.plan().runs() as f64;
    let (seconds, outcome) = timed(|| sweep.write(&mut io::sink(), threads, &mut |_| ()));
    outcome?;
    Ok(seconds * share)
}
