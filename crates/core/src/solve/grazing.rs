//! Detection of events that come and go within one step, so that the end of the step does not show them.
//!
//! The voltages of guards and kinks are interpolated by the cubic through the checked stages and the ends of the tried
//! step, or by the parabola of an equal step. A voltage that turns just before its event may graze it, so the location
//! of events then tries a step to the turning point. In adaptive steps, the turning point is first improved on the curve
//! of the states, because a short pulse is near it only. Stages of adaptive steps, which are near the solution, may also
//! show an event themselves.

use super::buffers::StepBuffers;
use super::dense_output::Curve;
use super::evaluate::{Scope, trial};
use super::events::{event_at, open_transitions};
use super::minimum_search::MinimumSearch;
use super::runge_kutta::largest_error;
use super::state::{Setup, SolverState};
use super::turning_points::TurningPoint;
use crate::delay_line::DelayLine;
use crate::ir::{Guard, KINK_TOLERANCE, Kink};
use crate::machines::REFERENCE;

/// Least distance from a corner, in volts, that a voltage must reach to be on one side of it.
const EXCURSION: f64 = 3.0 * KINK_TOLERANCE;
/// Margin for the error of the curve of the states, as a multiple of the estimated error of the step.
const ERROR_MARGIN: f64 = 10.0;
/// Margin for the position of a turning point on the curve, as a share of the swing of the samples.
const SWING_MARGIN: f64 = 1e-7;

/// A sign of an event within a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hint {
    /// The share (0 ... 1) of the step at which the event may be.
    pub share: f64,
    /// Whether the curve of the states surely reaches the event there.
    pub is_certain: bool,
}

/// A voltage with an event that may come and go.
#[derive(Debug, Clone, Copy)]
enum Watched<'k> {
    /// The voltage of a guard, whose event is at 0.
    Guard(Guard),
    /// The voltage of a kink.
    Kink(&'k Kink),
}

impl Watched<'_> {
    /// The voltage among all voltages.
    fn value(self, voltages: &[f64]) -> f64 {
        match self {
            Watched::Guard(guard) => guard.value(voltages),
            Watched::Kink(kink) => kink.value(voltages),
        }
    }

    /// Whether the event is between the voltage at the beginning of a step and this one.
    fn reaches(self, setup: &Setup<'_>, from: f64, to: f64) -> bool {
        match self {
            Watched::Guard(_) => to >= 0.0,
            Watched::Kink(kink) => kink.crossed(&setup.program.tables, from, to).is_some(),
        }
    }
}

/// All watched voltages: those of the guards that are possible from the present modes, then those of the kinks.
fn all_watched<'a>(setup: &'a Setup<'_>, state: &'a SolverState) -> impl Iterator<Item = Watched<'a>> {
    let guards = open_transitions(setup.program, &state.modes).map(|open| Watched::Guard(open.guard));
    guards.chain(setup.kinks().map(Watched::Kink))
}

/// The hint of an event that may come and go within the tried step of this length in problem seconds: at a stage that
/// shows one, or where a watched voltage turns just before its event. `None` if there is no sign of such an event.
pub(super) fn hint(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    length: f64,
) -> Option<Hint> {
    let uncertain = |share| Hint { share, is_certain: false };
    let mut watched = all_watched(setup, state);
    if !setup.is_adaptive {
        let ends = [&state.voltages, &buffers.voltages].map(Vec::as_slice);
        let shares = watched.filter_map(|watched| {
            let curve = buffers.parabola(ends, |voltages| watched.value(voltages));
            let (share, value) = curve.turning_point()?;
            watched.reaches(setup, curve.begin, value).then_some(share)
        });
        return shares.reduce(f64::min).map(uncertain);
    }
    let mut checked = setup.method.checked_stages.iter().zip(&buffers.checked_voltages);
    let visible = checked.find(|(_, voltages)| event_at(setup, state, buffers, voltages).is_some());
    let visible = visible.map(|(stage, _)| uncertain(setup.method.stages[*stage].node));
    if visible.is_some() || !watched.any(|watched| turn_towards(setup, state, buffers, watched).is_some()) {
        return visible;
    }
    first_turn(setup, state, delay_lines, buffers, length)
}

/// The turning point of a watched voltage in an adaptive step, if a slightly larger swing would reach its event. The
/// samples are those of the tried step.
fn turn_towards(
    setup: &Setup<'_>,
    state: &SolverState,
    buffers: &StepBuffers,
    watched: Watched<'_>,
) -> Option<(TurningPoint, f64)> {
    let ends = [&state.voltages, &buffers.voltages].map(Vec::as_slice);
    let samples = buffers.samples(setup.method, ends, |voltages| watched.value(voltages));
    let turn = samples
        .turning_points()
        .find(|turn| watched.reaches(setup, samples.values[0], samples.with_margin(turn)))?;
    Some((turn, samples.swing()))
}

/// The hint of the first watched voltage that reaches its event near a turning point in the tried adaptive step. The
/// states and voltages in the buffers are those of the end of the step again afterwards.
fn first_turn(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    length: f64,
) -> Option<Hint> {
    let (_, error) = largest_error(setup.method, &buffers.stage_rates, state.states.len(), length);
    let faults = buffers.evaluation.faults.len();
    buffers.end_states.copy_from_slice(&buffers.states);
    buffers.end_voltages.copy_from_slice(&buffers.voltages);
    let mut first = None;
    for watched in all_watched(setup, state) {
        let Some((turn, swing)) = turn_towards(setup, state, buffers, watched) else { continue };
        let margin = ERROR_MARGIN * error * REFERENCE + SWING_MARGIN * swing;
        let hint = refined(setup, state, delay_lines, buffers, (length, watched), (turn, margin));
        first = hint.into_iter().chain(first).min_by(|a, b| a.share.total_cmp(&b.share));
        buffers.voltages.copy_from_slice(&buffers.end_voltages);
    }
    buffers.states.copy_from_slice(&buffers.end_states);
    buffers.evaluation.faults.truncate(faults);
    first
}

/// The hint where a watched voltage on the curve of the states reaches its event near a turning point; `None` if it does
/// not, with this margin in volts.
fn refined(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    (length, watched): (f64, Watched<'_>),
    (turn, margin): (TurningPoint, f64),
) -> Option<Hint> {
    let begin = watched.value(&state.voltages);
    // The search looks for a minimum.
    let sign = if turn.is_peak { -1.0 } else { 1.0 };
    let mut evaluate = |share: f64| {
        let curve = Curve::new(setup.method, length, share);
        for index in 0..state.states.len() {
            let ends = [state.states[index], buffers.end_states[index]];
            buffers.states[index] = curve.value(ends, &buffers.stage_rates, index);
        }
        trial(setup.program, state, delay_lines, buffers, state.time + share * length, Scope::Checked);
        buffers.hint_evaluations += 1;
        sign * watched.value(&buffers.voltages)
    };
    let mut search = MinimumSearch::around(turn.share, evaluate(turn.share));
    let reaches = |value: f64| watched.reaches(setup, begin, sign * value);
    while !reaches(search.best.1 + margin)
        && let Some(share) = search.next()
    {
        search.add(share, evaluate(share));
    }
    let (share, value) = search.best;
    reaches(value - margin).then(|| Hint { share, is_certain: reaches(value + margin) })
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
