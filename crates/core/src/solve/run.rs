//! A whole run: how to run, whether it can be done, and its record.

use super::convoy::Convoy;
use super::error::{RunError, Stopped, TimeSetting};
use super::glide::Glider;
use super::machine::Machine;
use super::player::{self, Player};
use super::recorder::Recorder;
use crate::document::{Extent, LEAST_TOLERANCE, Phase};
use crate::grid::SAME;
use crate::ir::Program;
use crate::kernel::{Backend, Kernel, LANES};
use crate::trace::Trace;

/// How to run. Times are in problem seconds.
#[derive(Debug, Clone, PartialEq)]
pub struct RunSettings {
    /// What is done, one after the other; it begins in initial condition whether it says so or not.
    pub phases: Vec<Phase>,
    /// Step of the solver, above 0. Shorter is more accurate (order 4 where the circuit is smooth) and slower.
    pub step: f64,
    /// With one, steps are as long as it allows, and `step` is the first one tried: what the errors of the steps from
    /// one initial condition to the next may add up to in any state, in machine units of 100 V, [`LEAST_TOLERANCE`] or
    /// more. Where motion amplifies errors, as stick-slip does, the result is less right than that.
    pub tolerance: Option<f64>,
    /// Time between recorded samples, above 0. Recording never changes the steps.
    pub every: f64,
    /// Whether the machine goes into hold as soon as a lamp lights. What takes time is then passed over until the
    /// next initial condition.
    pub hold_on_overload: bool,
    /// Whether overload lamps light; they do in any case where they hold the machine. Where not, the trace tells of no
    /// overload, and runs beyond ±100 V are quicker.
    pub lamps: bool,
    /// Names of the signals to record, in order.
    pub record: Vec<String>,
    /// Names of the parameters by which the derivatives of all these signals are recorded as well.
    pub sensitivities: Vec<String>,
    /// What works the steps out. Runs with a tolerance or derivatives, and programs with loops, are worked out by the
    /// reference whatever it says.
    pub backend: Backend,
}

impl RunSettings {
    /// The same for one initial condition and this long operating.
    pub fn lasting(self, duration: f64) -> Self {
        RunSettings { phases: vec![Phase::InitialCondition, Phase::operate(duration)], ..self }
    }

    /// The same, so many times (repetitive operation).
    pub fn repeated(self, times: u64) -> Self {
        RunSettings { phases: vec![Phase::Repeat { times, phases: self.phases }], ..self }
    }

    /// Seconds between two initial conditions, or from one to the end of the run, at most.
    pub fn duration(&self) -> f64 {
        Extent::of(&self.phases).longest
    }

    /// Seconds of the whole run by the recorder's clock, at most.
    pub fn whole(&self) -> f64 {
        Extent::of(&self.phases).recorded
    }

    /// Whether runs of a program with these settings gain by being made side by side.
    pub fn go_abreast(&self, program: &Program) -> bool {
        let are_equal = self.tolerance.is_none() && self.sensitivities.is_empty();
        are_equal && self.backend.goes_abreast() && Kernel::can_be_of(program)
    }

    /// Whether a run can be made of the settings.
    ///
    /// # Errors
    /// When a time is none, the step or the time between samples is longer than the run, nothing takes time or
    /// is repeated, or the run would take more steps or more memory than can be had.
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

    fn check_size(&self, extent: Extent) -> Result<(), RunError> {
        let steps = extent.operated / self.step;
        if self.tolerance.is_none() && steps > MOST_STEPS {
            return Err(RunError::TooManySteps { steps, most: MOST_STEPS });
        }
        let numbers = self.numbers();
        if numbers > MOST_NUMBERS {
            return Err(RunError::TooManyNumbers { numbers, most: MOST_NUMBERS });
        }
        Ok(())
    }

    /// How many numbers are recorded, at most.
    pub fn numbers(&self) -> f64 {
        let extent = Extent::of(&self.phases);
        // Every phase may write a sample where it begins, and one where it ends.
        let rows = (extent.recorded / self.every).floor() + 2.0 * extent.phases;
        let marks = (extent.phases + extent.changes) * NUMBERS_OF_A_MARK;
        // Every phase may begin a run, too.
        let tracks = self.record.len() * (1 + self.sensitivities.len());
        let courses = extent.phases * tracks as f64 * NUMBERS_OF_A_COURSE;
        rows * (tracks + 1) as f64 + marks + courses
    }
}

pub(super) fn check_tolerance(value: f64) -> Result<(), RunError> {
    let is_one = value >= LEAST_TOLERANCE && value.is_finite();
    if is_one { Ok(()) } else { Err(RunError::NotATolerance { value, least: LEAST_TOLERANCE }) }
}

