//! The functions that a solver calls to keep its derivatives up to date: after evaluations, steps, changes of mode and
//! changes of parameters, and when it fills delay lines.
//!
//! Every function takes only the fields of the solver that it reads, because the derivatives are a field of the solver.

use super::Sensitivities;
use super::parameter_slopes::{AcceptedStep, ParameterSlopes};
use super::saltation::ZERO_SLOPE;
use crate::delay_line::DelayLine;
use crate::ir::{Program, RunScope, RunScopeSlopes, Transition};
use crate::solve::buffers::StepBuffers;
use crate::solve::dense_output::Curve;
use crate::solve::error::RunError;
use crate::solve::evaluate::{Scope, trial};
use crate::solve::runge_kutta::advance_states;
use crate::solve::state::{Setup, Solver, SolverState};
use patchcord_expr::Formula;

impl Solver<'_> {
    /// Checks that the derivatives can continue from the present instant.
    ///
    /// # Errors
    /// If a change of mode had no derivative, or a derivative is not finite.
    pub(in crate::solve) fn check_derivatives(&mut self) -> Result<(), RunError> {
        let Some(sensitivities) = &mut self.sensitivities else { return Ok(()) };
        if let Some(fault) = sensitivities.fault.take() {
            return Err(fault);
        }
        let program = self.setup.program;
        let state = &self.state;
        match sensitivities.by_parameter.iter().find(|slopes| !slopes.is_finite(program, state)) {
            Some(slopes) => Err(RunError::InfiniteDerivative {
                parameter: program.parameters[slopes.parameter].declared.name.clone(),
                time: state.time,
            }),
            None => Ok(()),
        }
    }
}

impl Sensitivities {
    /// Differentiates the tried step, which ends at the problem time `end` and is about to be accepted.
    pub(crate) fn follow_step(
        &mut self,
        setup: &Setup<'_>,
        state: &SolverState,
        delay_lines: &mut [DelayLine],
        buffers: &mut StepBuffers,
        end: f64,
    ) {
        let begin = state.time;
        self.length = end - begin;
        self.evaluate_stages(setup, state, delay_lines, buffers);
        let step = AcceptedStep {
            program: setup.program,
            method: setup.method,
            delay_lines,
            begin,
            length: self.length,
            stages: &self.stages,
            end: &buffers.voltages,
        };
        self.by_parameter.iter_mut().for_each(|slopes| slopes.follow_step(&step));
    }

    /// Evaluates the voltages of all stages of the tried step again, because the step stores only some of them.
    /// Afterwards the buffers are again at the end of the step.
    fn evaluate_stages(
        &mut self,
        setup: &Setup<'_>,
        state: &SolverState,
        delay_lines: &mut [DelayLine],
        buffers: &mut StepBuffers,
    ) {
        let (program, method) = (setup.program, setup.method);
        let first_moving = program.lowered.sections.moving;
        self.stages[0].copy_from_slice(&state.voltages);
        std::mem::swap(&mut self.end, &mut buffers.states);
        for (stage, row) in method.stages.iter().enumerate() {
            let voltages = &mut self.stages[stage + 1];
            voltages[..first_moving].copy_from_slice(&state.voltages[..first_moving]);
            std::mem::swap(voltages, &mut buffers.voltages);
            advance_states(
                &mut buffers.states,
                &state.states,
                &buffers.stage_rates,
                row.weights,
                self.length,
            );
            let scope = if stage == method.middle_stage { Scope::Checked } else { Scope::Rates };
            trial(program, state, delay_lines, buffers, state.time + row.node * self.length, scope);
            std::mem::swap(&mut self.stages[stage + 1], &mut buffers.voltages);
        }
        std::mem::swap(&mut self.end, &mut buffers.states);
    }

    /// Evaluates the slopes of all voltages at a problem time at which the solver interpolates. `voltages` are the
    /// voltages at that time.
    pub(crate) fn interpolate(
        &mut self,
        program: &Program,
        delay_lines: &[DelayLine],
        time: f64,
        curve: &Curve,
        voltages: &[f64],
    ) {
        for slopes in &mut self.by_parameter {
            slopes.interpolate(program, (time, delay_lines), curve, voltages);
        }
    }

    /// Evaluates the slopes of all present voltages.
    pub(crate) fn evaluate(&mut self, program: &Program, state: &SolverState, delay_lines: &[DelayLine]) {
        for slopes in &mut self.by_parameter {
            slopes.evaluate(program, state.time, delay_lines, &state.voltages);
        }
    }

    /// Samples the slopes of the values that stay constant within the next step.
    pub(crate) fn sample_values(&mut self, program: &Program) {
        self.by_parameter.iter_mut().for_each(|slopes| slopes.sample_values(program));
    }

    /// Stores the present slopes of the inputs in the delay lines.
    pub(crate) fn record_delay_inputs(&mut self, program: &Program, time: f64) {
        for slopes in &mut self.by_parameter {
            for (line, delay) in slopes.lines.iter_mut().zip(&program.lowered.delays) {
                line.put(time, slopes.voltages[delay.input.index()]);
            }
        }
    }

