//! Derivatives of a run by parameters, carried along with it (forward sensitivities).
//!
//! Between events the derivative of each step itself is taken, stage by stage. The instant T of an event may depend on
//! the parameter. With rates f before the event and g after it, its derivative is T' = -(derivative of the guard) /
//! (slope of the guard along the motion). The states then continue with their derivatives at the shifting instant,
//! x' + f T'. They are reset if the event does so, and return to a fixed time with - g T' (saltation).
//!
//! `column` holds the derivatives by one parameter, `line` those in a delay line, `hooks` the places at which the
//! solver makes them follow, and `saltation` the events.

mod column;
mod hooks;
mod line;
mod saltation;

use super::error::RunError;
use super::levels::jump_rate;
use super::machine::Machine;
use super::state::Solver;
use super::tableau::Tableau;
use crate::ir::{Probe, Program};
use column::Column;
use line::Line;

/// The derivatives that a solver carries along.
#[derive(Debug, Clone)]
pub(super) struct Sensitivities {
    /// One column for every parameter, in the order in which they were given.
    columns: Vec<Column>,
    /// The voltages of the stages of the last step.
    stages: Vec<Vec<f64>>,
    /// Buffer for the states at the end of a step while its stages are evaluated again.
    end: Vec<f64>,
    /// The slopes of the voltages along the motion at an event, in volts per problem second.
    flow: Vec<f64>,
    /// The slopes of the outputs of the delay lines along the motion.
    delayed_flow: Vec<f64>,
    /// Zeros, as many as there are coefficients or sampled values.
    zeros: Vec<f64>,
    /// Length of the last step in problem seconds.
    length: f64,
    /// Whether an event is being carried out.
    is_at_event: bool,
    /// Whether the modes are settling in initial condition.
    begins: bool,
    /// A change of mode without a derivative, found where no error could be returned.
    fault: Option<RunError>,
}

impl Sensitivities {
    /// The derivatives by the parameters of these indices. They begin with the next initial condition.
    fn new(program: &Program, method: &Tableau, parameters: &[usize]) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        Sensitivities {
            columns: parameters.iter().map(|index| Column::new(program, *index, method)).collect(),
            stages: vec![zeros(program.body.len()); method.stages.len() + 1],
            end: zeros(program.states.len()),
            flow: zeros(program.body.len()),
            delayed_flow: zeros(program.delays.len()),
            zeros: zeros(program.coefficients.len().max(program.kept.len())),
            length: 0.0,
            is_at_event: false,
            begins: false,
            fault: None,
        }
    }

    /// The number of parameters.
    pub fn count(&self) -> usize {
        self.columns.len()
    }

    /// The derivative of a signal by the parameter of this column, in its unit per declared unit of the parameter: at
    /// the present if `is_now`, else at the instant interpolated last.
    pub fn derivative(&self, place: usize, probe: &Probe, solver: &Solver<'_>, is_now: bool) -> f64 {
        let (column, at) = (&self.columns[place], probe.register.index());
        let pair = match is_now {
            true => [solver.state.voltages[at], column.voltages[at]],
            false => [solver.buffers.voltages[at], column.trial_voltages[at]],
        };
        column.derivative(solver.setup.program, &solver.state.coefficients, probe, pair)
    }

    /// Calculates the slopes of the coefficients from those of the parameters. `parameters` are values in SI units.
    fn follow(&mut self, program: &Program, parameters: &[f64]) {
        for column in &mut self.columns {
            column.coefficients = program.coefficient_slopes(parameters, &column.parameters);
        }
    }

    /// Checks that the program depends on every parameter in a way that has a derivative.
    ///
    /// # Errors
    /// If it does not.
    pub fn check_parameters(&self, program: &Program) -> Result<(), RunError> {
        self.columns.iter().try_for_each(|column| column.check(program))
    }
}

