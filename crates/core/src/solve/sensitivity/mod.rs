//! Derivatives of a run by parameters, computed during the run (forward sensitivities).
//!
//! Between events, each step itself is differentiated, stage by stage, so the derivatives belong to the discrete
//! solution. The instant T of an event may depend on the parameter. Let f be the rates before the event and g those
//! after it. The derivative of the instant is T' = -(derivative of the guard) / (slope of the guard along the motion).
//! The derivatives of the states at the shifting instant are x' + f T'. The event may reset them. Then they return to a
//! fixed time with - g T' (saltation).
//!
//! `parameter_slopes` contains the derivatives by one parameter, and `delayed_slopes` those in a delay line. `hooks` is
//! called by the solver when it evaluates, steps or changes a parameter. `saltation` handles the events. In this module
//! a *slope* is a derivative by a parameter, multiplied by the size of the parameter.

mod delayed_slopes;
mod hooks;
mod parameter_slopes;
mod saltation;

use super::error::RunError;
use super::levels::jump_rate;
use super::machine::Machine;
use super::state::{Setup, Solver};
use super::tableau::Tableau;
use crate::ir::{Program, SignalInfo};
use delayed_slopes::DelayedSlopes;
use parameter_slopes::ParameterSlopes;

/// The derivatives of a solver by some parameters.
#[derive(Debug, Clone)]
pub(super) struct Sensitivities {
    /// The slopes by each parameter, in the order in which the parameters were given.
    by_parameter: Vec<ParameterSlopes>,
    /// The voltages of the stages of the last step, one row per stage, the first stage included.
    stages: Vec<Vec<f64>>,
    /// Buffer for the states at the end of a step while its stages are evaluated again.
    end: Vec<f64>,
    /// The time derivatives of the voltages at an event, in volts per problem second.
    flow: Vec<f64>,
    /// The time derivatives of the outputs of the delay lines at an event, in volts per problem second.
    delayed_flow: Vec<f64>,
    /// Zeros, as many as there are coefficients or sampled values.
    zeros: Vec<f64>,
    /// Length of the last step in problem seconds.
    length: f64,
    /// Whether an event is being handled: slopes are those at the shifting instant.
    is_at_event: bool,
    /// Whether the modes are settling in initial condition.
    is_settling: bool,
    /// A change of mode without a derivative, detected where no error could be returned.
    fault: Option<RunError>,
}

impl Sensitivities {
    /// The derivatives by the parameters with these indices. They are valid from the next initial condition.
    fn new(program: &Program, method: &Tableau, parameters: &[usize]) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        Sensitivities {
            by_parameter: parameters
                .iter()
                .map(|index| ParameterSlopes::new(program, *index, method))
                .collect(),
            stages: vec![zeros(program.lowered.body.len()); method.stages.len() + 1],
            end: zeros(program.lowered.states.len()),
            flow: zeros(program.lowered.body.len()),
            delayed_flow: zeros(program.lowered.delays.len()),
            zeros: zeros(program.lowered.coefficients.len().max(program.lowered.sampled.len())),
            length: 0.0,
            is_at_event: false,
            is_settling: false,
            fault: None,
        }
    }

    /// The number of parameters.
    pub(super) fn count(&self) -> usize {
        self.by_parameter.len()
    }

    /// The derivative of a signal by the parameter of this position, in the unit of the signal per declared unit of the
    /// parameter: at the present if `is_present`, else at the instant interpolated last.
    pub(super) fn derivative(
        &self,
        index: usize,
        signal: &SignalInfo,
        solver: &Solver<'_>,
        is_present: bool,
    ) -> f64 {
        let (slopes, register) = (&self.by_parameter[index], signal.register.index());
        let pair = match is_present {
            true => [solver.state.voltages[register], slopes.voltages[register]],
            false => [solver.buffers.voltages[register], slopes.trial_voltages[register]],
        };
        slopes.derivative(solver.setup.program, &solver.state.coefficients, signal, pair)
    }

    /// Calculates the slopes of the coefficients from those of the parameters. `parameters` are values in SI units.
    fn update_coefficient_slopes(&mut self, program: &Program, parameters: &[f64]) {
        for slopes in &mut self.by_parameter {
            slopes.coefficients = program.coefficient_slopes(parameters, &slopes.parameters);
        }
    }

    /// Checks that the program depends on every parameter in a way that has a derivative. `coefficients` are the
    /// present ones.
    ///
    /// # Errors
    /// If it does not, for example because a parameter is the seed of a noise voltage.
    pub(super) fn check_parameters(&self, setup: &Setup<'_>, coefficients: &[f64]) -> Result<(), RunError> {
        self.by_parameter.iter().try_for_each(|slopes| slopes.check(setup, coefficients))
    }
}

