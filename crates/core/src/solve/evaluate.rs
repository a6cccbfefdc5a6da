//! Evaluation of all voltages: at the present instant, and at the end or a stage of a tried step.
//!
//! Both functions read the delay lines, run the operations of the program's body and leave the voltages in place. The
//! present instant has two sides if something jumps there, so the caller chooses the [`Side`].

use super::buffers::StepBuffers;
use super::error::RunError;
use super::state::{Solver, SolverState, read_rates};
use crate::delay_line::DelayLine;
use crate::ir::{LoopFault, Program, Sources, remedy, tell};
use crate::trace::Work;

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
    /// All voltages that change within a step.
    All,
    /// Only the voltages on which rates depend.
    Rates,
}

impl Solver<'_> {
    /// Evaluates every voltage and rate after whatever jumped at the present instant, and counts it as work.
    pub fn evaluate(&mut self, work: &mut Work) {
        work.evaluations += 1;
        self.evaluate_now(Side::After);
    }

    /// Evaluates every voltage, rate and derivative at the present instant. It is not counted as work.
    pub fn evaluate_now(&mut self, side: Side) {
        let Solver { setup, state, delay_lines, buffers, sensitivities } = self;
        present(setup.program, state, delay_lines, buffers, side);
        if let Some(own) = sensitivities {
            own.evaluate(setup.program, state, delay_lines);
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
    let output: fn(&mut DelayLine, f64) -> f64 = match side {
        Side::Before => DelayLine::next_until,
        Side::After => DelayLine::next_from,
    };
    for (delayed, line) in buffers.delayed.iter_mut().zip(delay_lines) {
        *delayed = output(line, state.time);
    }
    let from = Sources {
        parameters: &state.parameters,
        coefficients: &state.coefficients,
        states: &state.states,
        modes: &state.modes,
        time: state.time,
        tables: &program.tables,
        delayed: &buffers.delayed,
        kept: &state.sampled,
        levels: &state.levels,
    };
    program.evaluate_range(0..program.body.len(), &from, &mut state.voltages, &mut buffers.evaluation);
    let still = program.parts.moving;
    buffers.voltages[..still].copy_from_slice(&state.voltages[..still]);
    read_rates(program, &state.voltages, &mut state.rates);
}

/// Evaluates the voltages for the states in the buffers at a later time. If something jumps at that time, the voltages
/// are those before the jump. Faults of loops are added to those already listed.
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
        *delayed = line.next_until(time);
    }
    let (moving, watched, all) = (program.parts.moving, program.parts.watched, program.body.len());
    let range = match scope {
        Scope::All => moving..all,
        Scope::Rates => moving..watched,
    };
    let from = Sources {
        parameters: &state.parameters,
        coefficients: &state.coefficients,
        states: &buffers.states,
        modes: &state.modes,
        time,
        tables: &program.tables,
        delayed: &buffers.delayed,
        kept: &state.sampled,
        levels: &state.levels,
    };
    program.evaluate_range(range, &from, &mut buffers.voltages, &mut buffers.evaluation);
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
        let entry = &program.loops[index];
        return Err(RunError::Loop {
            members: entry.members.join(", "),
            opened: entry.opened().to_owned(),
            solutions: tell(entry, solutions),
            advice: remedy(entry, solutions).1,
            time: state.time,
        });
    }
    match program.in_order().find(|outlet| state.voltages[outlet.register.index()].is_nan()) {
        Some(outlet) => Err(RunError::NotANumber { element: outlet.name.clone(), time: state.time }),
        None => Ok(()),
    }
}
