//! Evaluation of all voltages: at the present instant, and at the end or a stage of a tried step.
//!
//! [`present`] evaluates the state in place, and [`trial`] evaluates the states in the buffers. Both read the delay
//! lines and run the operations of the program's body. If a voltage jumps at the present instant, the caller chooses
//! the [`Side`] of the jump.

use super::buffers::StepBuffers;
use super::error::RunError;
use super::state::{Solver, SolverState, read_rates};
use crate::delay_line::DelayLine;
use crate::ir::{LoopFault, Program, Sources, describe_solutions, remedy};
use crate::trace::WorkCounters;

/// The side of an instant at which delay lines may jump.
#[derive(Debug, Clone, Copy)]
pub(super) enum Side {
    /// Just before the jump.
    Before,
    /// Just after it.
    After,
}

/// The voltages that an evaluation calculates. Rates alone are enough at most stages of a step, and cheaper.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scope {
    /// All voltages that change within a step, guards and recorded signals included.
    All,
    /// Only the voltages on which rates and events depend.
    Checked,
    /// Only the voltages on which rates depend.
    Rates,
}

impl Solver<'_> {
    /// Evaluates every voltage, rate and derivative at the present instant, after a jump there, and counts the work.
    pub(super) fn evaluate(&mut self, work: &mut WorkCounters) {
        work.evaluations += 1;
        self.evaluate_now(Side::After);
    }

    /// Evaluates every voltage, rate and derivative at the present instant. It is not counted as work.
    pub(super) fn evaluate_now(&mut self, side: Side) {
        let Solver { setup, state, delay_lines, buffers, sensitivities } = self;
        present(setup.program, state, delay_lines, buffers, side);
        if let Some(sensitivities) = sensitivities {
            sensitivities.evaluate(setup.program, state, delay_lines);
        }
    }
}

/// Evaluates every voltage and rate of the state in place. Voltages that do not change within a step are also copied
/// into the buffers, because [`trial`] does not calculate them.
fn present(
    program: &Program,
    state: &mut SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    side: Side,
) {
    buffers.evaluation.faults.clear();
    let read_line: fn(&mut DelayLine, f64) -> f64 = match side {
        Side::Before => DelayLine::next_left_limit,
        Side::After => DelayLine::next_right_limit,
    };
    for (delayed, line) in buffers.delayed.iter_mut().zip(delay_lines) {
        *delayed = read_line(line, state.time);
    }
    let from = Sources {
        parameters: &state.parameters,
        coefficients: &state.coefficients,
        states: &state.states,
        modes: &state.modes,
        time: state.time,
        tables: &program.tables,
        delayed: &buffers.delayed,
        sampled: &state.sampled,
        levels: &state.levels,
    };
    program.evaluate_range(
        0..program.lowered.body.len(),
        &from,
        &mut state.voltages,
        &mut buffers.evaluation,
    );
    let first_moving = program.lowered.sections.moving;
    buffers.voltages[..first_moving].copy_from_slice(&state.voltages[..first_moving]);
    read_rates(program, &state.voltages, &mut state.rates);
}

/// Evaluates the voltages for the states in the buffers at a problem time within or at the end of a step. If a voltage
/// jumps at that time, the voltages are those before the jump. Faults of loops are added to those already listed.
#[inline]
pub(super) fn trial(
    program: &Program,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    time: f64,
    scope: Scope,
) {
    for (delayed, line) in buffers.delayed.iter_mut().zip(delay_lines) {
        *delayed = line.next_left_limit(time);
    }
    let sections = program.lowered.sections;
    let end = match scope {
        Scope::All => program.lowered.body.len(),
        Scope::Checked => sections.watched,
        Scope::Rates => sections.checked,
    };
    let from = Sources {
        parameters: &state.parameters,
        coefficients: &state.coefficients,
        states: &buffers.states,
        modes: &state.modes,
        time,
        tables: &program.tables,
        delayed: &buffers.delayed,
        sampled: &state.sampled,
        levels: &state.levels,
    };
    program.evaluate_range(sections.moving..end, &from, &mut buffers.voltages, &mut buffers.evaluation);
}

/// Checks the voltages of the present instant.
///
/// # Errors
/// If a loop without an integrator was not solved, or the output of an element is not a number.
pub(super) fn check_voltages(
    program: &Program,
    state: &SolverState,
    faults: &[LoopFault],
) -> Result<(), RunError> {
    if let Some(&LoopFault { index, solutions }) = faults.first() {
        let unsolved = &program.lowered.loops[index];
        return Err(RunError::Loop {
            members: unsolved.members.join(", "),
            opened: unsolved.openers().next().unwrap_or_default().to_owned(),
            solutions: describe_solutions(unsolved, solutions),
            advice: remedy(unsolved, solutions).1,
            time: state.time,
        });
    }
    match program.in_evaluation_order().find(|output| state.voltages[output.register.index()].is_nan()) {
        Some(output) => Err(RunError::NotANumber { element: output.name.clone(), time: state.time }),
        None => Ok(()),
    }
}
