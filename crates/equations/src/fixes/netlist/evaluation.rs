//! The evaluation of all laws at one point.

use std::ops::Range;

use patchcord_core::elements::{Family, Jacks};
use patchcord_core::ir::{ProgramPoint, Transition};

use super::{Conditions, Netlist, Order, Rewiring, Voltages};

/// An evaluation in progress.
pub(super) struct Evaluation<'a> {
    netlist: &'a Netlist,
    conditions: &'a Conditions,
    rewiring: &'a Rewiring,
    /// The outputs of the drives by element. `None` if they follow from time.
    drives: Option<&'a [f64]>,
    /// The point. Its modes follow the inputs during the evaluation.
    point: ProgramPoint,
    /// The registers of all laws.
    registers: Vec<f64>,
    /// The outputs so far, by element.
    outputs: Vec<f64>,
}

impl<'a> Evaluation<'a> {
    /// An evaluation at a point, before any law is evaluated.
    pub(super) fn new(
        netlist: &'a Netlist,
        conditions: &'a Conditions,
        rewiring: &'a Rewiring,
        point: ProgramPoint,
        drives: Option<&'a [f64]>,
    ) -> Self {
        let (registers, outputs) = (conditions.registers.clone(), vec![f64::NAN; netlist.len()]);
        Evaluation { netlist, conditions, rewiring, drives, point, registers, outputs }
    }

    /// Evaluates the outputs in an order. `tears` are the voltages at which loops are open. Returns the recomputed
    /// voltages of the tears.
    pub(super) fn sweep(&mut self, order: &Order, tears: &[f64]) -> Vec<f64> {
        for (element, voltage) in order.tears.iter().zip(tears) {
            self.outputs[*element] = *voltage;
        }
        let mut recomputed = tears.to_vec();
        for element in &order.elements {
            let output = self.output(*element);
            match order.tears.iter().position(|tear| tear == element) {
                Some(position) => recomputed[position] = output,
                None => self.outputs[*element] = output,
            }
        }
        recomputed
    }

    /// The output of an element. Those on which it depends are known.
    fn output(&mut self, element: usize) -> f64 {
        let (conditions, node) = (self.conditions, &self.netlist.nodes[element]);
        if let Some(drives) = self.drives
            && node.kind.family == Family::Drive
        {
            return drives[element];
        }
        let law = &conditions.laws.elements()[element];
        self.plug_in(element, !node.is_compared);
        if node.is_compared {
            self.settle(element);
        }
        self.evaluate(law.output_operations.clone());
        self.registers[law.output.index()]
    }

    /// Writes the voltages at the inputs of an element: all of them, or only those that act in the same instant.
    fn plug_in(&mut self, element: usize, only_direct: bool) {
        let (netlist, conditions) = (self.netlist, self.conditions);
        let links = netlist.links(element, self.rewiring);
        let inputs = netlist.nodes[element].kind.inputs;
        for (index, registers) in conditions.laws.elements()[element].inputs.iter().enumerate() {
            if only_direct && !inputs[index].direct {
                continue;
            }
            let own = links.iter().filter(|link| link.input == index);
            let voltages = own.map(|link| link.factor * self.outputs[link.from]);
            if inputs[index].jacks == Jacks::Gains {
                let sum: f64 = voltages.sum();
                registers.iter().for_each(|register| self.registers[register.index()] = sum);
            } else {
                let plugged = registers.iter().zip(voltages);
                plugged.for_each(|(register, voltage)| self.registers[register.index()] = voltage);
            }
        }
    }

    /// Sets the modes of an element to those that follow from its inputs and from time.
    fn settle(&mut self, element: usize) {
        let (conditions, node) = (self.conditions, &self.netlist.nodes[element]);
        let law = &conditions.laws.elements()[element];
        for mode in &node.modes {
            self.point.modes[*mode] = conditions.laws.modes()[*mode].initial;
        }
        self.evaluate(law.output_operations.clone());
        self.evaluate(law.memory_operations.clone());
        for index in &node.modes {
            let present = self.point.modes[*index];
            let is_due = |transition: &&Transition| {
                let guard = self.registers[transition.guard.register.index()];
                transition.from == present && (guard > 0.0 || (guard == 0.0 && !transition.guard.is_strict))
            };
            let due = conditions.laws.modes()[*index].transitions.iter().find(is_due);
            if let Some(transition) = due {
                self.point.modes[*index] = transition.to;
            }
        }
    }

    /// Evaluates operations of one element.
    fn evaluate(&mut self, operations: Range<usize>) {
        let Conditions { laws, coefficients, .. } = self.conditions;
        laws.evaluate(operations, &self.point, coefficients, &mut self.registers);
    }

    /// The rate of the state of an element. All outputs are known.
    fn rate(&mut self, state: usize) -> f64 {
        let (conditions, netlist) = (self.conditions, self.netlist);
        let law = &conditions.laws.states()[state];
        for mode in &netlist.nodes[law.element].modes {
            // A brake slips in the direction of motion.
            if conditions.laws.modes()[*mode].names.mode == "brake" {
                self.point.modes[*mode] = if self.outputs[law.element] < 0.0 { -1.0 } else { 1.0 };
            }
        }
        self.plug_in(law.element, false);
        self.evaluate(conditions.laws.elements()[law.element].memory_operations.clone());
        self.registers[law.demand.index()]
    }

    /// The outputs and the rates.
    pub(super) fn finish(mut self) -> Voltages {
        let rates = (0..self.conditions.laws.states().len()).map(|state| self.rate(state)).collect();
        Voltages { outputs: self.outputs, rates }
    }
}
