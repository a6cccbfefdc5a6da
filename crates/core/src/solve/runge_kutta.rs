//! A step of any explicit Runge-Kutta method, specified by its [`Tableau`].
//!
//! [`try_step`] evaluates a step from the present without accepting it: it leaves the states and voltages at the end in
//! the buffers. A caller then looks for events, checks the error ([`largest_error`]) and either accepts the step or
//! tries a shorter one.

use super::buffers::StepBuffers;
use super::evaluate::{Scope, trial};
use super::grazing;
use super::state::{Setup, SolverState, read_rates};
use super::tableau::{StageWeight, Tableau};
use crate::delay_line::DelayLine;
use crate::machines::REFERENCE;

/// Least state, in volts without sign, that is kept; smaller ones are set to 0. Without this a decay would reach
/// subnormal numbers (below 2.2e-308), on which processors are slow.
pub(super) const MIN_STATE: f64 = 1e-100;

/// Tries a step of this length in problem seconds from the present, without a change of modes. The states, voltages and
/// stages of the step are then in the buffers, with a hint of events within it.
pub(super) fn try_step(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    length: f64,
) {
    let (program, method) = (setup.program, setup.method);
    buffers.evaluation.faults.clear();
    buffers.stage_rates[0].copy_from_slice(&state.rates);
    for (stage, row) in method.stages.iter().enumerate() {
        advance_states(&mut buffers.states, &state.states, &buffers.stage_rates, row.weights, length);
        let checked = method.checked_stages.iter().position(|checked| *checked == stage);
        let scope = match checked {
            None => Scope::Rates,
            // Recorded voltages are interpolated in adaptive steps.
            Some(_) if setup.is_adaptive => Scope::All,
            Some(_) => Scope::Checked,
        };
        trial(program, state, delay_lines, buffers, state.time + row.node * length, scope);
        read_rates(program, &buffers.voltages, &mut buffers.stage_rates[stage + 1]);
        if let Some(checked) = checked {
            buffers.checked_voltages[checked].copy_from_slice(&buffers.voltages);
        }
    }
    advance_states(
        &mut buffers.states,
        &state.states,
        &buffers.stage_rates,
        method.end_weights,
        length / method.divisor,
    );
    flush_tiny_states(&mut buffers.states);
    trial(program, state, delay_lines, buffers, state.time + length, Scope::All);
    read_rates(program, &buffers.voltages, &mut buffers.stage_rates[method.rates() - 1]);
    buffers.hint = grazing::hint(setup, state, delay_lines, buffers, length);
}

/// Number of evaluations that [`try_step`] takes; its caller counts them as work. The first stage needs none, because
/// its rates are those of the present.
pub(super) fn evaluations(method: &Tableau) -> u64 {
    method.rates() as u64 - 1
}

/// Calculates the states at a stage: `into = from + length * (weighted sum of the rates)`. `rates` has a row per stage
/// and a column per state. The sensitivities use the same formula for slopes.
#[inline]
pub fn advance_states(
    into: &mut [f64],
    from: &[f64],
    rates: &[Vec<f64>],
    weights: &[StageWeight],
    length: f64,
) {
    for (index, (stage_state, state)) in into.iter_mut().zip(from).enumerate() {
        *stage_state = state + length * weighted_sum(rates, weights, index);
    }
}

/// The state in which the two orders of a method differ most over a step of this length, and the difference in machine
/// units of 100 V. A difference that is not a number counts as the largest. `states` is the number of states.
pub(super) fn largest_error(
    method: &Tableau,
    stage_rates: &[Vec<f64>],
    states: usize,
    length: f64,
) -> (usize, f64) {
    let error = |state| length * weighted_sum(stage_rates, method.error_weights, state).abs() / REFERENCE;
    let larger = |worst: (usize, f64), state| {
        let error = error(state);
        if error > worst.1 || error.is_nan() { (state, error) } else { worst }
    };
    (0..states).fold((0, 0.0), larger)
}

/// Sets states below [`MIN_STATE`] to 0, without regard to sign.
pub(super) fn flush_tiny_states(states: &mut [f64]) {
    states.iter_mut().filter(|volts| volts.abs() < MIN_STATE).for_each(|volts| *volts = 0.0);
}

/// The sum of the rates of a state at the stages, each multiplied by its weight.
pub fn weighted_sum(rates: &[Vec<f64>], weights: &[StageWeight], state: usize) -> f64 {
    weights.iter().map(|(stage, weight)| weight * rates[*stage][state]).sum()
}
