//! A complete run: preparation, the phases, and the record.
//!
//! [`prepare`] checks everything and makes a machine with its recorder. A [`Player`] then plays the phases, and the
//! recorder returns the trace. Programs that differ only in their parameters can run together as a [`Batch`], with the
//! same results to the bit.

mod in_blocks;

pub use in_blocks::run_in_blocks;
use in_blocks::{next_step, run_checked};

use std::ops::ControlFlow;

use super::amplifier_peaks::AmplifierPeaks;
use super::batch::Batch;
use super::error::RunError;
use super::levels::check_step_count;
use super::machine::Machine;
use super::player::{self, Player};
use super::recorder::Recorder;
use super::settings::RunSettings;
use super::settings_blocks::BLOCK_SAMPLES;
use super::step_check::{StepCheck, StepDoubt};
use super::stopped_run::StoppedRunError;
use crate::document::RunExtent;
use crate::ir::Program;
use crate::kernel::LANES;
use crate::trace::Trace;

/// Number of attempts with shorter steps after which an error that stops the run is not blamed on the step.
const MAX_STOPPED_ATTEMPTS: usize = 4;

/// Runs a program through its phases and records it.
///
/// # Errors
/// If the settings are invalid ([`RunSettings::check`]), a name is unknown, or the run has to stop. The error contains
/// the record up to then.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let trace = run(&program, &RunSettings::of(&circuit)?)?;
/// let last = trace.values("A1").and_then(|values| values.last().copied()).ok_or("A1 is not recorded")?;
/// assert!((last - 50.0 * (-1.0f64).exp()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run(program: &Program, settings: &RunSettings) -> Result<Trace, StoppedRunError> {
    run_with_progress(program, settings, &mut |_| ())
}

/// Runs a program, and calls `progress` after every step or block of steps with the seconds recorded so far, summed
/// over all repetitions. [`RunSettings::total_duration`] is the largest value. If checks of the steps repeat the run, the
/// seconds count from 0 again.
///
/// # Errors
/// As for [`run`].
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run_with_progress};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?;
/// let mut seconds = 0.0;
/// run_with_progress(&program, &settings, &mut |recorded| seconds = recorded)?;
/// assert!(seconds > 0.0 && seconds <= settings.total_duration() + 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_with_progress(
    program: &Program,
    settings: &RunSettings,
    progress: &mut dyn FnMut(f64),
) -> Result<Trace, StoppedRunError> {
    run_in_blocks(program, settings, progress, &mut |_| ControlFlow::Continue(()))
}

/// Plays all phases of a run up to a time in seconds, summed over all repetitions. Returns the trace, and the doubt about
/// the steps if they were checked.
///
/// # Errors
/// As for [`run`].
fn play<'w>(
    program: &Program,
    settings: &RunSettings,
    progress: &'w mut dyn FnMut(f64),
    consumer: &'w mut dyn FnMut(&Trace) -> ControlFlow<()>,
    end: f64,
) -> Result<(Trace, Option<StepDoubt>), StoppedRunError> {
    let mut player = prepare(program, settings, progress)?.with_end(end);
    player.recorder.consumer = Some(consumer);
    let outcome = player.run(&settings.phases);
    result_of(player, outcome)
}

/// Runs several programs and returns their results in the same order. Each result is the same, to the bit, as that of
/// [`run`]. Programs that differ only in their parameters take their steps together, up to [`LANES`] at a time, if
/// [`RunSettings::is_batchable`].
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run, run_batch};
///
/// // dx/dt = -k x, from 50 V
/// # let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
/// # let decay = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
/// # let patch = PatchBuilder::new("dx/dt = -k x").parameter("k", 0.5, "1", [0.0, 1.0]);
/// # let patch = patch.element("A1", decay).element("P1", pot).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let mut programs = vec![program; 3];
/// for (program, k) in programs.iter_mut().zip([0.1, 0.2, 0.4]) {
///     program.set_parameters([("k", k)])?;
/// }
/// let settings = RunSettings::of(&circuit)?;
/// for (program, trace) in programs.iter().zip(run_batch(&programs, &settings)) {
///     assert_eq!(trace?.values("A1"), run(program, &settings)?.values("A1"));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_batch(programs: &[Program], settings: &RunSettings) -> Vec<Result<Trace, StoppedRunError>> {
    if programs.len() < 2 || !programs.iter().all(|program| settings.is_batchable(program)) {
        return programs.iter().map(|program| run(program, settings)).collect();
    }
    programs.chunks(LANES).flat_map(|programs| run_chunk(programs, settings)).collect()
}

/// Runs at most [`LANES`] programs as a batch. The results are in the order of the programs; those that could not begin
/// are not members of the batch.
fn run_chunk(programs: &[Program], settings: &RunSettings) -> Vec<Result<Trace, StoppedRunError>> {
    let mut progress = vec![|_: f64| (); programs.len()];
    let mut players = Vec::new();
    let pairs = programs.iter().zip(&mut progress);
    let preparations = pairs
        .map(|(program, progress)| prepare(program, settings, progress).map(|player| players.push(player)));
    let preparations: Vec<Result<(), RunError>> = preparations.collect();
    let mut batch = Batch::new(players, settings.backend);
    batch.run(&settings.phases);
    let mut results =
        batch.into_players().map(|(player, outcome)| result_of(player, outcome).map(|(trace, _)| trace));
    let outcomes = preparations.into_iter().filter_map(|preparation| match preparation {
        Ok(()) => results.next(),
        Err(error) => Some(Err(error.into())),
    });
    outcomes.collect()
}

