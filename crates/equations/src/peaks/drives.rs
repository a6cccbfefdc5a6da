//! The drives of a problem as functions of time.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::solve::{DriveSections, RunError};

use super::times::RunTimes;

/// Largest number of steps in which jumps and corners of drives are searched.
const MAX_SEARCH_STEPS: f64 = 1e6;

/// The drives that a network uses.
#[derive(Debug)]
pub(super) struct Drives<'p> {
    /// The drives over time; `None` if the network uses none.
    sections: Option<DriveSections<'p>>,
    /// The nodes of the drives.
    outputs: Vec<Output>,
}

/// A drive of the program.
#[derive(Debug)]
struct Output {
    /// Its node.
    node: usize,
    /// The register with its voltage.
    register: usize,
    /// The value of one volt in SI units.
    per_volt: f64,
}

impl<'p> Drives<'p> {
    /// The drives of these nodes. `program` is the program of the circuit of the problem, which has only drives.
    ///
    /// # Errors
    /// If a drive has no value.
    pub(super) fn new(
        nodes: &[(usize, String)],
        circuit: &Circuit,
        program: &'p Program,
        times: RunTimes,
    ) -> Result<Self, RunError> {
        let outputs = nodes.iter().filter_map(|(node, name)| output(*node, name, circuit, program)).collect();
        let step = times.step.max(times.duration / MAX_SEARCH_STEPS);
        let sections = match nodes {
            [] => None,
            _ => Some(DriveSections::new(program, step, times.duration)?),
        };
        Ok(Drives { sections, outputs })
    }

    /// Sets the values of the nodes to those of a time in problem seconds. The time must be in the present section.
    pub(super) fn give(&mut self, time: f64, values: &mut [f64]) {
        let Some(sections) = &mut self.sections else { return };
        let voltages = sections.voltages_at(time);
        for output in &self.outputs {
            values[output.node] = output.per_volt * voltages[output.register];
        }
    }

    /// The problem time of the next jump or corner in seconds; infinity if there is none.
    pub(super) fn end(&self) -> f64 {
        match &self.sections {
            Some(sections) if !sections.is_last() => sections.end(),
            _ => f64::INFINITY,
        }
    }

    /// Moves to the next section.
    ///
    /// # Errors
    /// If a drive has no value.
    pub(super) fn advance(&mut self) -> Result<(), RunError> {
        self.sections.as_mut().map_or(Ok(()), DriveSections::advance)
    }
}

/// The drive with this name; `None` if the program does not have it.
fn output(node: usize, name: &str, circuit: &Circuit, program: &Program) -> Option<Output> {
    let found = program.element_outputs().iter().find(|output| output.name == name)?;
    let point = circuit.signals().iter().find(|point| point.name == name)?;
    let scale = point.scale?;
    let per_volt = circuit.derived_unit(scale).to_si(circuit.per_volt(scale)?);
    Some(Output { node, register: found.register.index(), per_volt })
}
