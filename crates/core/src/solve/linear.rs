//! The linear models of a machine at its present operating point.
//!
//! An operating point is the present state, with modes, levels and sampled values constant, and the outputs of the
//! delay lines with their slopes.

use super::machine::Machine;
use super::state::Solver;
use crate::delay_line::{DelayLine, Output};
use crate::ir::{Linearisation, OperatingPoint, Program, StateSpace};

impl Machine<'_> {
    /// The exact derivatives of the rates with respect to states and parameters, at the present operating point.
    pub fn linearise(&self) -> Linearisation {
        self.solver.at_operating_point(|program, point| program.linearise(point))
    }

    /// The linear model at the present operating point, from all drives to all signals.
    pub fn state_space(&self) -> StateSpace {
        let Solver { state, delay_lines, .. } = &self.solver;
        let delays = delay_lines.iter().map(DelayLine::delay);
        self.solver.at_operating_point(|program, point| program.state_space(point, &state.voltages, delays))
    }
}

impl Solver<'_> {
    /// Calls a function with the program and its present operating point. The output of a delay line is `None` as long
    /// as it is the initial output.
    fn at_operating_point<T>(&self, differentiate: impl FnOnce(&Program, &OperatingPoint<'_>) -> T) -> T {
        let Solver { setup, state, delay_lines, .. } = self;
        let delayed = delay_lines.iter().map(|line| match line.output(state.time) {
            Output::Initial => None,
            Output::Arrived(volts, slope) => Some((volts, slope)),
        });
        let point = OperatingPoint {
            parameters: &state.parameters,
            states: &state.states,
            modes: &state.modes,
            time: state.time,
            delayed: &delayed.collect::<Vec<_>>(),
            kept: &state.sampled,
            levels: &state.levels,
        };
        differentiate(setup.program, &point)
    }
}
