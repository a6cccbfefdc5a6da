//! Events whose instant depends on a parameter.
//!
//! Before an event the slopes move to the shifting instant ([`Solver::enter_event`]), and after it they return to a
//! fixed time ([`Solver::leave_event`]). The shift follows from the guard of the mode that changes, or from the echo of
//! an earlier jump in a delay line. The beginning of a phase shifts with the event that ended the phase before.

use super::Sensitivities;
use super::column::Column;
use crate::delay_line::DelayLine;
use crate::ir::{Beside, Guard, ON_THE_KINK, Program, Slopes};
use crate::solve::error::RunError;
use crate::solve::state::{Setup, Solver, SolverState};

/// Slopes of a guard below this, in volts for the size of a parameter, count as 0.
pub(super) const ZERO_SLOPE: f64 = 1e-12;
/// Two shifts of one instant are the same if they differ by less than this share of their size.
const SHIFT_TOLERANCE: f64 = 1e-6;

/// A change of mode that is due.
#[derive(Clone, Copy)]
struct DueChange {
    /// Index of the element.
    element: usize,
    /// Whether the mode depends on time alone.
    of_drive: bool,
    guard: Guard,
}

impl Solver<'_> {
    /// Moves the slopes to the shifting instant of the events that are due, before any of them is carried out.
    ///
    /// # Errors
    /// If the shift of an event has no derivative.
    pub(in crate::solve) fn enter_event(&mut self) -> Result<(), RunError> {
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        let Some(own) = sensitivities else { return Ok(()) };
        let echoes = delay_lines.iter().any(|line| line.jumps_at(state.time));
        if !echoes && due_changes(setup.program, &state.modes, &state.voltages).next().is_none() {
            own.columns.iter_mut().for_each(|column| column.event_shift = 0.0);
            return Ok(());
        }
        let mut outcome = Ok(());
        own.evaluate_flow(setup, state, delay_lines);
        for place in 0..own.columns.len() {
            match own.shift(place, setup.program, state, delay_lines) {
                Ok(shift) => own.columns[place].event_shift = shift,
                Err(error) => outcome = Err(error),
            }
        }
        own.enter(setup.program, state);
        outcome
    }

    /// Moves the slopes to the instant at which the present phase of a run began, if that instant shifts, for a change
    /// that an operator or a phase makes there. Slopes that are there already stay.
    pub(in crate::solve) fn enter_phase(&mut self) {
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        let Some(own) = sensitivities else { return };
        let shifts = own.columns.iter().any(|column| column.phase_shift != 0.0);
        own.columns.iter_mut().for_each(|column| column.event_shift = column.phase_shift);
        if shifts && !own.is_at_event {
            own.evaluate_flow(setup, state, delay_lines);
            own.enter(setup.program, state);
        }
    }

    /// Moves the slopes back to a fixed time.
    ///
    /// # Errors
    /// If a derivative is not finite after the event.
    pub(in crate::solve) fn leave_event(&mut self) -> Result<(), RunError> {
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        if let Some(own) = sensitivities {
            own.leave(setup.program, state, delay_lines);
        }
        self.check_derivatives()
    }
}

/// The changes of mode that are due, at most one for each mode.
fn due_changes<'a>(
    program: &'a Program,
    modes: &'a [f64],
    voltages: &'a [f64],
) -> impl Iterator<Item = DueChange> + 'a {
    let pairs = program.modes.iter().zip(modes);
    pairs.filter_map(|(mode, value)| {
        let mut open = mode.transitions.iter().filter(|open| open.from == *value);
        let first = open.find(|open| open.guard.holds(voltages))?;
        Some(DueChange { element: mode.element, of_drive: mode.of_drive, guard: first.guard })
    })
}

impl Sensitivities {
    /// Records that a phase ended with the last event, so the next phase begins at an instant with the same shift.
    pub fn end_phase(&mut self) {
        self.columns.iter_mut().for_each(|column| column.phase_shift = column.event_shift);
    }

    /// Evaluates the slopes of all present voltages along the motion.
    fn evaluate_flow(&mut self, setup: &Setup<'_>, state: &SolverState, delay_lines: &[DelayLine]) {
        for (slope, line) in self.delayed_flow.iter_mut().zip(delay_lines) {
            *slope = line.slope_until(state.time);
        }
        let program = setup.program;
        let from = Slopes {
            coefficients: &self.zeros,
            states: &state.rates,
            time: 1.0,
            delayed: &self.delayed_flow,
            kept: &self.zeros,
        };
        let (values, watched) = (state.voltages.as_slice(), program.parts.watched);
        let guide = &self.stages[setup.method.middle + 1];
        program.differentiate(0..watched, Beside { values, guide }, &from, &mut self.flow);
        let rest = watched..program.body.len();
        program.differentiate(rest, Beside { values, guide: values }, &from, &mut self.flow);
    }

