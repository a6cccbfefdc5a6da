//! A whole run: its settings, their check, and the record.
//!
//! [`ready`] checks everything and makes a machine with its recorder. A player then goes through the phases. Programs
//! that differ only in their parameters can run side by side as a batch.

use super::batch::Batch;
use super::error::{RunError, Stopped, TimeSetting};
use super::levels::check_noise;
use super::machine::Machine;
use super::player::{self, Player};
use super::recorder::Recorder;
use crate::document::{Extent, LEAST_TOLERANCE, Phase};
use crate::grid::SAME;
use crate::ir::Program;
use crate::kernel::{Backend, Kernel, LANES};
use crate::trace::Trace;

/// The settings of a run. Times are in problem seconds.
#[derive(Debug, Clone, PartialEq)]
pub struct RunSettings {
    /// The phases in their order. A run always begins in initial condition, even if the first phase does not say so.
    pub phases: Vec<Phase>,
    /// Length of the solver's steps, above 0. Shorter steps are slower and more accurate: the error decreases with the
    /// fourth power of the step if the circuit is smooth. With a tolerance, this is the first step tried.
    pub step: f64,
    /// With a tolerance, the length of steps adapts to it; `None` for equal steps. The tolerance bounds the sum of the
    /// errors of the steps from one initial condition to the next, in any state, in machine units of 100 V. It is at
    /// least [`LEAST_TOLERANCE`]. If the motion amplifies errors, as stick-slip does, the result is less accurate than
    /// that.
    pub tolerance: Option<f64>,
    /// Time between recorded samples, above 0. Recording never changes the steps.
    pub every: f64,
    /// Whether the machine goes into hold as soon as a lamp lights. Phases that take time are then skipped until the
    /// next initial condition.
    pub hold_on_overload: bool,
    /// Whether overload lamps can light. With `hold_on_overload` they always can. Without lamps the trace lists no
    /// overload, and runs beyond ±100 V are faster.
    pub lamps: bool,
    /// Names of the signals to record, in order.
    pub record: Vec<String>,
    /// Names of the parameters by which the derivatives of all these signals are also recorded.
    pub sensitivities: Vec<String>,
    /// The backend that takes the steps. Runs with a tolerance or derivatives, and programs with loops, always use the
    /// reference.
    pub backend: Backend,
}

impl RunSettings {
    /// The same settings for one initial condition and operation over a time in seconds.
    pub fn lasting(self, duration: f64) -> Self {
        RunSettings { phases: vec![Phase::InitialCondition, Phase::operate(duration)], ..self }
    }

    /// The same settings with all phases repeated (repetitive operation).
    pub fn repeated(self, times: u64) -> Self {
        RunSettings { phases: vec![Phase::Repeat { times, phases: self.phases }], ..self }
    }

    /// The longest time in seconds between two initial conditions, or from one to the end of the run.
    pub fn duration(&self) -> f64 {
        Extent::of(&self.phases).longest
    }

    /// The longest time in seconds of the whole run by the recorder's clock.
    pub fn whole(&self) -> f64 {
        Extent::of(&self.phases).recorded
    }

    /// Whether runs of a program with these settings are faster side by side.
    pub fn go_abreast(&self, program: &Program) -> bool {
        let are_equal = self.tolerance.is_none() && self.sensitivities.is_empty();
        are_equal && self.backend.goes_abreast() && Kernel::can_be_of(program)
    }

    /// Checks that the settings make a run.
    ///
    /// # Errors
    /// If a time is not positive, the step or the time between samples is longer than the run, no phase takes time, a
    /// repetition is empty, or the run would take too many steps or too much memory.
    pub fn check(&self) -> Result<(), RunError> {
        self.phases.iter().try_for_each(check_phase)?;
        let parts = [(TimeSetting::Step, self.step), (TimeSetting::Every, self.every)];
        parts.into_iter().try_for_each(|(which, value)| check_time(which, value))?;
        let extent = Extent::of(&self.phases);
        if extent.recorded == 0.0 {
            return Err(RunError::NoTime);
        }
        for (which, value) in parts {
            if value > extent.longest * (1.0 + SAME) {
                return Err(RunError::LongerThanRun { which, value, duration: extent.longest });
            }
        }
        self.tolerance.map_or(Ok(()), check_tolerance)?;
        self.check_size(extent)
    }

    /// Checks the number of steps and of recorded numbers.
    fn check_size(&self, extent: Extent) -> Result<(), RunError> {
        let steps = extent.operated / self.step;
        if self.tolerance.is_none() && steps > MAX_STEPS {
            return Err(RunError::TooManySteps { steps, most: MAX_STEPS });
        }
        let numbers = self.numbers();
        if numbers > MAX_NUMBERS {
            return Err(RunError::TooManyNumbers { numbers, most: MAX_NUMBERS });
        }
        Ok(())
    }

    /// The largest number of numbers that the run records.
    pub fn numbers(&self) -> f64 {
        let extent = Extent::of(&self.phases);
        // Every phase may write a sample at its beginning and one at its end.
        let rows = (extent.recorded / self.every).floor() + 2.0 * extent.phases;
        let marks = (extent.phases + extent.changes) * NUMBERS_PER_MARK;
        // Every phase may also begin a run.
        let tracks = self.record.len() * (1 + self.sensitivities.len());
        let courses = extent.phases * tracks as f64 * NUMBERS_PER_COURSE;
        rows * (tracks + 1) as f64 + marks + courses
    }
}

