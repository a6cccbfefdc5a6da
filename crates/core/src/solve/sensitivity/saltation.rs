//! Events whose instant depends on a parameter.
//!
//! Before an event the slopes move to the shifting instant ([`Solver::enter_event`]). After it they return to a fixed
//! time ([`Solver::leave_event`]). The shift is the derivative of the instant by the parameter. It follows from the
//! guard of the mode that changes, from the edge of a pulse, or from the earlier jump that arrives from a delay line.
//! The beginning of a phase shifts with the event that ended the phase before ([`Solver::enter_phase`]).

use super::Sensitivities;
use super::parameter_slopes::ParameterSlopes;
use crate::delay_line::DelayLine;
use crate::ir::{Guard, KINK_TOLERANCE, Program, SourceSlopes, TangentBase};
use crate::solve::error::RunError;
use crate::solve::levels::due_edges;
use crate::solve::state::{Setup, Solver, SolverState};

/// Slope of a guard without sign, in volts for the size of a parameter, up to which it counts as 0.
pub(super) const ZERO_SLOPE: f64 = 1e-12;
/// Relative difference of two shifts up to which they count as the same.
const SHIFT_TOLERANCE: f64 = 1e-6;

/// A change of mode that is due.
#[derive(Clone, Copy)]
struct DueChange {
    /// Index of the element.
    element: usize,
    /// Whether the element is a drive, whose mode depends on time only.
    is_of_drive: bool,
    /// The guard that is reached.
    guard: Guard,
}

impl Solver<'_> {
    /// Moves the slopes to the shifting instant of the events that are due, before any of them is handled. Without a
    /// due event, nothing moves.
    ///
    /// # Errors
    /// If the instant of an event has no derivative.
    pub(in crate::solve) fn enter_event(&mut self) -> Result<(), RunError> {
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        let Some(sensitivities) = sensitivities else { return Ok(()) };
        let has_jump = delay_lines.iter().any(|line| line.has_jump_at(state.time))
            || due_edges(setup, state).next().is_some();
        if !has_jump && due_changes(setup.program, &state.modes, &state.voltages).next().is_none() {
            sensitivities.by_parameter.iter_mut().for_each(|slopes| slopes.event_shift = 0.0);
            return Ok(());
        }
        let mut outcome = Ok(());
        sensitivities.evaluate_flow(setup, state, delay_lines);
        for index in 0..sensitivities.by_parameter.len() {
            match sensitivities.shift(index, setup, state, delay_lines) {
                Ok(shift) => sensitivities.by_parameter[index].event_shift = shift,
                Err(error) => outcome = Err(error),
            }
        }
        sensitivities.enter(setup.program, state);
        outcome
    }

    /// Moves the slopes to the instant at which the present phase of a run began, if that instant shifts. An operator
    /// or a phase then changes parameters there. Slopes that are at the shifting instant already stay.
    pub(in crate::solve) fn enter_phase(&mut self) {
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        let Some(sensitivities) = sensitivities else { return };
        let has_shift = sensitivities.by_parameter.iter().any(|slopes| slopes.phase_shift != 0.0);
        sensitivities.by_parameter.iter_mut().for_each(|slopes| slopes.event_shift = slopes.phase_shift);
        if has_shift && !sensitivities.is_at_event {
            sensitivities.evaluate_flow(setup, state, delay_lines);
            sensitivities.enter(setup.program, state);
        }
    }

    /// Moves the slopes back to a fixed time, with the rates after the event.
    ///
    /// # Errors
    /// If a derivative is not finite after the event.
    pub(in crate::solve) fn leave_event(&mut self) -> Result<(), RunError> {
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        if let Some(sensitivities) = sensitivities {
            sensitivities.leave(setup.program, state, delay_lines);
        }
        self.check_derivatives()
    }
}

/// The changes of mode that are due, at most one for each mode, in the order of `Program::modes`.
fn due_changes<'a>(
    program: &'a Program,
    modes: &'a [f64],
    voltages: &'a [f64],
) -> impl Iterator<Item = DueChange> + 'a {
    let pairs = program.lowered.modes.iter().zip(modes);
    pairs.filter_map(|(mode, value)| {
        let mut candidates = mode.transitions.iter().filter(|transition| transition.from == *value);
        let first = candidates.find(|transition| transition.guard.is_due(voltages))?;
        Some(DueChange { element: mode.element, is_of_drive: mode.is_drive, guard: first.guard })
    })
}

impl Sensitivities {
    /// Notes that a phase ended with the last event, so the next phase begins at an instant with the same shift.
    pub(crate) fn end_phase(&mut self) {
        self.by_parameter.iter_mut().for_each(|slopes| slopes.phase_shift = slopes.event_shift);
    }

    /// Evaluates the time derivatives of all present voltages before the event: coefficients are constant, states move
    /// with their rates, and time advances.
    fn evaluate_flow(&mut self, setup: &Setup<'_>, state: &SolverState, delay_lines: &[DelayLine]) {
        for (slope, line) in self.delayed_flow.iter_mut().zip(delay_lines) {
            *slope = line.left_slope(state.time);
        }
        let program = setup.program;
        let from = SourceSlopes {
            coefficients: &self.zeros,
            states: &state.rates,
            time: 1.0,
            delayed: &self.delayed_flow,
            sampled: &self.zeros,
        };
        let (values, checked) = (state.voltages.as_slice(), program.lowered.sections.checked);
        let guide = &self.stages[setup.method.middle_stage + 1];
        program.differentiate(0..checked, TangentBase { values, guide }, &from, &mut self.flow);
        let others = checked..program.lowered.body.len();
        program.differentiate(others, TangentBase { values, guide: values }, &from, &mut self.flow);
    }

