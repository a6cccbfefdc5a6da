//! Runs that pass their samples on, and the comparison of a run with one of a shorter step.

use std::ops::ControlFlow;

use super::play;
use crate::ir::Program;
use crate::solve::settings::RunSettings;
use crate::solve::settings_blocks::BLOCK_SAMPLES;
use crate::solve::step_comparison::step_warning;
use crate::solve::stopped_run::StoppedRunError;
use crate::solve::thinned_trace::ThinnedTrace;
use crate::trace::Trace;

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
    let (mut selection, mut flow) = (ThinnedTrace::new(), ControlFlow::Continue(()));
    let mut take = |block: &Trace| {
        if settings.checks_steps {
            selection.add(block);
        }
        flow = consumer(block);
        flow
    };
    let (mut trace, doubt) = play(program, settings, progress, &mut take)?;
    if let Some(doubt) = doubt.filter(|_| flow.is_continue()) {
        let shorter = doubt.compared_step(settings.step);
        copy_extremes(&mut selection.trace, &trace);
        let compared = if settings.block_samples.is_some() { &selection.trace } else { &trace };
        let selected = selection.for_other_run(compared.len());
        let other = with_step(program, settings, shorter, progress, selected);
        trace.step_warning = step_warning(program, doubt, settings.step, compared, &other);
    }
    Ok(trace)
}

/// The samples and extremes of a run with another step in problem seconds, up to an error if there is one. `selection` selects them.
fn with_step(
    program: &Program,
    settings: &RunSettings,
    step: f64,
    progress: &mut dyn FnMut(f64),
    mut selection: ThinnedTrace,
) -> Trace {
    let mut settings = RunSettings { checks_steps: false, step, ..settings.clone() };
    settings.sensitivities.clear();
    settings.block_samples = Some(BLOCK_SAMPLES);
    // The run before had no error. The samples before an error are compared, too.
    let mut take = |block: &Trace| {
        selection.add(block);
        ControlFlow::Continue(())
    };
    let played = play(program, &settings, progress, &mut take);
    let whole = played.map_or_else(|stopped| *stopped.trace, |(trace, _)| trace);
    copy_extremes(&mut selection.trace, &whole);
    selection.trace
}

/// Copies the extremes of a whole run to the tracks that have some of its samples.
fn copy_extremes(samples: &mut Trace, whole: &Trace) {
    for (track, whole) in samples.tracks.iter_mut().zip(&whole.tracks) {
        track.extremes.clone_from(&whole.extremes);
    }
}
