//! Runs that pass their samples on, and the comparison of a run with one of a shorter step.

use std::ops::ControlFlow;

use super::play;
use crate::ir::Program;
use crate::machines::REFERENCE;
use crate::solve::settings::RunSettings;
use crate::solve::settings_blocks::BLOCK_SAMPLES;
use crate::solve::step_check::StepDoubt;
use crate::solve::step_comparison::{SLIGHT_EXCESS, first_overload, step_warning};
use crate::solve::stopped_run::StoppedRunError;
use crate::solve::thinned_trace::ThinnedTrace;
use crate::trace::{StepWarning, Trace};

/// Number of steps after an overload within which a run with shorter steps has the same overload.
const STEPS_AFTER_OVERLOAD: f64 = 10.0;
/// Number of shorter steps up to the first overload that any run is compared with.
const STEPS_TO_OVERLOAD: f64 = 20_000.0;
/// Number of such steps as a share of the steps of the run, if that is more.
const SHARE_TO_OVERLOAD: f64 = 0.02;
/// Number of steps that the search for a recommended step takes.
const STEPS_FOR_ADVICE: f64 = 1e6;
/// Number of steps that this search takes in addition, as a multiple of the steps of the run.
const SHARE_FOR_ADVICE: f64 = 2.0;

/// Runs a program, and passes its samples to `consumer` in blocks if the settings have
/// [blocks](RunSettings::with_blocks). The memory of the run then does not grow with the number of samples.
///
/// `consumer` takes a trace with the samples of a block. If it returns [`ControlFlow::Break`], the run ends early, after
/// at most some steps, and the consumer takes no more samples. The result has no samples, but the extremes, repetitions
/// and phases of the whole run. Indices of samples count from the beginning of the run. `progress` is called as by
/// [`run_with_progress`](super::run_with_progress).
///
/// If checks of the steps compare the run with another one, they use a part of the samples of a long run.
///
/// # Errors
/// As for [`run`](super::run). The consumer has then taken the samples before the error.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
///
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run_in_blocks};
/// use patchcord_core::trace::Trace;
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?.with_blocks(400);
/// let mut blocks = Vec::new();
/// let mut take = |block: &Trace| {
///     blocks.push(block.len());
///     ControlFlow::Continue(())
/// };
/// let trace = run_in_blocks(&program, &settings, &mut |_| (), &mut take)?;
/// assert_eq!((blocks, trace.len()), (vec![400, 400, 201], 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_in_blocks(
    program: &Program,
    settings: &RunSettings,
    progress: &mut dyn FnMut(f64),
    consumer: &mut dyn FnMut(&Trace) -> ControlFlow<()>,
) -> Result<Trace, StoppedRunError> {
    let mut trace = run_checked(program, settings, progress, consumer)?;
    if let Some(warning) = &mut trace.step_warning {
        warning.recommended = passing_step(program, settings, warning.recommended);
    }
    Ok(trace)
}

/// Runs a program as [`run_in_blocks`] does, but does not check the step that the warning recommends.
///
/// # Errors
/// As for [`run_in_blocks`].
pub(super) fn run_checked(
    program: &Program,
    settings: &RunSettings,
    progress: &mut dyn FnMut(f64),
    consumer: &mut dyn FnMut(&Trace) -> ControlFlow<()>,
) -> Result<Trace, StoppedRunError> {
    let (mut selection, mut flow) = (ThinnedTrace::new(), ControlFlow::Continue(()));
    let mut take = |block: &Trace| {
        if settings.checks_steps {
            selection.add(block);
        }
        flow = consumer(block);
        flow
    };
    let (mut trace, doubt) = play(program, settings, progress, &mut take, f64::INFINITY)?;
    if !settings.checks_steps || flow.is_break() {
        return Ok(trace);
    }
    let Some((doubt, end)) = comparison(program, settings, &trace, doubt) else { return Ok(trace) };
    let shorter = doubt.compared_step(settings.step);
    copy_extremes(&mut selection.trace, &trace);
    selection.trace.repetitions.clone_from(&trace.repetitions);
    let compared = if settings.block_samples.is_some() { &selection.trace } else { &trace };
    let selected = selection.for_other_run(compared.len());
    let mut other_settings = RunSettings { step: shorter, ..settings.clone() };
    other_settings.record.extend(trace.overloads().next().map(|overload| overload.element.clone()));
    let other = other_trace(program, other_settings, (progress, end), selected);
    trace.step_warning = step_warning(program, doubt, settings.step, compared, &other);
    Ok(trace)
}

