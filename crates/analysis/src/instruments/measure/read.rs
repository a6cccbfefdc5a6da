//! The functions that read each measure off the last run of a trace. The table of measures refers to them.

use super::super::friction_loop::whole_cycles;
use super::super::oscillation::{Oscillation, oscillation_within};
use super::super::voltmeter::{VoltmeterReading, readings};
use super::{Measure, MeasureValue};
use crate::instruments::{
    self, Criterion, CriticalInterval, CriticalVelocityError, FrictionLoop, ProfileCriterion, RampDirection,
};
use patchcord_core::document::format_distinct;
use patchcord_core::trace::{Trace, Track};
use patchcord_expr::Unit;

/// Tolerance for comparing a requested duration with the length of the run, as a fraction of that length.
const DURATION_TOLERANCE: f64 = 1e-9;

/// The last run of a trace, as a measure reads it.
pub(super) struct LastRun<'a> {
    /// The trace, which may contain several runs.
    trace: &'a Trace,
    /// The measure with its signals and options.
    measure: &'a Measure,
    /// Index of the first sample of the run in the trace.
    first: usize,
}

/// One value per column of the measure, or why it has none.
type Values = Vec<Result<MeasureValue, String>>;

impl<'a> LastRun<'a> {
    /// The last run of a trace. An empty trace has an empty run.
    pub(super) fn new(trace: &'a Trace, measure: &'a Measure) -> Self {
        LastRun { trace, measure, first: trace.repetitions.last().map_or(0, |repetition| repetition.first) }
    }

