//! The places at which a solver makes its derivatives follow: evaluation, steps, delay lines, changes of mode,
//! parameters.
//!
//! Every function takes only the parts of the solver that it reads, so that derivatives and solver are borrowed apart.

use super::Sensitivities;
use super::column::{Column, TakenStep};
use super::saltation::ZERO_SLOPE;
use crate::delay_line::DelayLine;
use crate::ir::{Program, Standing, StandingSlopes, Transition};
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
        let Some(own) = &mut self.sensitivities else { return Ok(()) };
        if let Some(fault) = own.fault.take() {
            return Err(fault);
        }
        let program = self.setup.program;
        match own.columns.iter().find(|column| !column.is_finite(program)) {
            Some(column) => Err(RunError::NoDerivative {
                parameter: program.parameters[column.parameter].name.clone(),
                why: format!("at t = {} s it is not a finite number", self.state.time),
            }),
            None => Ok(()),
        }
    }
}

impl Sensitivities {
    /// Follows the tried step, which ends at this time and is about to be accepted.
    pub fn follow_step(
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
        let step = TakenStep {
            program: setup.program,
            method: setup.method,
            delay_lines,
            begin,
            length: self.length,
            stages: &self.stages,
            end: &buffers.voltages,
        };
        self.columns.iter_mut().for_each(|column| column.follow_step(&step));
    }

    /// Evaluates the voltages of all stages of the tried step again. The buffers are left as they were: at its end.
    fn evaluate_stages(
        &mut self,
        setup: &Setup<'_>,
        state: &SolverState,
        delay_lines: &mut [DelayLine],
        buffers: &mut StepBuffers,
    ) {
        let (program, method) = (setup.program, setup.method);
        let still = program.parts.moving;
        self.stages[0].copy_from_slice(&state.voltages);
        std::mem::swap(&mut self.end, &mut buffers.states);
        for (stage, row) in method.stages.iter().enumerate() {
            let voltages = &mut self.stages[stage + 1];
            voltages[..still].copy_from_slice(&state.voltages[..still]);
            std::mem::swap(voltages, &mut buffers.voltages);
            advance_states(&mut buffers.states, &state.states, &buffers.stage_rates, row.from, self.length);
            let scope = if stage == method.middle { Scope::All } else { Scope::Rates };
            trial(program, state, delay_lines, buffers, state.time + row.at * self.length, scope);
            std::mem::swap(&mut self.stages[stage + 1], &mut buffers.voltages);
        }
        std::mem::swap(&mut self.end, &mut buffers.states);
    }

    /// Evaluates the slopes of all voltages at a time at which the solver interpolates. `voltages` are those there.
    pub fn interpolate(
        &mut self,
        program: &Program,
        delay_lines: &[DelayLine],
        time: f64,
        curve: &Curve,
        voltages: &[f64],
    ) {
        for column in &mut self.columns {
            column.interpolate(program, (time, delay_lines), curve, voltages);
        }
    }

    /// Evaluates the slopes of all present voltages.
    pub fn evaluate(&mut self, program: &Program, state: &SolverState, delay_lines: &[DelayLine]) {
        for column in &mut self.columns {
            column.evaluate(program, state.time, delay_lines, &state.voltages);
        }
    }

    /// Samples the slopes of the values that stay constant within the next step.
    pub fn sample_values(&mut self, program: &Program) {
        self.columns.iter_mut().for_each(|column| column.sample_values(program));
    }

    /// Puts the present slopes of the inputs into the delay lines.
    pub fn record_delay_inputs(&mut self, program: &Program, time: f64) {
        for column in &mut self.columns {
            for (line, delay) in column.lines.iter_mut().zip(&program.delays) {
                line.put(time, column.voltages[delay.input.index()]);
            }
        }
    }

    /// Puts the slopes at the instant interpolated last into the delay lines.
    pub fn record_within(&mut self, program: &Program, time: f64) {
        for column in &mut self.columns {
            for (line, delay) in column.lines.iter_mut().zip(&program.delays) {
                line.put(time, column.trial_voltages[delay.input.index()]);
            }
        }
    }

