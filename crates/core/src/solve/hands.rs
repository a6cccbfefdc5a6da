//! What an operator does by hand, also while the machine runs: turning pots, setting integrators.

use super::error::RunError;
use super::machine::{Machine, MachineMode};
use crate::ir::{Fault, Program, TimeConstant, Unfit};

impl Machine<'_> {
    /// Turns whatever pots follow from a parameter, given in its declared unit; also while running.
    /// In initial condition the initial conditions follow too.
    ///
    /// # Errors
    /// When there is no such parameter, or a value or a setting leaves its range, is not whole where it must be,
    /// or does not stand to another as it must;
    /// nothing is changed then.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), RunError> {
        self.set_all(&[(name, value)])
    }

    /// The same with several parameters at one instant.
    ///
    /// # Errors
    /// Those of [`Machine::set`]; nothing is changed then.
    pub fn set_all(&mut self, changes: &[(&str, f64)]) -> Result<(), RunError> {
        // In initial condition a value by hand is another value to differentiate at.
        let is_running = self.mode != MachineMode::InitialCondition;
        self.turn(changes, is_running.then_some(&[]))
    }

    /// The same, telling how the values depend on the parameters by which derivatives are carried along: a row for
    /// every change, on nothing where there is none. Without, they depend as before.
    pub(super) fn turn(
        &mut self,
        changes: &[(&str, f64)],
        slopes: Option<&[Vec<f64>]>,
    ) -> Result<(), RunError> {
        let (parameters, coefficients) = turned(self.program, &self.parameters, changes)?;
        self.or_as_before(|machine| {
            machine.enter_phase();
            (machine.parameters, machine.coefficients) = (parameters, coefficients);
            machine.beside(|own, machine| {
                let changed = changes.iter().filter_map(|(name, _)| machine.program.parameter(name));
                if let Some(slopes) = slopes {
                    own.set(changed, slopes);
                }
            });
            machine.follow_coefficients()?;
            machine.leave_event()
        })
    }

    /// Puts the output of an integrator at a voltage, as an operator does who overrides its initial
    /// condition; also while running. It lasts until the next initial condition.
    ///
    /// # Errors
    /// When there is no such integrator, the voltage is not within its limits (±100 V without others), or the
    /// circuit cannot be worked out there; nothing is changed then.
    pub fn set_state(&mut self, integrator: &str, volts: f64) -> Result<(), RunError> {
        let state =
            self.program.states.iter().position(|state| self.program.name(state.element) == integrator);
        let Some(state) = state else { return Err(RunError::UnknownElement(integrator.to_owned())) };
        let [low, high] = self.program.states[state].limits.map(|limit| self.registers[limit.index()]);
        if !(low <= volts && volts <= high) {
            return Err(RunError::OutsideRange {
                what: integrator.to_owned(),
                value: volts,
                low,
                high,
                unit: "V".to_owned(),
            });
        }
        self.or_as_before(|machine| {
            machine.enter_phase();
            machine.states[state] = volts;
            machine.beside(|own, _| own.put_state(state));
            machine.begin_modes(machine.program.states[state].element);
            machine.disturbed()?;
            machine.leave_event()
        })
    }

    /// Makes a change, or leaves the machine as it was where the change cannot be made.
    fn or_as_before(
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

    fn follow_coefficients(&mut self) -> Result<(), RunError> {
        self.glider.forget_factors();
        for (line, delay) in self.lines.iter_mut().zip(&self.program.delays) {
            let (time, initial) =
                (self.coefficients[delay.time as usize], self.coefficients[delay.initial as usize]);
            line.set(time * delay.problem_seconds, initial, self.time);
        }
        self.beside(|own, machine| own.follow_coefficients(machine));
        self.check_differentiable()?;
        self.begin_levels();
        self.check_times()?;
        match self.mode {
            MachineMode::InitialCondition => self.initial_condition(),
            _ => self.disturbed(),
        }
    }

    /// Puts the modes of an element to where they stand in initial condition.
    fn begin_modes(&mut self, element: usize) {
        for (value, mode) in self.modes.iter_mut().zip(&self.program.modes) {
            if mode.element == element {
                *value = mode.initial;
            }
        }
    }

    /// A time constant in problem seconds.
    pub(super) fn time_of(&self, lag: TimeConstant) -> f64 {
        self.coefficient(lag.time) * lag.problem_seconds
    }

    /// Delays and lags must not be shorter than equal steps.
    pub(super) fn check_times(&self) -> Result<(), RunError> {
        if self.control.is_some() {
            return Ok(());
        }
        let shortest = self.step * (1.0 - 1e-9);
        for (line, delay) in self.lines.iter().zip(&self.program.delays) {
            if line.delay() < shortest {
                let element = self.program.name(delay.element).to_owned();
                return Err(RunError::DelayTooShort { element, delay: line.delay(), step: self.step });
            }
        }
        for state in &self.program.states {
            if let Some(time) = state.lag.map(|lag| self.time_of(lag)).filter(|time| *time < shortest) {
                let element = self.program.name(state.element).to_owned();
                return Err(RunError::LagTooShort { element, time, step: self.step });
            }
        }
        Ok(())
    }
}

/// Sets parameters of a program before a run, in their declared units, as if its circuit had been made with them.
///
/// # Errors
/// Those of [`Machine::set`]; nothing is changed then.
pub fn preset(program: &mut Program, changes: &[(&str, f64)]) -> Result<(), RunError> {
    let before: Vec<f64> = program.parameters.iter().map(|slot| slot.value).collect();
    let (parameters, _) = turned(program, &before, changes)?;
    for (slot, value) in program.parameters.iter_mut().zip(parameters) {
        slot.value = value;
    }
    Ok(())
}

/// Parameters in SI with changes in their declared units, and the coefficients that follow.
fn turned(
    program: &Program,
    parameters: &[f64],
    changes: &[(&str, f64)],
) -> Result<(Vec<f64>, Vec<f64>), RunError> {
    let mut parameters = parameters.to_vec();
    for (name, value) in changes {
        let (index, value) = in_si(program, name, *value)?;
        parameters[index] = value;
    }
    let coefficients = program.prepare(&parameters);
    match program.first_unfit(&coefficients) {
        Some(unfit) => Err(refused(&unfit)),
        None => Ok((parameters, coefficients)),
    }
}

/// Index of a parameter, and a value of it in SI.
fn in_si(program: &Program, name: &str, value: f64) -> Result<(usize, f64), RunError> {
    let index = program.parameter(name).ok_or_else(|| RunError::UnknownParameter(name.to_owned()))?;
    let slot = &program.parameters[index];
    let (low, high) = slot.range.unwrap_or((f64::MIN, f64::MAX));
    if !(low <= value && value <= high) {
        let (what, unit) = (name.to_owned(), slot.unit.clone());
        return Err(RunError::OutsideRange { what, value, low, high, unit });
    }
    Ok((index, value * slot.per_unit))
}

/// Why a coefficient cannot have its value.
fn refused(unfit: &Unfit<'_>) -> RunError {
    let (what, value) = (unfit.coefficient.label.clone(), unfit.value);
    match unfit.fault {
        Fault::Range(low, high) => RunError::OutsideRange { what, value, low, high, unit: String::new() },
        Fault::NotWhole => RunError::NotWhole { what, value },
        Fault::Order(stands, other, limit) => {
            RunError::OutOfOrder { what, value, stands, other: other.label.clone(), limit }
        }
    }
}