/// The result of a run: the trace and the doubt about its steps, or the error with the trace up to it.
fn result_of(
    player: Player<'_, '_>,
    outcome: Result<(), RunError>,
) -> Result<(Trace, Option<StepDoubt>), StoppedRunError> {
    let (trace, doubt) = player.finish();
    match outcome {
        Ok(()) => Ok((trace, doubt)),
        Err(error) => Err(StoppedRunError { error, trace: Box::new(trace) }),
    }
}

/// Runs a program up to a time by the recorder's clock, in seconds summed over all repetitions. Returns the machine and
/// the time reached, which is earlier if the phases or an overload end the run before. `progress` is called as by
/// [`run_with_progress`].
///
/// # Errors
/// If the settings are invalid, a name is unknown, or the run has to stop.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, machine_after};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?;
/// let (machine, reached) = machine_after(&program, &settings, 0.5, &mut |_| ())?;
/// assert!((reached - 0.5).abs() < 1e-9);
/// assert!((machine.voltage("A1")? - 50.0 * (-0.5f64).exp()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn machine_after<'p>(
    program: &'p Program,
    settings: &RunSettings,
    seconds: f64,
    progress: &mut dyn FnMut(f64),
) -> Result<(Machine<'p>, f64), RunError> {
    let mut player = prepare(program, settings, progress)?.with_end(seconds);
    player.run(&settings.phases)?;
    Ok(player.into_machine())
}

/// A step with which a run of equal steps is not warned of: the step of the settings, or a shorter one that earlier
/// runs recommended. The parameters are those of the program. The runs do not keep their samples.
///
/// # Errors
/// If the run stops with the step of the settings and with much shorter ones, with an error that does not depend on the
/// step, or if no step is short enough.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, sufficient_step};
///
/// // dx/dt = -1000 x, from 50 V: steps of 3 ms are too long.
/// let decay = ElementBuilder::new("integrator").cords("x1000", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(0.1, 3e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// assert!(sufficient_step(&program, &RunSettings::of(&circuit)?)? <= 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sufficient_step(program: &Program, settings: &RunSettings) -> Result<f64, RunError> {
    let settings = settings.clone().with_step(settings.step).with_step_checks();
    let mut settings = settings.with_blocks(BLOCK_SAMPLES);
    for attempt in 1.. {
        let checked = run_checked(program, &settings, &mut |_| (), &mut |_| ControlFlow::Continue(()));
        let shorter = match checked {
            Ok(trace) => {
                let Some(warning) = trace.step_warning else { break };
                next_step(&settings, &warning)
            }
            Err(stopped) if attempt >= MAX_STOPPED_ATTEMPTS || !stopped.error.may_depend_on_step() => {
                return Err(stopped.error);
            }
            Err(_) => 0.1 * settings.step,
        };
        settings.step = shorter;
    }
    Ok(settings.step)
}

/// Checks that a run can begin, without running it.
///
/// # Errors
/// The errors of [`run`] that come before the first step.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, check};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?;
/// assert!(check(&program, &settings).is_ok());
/// let error = check(&program, &settings.with_signals(["x"])).unwrap_err();
/// assert_eq!(error.code(), "unknown-signal");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn check(program: &Program, settings: &RunSettings) -> Result<(), RunError> {
    prepare(program, settings, &mut |_| ()).map(|_| ())
}

/// Makes a player with a machine in initial condition and its recorder. The tolerance of the run is divided by its
/// duration, because the machine takes it per problem second. Its range is that of the number before the division.
///
/// # Errors
/// The errors of [`run`] that come before the first step.
pub(super) fn prepare<'p, 'w>(
    program: &'p Program,
    settings: &RunSettings,
    progress: &'w mut dyn FnMut(f64),
) -> Result<Player<'p, 'w>, RunError> {
    prepare_player(program, settings, Some(progress))
}

/// The same with a progress that need not be reported.
///
/// # Errors
/// The errors of [`run`] that come before the first step.
pub(super) fn prepare_player<'p, 'w>(
    program: &'p Program,
    settings: &RunSettings,
    progress: Option<&'w mut dyn FnMut(f64)>,
) -> Result<Player<'p, 'w>, RunError> {
    settings.check()?;
    player::check(program, &settings.phases)?;
    let mut machine = match settings.tolerance {
        Some(tolerance) => Machine::with_error_rate(program, tolerance / settings.duration(), settings.step)?,
        None => Machine::new(program, settings.step)?,
    };
    machine.max_steps = settings.max_steps;
    if !settings.sensitivities.is_empty() {
        machine.differentiate(&settings.sensitivities)?;
    }
    let operated = RunExtent::of(&settings.phases).operate_time;
    let equal_steps = machine.equal_steps_in(operated);
    check_step_count(program, &machine.solver.state.level_sources, operated, equal_steps, machine.max_steps)?;
    let recorder = Recorder::new(program, &machine.solver, settings, progress)?;
    machine.fast_path.restart(settings.backend, recorder.registers());
    if settings.checks_steps && settings.tolerance.is_none() {
        machine.step_check = Some(StepCheck::new(program.lowered.states.len(), equal_steps.round() as u64));
    }
    if settings.finds_amplifier_peaks {
        machine.amplifier_peaks = Some(AmplifierPeaks::new(program, equal_steps.round() as u64));
    }
    machine.lamps.is_on = settings.has_lamps || settings.hold_on_overload;
    Ok(Player::new(machine, recorder, operated))
}
