//! How every measure reads a run.

use super::super::friction_loop::whole_cycles;
use super::super::oscillation::{Oscillation, oscillation_within};
use super::super::voltmeter::{Reading, readings};
use super::{Cell, Measure};
use crate::instruments::{
    self, Criterion, CriticalInterval, FrictionLoop, NoCriticalVelocity, ProfileCriterion, Way,
};
use patchcord_core::document::told;
use patchcord_core::trace::{Trace, Track};
use patchcord_expr::Unit;

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

    /// Index of the first sample of the last so many seconds; where nothing is given, of the last half of the run.
    fn begin_of_last(&self, last: Option<f64>) -> Result<usize, String> {
        let time = self.time();
        let (begin, end) = (time.first().copied().unwrap_or(0.0), time.last().copied().unwrap_or(0.0));
        let run = self.trace.sweeps.last().map_or(0.0, |sweep| sweep.end) - begin;
        if let Some(last) = last.filter(|last| *last > run * (1.0 + ROUNDING)) {
            return Err(format!("the last {} s are longer than the run of {} s", told(last), told(run)));
        }
        let from = end - last.unwrap_or((end - begin) / 2.0);
        Ok(time.partition_point(|instant| *instant < from))
    }

    /// The oscillation at the end of the run.
    fn oscillation(&self, read: impl Fn(Oscillation) -> f64) -> Cells {
        let first = match self.begin_of_last(self.measure.option(0)) {
            Ok(first) => first,
            Err(longer) => return vec![Err(longer)],
        };
        let reach = self
            .course()
            .map_or([f64::NEG_INFINITY, f64::INFINITY], |course| [course.least.value, course.most.value]);
        one(oscillation_within(&self.time()[first..], &self.values(0)[first..], reach).map(read))
    }

    /// The loop of its velocity and its force at the end of the run, and how many SI units its area has.
    fn friction_loop(&self) -> Result<(FrictionLoop, f64), String> {
        let first = self.begin_of_last(self.measure.option(1))?;
        let threshold = self.measure.option(0).unwrap_or(Criterion::USUAL.threshold);
        let (time, velocity, force) = (&self.time()[first..], self.values(0), self.values(1));
        let (velocity, force) = (&velocity[first..], &force[first..]);
        let cycles = whole_cycles(time, velocity, threshold).max(1);
        let found = instruments::friction_loop(time, velocity, force, cycles, threshold);
        let unit =
            |signal: usize| Unit::parse(&self.measure.signals[signal].1).map_or(1.0, |unit| unit.factor());
        found.map(|found| (found, unit(0) * unit(1))).map_err(|error| error.to_string())
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

/// When velocities oscillate, as the first two options tell.
fn criterion(run: &Run<'_>) -> Criterion {
    Criterion {
        threshold: run.measure.option(0).unwrap_or(Criterion::USUAL.threshold),
        window: run.measure.option(1).unwrap_or(Criterion::USUAL.window),
    }
}

pub(super) fn critical_velocity(run: &Run<'_>) -> Cells {
    let found = instruments::critical_velocity(run.time(), &run.values(0), &run.values(1), criterion(run));
    vec![number(found.rising), number(found.falling)]
}

pub(super) fn critical_velocity_range(run: &Run<'_>) -> Cells {
    let found = instruments::critical_range(run.time(), &run.values(0), &run.values(1), criterion(run));
    let cells = |interval: Result<CriticalInterval, NoCriticalVelocity>| {
        let of = |value: fn(CriticalInterval) -> f64| number(interval.map(value));
        [of(|interval| interval.least), of(|interval| interval.most), of(|interval| interval.unread as f64)]
    };
    [cells(found.rising), cells(found.falling)].concat()
}

/// The same with the third option, or what is usual with the first.
fn profile_criterion(run: &Run<'_>) -> ProfileCriterion {
    let usual = ProfileCriterion::usual(criterion(run));
    ProfileCriterion { standstill: run.measure.option(2).unwrap_or(usual.standstill), ..usual }
}

pub(super) fn first_oscillation(run: &Run<'_>) -> Cells {
    let found =
        instruments::first_oscillation(run.time(), &run.values(0), &run.values(1), profile_criterion(run));
    [found.rising, found.falling].map(|point| number(point.map(|point| point.command))).to_vec()
}

pub(super) fn profile(run: &Run<'_>) -> Cells {
    points(run, Way::Rising)
}

pub(super) fn profile_falling(run: &Run<'_>) -> Cells {
    points(run, Way::Falling)
}

/// The commands at the points of the profile.
fn points(run: &Run<'_>, way: Way) -> Cells {
    let criterion = profile_criterion(run);
    match instruments::velocity_profile(run.time(), &run.values(0), &run.values(1), criterion, way) {
        Ok(profile) => profile.points.map(|point| number(point.map(|point| point.command))).to_vec(),
        Err(error) => vec![Err(error.to_string()); 5],
    }
}

pub(super) fn friction_loop(run: &Run<'_>) -> Cells {
    let cells =
        |(found, si): (FrictionLoop, f64)| [found.area, found.work].map(|value| Ok(Cell::Number(value * si)));
    run.friction_loop().map_or_else(|error| vec![Err(error); 2], |found| cells(found).to_vec())
}

pub(super) fn stick_end(run: &Run<'_>) -> Cells {
    one(instruments::stick_end(run.time(), &run.values(0), run.measure.option(0)))
}

pub(super) fn overload(run: &Run<'_>) -> Cells {
    match run.trace.sweeps.last().and_then(|sweep| sweep.overloads.first()) {
        Some(first) => vec![Ok(Cell::Name(first.element.clone())), Ok(Cell::Number(first.time))],
        None => vec![Ok(Cell::Name("none".to_owned())), Ok(Cell::Empty)],
    }
}
