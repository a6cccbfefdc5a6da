//! Detection of events that come and go within one step, so that the end of the step does not show them.
//!
//! The voltages of guards and kinks are interpolated by the cubic through the checked stages and the ends of the tried
//! step, or by the parabola of an equal step. A voltage that turns just before its event may graze it, so the location
//! of events then tries a step to the turning point. Stages of adaptive steps, which are near the solution, may also
//! show an event themselves.

use super::buffers::StepBuffers;
use super::events::{event_at, open_transitions};
use super::state::{Setup, SolverState};
use crate::ir::{KINK_TOLERANCE, Kink};

/// Least distance from a corner, in volts, that a voltage must reach to be on one side of it.
const EXCURSION: f64 = 3.0 * KINK_TOLERANCE;

/// The share (0 ... 1) of the tried step at which an event may come and go: at a stage that shows one, or where a
/// watched voltage turns just before its event. `None` if there is no sign of such an event.
pub(super) fn hint(setup: &Setup<'_>, state: &SolverState, buffers: &StepBuffers) -> Option<f64> {
    let method = setup.method;
    let mut checked = method.checked_stages.iter().zip(&buffers.checked_voltages);
    let visible =
        checked
        .find(|(_, voltages)| setup.is_adaptive && event_at(setup, state, buffers, voltages).is_some());
    let share = visible.map(|(stage, _)| method.stages[*stage].node);
    share.or_else(|| grazing_time(setup, state, buffers))
}

/// The share (0 ... 1) of the tried step at which the first guard or kink turns just before its event; `None` if none
/// does.
fn grazing_time(setup: &Setup<'_>, state: &SolverState, buffers: &StepBuffers) -> Option<f64> {
    let ends = [&state.voltages, &buffers.voltages].map(Vec::as_slice);
    let guards = open_transitions(setup.program, &state.modes).filter_map(|open| {
        turn_towards(setup, buffers, ends, |voltages| open.guard.value(voltages), |_, to| to >= 0.0)
    });
    let kinks = setup.kinks().filter_map(|kink| {
        let reaches = |from, to| kink.crossed(&setup.program.tables, from, to).is_some();
        turn_towards(setup, buffers, ends, |voltages| kink.value(voltages), reaches)
    });
    guards.chain(kinks).reduce(f64::min)
}

/// Whether a voltage that begins the tried step on a corner, with the value `from`, goes to one side of it before it
/// reaches `to` on the other.
pub(super) fn turns_back(
    setup: &Setup<'_>,
    state: &SolverState,
    buffers: &StepBuffers,
    kink: &Kink,
    [from, to]: [f64; 2],
) -> bool {
    let ends = [&state.voltages, &buffers.voltages].map(Vec::as_slice);
    let least = if to > from { -EXCURSION } else { EXCURSION };
    let leaves = |turn: f64| (turn - from) / least > 1.0;
    let value = |voltages: &[f64]| kink.value(voltages);
    if setup.is_adaptive {
        buffers.samples(setup.method, ends, value).turning_points().any(|turn| leaves(turn.value))
    } else {
        buffers.parabola(ends, value).turning_point().is_some_and(|(_, turn)| leaves(turn))
    }
}

/// The share (0 ... 1) of the tried step at which a voltage turns, if a slightly larger swing would reach an event.
/// `ends` are all voltages at the ends of the step. `reaches` decides from the voltage at the beginning and the voltage
/// with margin at the turning point.
fn turn_towards(
    setup: &Setup<'_>,
    buffers: &StepBuffers,
    ends: [&[f64]; 2],
    voltage: impl Fn(&[f64]) -> f64,
    reaches: impl Fn(f64, f64) -> bool,
) -> Option<f64> {
    if !setup.is_adaptive {
        let curve = buffers.parabola(ends, voltage);
        let (share, value) = curve.turning_point()?;
        return reaches(curve.begin, value).then_some(share);
    }
    let samples = buffers.samples(setup.method, ends, voltage);
    let mut turns = samples.turning_points();
    turns.find(|turn| reaches(samples.values[0], samples.with_margin(turn))).map(|turn| turn.share)
}
