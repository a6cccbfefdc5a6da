//! The controls of an operator: setting parameters and integrators by hand, also while the machine runs.
//!
//! A change is made as a whole or not at all: if any part of it fails, the machine is as it was before.

use super::error::RunError;
use super::machine::{Machine, MachineMode};
use super::state::Solver;
use crate::ir::ChangedParameters;

impl Machine<'_> {
    /// Sets a parameter to a value in its declared unit, and with it all pots and settings that follow from it. This is
    /// also possible while the machine runs. In initial condition the initial conditions follow, too.
    ///
    /// # Errors
    /// If no parameter has this name, the value is outside its range, or a setting that follows does not fit its
    /// element. Nothing is changed then.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), RunError> {
        self.set_parameters(&[(name, value)])
    }

    /// Sets several parameters at one instant, in their declared units.
    ///
    /// # Errors
    /// As for [`Machine::set`]. Nothing is changed then.
    pub fn set_parameters(&mut self, changes: &[(&str, f64)]) -> Result<(), RunError> {
        // In initial condition, a value set by hand is a new value at which derivatives are taken.
        let is_running = self.mode != MachineMode::InitialCondition;
        self.set_with_slopes(changes, is_running.then_some(&[]))
    }

    /// Sets parameters whose new values depend on the parameters by which derivatives are carried along. `slopes` has a
    /// row for every change, with one derivative in SI units for each column; a missing row is zero. With `None` the
    /// values depend as before.
    pub(super) fn set_with_slopes(
        &mut self,
        changes: &[(&str, f64)],
        slopes: Option<&[Vec<f64>]>,
    ) -> Result<(), RunError> {
        let Solver { setup, state, .. } = &self.solver;
        let changed = setup.program.changed_parameters(&state.parameters, changes.iter().copied())?;
        let ChangedParameters { parameters, coefficients, changed } = changed;
        self.transaction(|machine| {
            machine.solver.enter_phase();
            let Solver { state, sensitivities, .. } = &mut machine.solver;
            (state.parameters, state.coefficients) = (parameters, coefficients);
            if let (Some(own), Some(slopes)) = (sensitivities, slopes) {
                own.set(&changed, slopes);
            }
            machine.apply_coefficients()?;
            machine.solver.leave_event()
        })
    }

    /// Sets the output of an integrator to a voltage, as an operator does who overrides its initial condition. This is
    /// also possible while the machine runs. It lasts until the next initial condition.
    ///
    /// # Errors
    /// If no integrator has this name, the voltage is outside its limits (±100 V unless it has narrower ones), or the
    /// voltages cannot be evaluated there. Nothing is changed then.
    pub fn set_state(&mut self, integrator: &str, volts: f64) -> Result<(), RunError> {
        let program = self.solver.setup.program;
        let state = program.states.iter().position(|state| program.name(state.element) == integrator);
        let Some(state) = state else { return Err(RunError::UnknownElement(integrator.to_owned())) };
        let limits = program.states[state].limits;
        let [low, high] = limits.map(|limit| self.solver.state.voltages[limit.index()]);
        if !(low <= volts && volts <= high) {
            let integrator = integrator.to_owned();
            return Err(RunError::StateOutsideRange { integrator, volts, low, high });
        }
        self.transaction(|machine| {
            machine.solver.enter_phase();
            let Solver { setup, state: own, sensitivities, .. } = &mut machine.solver;
            own.states[state] = volts;
            if let Some(sensitivities) = sensitivities {
                sensitivities.clear_state(state);
            }
            own.reset_modes(setup.program, setup.program.states[state].element);
            machine.reevaluate()?;
            machine.solver.leave_event()
        })
    }

    /// Makes a change. If it fails, the machine is restored as it was before, with all its buffers.
    fn transaction(
        &mut self,
        change: impl FnOnce(&mut Self) -> Result<(), RunError>,
    ) -> Result<(), RunError> {
        let before = self.clone();
        let outcome = change(self);
        if outcome.is_err() {
            *self = before;
        }
        outcome
    }

    /// Makes delay lines, derivatives, levels and kernels follow new coefficients, and evaluates everything again.
    fn apply_coefficients(&mut self) -> Result<(), RunError> {
        self.fast_path.forget_factors();
        let Solver { setup, state, delay_lines, sensitivities, .. } = &mut self.solver;
        for (line, delay) in delay_lines.iter_mut().zip(&setup.program.delays) {
            let (time, initial) =
                (state.coefficients[delay.time as usize], state.coefficients[delay.initial as usize]);
            line.set(time * delay.problem_seconds, initial, state.time);
        }
        if let Some(own) = sensitivities {
            own.follow_coefficients(setup.program, &state.parameters, delay_lines, state.time);
            own.check_parameters(setup.program)?;
        }
        state.begin_levels(setup);
        check_times(&self.solver)?;
        match self.mode {
            MachineMode::InitialCondition => self.initial_condition(),
            _ => self.reevaluate(),
        }
    }
}

/// Checks that delays and lags are not shorter than equal steps. Adaptive steps are never longer than a delay.
///
/// # Errors
/// If a delay or the time constant of a lag is shorter than the step.
pub(super) fn check_times(solver: &Solver<'_>) -> Result<(), RunError> {
    let Solver { setup, state, delay_lines, .. } = solver;
    if setup.is_adaptive {
        return Ok(());
    }
    let (program, step) = (setup.program, setup.step);
    let shortest = step * (1.0 - 1e-9);
    for (line, delay) in delay_lines.iter().zip(&program.delays) {
        if line.delay() < shortest {
            let element = program.name(delay.element).to_owned();
            return Err(RunError::DelayTooShort { element, delay: line.delay(), step });
        }
    }
    for own in &program.states {
        let time = own.lag.map(|lag| state.time_constant(lag));
        if let Some(time) = time.filter(|time| *time < shortest) {
            let element = program.name(own.element).to_owned();
            return Err(RunError::LagTooShort { element, time, step });
        }
    }
    Ok(())
}