impl Machine<'_> {
    /// Puts the machine into initial condition, and computes derivatives by these parameters from then on. With an
    /// empty list, no derivatives are computed. Derivatives are those at fixed problem times. While the machine runs,
    /// [`Machine::set_parameter`] sets a parameter to a value that depends on no parameter.
    ///
    /// # Errors
    /// If no parameter has this name, the machine does not depend on one in a way that has a derivative, or
    /// [`Machine::initial_condition`] fails.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// // x = x0 exp(-t), so dx/dx0 = exp(-t)
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", "x0");
    /// let patch = PatchBuilder::new("decay").parameter("x0", 50.0, "V", [-100.0, 100.0]);
    /// let patch = patch.element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let mut machine = Machine::new(&program, 1e-3)?;
    /// machine.differentiate(["x0"])?;
    /// machine.operate(1.0)?;
    /// assert!((machine.sensitivity("A1", "x0")? - (-1.0f64).exp()).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn differentiate(
        &mut self,
        parameters: impl IntoIterator<Item = impl AsRef<str>>,
    ) -> Result<(), RunError> {
        let program = self.solver.setup.program;
        let indices: Result<Vec<_>, _> =
            parameters.into_iter().map(|name| parameter_index(program, name.as_ref())).collect();
        let indices = indices?;
        self.solver.sensitivities = None;
        if !indices.is_empty() {
            let mut sensitivities = Sensitivities::new(program, self.solver.setup.method, &indices);
            sensitivities.update_coefficient_slopes(program, &self.solver.state.parameters);
            for slopes in &mut sensitivities.by_parameter {
                slopes.lines = delayed_slopes_of(&self.solver, &slopes.coefficients);
            }
            sensitivities.check_parameters(&self.solver.setup, &self.solver.state.coefficients)?;
            self.solver.sensitivities = Some(Box::new(sensitivities));
        }
        self.initial_condition()
    }

    /// The present derivative of a signal, drive or element, in its unit per declared unit of a parameter. A run
    /// records the same value.
    ///
    /// # Errors
    /// If no signal has this name, or no derivative by the parameter is computed.
    pub fn sensitivity(&self, signal: &str, parameter: &str) -> Result<f64, RunError> {
        let (program, state) = (self.solver.setup.program, &self.solver.state);
        let info = program.recordable_signal(signal);
        let info = info.ok_or_else(|| RunError::UnknownSignal(signal.to_owned()))?;
        let (slopes, register) = (self.solver.slopes(parameter)?, info.register.index());
        let pair = [state.voltages[register], slopes.voltages[register]];
        Ok(slopes.derivative(program, &state.coefficients, info, pair))
    }

    /// The present derivatives of the states, in volts per declared unit of a parameter, in the order of
    /// [`Program::states`](crate::ir::Program::states).
    ///
    /// # Errors
    /// If no derivative by the parameter is computed.
    pub fn state_sensitivities(&self, parameter: &str) -> Result<Vec<f64>, RunError> {
        let slopes = self.solver.slopes(parameter)?;
        let unit = slopes.size / self.solver.setup.program.parameters[slopes.parameter].declared.per_unit;
        Ok(slopes.states.iter().map(|slope| slope / unit).collect())
    }
}

impl Solver<'_> {
    /// The slopes by the parameter with this name.
    ///
    /// # Errors
    /// If no derivative by it is computed.
    fn slopes(&self, parameter: &str) -> Result<&ParameterSlopes, RunError> {
        let index = self.setup.program.parameter(parameter);
        let mut candidates = self.sensitivities.iter().flat_map(|sensitivities| &sensitivities.by_parameter);
        candidates.find(|slopes| Some(slopes.parameter) == index).ok_or_else(|| RunError::NoDerivative {
            parameter: parameter.to_owned(),
            why: "it is not computed in this run; pass the parameter to `Machine::differentiate`".to_owned(),
        })
    }
}

/// The index of a parameter by which derivatives are to be computed.
///
/// # Errors
/// If no parameter has this name.
fn parameter_index(program: &Program, name: &str) -> Result<usize, RunError> {
    program.parameter(name).ok_or_else(|| RunError::NoDerivative {
        parameter: name.to_owned(),
        why: "the patch declares no such parameter; choose one that it declares".to_owned(),
    })
}

/// Empty slopes for the delay lines of a solver, in their order, from the slopes of its coefficients.
fn delayed_slopes_of(solver: &Solver<'_>, slopes: &[f64]) -> Vec<DelayedSlopes> {
    let Solver { setup, state, delay_lines, .. } = solver;
    let jumps = jump_rate(setup.program, &state.level_sources);
    let lines = delay_lines.iter().zip(&setup.program.lowered.delays).map(|(line, delay)| {
        let delay_slope = slopes[delay.time as usize] * delay.problem_seconds;
        let initial_slope = slopes[delay.initial as usize];
        // A slope may jump where its voltage jumps, and where its voltage has a corner.
        DelayedSlopes::new(line.delay(), delay_slope, initial_slope, setup.step)
            .with_capacity_for(2.0 * jumps)
    });
    lines.collect()
}