/// Checks that a tolerance is finite and at least [`LEAST_TOLERANCE`].
pub(super) fn check_tolerance(value: f64) -> Result<(), RunError> {
    let is_valid = value >= LEAST_TOLERANCE && value.is_finite();
    if is_valid { Ok(()) } else { Err(RunError::NotATolerance { value, least: LEAST_TOLERANCE }) }
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

/// A run takes at most this many steps, which are hours of work. More are a mistake in the settings.
pub(super) const MAX_STEPS: f64 = 1e10;
/// A run records at most this many numbers. They take 8 bytes each, and as much again while they are written.
const MAX_NUMBERS: f64 = 2e8;
/// The memory of the mark of a phase, and of every change in it, in numbers.
const NUMBERS_PER_MARK: f64 = 16.0;
/// The memory of the course of a signal in a run, in addition to its samples, in numbers.
const NUMBERS_PER_COURSE: f64 = 6.0;

/// Runs a program through its phases and records it.
///
/// # Errors
/// If the settings make no run, a signal is unknown, or the run has to stop. The error holds the record up to then.
pub fn run(program: &Program, settings: &RunSettings) -> Result<Trace, Stopped> {
    run_watched(program, settings, &mut |_| ())
}

/// Runs a program, and calls `progress` after every step or block of steps with the seconds recorded so far, summed
/// over all runs.
///
/// # Errors
/// As for [`run`].
pub fn run_watched(
    program: &Program,
    settings: &RunSettings,
    progress: &mut dyn FnMut(f64),
) -> Result<Trace, Stopped> {
    let mut player = ready(program, settings, progress)?;
    let outcome = player.run(&settings.phases);
    finished(player, outcome)
}

/// Runs several programs, each with the same result as [`run`], in their order. Programs that differ only in their
/// parameters take their steps together (with [`Backend::Lanes`] and [`Backend::Automatic`]).
pub fn run_abreast(programs: &[Program], settings: &RunSettings) -> Vec<Result<Trace, Stopped>> {
    if programs.len() < 2 || !programs.iter().all(|program| settings.go_abreast(program)) {
        return programs.iter().map(|program| run(program, settings)).collect();
    }
    programs.chunks(LANES).flat_map(|programs| run_batch(programs, settings)).collect()
}

/// Runs at most [`LANES`] programs as a batch.
fn run_batch(programs: &[Program], settings: &RunSettings) -> Vec<Result<Trace, Stopped>> {
    let mut progress = vec![|_: f64| (); programs.len()];
    let mut players = Vec::new();
    let pairs = programs.iter().zip(&mut progress);
    let begun = pairs
        .map(|(program, progress)| ready(program, settings, progress).map(|player| players.push(player)));
    let begun: Vec<Result<(), RunError>> = begun.collect();
    let mut batch = Batch::new(players, settings.backend);
    batch.run(&settings.phases);
    let mut ended = batch.into_players().map(|(player, outcome)| finished(player, outcome));
    let outcomes = begun.into_iter().filter_map(|begun| match begun {
        Ok(()) => ended.next(),
        Err(error) => Some(Err(error.into())),
    });
    outcomes.collect()
}

/// The result of a run from its player and its outcome.
fn finished(player: Player<'_, '_>, outcome: Result<(), RunError>) -> Result<Trace, Stopped> {
    let trace = player.finish();
    match outcome {
        Ok(()) => Ok(trace),
        Err(error) => Err(Stopped { error, trace: Box::new(trace) }),
    }
}

/// Runs a program up to a time by the recorder's clock, summed over all runs. Returns the machine and the time reached.
/// The time reached is earlier if the phases, or an overload, end the run before. `progress` is called as by
/// [`run_watched`].
///
/// # Errors
/// If the settings make no run, a signal is unknown, or the run has to stop.
pub fn machine_after<'p>(
    program: &'p Program,
    settings: &RunSettings,
    seconds: f64,
    progress: &mut dyn FnMut(f64),
) -> Result<(Machine<'p>, f64), RunError> {
    let mut player = ready(program, settings, progress)?.ending_at(seconds);
    player.run(&settings.phases)?;
    Ok(player.into_machine())
}

/// Checks that a run can begin, without running it.
///
/// # Errors
/// The errors of [`run`] that come before the first step.
pub fn check(program: &Program, settings: &RunSettings) -> Result<(), RunError> {
    ready(program, settings, &mut |_| ()).map(|_| ())
}

/// A machine in initial condition and its recorder, after all checks.
pub(super) fn ready<'p, 'w>(
    program: &'p Program,
    settings: &RunSettings,
    progress: &'w mut dyn FnMut(f64),
) -> Result<Player<'p, 'w>, RunError> {
    settings.check()?;
    player::check(program, &settings.phases)?;
    let mut machine = match settings.tolerance {
        Some(tolerance) => Machine::adaptive(program, tolerance / settings.duration(), settings.step)?,
        None => Machine::new(program, settings.step)?,
    };
    if !settings.sensitivities.is_empty() {
        machine.differentiate(&settings.sensitivities.iter().map(String::as_str).collect::<Vec<_>>())?;
    }
    let operated = Extent::of(&settings.phases).operated;
    check_noise(program, &machine.solver.state.level_sources, operated)?;
    let recorder = Recorder::new(program, &machine.solver, settings, progress)?;
    machine.fast_path.restart(settings.backend, recorder.registers());
    machine.lamps.is_on = settings.lamps || settings.hold_on_overload;
    Ok(Player::new(machine, recorder, operated))
}
