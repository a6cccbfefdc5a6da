//! Turning points that a sampled value must not miss, such as those of the input of a backlash.
//!
//! The sampled value of a backlash follows its input while the input pushes it. If the input turned within a step, the
//! sample at the end of the step would fall short of the turning point. So the step ends there. The turning point is
//! that of the cubic through the values and slopes of the input at both ends of the tried step. A shorter step is then
//! tried, until its end is so close to the turning point that the rest does not matter.

use super::buffers::StepBuffers;
use super::evaluate::{Scope, trial};
use super::machine::Machine;
use super::state::{Setup, Solver, SolverState};
use crate::delay_line::DelayLine;
use crate::multiply_add::multiply_add;

/// Distance from the ends of a step at which the slopes are measured, as a share of the step. It is large enough for the
/// rounding of the voltages to change no turning point by more than [`SHORTFALL`].
const SLOPE_DISTANCE: f64 = 1e-3;
/// Largest ratio of a corrected length to the length before.
const MAX_CORRECTION: f64 = 1.1;
/// Shortfall of a turning point that does not matter, in volts.
const SHORTFALL: f64 = 1e-10;

impl Machine<'_> {
    /// The length in problem seconds of a step that ends where the input of a sampled value turns, if that is within the
    /// tried step; `None` if no such input turns there. With `is_refined` the tried step was such a length, which is
    /// corrected, also beyond its end.
    pub(super) fn length_to_turn(&mut self, length: f64, is_refined: bool) -> Option<f64> {
        let Solver { setup, state, delay_lines, buffers, .. } = &mut self.solver;
        let has_turns = setup.program.lowered.sampled.iter().any(|sampled| sampled.follows.is_some());
        self.work.evaluations += if has_turns { 2 } else { 0 };
        length_to_turn(setup, state, delay_lines, buffers, (length, is_refined))
    }
}

/// The same for a state that need not be the one of a machine.
pub(super) fn length_to_turn(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    (length, is_refined): (f64, bool),
) -> Option<f64> {
    let sampled = &setup.program.lowered.sampled;
    if sampled.iter().all(|sampled| sampled.follows.is_none()) {
        return None;
    }
    evaluate_near_ends(setup, state, delay_lines, buffers, length);
    let shares = sampled.iter().filter_map(|sampled| {
        let (input, next) = (sampled.follows?.index(), sampled.next.index());
        let [near_begin, near_end] = buffers.near_ends.each_ref().map(|voltages| voltages[input]);
        let is_pushed = buffers.near_ends[0][next] != state.voltages[next];
        let [begin, end] = [state.voltages[input], buffers.voltages[input]];
        let slopes = slopes_at_ends([near_begin - begin, end - near_end]);
        let limit = if is_refined { MAX_CORRECTION } else { 1.0 };
        turning_share([begin, end], slopes, limit).filter(|_| is_pushed)
    });
    let to_turn = shares.reduce(f64::min)? * length;
    // The step must not vanish in the rounding of time.
    (state.time + to_turn > state.time).then_some(to_turn)
}

/// Evaluates the voltages of events near both ends of the tried step.
fn evaluate_near_ends(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    length: f64,
) {
    let (distance, last) = (SLOPE_DISTANCE * length, buffers.stage_rates.len() - 1);
    buffers.end_states.copy_from_slice(&buffers.states);
    advance(&mut buffers.states, &state.states, &state.rates, distance);
    evaluate_near(setup, state, delay_lines, buffers, (0, state.time + distance));
    advance(&mut buffers.states, &buffers.end_states, &buffers.stage_rates[last], -distance);
    evaluate_near(setup, state, delay_lines, buffers, (1, state.time + length - distance));
    buffers.states.copy_from_slice(&buffers.end_states);
}

/// Moves states by a time in problem seconds, in proportion to their rates.
fn advance(into: &mut [f64], states: &[f64], rates: &[f64], time: f64) {
    for ((moved, volts), rate) in into.iter_mut().zip(states).zip(rates) {
        *moved = multiply_add(*rate, time, *volts);
    }
}

