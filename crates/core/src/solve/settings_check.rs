//! Checks the settings of a run: times, phases, tolerance, and the size of the run.
//!
//! The limits of the size stop a run whose settings are a mistake before it uses hours or gigabytes.

use super::error::RunError;
use super::settings::RunSettings;
use super::time_setting::TimeSetting;
use crate::document::{MAX_TOLERANCE, MIN_TOLERANCE, Phase, RunExtent, is_tolerance};
use crate::grid::SAME_INSTANT;

impl RunSettings {
    /// Checks the times, the phases, the tolerance and the size of the run. Names are checked by
    /// [`check()`](super::check).
    ///
    /// # Errors
    /// If a time is not positive, the step or the time between samples is longer than the run, no phase takes time, a
    /// repetition is empty, or the run would take too many steps or too much memory.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::RunSettings;
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
    /// let settings = RunSettings::of(&Circuit::new(&patch)?)?.with_sample_interval(2.0);
    /// let error = settings.check().unwrap_err();
    /// assert_eq!(error.to_string(), "the time between samples is 2 s, longer than the run of 1 s");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn check(&self) -> Result<(), RunError> {
        self.phases.iter().try_for_each(check_phase)?;
        let intervals = [(TimeSetting::Step, self.step), (TimeSetting::Every, self.every)];
        intervals.into_iter().try_for_each(|(which, value)| check_time(which, value))?;
        let extent = RunExtent::of(&self.phases);
        if extent.record_time == 0.0 {
            return Err(RunError::NoTime);
        }
        for (which, value) in intervals {
            if value > extent.longest_repetition * (1.0 + SAME_INSTANT) {
                return Err(RunError::LongerThanRun { which, value, duration: extent.longest_repetition });
            }
        }
        self.tolerance.map_or(Ok(()), check_tolerance)?;
        self.check_size(extent)
    }

    /// Checks the number of steps, of recorded numbers, and of those that stay in memory.
    ///
    /// # Errors
    /// If they exceed [`RunSettings::max_steps`], [`MAX_STREAMED_NUMBERS`] or [`MAX_NUMBERS`].
    fn check_size(&self, extent: RunExtent) -> Result<(), RunError> {
        let (steps, max) = (extent.operate_time / self.step, self.max_steps);
        if self.tolerance.is_none() && steps > max {
            return Err(RunError::TooManySteps { steps, max });
        }
        if self.block_samples.is_none() {
            return check_numbers(self.recorded_numbers(), MAX_NUMBERS);
        }
        check_numbers(self.recorded_numbers(), MAX_STREAMED_NUMBERS)?;
        check_numbers(self.numbers_without_samples(extent), MAX_NUMBERS)
    }

    /// An upper limit of the numbers that the run records, with repetitions: one time and one value per track for every
    /// sample, and a constant amount for every phase, change and repetition.
    pub fn recorded_numbers(&self) -> f64 {
        let extent = RunExtent::of(&self.phases);
        self.max_samples() * (self.track_count() + 1.0) + self.numbers_without_samples(extent)
    }

    /// An upper limit of the number of samples that the run records, with repetitions.
    pub fn max_samples(&self) -> f64 {
        let extent = RunExtent::of(&self.phases);
        // Every phase may write a sample at its beginning and one at its end.
        (extent.record_time / self.every).floor() + 2.0 * extent.phase_count
    }

    /// The number of phases, with every repetition counted.
    pub fn phase_count(&self) -> f64 {
        RunExtent::of(&self.phases).phase_count
    }

    /// An upper limit of the numbers for phases, changes and repetitions.
    fn numbers_without_samples(&self, extent: RunExtent) -> f64 {
        let phase_records = (extent.phase_count + extent.change_count) * NUMBERS_PER_PHASE_RECORD;
        let per_repetition =
            self.track_count() * NUMBERS_PER_EXTREMES + self.curves.len() as f64 * NUMBERS_PER_CURVE;
        // Every phase may begin a repetition.
        phase_records + extent.phase_count * per_repetition
    }

    /// Number of tracks: one for every signal and every derivative.
    fn track_count(&self) -> f64 {
        (self.record.len() * (1 + self.sensitivities.len())) as f64
    }
}

/// Checks that a tolerance is from [`MIN_TOLERANCE`] to [`MAX_TOLERANCE`].
///
/// # Errors
/// If it is not.
pub(super) fn check_tolerance(value: f64) -> Result<(), RunError> {
    match is_tolerance(value) {
        true => Ok(()),
        false => Err(RunError::NotATolerance { value, min: MIN_TOLERANCE, max: MAX_TOLERANCE }),
    }
}

/// Checks that the numbers that a run records do not exceed a limit.
///
/// # Errors
/// If they do.
fn check_numbers(numbers: f64, max: f64) -> Result<(), RunError> {
    if numbers > max { Err(RunError::TooManyNumbers { numbers, max }) } else { Ok(()) }
}

/// Checks that a time is positive and finite.
fn check_time(which: TimeSetting, value: f64) -> Result<(), RunError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(RunError::NotATime { which, value }) }
}

/// Checks the times of a phase, and that a repetition is not empty.
fn check_phase(phase: &Phase) -> Result<(), RunError> {
    match phase {
        Phase::Operate { time, .. } => check_time(TimeSetting::Duration, *time),
        Phase::Hold { time } => check_time(TimeSetting::Hold, *time),
        Phase::Repeat { times, phases } if *times == 0 || phases.is_empty() => Err(RunError::EmptyRepeat),
        Phase::Repeat { phases, .. } => phases.iter().try_for_each(check_phase),
        Phase::InitialCondition | Phase::Set { .. } => Ok(()),
    }
}

/// Largest number of steps of a run, over all phases and repetitions. Steps that end at a jump of a drive count, too.
/// At a million steps a second they take 2.8 hours, so more steps are a mistake in the settings.
pub(super) const MAX_STEPS: f64 = 1e10;
/// Largest number of numbers of a run that stay in memory. They take 8 bytes each, and as much again while they are
/// written to a file: 3.2 GB together.
const MAX_NUMBERS: f64 = 2e8;
/// Largest number of numbers that a run passes on in blocks. In a table they take up to 200 GB, so more are a mistake
/// in the settings.
const MAX_STREAMED_NUMBERS: f64 = 1e10;
/// Memory of the record of a phase, and of every change in it, in numbers of 8 bytes.
const NUMBERS_PER_PHASE_RECORD: f64 = 16.0;
/// Memory of the extremes of a signal in a repetition, in numbers: first and last voltage, and two extremes with their
/// times.
const NUMBERS_PER_EXTREMES: f64 = 6.0;
/// Least memory of a curve in a repetition, in numbers: two points, while it is thinned.
const NUMBERS_PER_CURVE: f64 = 16.0;
