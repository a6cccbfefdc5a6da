//! The linear models of a machine at its present operating point.
//!
//! The operating point consists of the present states, the outputs of the delay lines with their slopes, and the modes,
//! levels and sampled values, which count as constant. The program differentiates itself exactly, without differences.

use super::machine::Machine;
use super::state::Solver;
use crate::delay_line::{DelayLine, DelayOutput};
use crate::ir::{Linearisation, OperatingPoint, Program, StateSpace};

impl Machine<'_> {
    /// The exact derivatives of the rates with respect to states and parameters, at the present operating point. At a
    /// kink they are those of one side.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("dx/dt = -k x").parameter("k", 0.5, "1", [0.0, 1.0]);
    /// let patch = patch.element("A1", decay).element("P1", pot).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let model = Machine::new(&program, 1e-3)?.linearise();
    /// assert_eq!(model.states, ["A1"]);
    /// assert_eq!(model.by_states, [[-0.5]]);
    /// // d(-k x) / dk = -x
    /// assert_eq!(model.by_parameters, [[-50.0]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn linearise(&self) -> Linearisation {
        self.solver.at_operating_point(|program, point| program.linearise(point))
    }

    /// The linear model at the present operating point, from all drives to all signals. A delay line remains a delay.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// // dx/dt = -(u + x)
    /// let step = ElementBuilder::new("step").set("height", 10);
    /// let integrator = ElementBuilder::new("integrator").cords("x1", ["u", "A1"]);
    /// let patch = PatchBuilder::new("follower").scale("volt", 1, "V").drive("u", "volt", step);
    /// let patch = patch.element("A1", integrator).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let model = Machine::new(&program, 1e-3)?.state_space();
    /// assert_eq!((model.states[0].name.as_str(), model.inputs[0].name.as_str()), ("A1", "u"));
    /// // The first row is the rate of A1; its columns are A1 and u.
    /// assert_eq!(model.matrix[0], [-1.0, -1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn state_space(&self) -> StateSpace {
        let Solver { state, delay_lines, .. } = &self.solver;
        let delays = delay_lines.iter().map(DelayLine::delay);
        self.solver.at_operating_point(|program, point| program.state_space(point, &state.voltages, delays))
    }
}

impl Solver<'_> {
    /// Calls a function with the program and its present operating point. The output of a delay line is `None` until
    /// the first input arrives.
    fn at_operating_point<T>(&self, differentiate: impl FnOnce(&Program, &OperatingPoint<'_>) -> T) -> T {
        let Solver { setup, state, delay_lines, .. } = self;
        let delayed = delay_lines.iter().map(|line| match line.output(state.time) {
            DelayOutput::Initial => None,
            DelayOutput::Arrived(volts, slope) => Some((volts, slope)),
        });
        let point = OperatingPoint {
            parameters: &state.parameters,
            states: &state.states,
            modes: &state.modes,
            time: state.time,
            delayed: &delayed.collect::<Vec<_>>(),
            sampled: &state.sampled,
            levels: &state.levels,
        };
        differentiate(setup.program, &point)
    }
}