/// Evaluates the voltages of events for the states in the buffers at a problem time, near one end of the tried step. The
/// voltages at its end stay in the buffers, and a loop that has no solution there is no fault of the step.
fn evaluate_near(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    (side, time): (usize, f64),
) {
    let faults = buffers.evaluation.faults.len();
    buffers.near_ends[side].copy_from_slice(&state.voltages);
    std::mem::swap(&mut buffers.voltages, &mut buffers.near_ends[side]);
    trial(setup.program, state, delay_lines, buffers, time, Scope::Checked);
    std::mem::swap(&mut buffers.voltages, &mut buffers.near_ends[side]);
    buffers.evaluation.faults.truncate(faults);
}

/// The slopes at both ends of a step, in volts per step, from the changes over [`SLOPE_DISTANCE`] next to each end. The
/// changes give the slopes in the middles of these distances.
fn slopes_at_ends(changes: [f64; 2]) -> [f64; 2] {
    let [first, last] = changes.map(|change| change / SLOPE_DISTANCE);
    let correction = 0.5 * SLOPE_DISTANCE * (last - first);
    [first - correction, last + correction]
}

/// The share of a step, below `limit`, at which the cubic with these values and slopes at its ends turns first. The
/// slopes are in volts per step. `None` if it does not turn, or if the turning point hardly differs from an end.
fn turning_share([begin, end]: [f64; 2], [first, last]: [f64; 2], limit: f64) -> Option<f64> {
    let rise = end - begin;
    let square = 3.0 * rise - 2.0 * first - last;
    let cubic = first + last - 2.0 * rise;
    // The slope is first + 2 square s + 3 cubic s^2. Its roots are in the form without cancellation.
    let root = (square * square - 3.0 * cubic * first).sqrt();
    let sum = -(square + square.signum() * root);
    let roots = [sum / (3.0 * cubic), first / sum];
    let inside = || roots.into_iter().filter(|share| *share > 0.0 && *share < limit);
    let (share, second) = (inside().reduce(f64::min)?, inside().reduce(f64::max)?);
    let value = |share: f64| begin + share * (first + share * (square + share * cubic));
    // Behind a second turning point the input may run on beyond the first one.
    let farthest = match (second > share, first > 0.0) {
        (true, _) => value(second),
        (false, true) => begin.max(end),
        (false, false) => begin.min(end),
    };
    let shortfall = if first > 0.0 { value(share) - farthest } else { farthest - value(share) };
    (shortfall > SHORTFALL).then_some(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_turns_where_its_slope_is_0() {
        for at in [0.01, 0.3, 0.77] {
            for sign in [1.0, -1.0] {
                let value = |s: f64| sign * (s - at) * (s - at) * (s + 2.0);
                let slope = |s: f64| sign * (s - at) * (3.0 * s + 4.0 - at);
                let share = turning_share([value(0.0), value(1.0)], [slope(0.0), slope(1.0)], 1.0).unwrap();
                assert!((share - at).abs() < 1e-12, "{share} for {at}");
            }
        }
        assert_eq!(turning_share([0.0, 1.0], [1.0, 1.0], 1.0), None);
        assert_eq!(turning_share([0.0, -1.0], [1e-7, -2.0], 1.0), None);
        assert_eq!(turning_share([f64::NAN, 1.0], [1.0, -1.0], 1.0), None);
        // A cubic with turning points at 0.2 and 0.6 that ends above the first one.
        let value = |s: f64| s * s * s / 3.0 - 0.4 * s * s + 0.12 * s;
        let share = turning_share([0.0, value(1.0)], [0.12, 0.32], 1.0).unwrap();
        assert!((share - 0.2).abs() < 1e-12 && value(1.0) > value(0.2), "{share}");
        // 2.1 s - s^2 turns just beyond the end.
        assert_eq!(turning_share([0.0, 1.1], [2.1, 0.1], 1.0), None);
        assert!((turning_share([0.0, 1.1], [2.1, 0.1], MAX_CORRECTION).unwrap() - 1.05).abs() < 1e-12);
    }
}
