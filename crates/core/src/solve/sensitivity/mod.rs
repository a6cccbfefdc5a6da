//! Derivatives of a run by parameters, carried along beside it (forward sensitivities).
//!
//! In a stretch between events the derivative of the step itself is taken, stage by stage. At an event whose instant
//! T depends on the parameter, with rates f before and g after it: T' = -(derivative of the guard) / (its slope along
//! the motion), the states go on with their derivatives at the moving instant, x' + f T', are set anew where the event
//! does so, and come back to a fixed time with - g T' (saltation).

mod column;
mod hooks;
mod line;
mod saltation;

use super::error::RunError;
use super::level_source::most_jumps;
use super::machine::Machine;
use super::tableau::Tableau;
use crate::ir::{Probe, Program};
use column::Column;
use line::Line;

/// The derivatives that a machine carries along.
#[derive(Debug, Clone)]
pub(super) struct Sensitivities {
    columns: Vec<Column>,
    /// The voltages of the stages of a stretch.
    stages: Vec<Vec<f64>>,
    /// Place for the states at its end meanwhile.
    end: Vec<f64>,
    /// The voltages' slopes along the motion, at an event.
    flow: Vec<f64>,
    /// What comes out of the delay lines, along the motion.
    delayed_flow: Vec<f64>,
    /// Zeros, as many as there are coefficients or kept values.
    nothing: Vec<f64>,
    /// Length of the last stretch.
    length: f64,
    /// Whether an event is being carried out.
    is_at_event: bool,
    /// Whether the machine is put into initial condition.
    begins: bool,
    /// What went wrong where nothing could be told of it.
    fault: Option<RunError>,
}

impl Sensitivities {
    fn new(program: &Program, method: &Tableau, parameters: &[usize]) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        Sensitivities {
            columns: parameters.iter().map(|index| Column::new(program, *index, method)).collect(),
            stages: vec![zeros(program.body.len()); method.stages.len() + 1],
            end: zeros(program.states.len()),
            flow: zeros(program.body.len()),
            delayed_flow: zeros(program.delays.len()),
            nothing: zeros(program.coefficients.len().max(program.kept.len())),
            length: 0.0,
            is_at_event: false,
            begins: false,
            fault: None,
        }
    }

    /// How many parameters there are.
    pub fn count(&self) -> usize {
        self.columns.len()
    }

    /// The derivative of a signal by the parameter of this place, now or where the machine was last looked back at.
    pub fn derivative(&self, place: usize, probe: &Probe, machine: &Machine<'_>, is_now: bool) -> f64 {
        let (column, at) = (&self.columns[place], probe.register.index());
        let pair = match is_now {
            true => [machine.registers[at], column.registers[at]],
            false => [machine.trial_registers[at], column.trial_registers[at]],
        };
        column.derivative(machine, probe, pair)
    }

    /// The slopes of the coefficients where those of the parameters are new.
    fn follow(&mut self, program: &Program, parameters: &[f64]) {
        for column in &mut self.columns {
            column.coefficients = program.coefficient_slopes(parameters, &column.parameters);
        }
    }
}

impl Machine<'_> {
    /// Puts the machine into initial condition and carries the derivatives by these parameters along from there;
    /// with none, nothing is carried along. Derivatives hold at fixed problem times; [`Machine::set`] while it runs
    /// puts a parameter to a value that depends on none.
    ///
    /// # Errors
    /// When there is no such parameter, the machine does not depend on one in a way that has a derivative, or what
    /// [`Machine::initial_condition`] cannot do.
    pub fn differentiate(&mut self, parameters: &[&str]) -> Result<(), RunError> {
        let found: Result<Vec<_>, _> = parameters.iter().map(|name| self.differentiable(name)).collect();
        let found = found?;
        self.sensitivities = None;
        if !found.is_empty() {
            let mut own = Sensitivities::new(self.program, self.method, &found);
            own.follow(self.program, &self.parameters);
            own.columns.iter_mut().for_each(|column| column.lines = self.lines_of(&column.coefficients));
            own.columns.iter().try_for_each(|column| self.check_column(column))?;
            self.sensitivities = Some(Box::new(own));
        }
        self.initial_condition()
    }

    /// The derivative of a signal, drive or element here and now, in its unit per declared unit of a parameter, as it
    /// would be recorded.
    ///
    /// # Errors
    /// When there is no such signal, or no derivative by the parameter is carried along.
    pub fn sensitivity(&self, signal: &str, parameter: &str) -> Result<f64, RunError> {
        let probe = self.program.signals.iter().find(|probe| probe.name == signal);
        let probe = probe.ok_or_else(|| RunError::UnknownSignal(signal.to_owned()))?;
        let (column, at) = (self.column(parameter)?, probe.register.index());
        Ok(column.derivative(self, probe, [self.registers[at], column.registers[at]]))
    }

    /// The derivatives of the states, in volts per declared unit of a parameter, in the order of
    /// [`Program::states`](crate::ir::Program::states).
    ///
    /// # Errors
    /// When no derivative by the parameter is carried along.
    pub fn state_sensitivities(&self, parameter: &str) -> Result<Vec<f64>, RunError> {
        let column = self.column(parameter)?;
        let unit = column.size / self.program.parameters[column.parameter].per_unit;
        Ok(column.states.iter().map(|slope| slope / unit).collect())
    }

    fn column(&self, parameter: &str) -> Result<&Column, RunError> {
        let columns = self.sensitivities.iter().flat_map(|own| &own.columns);
        let is_it = |column: &&Column| self.program.parameters[column.parameter].name == parameter;
        columns.into_iter().find(is_it).ok_or_else(|| RunError::NoDerivative {
            parameter: parameter.to_owned(),
            why: "none is carried along".to_owned(),
        })
    }

    fn differentiable(&self, name: &str) -> Result<usize, RunError> {
        self.program.parameter(name).ok_or_else(|| RunError::NoDerivative {
            parameter: name.to_owned(),
            why: "there is no such parameter".to_owned(),
        })
    }

    fn lines_of(&self, slopes: &[f64]) -> Vec<Line> {
        let jumps = most_jumps(self.program, &self.level_sources);
        let lines = self.lines.iter().zip(&self.program.delays).map(|(line, delay)| {
            let longer = slopes[delay.time as usize] * delay.problem_seconds;
            let initial = slopes[delay.initial as usize];
            // A slope may jump where its voltage does, and where that has a corner.
            Line::new(line.delay(), longer, initial, self.step).with_room_for(2.0 * jumps)
        });
        lines.collect()
    }

    /// Refuses parameters that the machine follows by leaps.
    pub(super) fn check_differentiable(&self) -> Result<(), RunError> {
        let mut columns = self.sensitivities.iter().flat_map(|own| &own.columns);
        columns.try_for_each(|column| self.check_column(column))
    }

    fn check_column(&self, column: &Column) -> Result<(), RunError> {
        let refused = |why: String| RunError::NoDerivative {
            parameter: self.program.parameters[column.parameter].name.clone(),
            why,
        };
        for noise in self.program.noises() {
            let slopes = [noise.seed, noise.every].map(|index| column.coefficients[index as usize]);
            if slopes.iter().any(|slope| *slope != 0.0) {
                let name = self.program.name(noise.element);
                return Err(refused(format!("{name} draws other numbers for every other value")));
            }
        }
        match column.coefficients.iter().position(|slope| !slope.is_finite()) {
            Some(index) => {
                let label = &self.program.coefficients[index].label;
                Err(refused(format!("{label} has no finite derivative")))
            }
            None => Ok(()),
        }
    }
}
