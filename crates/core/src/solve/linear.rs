//! The machine differentiated where it stands.

use super::machine::Machine;
use crate::delay_line::{DelayLine, Output};
use crate::ir::{Linearisation, OperatingPoint, Program, StateSpace};

impl Machine<'_> {
    /// The rates' exact derivatives with respect to states and parameters, here and now.
    pub fn linearise(&self) -> Linearisation {
        self.at_this_point(|program, point| program.linearise(point))
    }

    /// The linear model here and now, between all drives and all signals.
    pub fn state_space(&self) -> StateSpace {
        let delays = self.lines.iter().map(DelayLine::delay);
        self.at_this_point(|program, point| program.state_space(point, &self.registers, delays))
    }

    fn at_this_point<T>(&self, differentiate: impl FnOnce(&Program, &OperatingPoint<'_>) -> T) -> T {
        let delayed = self.lines.iter().map(|line| match line.output(self.time) {
            Output::Initial => None,
            Output::Arrived(volts, slope) => Some((volts, slope)),
        });
        let point = OperatingPoint {
            parameters: &self.parameters,
            states: &self.states,
            modes: &self.modes,
            time: self.time,
            delayed: &delayed.collect::<Vec<_>>(),
            kept: &self.kept,
            levels: &self.levels,
        };
        differentiate(self.program, &point)
    }
}
