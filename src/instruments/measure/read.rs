//! How every measure reads a run.

use super::super::critical_velocity::{self as profile, Criterion};
use super::super::oscillation::{Oscillation, oscillation_within};
use super::super::stick;
use super::super::voltmeter::{Reading, readings};
use super::{Cell, Measure};
use crate::patch::told;
use crate::trace::{Trace, Track};

/// This share of the length of a run is rounding.
const ROUNDING: f64 = 1e-9;

/// The last run of a trace, and the measure that looks at it.
pub(super) struct Run<'a> {
    trace: &'a Trace,
    measure: &'a Measure,
    /// Index of its first sample.
    first: usize,
}

type Cells = Vec<Result<Cell, String>>;

impl<'a> Run<'a> {
    pub fn last(trace: &'a Trace, measure: &'a Measure) -> Self {
        Run { trace, measure, first: trace.sweeps.last().map_or(0, |sweep| sweep.first) }
    }

    fn time(&self) -> &'a [f64] {
        &self.trace.time[self.first..]
    }

    fn track(&self, signal: usize) -> Option<&'a Track> {
        self.trace.track(&self.measure.signals[signal].0)
    }

    /// The samples of one of its signals.
    fn values(&self, signal: usize) -> Vec<f64> {
        self.track(signal).map_or_else(Vec::new, |track| track.values().skip(self.first).collect())
    }

    /// What the voltmeter reads of its signal.
    fn reading(&self, read: impl Fn(&Reading) -> f64) -> Cells {
        let read = self.course().map(|course| Cell::Number(read(&course)));
        vec![read.ok_or_else(|| "nothing was recorded".to_owned())]
    }

    /// What its signal went through.
    fn course(&self) -> Option<Reading> {
        let last = self.trace.sweeps.len().saturating_sub(1);
        let name = &self.measure.signals[0].0;
        readings(self.trace).into_iter().find(|found| found.run == last && found.signal == *name)
    }

    /// What is told of a last part that is longer than the run.
    fn longer_than_run(&self, last: Option<f64>) -> Option<String> {
        let end = self.trace.sweeps.last().map_or(0.0, |sweep| sweep.end);
        let run = end - self.time().first().copied().unwrap_or(0.0);
        let last = last.filter(|last| *last > run * (1.0 + ROUNDING))?;
        Some(format!("the last {} s are longer than the run of {} s", told(last), told(run)))
    }

    /// The oscillation at the end of the run.
    fn oscillation(&self, read: impl Fn(Oscillation) -> f64) -> Cells {
        let (time, values) = (self.time(), self.values(0));
        let (begin, end) = (time.first().copied().unwrap_or(0.0), time.last().copied().unwrap_or(0.0));
        if let Some(longer) = self.longer_than_run(self.measure.option(0)) {
            return vec![Err(longer)];
        }
        let from = end - self.measure.option(0).unwrap_or((end - begin) / 2.0);
        let first = time.partition_point(|instant| *instant < from);
        let reach = self
            .course()
            .map_or([f64::NEG_INFINITY, f64::INFINITY], |course| [course.least.value, course.most.value]);
        one(oscillation_within(&time[first..], &values[first..], reach).map(read))
    }
}

fn one<E: std::fmt::Display>(read: Result<f64, E>) -> Cells {
    vec![number(read)]
}

fn number<E: std::fmt::Display>(read: Result<f64, E>) -> Result<Cell, String> {
    read.map(Cell::Number).map_err(|error| error.to_string())
}

pub(super) fn voltmeter(run: &Run<'_>) -> Cells {
    run.reading(|reading| reading.end)
}

pub(super) fn peak(run: &Run<'_>) -> Cells {
    run.reading(Reading::largest)
}

pub(super) fn least(run: &Run<'_>) -> Cells {
    run.reading(|reading| reading.least.value)
}

pub(super) fn most(run: &Run<'_>) -> Cells {
    run.reading(|reading| reading.most.value)
}

pub(super) fn amplitude(run: &Run<'_>) -> Cells {
    run.oscillation(|read| read.amplitude)
}

pub(super) fn frequency(run: &Run<'_>) -> Cells {
    run.oscillation(|read| read.frequency)
}

pub(super) fn critical_velocity(run: &Run<'_>) -> Cells {
    let criterion = Criterion {
        threshold: run.measure.option(0).unwrap_or(Criterion::USUAL.threshold),
        window: run.measure.option(1).unwrap_or(Criterion::USUAL.window),
    };
    let found = profile::critical_velocity(run.time(), &run.values(0), &run.values(1), criterion);
    vec![number(found.rising), number(found.falling)]
}

pub(super) fn stick_end(run: &Run<'_>) -> Cells {
    one(stick::stick_end(run.time(), &run.values(0), run.measure.option(0)))
}

pub(super) fn overload(run: &Run<'_>) -> Cells {
    match run.trace.sweeps.last().and_then(|sweep| sweep.overloads.first()) {
        Some(first) => vec![Ok(Cell::Name(first.element.clone())), Ok(Cell::Number(first.time))],
        None => vec![Ok(Cell::Name("none".to_owned())), Ok(Cell::Empty)],
    }
}
