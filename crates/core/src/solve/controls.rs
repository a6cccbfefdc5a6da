//! The controls of an operator: setting parameters and integrators by hand, also while the machine runs.
//!
//! A change is a transaction: if any part of it fails, the machine is restored to its state before the change. The
//! phases of a run use the same functions.

use super::error::RunError;
use super::machine::{Machine, MachineMode};
use super::state::Solver;
use crate::ir::ChangedParameters;

impl Machine<'_> {
    /// Sets a parameter to a value in its declared unit, and all pots and settings that depend on it. This is also
    /// possible while the machine runs. In initial condition the initial voltages change, too.
    ///
    /// # Errors
    /// If no parameter has this name, the value is outside its range, a setting that depends on it does not fit its
    /// element, a delay or lag becomes shorter than equal steps, or the voltages cannot be evaluated. Nothing is
    /// changed then.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// // dx/dt = -k x, from 50 V
    /// # let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
    /// # let decay = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
    /// # let patch = PatchBuilder::new("dx/dt = -k x").parameter("k", 0.5, "1", [0.0, 1.0]);
    /// # let patch = patch.element("A1", decay).element("P1", pot).run(1.0, 1e-3).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let mut machine = Machine::new(&program, 1e-3)?;
    /// machine.operate(0.5)?;
    /// let before = machine.voltage("A1")?;
    /// machine.set_parameter("k", 0.0)?;
    /// machine.operate(0.5)?;
    /// assert!((machine.voltage("A1")? - before).abs() < 1e-12);
    /// assert_eq!(machine.set_parameter("q", 1.0).unwrap_err().code(), "unknown-parameter");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_parameter(&mut self, name: &str, value: f64) -> Result<(), RunError> {
        self.set_parameters([(name, value)])
    }

    /// Sets several parameters at one instant. Each change is a name and a value in the declared unit.
    ///
    /// # Errors
    /// As for [`Machine::set_parameter`]. Nothing is changed then.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// let input = ElementBuilder::new("pot").cord("in", "+100").set("setting", "a");
    /// let output = ElementBuilder::new("pot").cord("in", "P1").set("setting", "b");
    /// let patch = PatchBuilder::new("pots").parameter("a", 0.5, "1", [0.0, 1.0]).parameter("b", 0.5, "1", [0.0, 1.0]);
    /// let patch = patch.element("P1", input).element("P2", output).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let mut machine = Machine::new(&program, 1e-3)?;
    /// machine.set_parameters([("a", 0.2), ("b", 0.1)])?;
    /// assert!((machine.voltage("P2")? - 2.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_parameters(
        &mut self,
        changes: impl IntoIterator<Item = (impl AsRef<str>, f64)>,
    ) -> Result<(), RunError> {
        // In initial condition, derivatives are taken at the new value. While running, a constant replaces the
        // parameter.
        let is_running = self.mode != MachineMode::InitialCondition;
        self.set_with_slopes(changes, is_running.then_some(&[]))
    }

    /// Sets parameters whose new values may depend on the parameters by which derivatives are computed. `slopes`
    /// has a row for every change. A row has one derivative in SI units for each of those parameters, in their order; a
    /// missing row is zero. With `None` the derivatives of the parameters stay as they are.
    ///
    /// # Errors
    /// As for [`Machine::set_parameter`], and if a derivative does not exist after the change. Nothing is changed then.
    pub(super) fn set_with_slopes(
        &mut self,
        changes: impl IntoIterator<Item = (impl AsRef<str>, f64)>,
        slopes: Option<&[Vec<f64>]>,
    ) -> Result<(), RunError> {
        let Solver { setup, state, .. } = &self.solver;
        let changed = setup.program.changed_parameters(&state.parameters, changes)?;
        let ChangedParameters { parameters, coefficients, changed } = changed;
        self.transaction(|machine| {
            machine.solver.enter_phase();
            let Solver { state, sensitivities, .. } = &mut machine.solver;
            (state.parameters, state.coefficients) = (parameters, coefficients);
            if let (Some(sensitivities), Some(slopes)) = (sensitivities, slopes) {
                sensitivities.set_parameter_slopes(&changed, slopes);
            }
            machine.apply_coefficients()?;
            machine.solver.leave_event()
        })
    }

    /// Sets the output of an integrator or a lag to a voltage, as an operator who overrides its initial condition. This
    /// is also possible while the machine runs. The next initial condition restores the initial voltage.
    ///
    /// # Errors
    /// If no integrator or lag has this name, the voltage is outside its limits (±100 V unless it has narrower ones),
    /// or the voltages cannot be evaluated there. Nothing is changed then.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let mut machine = Machine::new(&program, 1e-3)?;
    /// machine.set_state("A1", 10.0)?;
    /// assert_eq!(machine.voltage("A1")?, 10.0);
    /// let error = machine.set_state("A1", 200.0).unwrap_err();
    /// assert!(error.to_string().starts_with("A1 cannot be set to 200 V, outside -100 ... 100 V"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_state(&mut self, integrator: &str, volts: f64) -> Result<(), RunError> {
        let program = self.solver.setup.program;
        let state = program.lowered.states.iter().position(|state| program.name(state.element) == integrator);
        let Some(state) = state else { return Err(RunError::UnknownElement(integrator.to_owned())) };
        let limits = program.lowered.states[state].limits;
        let [low, high] = limits.map(|limit| self.solver.state.voltages[limit.index()]);
        if !(low <= volts && volts <= high) {
            let integrator = integrator.to_owned();
            return Err(RunError::StateOutsideRange { integrator, volts, low, high });
        }
        self.transaction(|machine| {
            machine.solver.enter_phase();
            let Solver { setup, state: solver_state, sensitivities, .. } = &mut machine.solver;
            solver_state.states[state] = volts;
            if let Some(sensitivities) = sensitivities {
                sensitivities.clear_state(state);
            }
            solver_state.reset_modes(setup.program, setup.program.lowered.states[state].element);
            machine.reevaluate()?;
            machine.solver.leave_event()
        })
    }

    /// Makes a change. If it fails, the machine is restored from a copy, with all its buffers.
    ///
    /// # Errors
    /// The error of the change.
    pub(super) fn transaction(
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

    /// Applies new coefficients to delay lines, derivatives, levels and kernels, and evaluates all voltages again. In
    /// initial condition the machine begins again.
    ///
    /// # Errors
    /// If a delay or lag is shorter than equal steps, a parameter has no derivative, or the evaluation fails.
    fn apply_coefficients(&mut self) -> Result<(), RunError> {
        self.fast_path.invalidate_factors();
        let Solver { setup, state, delay_lines, sensitivities, .. } = &mut self.solver;
        for (line, delay) in delay_lines.iter_mut().zip(&setup.program.lowered.delays) {
            let (time, initial) =
                (state.coefficients[delay.time as usize], state.coefficients[delay.initial as usize]);
            line.set(time * delay.problem_seconds, initial, state.time);
        }
        if let Some(sensitivities) = sensitivities {
            sensitivities.update_coefficients(setup.program, &state.parameters, delay_lines, state.time);
            sensitivities.check_parameters(setup, &state.coefficients)?;
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
    // A delay of one step may be shorter by rounding.
    let shortest = step * (1.0 - 1e-9);
    for (line, delay) in delay_lines.iter().zip(&program.lowered.delays) {
        if line.delay() < shortest {
            let element = program.name(delay.element).to_owned();
            return Err(RunError::DelayTooShort { element, delay: line.delay(), step });
        }
    }
    for state_info in &program.lowered.states {
        let time = state_info.lag.map(|lag| state.time_constant(lag));
        if let Some(time) = time.filter(|time| *time < shortest) {
            let element = program.name(state_info.element).to_owned();
            return Err(RunError::LagTooShort { element, time, step });
        }
    }
    Ok(())
}