    /// Stores the slopes at the instant interpolated last, which is `time`, in the delay lines.
    pub(crate) fn record_within(&mut self, program: &Program, time: f64) {
        for slopes in &mut self.by_parameter {
            for (line, delay) in slopes.lines.iter_mut().zip(&program.lowered.delays) {
                line.put(time, slopes.trial_voltages[delay.input.index()]);
            }
        }
    }

    /// Records in the delay lines that slopes may have a jump or a corner at a fixed instant. During an event,
    /// [`Solver::leave_event`] does this with the shift of the event.
    pub(crate) fn record_discontinuity(&mut self, program: &Program, time: f64) {
        if !self.is_at_event {
            self.by_parameter.iter_mut().for_each(|slopes| slopes.record_discontinuity(program, time, 0.0));
        }
    }

    /// Sets the slope of the state that a change of mode resets. `mode` is the index of the mode.
    pub(crate) fn change_mode(
        &mut self,
        program: &Program,
        voltages: &[f64],
        mode: usize,
        transition: &Transition,
    ) {
        self.check_threshold(program, voltages, mode, transition);
        let Some(reset) = transition.reset else { return };
        for slopes in &mut self.by_parameter {
            slopes.states[reset.state as usize] = slopes.voltages[reset.to.index()];
        }
    }

    /// Sets the slopes of the state with this index to 0, because an operator set it to a voltage.
    pub(crate) fn clear_state(&mut self, state: usize) {
        self.by_parameter.iter_mut().for_each(|slopes| slopes.states[state] = 0.0);
    }

    /// Sets all slopes to initial condition, before the modes settle.
    pub(crate) fn begin(&mut self, program: &Program) {
        (self.is_at_event, self.is_settling) = (false, true);
        self.by_parameter.iter_mut().for_each(|slopes| slopes.begin(program));
    }

    /// Notes that the modes have settled in initial condition.
    pub(crate) fn finish_begin(&mut self) {
        self.is_settling = false;
    }

    /// Records a fault if a transition in initial condition is exactly at its threshold and the guard depends on a
    /// parameter: with a slightly different value the mode would not change.
    fn check_threshold(&mut self, program: &Program, voltages: &[f64], mode: usize, transition: &Transition) {
        if !self.is_settling || transition.guard.value(voltages) != 0.0 {
            return;
        }
        let guard = transition.guard.register.index();
        let depends = |slopes: &&ParameterSlopes| slopes.voltages[guard].abs() > ZERO_SLOPE;
        if let Some(slopes) = self.by_parameter.iter().find(depends) {
            let element = program.name(program.lowered.modes[mode].element);
            self.fault.get_or_insert(RunError::NoDerivative {
                parameter: program.parameters[slopes.parameter].declared.name.clone(),
                why: format!(
                    "{element} is exactly at its switching threshold in initial condition; change the threshold or \
                     the initial condition slightly"
                ),
            });
        }
    }

    /// Sets the slopes of parameters that an operator or a phase has set. `changed` are their indices. `new_slopes` has
    /// a row for every change, with a slope for each parameter by which derivatives are computed. A missing row means
    /// that the new value depends on none of them.
    pub(crate) fn set_parameter_slopes(&mut self, changed: &[usize], new_slopes: &[Vec<f64>]) {
        for (change, index) in changed.iter().enumerate() {
            for (position, slopes) in self.by_parameter.iter_mut().enumerate() {
                slopes.parameters[*index] = new_slopes.get(change).map_or(0.0, |row| row[position]);
            }
        }
    }

    /// Calculates the slopes of new coefficients, and updates the delays and their slopes. `parameters` are in SI
    /// units, `time` is the present.
    pub(crate) fn update_coefficients(
        &mut self,
        program: &Program,
        parameters: &[f64],
        delay_lines: &[DelayLine],
        time: f64,
    ) {
        self.update_coefficient_slopes(program, parameters);
        for slopes in &mut self.by_parameter {
            let pairs = slopes.lines.iter_mut().zip(delay_lines).zip(&program.lowered.delays);
            for ((line, input), delay) in pairs {
                let delay_slope = slopes.coefficients[delay.time as usize] * delay.problem_seconds;
                let initial_slope = slopes.coefficients[delay.initial as usize];
                line.set(input.delay(), delay_slope, initial_slope, time);
            }
        }
    }

    /// The slopes of the value of a formula in SI units, one for every parameter by which derivatives are computed.
    pub(crate) fn slopes_of_formula(&self, scope: &RunScope<'_>, formula: &Formula) -> Vec<f64> {
        let slope = |slopes: &ParameterSlopes| {
            let slopes = RunScopeSlopes {
                parameters: &slopes.parameters,
                coefficients: &slopes.coefficients,
                registers: &slopes.voltages,
            };
            scope.slope(formula, &slopes)
        };
        self.by_parameter.iter().map(slope).collect()
    }
}
