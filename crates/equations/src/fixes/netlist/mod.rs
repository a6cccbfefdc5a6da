//! The elements of a circuit with cords that can be changed, evaluated numerically.
//!
//! The laws of the elements are those of the engine, without the limits of amplifiers. A rewiring replaces the cords of
//! some elements, so that other wirings are evaluated without a circuit for each.

mod evaluation;
mod loops;
mod order;

use patchcord_core::circuit::Circuit;
use patchcord_core::elements::{Family, Kind, OutputStage};
use patchcord_core::ir::{ElementLaws, ProgramPoint};

use evaluation::Evaluation;
pub(super) use order::Order;

/// A cord into an input of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    /// Index of the input among those of the kind.
    pub input: usize,
    /// Index of the element whose output is plugged in.
    pub from: usize,
    /// The gain of the jack, with a minus sign if an inverter is between the output and the input.
    pub factor: f64,
}

/// The elements whose cords differ from those of the circuit, with all their cords.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Rewiring {
    changed: Vec<(usize, Vec<Link>)>,
}

impl Rewiring {
    /// Gives an element other cords.
    pub(super) fn set(&mut self, element: usize, links: Vec<Link>) {
        match self.changed.iter_mut().find(|(changed, _)| *changed == element) {
            Some((_, present)) => *present = links,
            None => self.changed.push((element, links)),
        }
    }

    /// The cords of an element, if they differ from those of the circuit.
    pub(super) fn links(&self, element: usize) -> Option<&[Link]> {
        self.changed.iter().find(|(changed, _)| *changed == element).map(|(_, links)| links.as_slice())
    }
}

/// An element with its cords.
#[derive(Debug)]
struct Node {
    kind: &'static Kind,
    /// The cords of the circuit, in its order.
    links: Vec<Link>,
    /// The indices of its modes.
    modes: Vec<usize>,
    /// Whether its modes follow from its inputs or from time, as those of comparators and drives.
    is_compared: bool,
}

/// The elements of a circuit with their cords.
#[derive(Debug)]
pub(super) struct Netlist {
    nodes: Vec<Node>,
}

/// What is given in an evaluation: the laws, the parameters and the drives.
#[derive(Debug)]
pub(super) struct Conditions {
    /// The laws of the elements.
    pub laws: ElementLaws,
    /// The parameters in SI.
    pub parameters: Vec<f64>,
    /// The coefficients for these parameters.
    pub coefficients: Vec<f64>,
    /// The registers before an evaluation.
    registers: Vec<f64>,
}

impl Conditions {
    /// Conditions with these parameters in SI.
    pub(super) fn new(laws: ElementLaws, parameters: Vec<f64>) -> Self {
        let (coefficients, registers) = (laws.coefficients(&parameters), laws.registers());
        Conditions { laws, parameters, coefficients, registers }
    }
}

/// The voltages of all elements at one instant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Voltages {
    /// The outputs, by element.
    pub outputs: Vec<f64>,
    /// The rates of the states in volts per problem second, in the order of the laws.
    pub rates: Vec<f64>,
}

impl Netlist {
    /// The elements of a circuit. `laws` are their laws.
    pub(super) fn new(circuit: &Circuit, laws: &ElementLaws) -> Self {
        let mut nodes: Vec<Node> = circuit
            .elements()
            .iter()
            .enumerate()
            .map(|(index, element)| Node {
                kind: element.kind,
                links: links(circuit, index),
                modes: Vec::new(),
                is_compared: element.kind.family == Family::Drive
                    || ["comparator", "track-hold"].contains(&element.kind.name),
            })
            .collect();
        for (index, mode) in laws.modes().iter().enumerate() {
            nodes[mode.element].modes.push(index);
        }
        Netlist { nodes }
    }

    /// The number of elements.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The cords of an element in a rewiring.
    pub(super) fn links<'n>(&'n self, element: usize, rewiring: &'n Rewiring) -> &'n [Link] {
        rewiring.links(element).unwrap_or(&self.nodes[element].links)
    }

    /// Whether an element is an amplifier without built-in feedback.
    fn is_open_amplifier(&self, element: usize) -> bool {
        self.nodes[element].kind.output == OutputStage::OpenAmplifier
    }

    /// Whether the output of an element depends on this input in the same instant.
    fn is_direct(&self, element: usize, input: usize) -> bool {
        let node = &self.nodes[element];
        node.is_compared || node.kind.inputs[input].direct
    }

    /// All voltages at a point. `drives` has the outputs of the drives by element; `None` if they follow from time.
    ///
    /// Brakes slip, and limits, stops and resets do not act. Relays have the positions of the point. `None` if a loop
    /// without an integrator cannot be solved.
    pub(super) fn voltages(
        &self,
        conditions: &Conditions,
        (rewiring, order): (&Rewiring, &Order),
        point: &ProgramPoint,
        drives: Option<&[f64]>,
    ) -> Option<Voltages> {
        let mut evaluation = Evaluation::new(self, conditions, rewiring, point.clone(), drives);
        evaluation.close_loops(order)?;
        Some(evaluation.finish())
    }
}

/// The cords of an element of a circuit.
fn links(circuit: &Circuit, element: usize) -> Vec<Link> {
    let link = |(from, cord): (usize, patchcord_core::circuit::Cord)| Link {
        input: cord.input,
        from,
        factor: cord.gain,
    };
    circuit.cords(element).into_iter().map(link).collect()
}

#[cfg(test)]
mod tests;