    /// The shift of the present instant in problem seconds, by the events that are due; 0 if none of them shifts.
    /// `index` is the position of the parameter.
    ///
    /// # Errors
    /// If two events are due whose shifts differ, or a guard only touches its threshold.
    fn shift(
        &self,
        index: usize,
        setup: &Setup<'_>,
        state: &SolverState,
        delay_lines: &[DelayLine],
    ) -> Result<f64, RunError> {
        let (slopes, program, time) = (&self.by_parameter[index], setup.program, state.time);
        let guards = due_changes(program, &state.modes, &state.voltages)
            .map(|due| Ok::<_, RunError>((self.crossing_shift(slopes, due, program, time)?, due.element)));
        let lines = delay_lines.iter().zip(&slopes.lines).zip(&program.lowered.delays);
        let arrivals = lines
            .filter(|((line, _), _)| line.has_jump_at(time))
            .map(|((_, line), delay)| Ok((line.arrival_shift(time), delay.element)));
        let edges = due_edges(setup, state).map(|(pulses, edge)| {
            Ok((pulses.shift(edge, &state.coefficients, &slopes.coefficients), pulses.element))
        });
        let mut first: Option<(f64, usize)> = None;
        for shift_and_element in guards.chain(arrivals).chain(edges) {
            let (shift, element) = shift_and_element?;
            let Some((previous_shift, first_element)) = first else {
                first = Some((shift, element));
                continue;
            };
            if (shift - previous_shift).abs()
                > SHIFT_TOLERANCE * (shift.abs() + previous_shift.abs()) + ZERO_SLOPE
            {
                let first_name = program.name(first_element);
                let why = format!("and {first_name} switch at the same instant, but only for this value");
                return Err(lost(slopes, element, why, program, time));
            }
        }
        Ok(first.map_or(0.0, |(shift, _)| shift))
    }

    /// The shift of the instant at which a guard reaches its threshold, in problem seconds.
    ///
    /// # Errors
    /// If the guard only touches the threshold.
    fn crossing_shift(
        &self,
        slopes: &ParameterSlopes,
        due: DueChange,
        program: &Program,
        time: f64,
    ) -> Result<f64, RunError> {
        let register = due.guard.register.index();
        let (guard_slope, guard_rate) = (slopes.voltages[register], self.flow[register]);
        if guard_slope.abs() <= ZERO_SLOPE {
            return Ok(0.0);
        }
        // Guards of drives are straight lines in time. The guard at the lowest point of a triangle reaches its
        // threshold by a jump, so its rate may be negative.
        let has_derivative = if due.is_of_drive {
            guard_rate != 0.0
        } else {
            guard_rate > 0.0 && !self.is_grazing(due.guard, guard_rate)
        };
        if has_derivative {
            return Ok(-guard_slope / guard_rate);
        }
        let why = "only touches its switching threshold".to_owned();
        Err(lost(slopes, due.element, why, program, time))
    }

    /// Whether a guard turns back less than [`KINK_TOLERANCE`] above its threshold. The parabola through its value at
    /// the beginning of the last step and its value and rate at the end decides it. `guard_rate` is in volts per
    /// problem second.
    fn is_grazing(&self, guard: Guard, guard_rate: f64) -> bool {
        let (start_value, rise) = (guard.value(&self.stages[0]), guard_rate * self.length);
        let curvature = -(start_value + rise);
        // If the step began at the threshold, it is too short to decide.
        start_value < -KINK_TOLERANCE
            && curvature > ZERO_SLOPE
            && rise * rise < 4.0 * KINK_TOLERANCE * curvature
    }

    /// Moves all slopes to the shifting instant, with the rates before the event.
    fn enter(&mut self, program: &Program, state: &SolverState) {
        self.is_at_event = true;
        for slopes in &mut self.by_parameter {
            let shift = slopes.event_shift;
            slopes.shift = shift;
            if shift != 0.0 {
                add_scaled(&mut slopes.states, &state.rates, shift);
                add_scaled(&mut slopes.voltages, &self.flow, shift);
            }
            slopes.sample_values(program);
        }
    }

    /// Moves all slopes back to a fixed time.
    fn leave(&mut self, program: &Program, state: &SolverState, delay_lines: &[DelayLine]) {
        if !std::mem::take(&mut self.is_at_event) {
            return;
        }
        for slopes in &mut self.by_parameter {
            if slopes.shift != 0.0 {
                add_scaled(&mut slopes.states, &state.rates, -slopes.shift);
                slopes.shift = 0.0;
                slopes.evaluate(program, state.time, delay_lines, &state.voltages);
            }
            slopes.record_discontinuity(program, state.time, slopes.event_shift);
        }
    }
}

/// Adds rates multiplied by a shift, in problem seconds, to slopes.
fn add_scaled(slopes: &mut [f64], rates: &[f64], shift: f64) {
    slopes.iter_mut().zip(rates).for_each(|(slope, rate)| *slope += rate * shift);
}

/// The error of an event at problem time `time` after which there is no derivative by the parameter of these slopes.
fn lost(slopes: &ParameterSlopes, element: usize, why: String, program: &Program, time: f64) -> RunError {
    RunError::DerivativeLost {
        parameter: program.parameters[slopes.parameter].declared.name.clone(),
        element: program.name(element).to_owned(),
        why,
        time,
    }
}