fn check_time(which: TimeSetting, value: f64) -> Result<(), RunError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(RunError::NotATime { which, value }) }
}

fn check_phase(phase: &Phase) -> Result<(), RunError> {
    match phase {
        Phase::Operate { time, .. } => check_time(TimeSetting::Duration, *time),
        Phase::Hold { time } => check_time(TimeSetting::Hold, *time),
        Phase::Repeat { times, phases } if *times == 0 || phases.is_empty() => Err(RunError::EmptyRepeat),
        Phase::Repeat { phases, .. } => phases.iter().try_for_each(check_phase),
        Phase::InitialCondition | Phase::Set { .. } => Ok(()),
    }
}

/// More steps than this, hours of work, are a slip of the pen.
pub(super) const MOST_STEPS: f64 = 1e10;
/// The numbers of a trace take 8 bytes each, and as much again while they are written.
const MOST_NUMBERS: f64 = 2e8;
/// The room that the mark of a phase takes, in numbers, and every change in it.
const NUMBERS_OF_A_MARK: f64 = 16.0;
/// What is kept of every run beside the samples of a signal.
const NUMBERS_OF_A_COURSE: f64 = 6.0;

/// Runs a program through its phases and records it.
///
/// # Errors
/// When the settings make no run, a signal is not known, or the run had to stop; what was recorded until
/// then comes with the error.
pub fn run(program: &Program, settings: &RunSettings) -> Result<Trace, Stopped> {
    run_watched(program, settings, &mut |_| ())
}

/// The same, telling after every step how many seconds have been recorded, all runs added up.
///
/// # Errors
/// Those of [`run`].
pub fn run_watched(
    program: &Program,
    settings: &RunSettings,
    progress: &mut dyn FnMut(f64),
) -> Result<Trace, Stopped> {
    let mut player = ready(program, settings, progress)?;
    let outcome = player.run(&settings.phases);
    told(player, outcome)
}

/// Runs programs side by side, each as [`run`] would; those that differ in their parameters alone take their quiet steps
/// together (with [`Backend::Lanes`] and [`Backend::Automatic`]).
pub fn run_abreast(programs: &[Program], settings: &RunSettings) -> Vec<Result<Trace, Stopped>> {
    if programs.len() < 2 || !programs.iter().all(|program| settings.go_abreast(program)) {
        return programs.iter().map(|program| run(program, settings)).collect();
    }
    programs.chunks(LANES).flat_map(|programs| in_convoy(programs, settings)).collect()
}

fn in_convoy(programs: &[Program], settings: &RunSettings) -> Vec<Result<Trace, Stopped>> {
    let mut progress = vec![|_: f64| (); programs.len()];
    let mut players = Vec::new();
    let pairs = programs.iter().zip(&mut progress);
    let begun = pairs
        .map(|(program, progress)| ready(program, settings, progress).map(|player| players.push(player)));
    let begun: Vec<Result<(), RunError>> = begun.collect();
    let mut convoy = Convoy::new(players, settings.backend);
    convoy.run(&settings.phases);
    let mut ended = convoy.into_players().map(|(player, outcome)| told(player, outcome));
    let outcomes = begun.into_iter().filter_map(|begun| match begun {
        Ok(()) => ended.next(),
        Err(error) => Some(Err(error.into())),
    });
    outcomes.collect()
}

/// What came of a run.
fn told(player: Player<'_, '_>, outcome: Result<(), RunError>) -> Result<Trace, Stopped> {
    let trace = player.finish();
    match outcome {
        Ok(()) => Ok(trace),
        Err(error) => Err(Stopped { error, trace: Box::new(trace) }),
    }
}

/// The machine within a run, after so many seconds by the recorder's clock, all runs added up; and by this clock
/// the instant reached, which comes earlier where the phases, or an overload, end the run before. Progress is told
/// like in [`run_watched`].
///
/// # Errors
/// When the settings make no run, a signal is not known, or the run had to stop.
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

/// Whether a run can begin: all that can be told without running it.
///
/// # Errors
/// Those of [`run`] for which no step is taken.
pub fn check(program: &Program, settings: &RunSettings) -> Result<(), RunError> {
    ready(program, settings, &mut |_| ()).map(|_| ())
}

/// A machine and its recorder, everything checked.
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
    machine.check_noise(operated)?;
    let recorder = Recorder::new(program, &machine, settings, progress)?;
    machine.glider = Glider::new(settings.backend, recorder.registers());
    machine.has_lamps = settings.lamps || settings.hold_on_overload;
    Ok(Player::new(machine, recorder, operated))
}