    /// The times of the run, in seconds.
    fn time(&self) -> &'a [f64] {
        &self.trace.time[self.first..]
    }

    /// The track of the measure's signal with this index.
    fn track(&self, signal: usize) -> Option<&'a Track> {
        self.trace.track(&self.measure.signals[signal].0)
    }

    /// The samples of the measure's signal with this index, in its unit.
    fn values(&self, signal: usize) -> Vec<f64> {
        self.track(signal).map_or_else(Vec::new, |track| track.values().skip(self.first).collect())
    }

    /// One value from the voltmeter reading of the measure's signal.
    fn voltmeter_value(&self, read: impl Fn(&VoltmeterReading) -> f64) -> Values {
        let read = self.voltmeter_reading().map(|reading| MeasureValue::Number(read(&reading)));
        vec![read.ok_or_else(|| "no sample was recorded".to_owned())]
    }

    /// The voltmeter reading of the measure's signal in this run.
    fn voltmeter_reading(&self) -> Option<VoltmeterReading> {
        let last = self.trace.repetitions.len().saturating_sub(1);
        let name = &self.measure.signals[0].0;
        readings(self.trace).into_iter().find(|found| found.run == last && found.signal == *name)
    }

    /// Index of the first sample of the last `last` seconds; None means the last half of the run.
    fn start_of_last(&self, last: Option<f64>) -> Result<usize, String> {
        let time = self.time();
        let (begin, end) = (time.first().copied().unwrap_or(0.0), time.last().copied().unwrap_or(0.0));
        let run = self.trace.repetitions.last().map_or(0.0, |repetition| repetition.end) - begin;
        if let Some(last) = last.filter(|last| *last > run * (1.0 + DURATION_TOLERANCE)) {
            return Err(format!(
                "last={} s exceeds the run of {} s",
                format_distinct(last, run),
                format_distinct(run, last)
            ));
        }
        let from = end - last.unwrap_or((end - begin) / 2.0);
        Ok(time.partition_point(|instant| *instant < from))
    }

    /// One value of the oscillation at the end of the run.
    fn oscillation(&self, read: impl Fn(Oscillation) -> f64) -> Values {
        let first = match self.start_of_last(self.measure.option(0)) {
            Ok(first) => first,
            Err(too_long) => return vec![Err(too_long)],
        };
        let range = self
            .voltmeter_reading()
            .map_or([f64::NEG_INFINITY, f64::INFINITY], |reading| [reading.least.value, reading.most.value]);
        single(oscillation_within(&self.time()[first..], &self.values(0)[first..], range).map(read))
    }

    /// The loop of velocity and force at the end of the run, and the factor that converts its area to SI units.
    fn friction_loop(&self) -> Result<(FrictionLoop, f64), String> {
        let first = self.start_of_last(self.measure.option(1))?;
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

/// The values of a measure with one column.
fn single<E: std::fmt::Display>(read: Result<f64, E>) -> Values {
    vec![number(read)]
}

/// The value of one column.
fn number<E: std::fmt::Display>(read: Result<f64, E>) -> Result<MeasureValue, String> {
    read.map(MeasureValue::Number).map_err(|error| error.to_string())
}

/// The value at the end of the run.
pub(super) fn voltmeter(run: &LastRun<'_>) -> Values {
    run.voltmeter_value(|reading| reading.end)
}

/// The largest absolute value, also between samples.
pub(super) fn peak(run: &LastRun<'_>) -> Values {
    run.voltmeter_value(VoltmeterReading::largest)
}

/// The smallest value, also between samples.
pub(super) fn least(run: &LastRun<'_>) -> Values {
    run.voltmeter_value(|reading| reading.least.value)
}

/// The largest value, also between samples.
pub(super) fn most(run: &LastRun<'_>) -> Values {
    run.voltmeter_value(|reading| reading.most.value)
}

/// Half the peak-to-peak value of an oscillation, see [`instruments::oscillation`].
pub(super) fn amplitude(run: &LastRun<'_>) -> Values {
    run.oscillation(|read| read.amplitude)
}

/// The frequency of an oscillation in Hz, see [`instruments::oscillation`].
pub(super) fn frequency(run: &LastRun<'_>) -> Values {
    run.oscillation(|read| read.frequency)
}

/// The oscillation criterion from the first two options, threshold and window.
fn criterion(run: &LastRun<'_>) -> Criterion {
    Criterion {
        threshold: run.measure.option(0).unwrap_or(Criterion::USUAL.threshold),
        window: run.measure.option(1).unwrap_or(Criterion::USUAL.window),
    }
}

/// The rising and the falling critical velocity. Each one may be missing for its own reason.
pub(super) fn critical_velocity(run: &LastRun<'_>) -> Values {
    let found = instruments::critical_velocity(run.time(), &run.values(0), &run.values(1), criterion(run));
    vec![number(found.rising), number(found.falling)]
}

/// Smallest value, largest value and number of failed readings, rising and then falling.
pub(super) fn critical_velocity_range(run: &LastRun<'_>) -> Values {
    let found = instruments::critical_range(run.time(), &run.values(0), &run.values(1), criterion(run));
    let values = |interval: Result<CriticalInterval, CriticalVelocityError>| {
        let of = |value: fn(CriticalInterval) -> f64| number(interval.map(value));
        [of(|interval| interval.least), of(|interval| interval.most), of(|interval| interval.unread as f64)]
    };
    [values(found.rising), values(found.falling)].concat()
}

/// The profile criterion from the first three options: threshold, window and standstill.
fn profile_criterion(run: &LastRun<'_>) -> ProfileCriterion {
    let usual = ProfileCriterion::usual(criterion(run));
    ProfileCriterion { standstill: run.measure.option(2).unwrap_or(usual.standstill), ..usual }
}

/// The command at the first oscillation of the rising and of the falling ramp.
pub(super) fn first_oscillation(run: &LastRun<'_>) -> Values {
    let found =
        instruments::first_oscillation(run.time(), &run.values(0), &run.values(1), profile_criterion(run));
    [found.rising, found.falling].map(|point| number(point.map(|point| point.command))).to_vec()
}

/// The commands at points 1 to 5 of the rising ramp.
pub(super) fn profile(run: &LastRun<'_>) -> Values {
    points(run, RampDirection::Rising)
}

/// The commands at points 1 to 5 of the falling ramp.
pub(super) fn profile_falling(run: &LastRun<'_>) -> Values {
    points(run, RampDirection::Falling)
}

/// The commands at the five points of the profile.
fn points(run: &LastRun<'_>, direction: RampDirection) -> Values {
    let criterion = profile_criterion(run);
    match instruments::velocity_profile(run.time(), &run.values(0), &run.values(1), criterion, direction) {
        Ok(profile) => profile.points.map(|point| number(point.map(|point| point.command))).to_vec(),
        Err(error) => vec![Err(error.to_string()); 5],
    }
}

/// Area in W and work in J of the loop of force against velocity.
pub(super) fn friction_loop(run: &LastRun<'_>) -> Values {
    let values = |(found, si): (FrictionLoop, f64)| {
        [found.area, found.work].map(|value| Ok(MeasureValue::Number(value * si)))
    };
    run.friction_loop().map_or_else(|error| vec![Err(error); 2], |found| values(found).to_vec())
}

/// The time in seconds at which sticking ends.
pub(super) fn stick_end(run: &LastRun<'_>) -> Values {
    single(instruments::stick_end(run.time(), &run.values(0), run.measure.option(0)))
}

/// Name of the amplifier that is overloaded first, and the time; "none" and no time without an overload.
pub(super) fn overload(run: &LastRun<'_>) -> Values {
    match run.trace.repetitions.last().and_then(|repetition| repetition.overloads.first()) {
        Some(first) => {
            vec![Ok(MeasureValue::Name(first.element.clone())), Ok(MeasureValue::Number(first.time))]
        }
        None => vec![Ok(MeasureValue::Name("none".to_owned())), Ok(MeasureValue::Empty)],
    }
}