/// The doubt because of which a run is compared with another one, and the time in seconds, summed over all repetitions,
/// up to which. Without another doubt, a run is compared up to its first overload, because an unstable step may have
/// caused it. `None` if there is no reason, or if it would take too many steps.
fn comparison(
    program: &Program,
    settings: &RunSettings,
    trace: &Trace,
    doubt: Option<StepDoubt>,
) -> Option<(StepDoubt, f64)> {
    if doubt.is_some() || settings.tolerance.is_some() {
        return doubt.map(|doubt| (doubt, f64::INFINITY));
    }
    let (time, overload) = first_overload(trace)?;
    let is_slight = overload.peak().is_some_and(|peak| peak < REFERENCE + SLIGHT_EXCESS);
    let end = time + STEPS_AFTER_OVERLOAD * settings.step;
    let doubt = StepDoubt::of_overload(program.element(&overload.element)?, settings.step);
    let steps = end / doubt.compared_step(settings.step);
    let most = f64::max(STEPS_TO_OVERLOAD, SHARE_TO_OVERLOAD * settings.duration() / settings.step);
    (!is_slight && steps <= most).then_some((doubt, end))
}

/// The first step, beginning with `first`, whose run gets no warning, in problem seconds. If too many steps would be
/// needed to find out, it is the last step that was recommended. A run that records every step does so with the other
/// steps, too.
fn passing_step(program: &Program, settings: &RunSettings, first: f64) -> f64 {
    let mut settings = without_results(settings);
    let (duration, records_all) = (settings.duration(), settings.every == settings.step);
    let mut steps_left = STEPS_FOR_ADVICE + SHARE_FOR_ADVICE * duration / settings.step;
    settings.step = first;
    loop {
        settings.every = if records_all { settings.step } else { settings.every };
        steps_left -= duration / settings.step;
        if steps_left < 0.0 {
            return settings.step;
        }
        let checked = run_checked(program, &settings, &mut |_| (), &mut |_| ControlFlow::Continue(()));
        settings.step = match checked.map(|trace| trace.step_warning) {
            Ok(None) => return settings.step,
            Ok(Some(warning)) => {
                steps_left -= duration / warning.compared_step;
                next_step(&settings, &warning)
            }
            Err(_) => 0.5 * settings.step,
        };
    }
}

/// The step to try after a warning, in problem seconds.
pub(super) fn next_step(settings: &RunSettings, warning: &StepWarning) -> f64 {
    warning.recommended.min(0.5 * settings.step)
}

/// Settings of a run whose samples, curves, derivatives and peaks of amplifiers are not kept.
fn without_results(settings: &RunSettings) -> RunSettings {
    let block_samples = Some(BLOCK_SAMPLES);
    RunSettings {
        curves: Vec::new(),
        sensitivities: Vec::new(),
        block_samples,
        finds_amplifier_peaks: false,
        ..settings.clone()
    }
}

/// The samples, extremes and overloads of another run up to a time in seconds, or up to an error if there is one.
/// `selection` selects the samples.
fn other_trace(
    program: &Program,
    settings: RunSettings,
    (progress, end): (&mut dyn FnMut(f64), f64),
    mut selection: ThinnedTrace,
) -> Trace {
    let settings = RunSettings { checks_steps: false, ..without_results(&settings) };
    // The run before had no error. The samples before an error are compared, too.
    let mut take = |block: &Trace| {
        selection.add(block);
        ControlFlow::Continue(())
    };
    let played = play(program, &settings, progress, &mut take, end);
    let whole = played.map_or_else(|stopped| *stopped.trace, |(trace, _)| trace);
    copy_extremes(&mut selection.trace, &whole);
    selection.trace.repetitions = whole.repetitions;
    selection.trace
}

/// Copies the extremes of a whole run to the tracks that have some of its samples.
fn copy_extremes(samples: &mut Trace, whole: &Trace) {
    for (track, whole) in samples.tracks.iter_mut().zip(&whole.tracks) {
        track.extremes.clone_from(&whole.extremes);
    }
}
