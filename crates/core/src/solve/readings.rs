//! What can be read from a machine at any instant: voltages, positions, states, rates, overloads and counts of work.
//!
//! Reading changes nothing. Voltages are those of the last evaluation, so they belong to the present instant.

use super::error::RunError;
use super::machine::Machine;
use super::state::SolverState;
use crate::delay_line::DelayLine;
use crate::ir::{Op, ProgramPoint};
use crate::trace::{Overload, WorkCounters};

impl Machine<'_> {
    /// The present voltage at the output of an element, drive or reference, in volts.
    ///
    /// # Errors
    /// If no element, drive or reference has this name.
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
    /// let machine = Machine::new(&program, 1e-3)?;
    /// assert_eq!((machine.voltage("A1")?, machine.voltage("-100")?), (50.0, -100.0));
    /// let error = machine.voltage("A2").unwrap_err();
    /// assert_eq!(error.to_string(), "there is no element A2; choose a name from the patch");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn voltage(&self, element: &str) -> Result<f64, RunError> {
        let program = self.solver.setup.program;
        let index = program.element(element).ok_or_else(|| RunError::UnknownElement(element.to_owned()))?;
        Ok(self.solver.state.voltages[program.lowered.elements[index].register.index()])
    }

    /// Size of the past that the delays have stored, in bytes. It grows to twice the delay divided by the step.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// let delay = ElementBuilder::new("delay").cord("in", "+100").set("delay", 0.5);
    /// let patch = PatchBuilder::new("echo").element("D1", delay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let mut machine = Machine::new(&program, 1e-3)?;
    /// machine.operate(3.0)?;
    /// // At least 1000 samples of a time and a voltage.
    /// assert!((16_000..100_000).contains(&machine.delay_bytes()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn delay_bytes(&self) -> usize {
        self.solver.delay_lines.iter().map(DelayLine::bytes).sum()
    }

    /// The position of a switching element, such as "pulled-in"; `None` if the element has no positions or does not
    /// exist.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// let relay = ElementBuilder::new("relay").cord("in", "+100").cord("on", "+100").cord("off", "-100");
    /// let relay = relay.set("pull_in", 10).set("drop_out", 5);
    /// let patch = PatchBuilder::new("comparator").element("K1", relay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let machine = Machine::new(&program, 1e-3)?;
    /// assert_eq!((machine.position("K1"), machine.position("K2")), (Some("pulled-in"), None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn position(&self, element: &str) -> Option<&'static str> {
        let program = self.solver.setup.program;
        let index = program.element(element)?;
        // The switches are in the order of the elements.
        let switches = &program.lowered.switches;
        let switch = &switches[switches.binary_search_by_key(&index, |switch| switch.element).ok()?];
        switch.positions.get(self.solver.state.modes[switch.mode] as usize).copied()
    }

    /// The overloads since the last initial condition, in the order in which the lamps lit.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// // The demanded output is -1000 V.
    /// let summer = ElementBuilder::new("summer").cords("x10", ["+100"]);
    /// let patch = PatchBuilder::new("overload").element("S1", summer).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let machine = Machine::new(&program, 1e-3)?;
    /// assert!(machine.is_overloaded());
    /// assert_eq!(machine.overloads()[0].element, "S1");
    /// assert_eq!(machine.voltage("S1")?, -100.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn overloads(&self) -> Vec<Overload> {
        self.lamps.history(self.solver.setup.program)
    }

    /// The steps, evaluations and events since the last initial condition.
    pub fn work(&self) -> WorkCounters {
        self.work
    }

    /// Whether any overload lamp is lit.
    pub fn is_overloaded(&self) -> bool {
        self.lamps.is_any_lit()
    }

    /// The present rates of the states, in volts per problem second. They are in the order of
    /// [`Program::states`](crate::ir::Program::states). A state that is held at a limit has rate 0.
    pub fn rates(&self) -> &[f64] {
        &self.solver.state.rates
    }

    /// The present states (outputs of integrators and lags), in volts. They are in the order of
    /// [`Program::states`](crate::ir::Program::states).
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
    /// let machine = Machine::new(&program, 1e-3)?;
    /// assert_eq!(program.states(), ["A1"]);
    /// assert_eq!((machine.states()[0], machine.rates()[0]), (50.0, -50.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn states(&self) -> &[f64] {
        &self.solver.state.states
    }

    /// The present instant as a point at which a program is evaluated. Modes and loops have settled there.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// let relay = ElementBuilder::new("relay").cord("in", "A1").cord("on", "+100").cord("off", "-100");
    /// let relay = relay.set("pull_in", 10).set("drop_out", 5);
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["K1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("comparator").element("K1", relay).element("A1", decay).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let point = Machine::new(&program, 1e-3)?.point();
    /// assert_eq!((point.states.as_slice(), point.time), (&[50.0][..], 0.0));
    /// let voltages = program.voltages_at(&point).expect("there is no loop");
    /// assert_eq!(voltages[program.state_laws()[0].rate.index()], -100.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn point(&self) -> ProgramPoint {
        let program = self.solver.setup.program;
        let SolverState { time, states, modes, voltages, sampled, levels, .. } = &self.solver.state;
        let mut delayed = vec![0.0; program.lowered.delays.len()];
        for (op, volts) in program.lowered.body.iter().zip(voltages) {
            if let Op::Delayed(index) = op {
                delayed[*index as usize] = *volts;
            }
        }
        ProgramPoint {
            states: states.clone(),
            modes: modes.clone(),
            time: *time,
            delayed,
            sampled: sampled.clone(),
            levels: levels.clone(),
        }
    }
}