impl Machine<'_> {
    /// Puts the machine into initial condition and carries along the derivatives by these parameters from there. With
    /// an empty list, no derivatives are carried along. Derivatives are those at fixed problem times. [`Machine::set`]
    /// while the machine runs sets a parameter to a value that depends on no parameter.
    ///
    /// # Errors
    /// If no parameter has this name, the machine does not depend on one in a way that has a derivative, or
    /// [`Machine::initial_condition`] fails.
    pub fn differentiate(&mut self, parameters: &[&str]) -> Result<(), RunError> {
        let program = self.solver.setup.program;
        let found: Result<Vec<_>, _> = parameters.iter().map(|name| parameter_index(program, name)).collect();
        let found = found?;
        self.solver.sensitivities = None;
        if !found.is_empty() {
            let mut own = Sensitivities::new(program, self.solver.setup.method, &found);
            own.follow(program, &self.solver.state.parameters);
            for column in &mut own.columns {
                column.lines = lines_of(&self.solver, &column.coefficients);
            }
            own.check_parameters(program)?;
            self.solver.sensitivities = Some(Box::new(own));
        }
        self.initial_condition()
    }

    /// The present derivative of a signal, drive or element, in its unit per declared unit of a parameter, as it would
    /// be recorded.
    ///
    /// # Errors
    /// If no signal has this name, or no derivative by the parameter is carried along.
    pub fn sensitivity(&self, signal: &str, parameter: &str) -> Result<f64, RunError> {
        let (program, state) = (self.solver.setup.program, &self.solver.state);
        let probe = program.signals.iter().find(|probe| probe.name == signal);
        let probe = probe.ok_or_else(|| RunError::UnknownSignal(signal.to_owned()))?;
        let (column, at) = (self.solver.column(parameter)?, probe.register.index());
        let pair = [state.voltages[at], column.voltages[at]];
        Ok(column.derivative(program, &state.coefficients, probe, pair))
    }

    /// The present derivatives of the states, in volts per declared unit of a parameter, in the order of
    /// [`Program::states`](crate::ir::Program::states).
    ///
    /// # Errors
    /// If no derivative by the parameter is carried along.
    pub fn state_sensitivities(&self, parameter: &str) -> Result<Vec<f64>, RunError> {
        let column = self.solver.column(parameter)?;
        let unit = column.size / self.solver.setup.program.parameters[column.parameter].per_unit;
        Ok(column.states.iter().map(|slope| slope / unit).collect())
    }
}

impl Solver<'_> {
    /// The derivatives by a parameter.
    ///
    /// # Errors
    /// If none are carried along.
    fn column(&self, parameter: &str) -> Result<&Column, RunError> {
        let columns = self.sensitivities.iter().flat_map(|own| &own.columns);
        let is_it = |column: &&Column| self.setup.program.parameters[column.parameter].name == parameter;
        columns.into_iter().find(is_it).ok_or_else(|| RunError::NoDerivative {
            parameter: parameter.to_owned(),
            why: "none is carried along".to_owned(),
        })
    }
}

/// The index of a parameter by which derivatives are wanted.
fn parameter_index(program: &Program, name: &str) -> Result<usize, RunError> {
    program.parameter(name).ok_or_else(|| RunError::NoDerivative {
        parameter: name.to_owned(),
        why: "there is no such parameter".to_owned(),
    })
}

/// The slopes in the delay lines of a solver, from the slopes of its coefficients.
fn lines_of(solver: &Solver<'_>, slopes: &[f64]) -> Vec<Line> {
    let Solver { setup, state, delay_lines, .. } = solver;
    let jumps = jump_rate(setup.program, &state.level_sources);
    let lines = delay_lines.iter().zip(&setup.program.delays).map(|(line, delay)| {
        let longer = slopes[delay.time as usize] * delay.problem_seconds;
        let initial = slopes[delay.initial as usize];
        // A slope may jump where its voltage jumps, and where its voltage has a corner.
        Line::new(line.delay(), longer, initial, setup.step).with_room_for(2.0 * jumps)
    });
    lines.collect()
}