    /// The shift of the present instant in problem seconds, by the events that are due; 0 if none of them shifts.
    ///
    /// # Errors
    /// If two events are due whose shifts differ, or a guard only touches its threshold.
    fn shift(
        &self,
        place: usize,
        program: &Program,
        state: &SolverState,
        delay_lines: &[DelayLine],
    ) -> Result<f64, RunError> {
        let (column, time) = (&self.columns[place], state.time);
        let guards = due_changes(program, &state.modes, &state.voltages)
            .map(|due| Ok::<_, RunError>((self.crossing(column, due, program, time)?, due.element)));
        let lines = delay_lines.iter().zip(&column.lines).zip(&program.delays);
        let echoes = lines
            .filter(|((line, _), _)| line.jumps_at(time))
            .map(|((_, line), delay)| Ok((line.shift_of_echo(time), delay.element)));
        let mut first: Option<(f64, usize)> = None;
        for found in guards.chain(echoes) {
            let (shift, element) = found?;
            let Some((before, other)) = first else {
                first = Some((shift, element));
                continue;
            };
            if (shift - before).abs() > SHIFT_TOLERANCE * (shift.abs() + before.abs()) + ZERO_SLOPE {
                let other = program.name(other);
                let why = format!("and {other} switch at the same instant, and would not for another value");
                return Err(lost(column, element, why, program, time));
            }
        }
        Ok(first.map_or(0.0, |(shift, _)| shift))
    }

    /// The shift of the instant at which a guard reaches its threshold, in problem seconds.
    ///
    /// # Errors
    /// If the guard only touches the threshold.
    fn crossing(
        &self,
        column: &Column,
        due: DueChange,
        program: &Program,
        time: f64,
    ) -> Result<f64, RunError> {
        let at = due.guard.register.index();
        let (by_itself, along) = (column.voltages[at], self.flow[at]);
        if by_itself.abs() <= ZERO_SLOPE {
            return Ok(0.0);
        }
        // Guards of drives are straight lines in time; the guard at the foot of a triangle reaches its threshold by a
        // jump.
        let is_fair = if due.of_drive { along != 0.0 } else { along > 0.0 && !self.grazes(due.guard, along) };
        if is_fair {
            return Ok(-by_itself / along);
        }
        let why = "only touches its switching threshold".to_owned();
        Err(lost(column, due.element, why, program, time))
    }

    /// Whether a guard turns back less than 1e-9 V beyond its threshold, by the parabola through its value at the
    /// beginning of the last step and its value and slope at the end.
    fn grazes(&self, guard: Guard, along: f64) -> bool {
        let (before, way) = (guard.excess(&self.stages[0]), along * self.length);
        let bend = -(before + way);
        // A step that began at the threshold is too short to decide.
        before < -ON_THE_KINK && bend > ZERO_SLOPE && way * way < 4.0 * ON_THE_KINK * bend
    }

    /// Moves all slopes to the shifting instant.
    fn enter(&mut self, program: &Program, state: &SolverState) {
        self.is_at_event = true;
        for column in &mut self.columns {
            let shift = column.event_shift;
            column.shift = shift;
            if shift != 0.0 {
                add(&mut column.states, &state.rates, shift);
                add(&mut column.voltages, &self.flow, shift);
            }
            column.sample_values(program);
        }
    }

    /// Moves all slopes back to a fixed time.
    fn leave(&mut self, program: &Program, state: &SolverState, delay_lines: &[DelayLine]) {
        if !std::mem::take(&mut self.is_at_event) {
            return;
        }
        for column in &mut self.columns {
            if column.shift != 0.0 {
                add(&mut column.states, &state.rates, -column.shift);
                column.shift = 0.0;
                column.evaluate(program, state.time, delay_lines, &state.voltages);
            }
            column.record_discontinuity(program, state.time, column.event_shift);
        }
    }
}

/// Adds the rates multiplied by a shift in seconds to slopes.
fn add(slopes: &mut [f64], rates: &[f64], shift: f64) {
    slopes.iter_mut().zip(rates).for_each(|(slope, rate)| *slope += rate * shift);
}

/// The error of an event at which the derivatives of a column end.
fn lost(column: &Column, element: usize, why: String, program: &Program, time: f64) -> RunError {
    RunError::DerivativeLost {
        parameter: program.parameters[column.parameter].name.clone(),
        element: program.name(element).to_owned(),
        why,
        time,
    }
}
