//! 1000 runs of 2 s, VcL 1.27 ... 25.4 mm/s by Tc 6 ... 25 ms: how many a second, each solver at the largest step at which
//! 95 % of the runs are right to 1e-5 of their peak velocity.

use std::{io, thread};

use crate::clock::{Work, in_turns, three, timed, told};
use crate::own::{self, BACKENDS_OF_SWEEPS, Backend, Fig816, SAMPLES, Steps};
use crate::peers::{Peers, RUNS};
use crate::{Outcome, page, threads};
use patchcord::instruments::Measure;
use patchcord::solve::{self, RunSettings};
use patchcord::sweep::{Axis, Plan, Sweep};

/// The share of the runs that has to be right, and to what.
const SHARE: f64 = 0.95;
const WANTED: f64 = 1e-5;
/// Every so many-th run is looked at while a step is looked for.
const THINNED: usize = 10;
/// Steps of the reference, in seconds.
const REFERENCE: f64 = 5e-6;

const VCL: &str = "VcL=1.27e-3:25.4e-3:40";

/// How often everything is measured, in turns.
const ROUNDS: usize = 2;

pub fn table(peers: &Peers, fig: &Fig816, quick: bool) -> Outcome<String> {
    let reference = peers.c_swept("fig_8_16_located", REFERENCE)?.velocity;
    let tried = threads::up_to(thread::available_parallelism()?.get());
    let (mut entries, mut works): (Vec<Entry>, Vec<Work<'_>>) = (Vec::new(), Vec::new());
    for (stem, name) in [("fig_8_16", "C, kinks stepped over"), ("fig_8_16_located", "C, kinks located")] {
        let (step, share) = c_step(peers, stem, &reference)?;
        entries.push(Entry { name: name.to_owned(), step, share, threads: None });
        works.push(Box::new(move || Ok(peers.c_swept(stem, step)?.seconds)));
    }
    for backend in BACKENDS_OF_SWEEPS {
        let step = step_of(fig, backend, &reference)?;
        let share = share_right(fig, backend, step, &reference, if quick { THINNED } else { 1 })?;
        for &threads in &tried {
            let name =
                format!("patchcord, {}, {threads} thread{}", backend.0, if threads == 1 { "" } else { "s" });
            entries.push(Entry { name, step, share, threads: Some(threads) });
            works.push(Box::new(move || swept(fig, backend, step, threads, quick)));
        }
    }
    let seconds = in_turns(ROUNDS, works)?;
    let mut one_thread = f64::NAN;
    let rows = entries.iter().zip(&seconds).map(|(entry, own)| {
        one_thread = if entry.threads == Some(1) { *own } else { one_thread };
        entry.row(*own, seconds[0], one_thread)
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

/// A solver at its step.
struct Entry {
    name: String,
    step: f64,
    share: f64,
    /// How many threads patchcord has.
    threads: Option<usize>,
}

impl Entry {
    fn row(&self, seconds: f64, base: f64, one_thread: f64) -> Vec<String> {
        vec![
            self.name.clone(),
            format!("{:.1} µs", self.step * 1e6),
            format!("{:.1} %", self.share * 100.0),
            told(seconds),
            format!("{:.0}", RUNS as f64 / seconds),
            three(base / seconds),
            self.threads.map_or(String::new(), |_| three(one_thread / seconds)),
        ]
    }
}

/// The share of runs that are right to what is wanted.
fn right<'a>(runs: impl Iterator<Item = (&'a [f64], &'a [f64])>) -> f64 {
    let errors: Vec<f64> = runs.map(|(found, reference)| own::error(found, reference)).collect();
    errors.iter().filter(|error| **error <= WANTED).count() as f64 / errors.len() as f64
}

/// The longest step of a C program that does, and the share that it has right.
fn c_step(peers: &Peers, stem: &str, reference: &[f64]) -> Outcome<(f64, f64)> {
    for parts in own::rungs() {
        let step = 1e-3 / f64::from(parts);
        let solved = peers.c_swept(stem, step)?;
        let share = right(solved.velocity.chunks(SAMPLES).zip(reference.chunks(SAMPLES)));
        if share >= SHARE {
            return Ok((step, share));
        }
    }
    Err(format!("{stem}: no step is right enough").into())
}

fn step_of(fig: &Fig816, backend: Backend, reference: &[f64]) -> Outcome<f64> {
    for parts in own::rungs() {
        let step = 1e-3 / f64::from(parts);
        if share_right(fig, backend, step, reference, THINNED)? >= SHARE {
            return Ok(step);
        }
    }
    Err("no step is right enough".into())
}

fn values(run: usize) -> [(&'static str, f64); 2] {
    let along = |low: f64, high: f64, index: usize, count: usize| {
        low + (high - low) * index as f64 / (count - 1) as f64
    };
    [("VcL", along(1.27e-3, 25.4e-3, run / 25, 40)), ("Tc", along(6e-3, 25e-3, run % 25, 25))]
}

/// Every so many-th run held against the reference, on two threads.
fn share_right(fig: &Fig816, backend: Backend, step: f64, reference: &[f64], thinned: usize) -> Outcome<f64> {
    let chosen: Vec<usize> = (0..RUNS).step_by(thinned).collect();
    let velocities = thread::scope(|scope| {
        let halves = chosen.chunks(chosen.len().div_ceil(2));
        let threads: Vec<_> = halves
            .map(|runs| {
                scope.spawn(move || {
                    runs.iter().map(|run| velocity(fig, backend, step, *run)).collect::<Vec<_>>()
                })
            })
            .collect();
        let halves = threads.into_iter().map(|thread| thread.join().map_err(|_| "a run broke off"));
        halves.collect::<Result<Vec<_>, _>>()
    })?;
    let velocities = velocities.concat();
    let expected = chosen.iter().map(|run| &reference[run * SAMPLES..(run + 1) * SAMPLES]);
    Ok(right(velocities.iter().map(Vec::as_slice).zip(expected)))
}

/// The output velocity of a run; nothing, which is as wrong as can be, when it had to stop.
fn velocity(fig: &Fig816, backend: Backend, step: f64, run: usize) -> Vec<f64> {
    let mut program = fig.program.clone();
    let settings = backend.1(fig.compared(Steps::Equal(step)));
    let trace = program.set_parameters(values(run)).ok().and_then(|()| solve::run(&program, &settings).ok());
    trace.map_or_else(|| vec![f64::NAN; SAMPLES], |trace| own::velocity(&trace))
}

/// The whole sweep by a backend, with steps of so many seconds.
pub fn sweep(fig: &Fig816, backend: solve::Backend, step: f64) -> Outcome<Sweep> {
    sweep_of(fig, RunSettings { backend, ..fig.compared(Steps::Equal(step)) }, VCL)
}

fn sweep_of(fig: &Fig816, settings: RunSettings, vcl: &str) -> Outcome<Sweep> {
    let axes = vec![Axis::parse(vcl)?, Axis::parse("Tc=0.006:0.025:25")?];
    let plan = Plan::new(axes, &fig.program)?;
    let measures = vec![Measure::parse("peak:v_o", fig.program.signals())?];
    Ok(Sweep::new(fig.circuit.patch(), fig.program.clone(), settings, plan, measures)?)
}

/// Seconds that the sweep takes as the command makes it, rows made and thrown away.
fn swept(fig: &Fig816, backend: Backend, step: f64, threads: usize, quick: bool) -> Outcome<f64> {
    let vcl = if quick { "VcL=1.27e-3:25.4e-3:4" } else { VCL };
    let sweep = sweep_of(fig, backend.1(fig.compared(Steps::Equal(step))), vcl)?;
    let share = RUNS as f64 / sweep.plan().runs() as f64;
    let (seconds, outcome) = timed(|| sweep.write(&mut io::sink(), threads, &mut |_| ()));
    outcome?;
    Ok(seconds * share)
}