    /// Records in the delay lines that slopes may jump or turn a corner at a fixed instant. During an event this is
    /// done when the event ends.
    pub fn record_discontinuity(&mut self, program: &Program, time: f64) {
        if !self.is_at_event {
            self.columns.iter_mut().for_each(|column| column.record_discontinuity(program, time, 0.0));
        }
    }

    /// Follows a change of mode: sets the slope of the state that the transition resets.
    pub fn change_mode(&mut self, program: &Program, voltages: &[f64], mode: usize, transition: &Transition) {
        self.check_threshold(program, voltages, mode, transition);
        let Some(reset) = transition.reset else { return };
        for column in &mut self.columns {
            column.states[reset.state as usize] = column.voltages[reset.to.index()];
        }
    }

    /// Sets the slopes of a state to 0, because an operator set it to a voltage.
    pub fn clear_state(&mut self, state: usize) {
        self.columns.iter_mut().for_each(|column| column.states[state] = 0.0);
    }

    /// Begins at initial condition, before the modes settle.
    pub fn begin(&mut self, program: &Program) {
        (self.is_at_event, self.begins) = (false, true);
        self.columns.iter_mut().for_each(|column| column.begin(program));
    }

    /// Ends the beginning: the modes have settled in initial condition.
    pub fn finish_begin(&mut self) {
        self.begins = false;
    }

    /// Records a fault if a transition in initial condition is exactly at its threshold and the threshold depends on a
    /// parameter: with another value the mode would not change.
    fn check_threshold(&mut self, program: &Program, voltages: &[f64], mode: usize, transition: &Transition) {
        if !self.begins || transition.guard.excess(voltages) != 0.0 {
            return;
        }
        let guard = transition.guard.register.index();
        let depends = |column: &&Column| column.voltages[guard].abs() > ZERO_SLOPE;
        if let Some(column) = self.columns.iter().find(depends) {
            let element = program.name(program.modes[mode].element);
            self.fault.get_or_insert(RunError::NoDerivative {
                parameter: program.parameters[column.parameter].name.clone(),
                why: format!("{element} is exactly at its switching threshold in initial condition"),
            });
        }
    }

    /// Follows parameters that an operator or a phase set, given by their indices. `slopes` has a row for every change;
    /// a missing row means that the new value depends on nothing.
    pub fn set(&mut self, changed: &[usize], slopes: &[Vec<f64>]) {
        for (change, index) in changed.iter().enumerate() {
            for (place, column) in self.columns.iter_mut().enumerate() {
                column.parameters[*index] = slopes.get(change).map_or(0.0, |slopes| slopes[place]);
            }
        }
    }

    /// Follows new coefficients: calculates their slopes, and those of the delays. `parameters` are in SI units, `time`
    /// is the present.
    pub fn follow_coefficients(
        &mut self,
        program: &Program,
        parameters: &[f64],
        delay_lines: &[DelayLine],
        time: f64,
    ) {
        self.follow(program, parameters);
        for column in &mut self.columns {
            let pairs = column.lines.iter_mut().zip(delay_lines).zip(&program.delays);
            for ((line, input), delay) in pairs {
                let longer = column.coefficients[delay.time as usize] * delay.problem_seconds;
                let initial = column.coefficients[delay.initial as usize];
                line.set(input.delay(), longer, initial, time);
            }
        }
    }

    /// The slopes of a formula's value in SI units, one for every parameter carried along.
    pub fn slopes_of_formula(&self, standing: &Standing<'_>, formula: &Formula) -> Vec<f64> {
        let slope = |column: &Column| {
            let slopes = StandingSlopes {
                parameters: &column.parameters,
                coefficients: &column.coefficients,
                registers: &column.voltages,
            };
            standing.slope(formula, &slopes)
        };
        self.columns.iter().map(slope).collect()
    }
}
