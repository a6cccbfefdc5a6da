//! The tables that explain the scales of a patch.

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Problem;
use patchcord_expr::round_significant;
use serde::Serialize;

use super::scaled_equation::ScaledEquations;
use crate::graph::{ConstantValues, Node, NodeId, Operation, Plan};
use crate::synthesis::{GOOD_VOLTS, Scales, Synthesis};

/// A row of the scaling table: a quantity with its maximum, its scale and its scaled equation.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ScaledQuantity {
    /// The name, with primes for a derivative.
    pub name: String,
    /// The text of the unit.
    pub unit: String,
    /// The expected maximum that the problem states, in the unit.
    pub expected_maximum: Option<f64>,
    /// The largest magnitude in a run of the scaled patch, in the unit.
    pub maximum: f64,
    /// The value of one volt in the unit.
    pub per_volt: f64,
    /// The largest magnitude in volts.
    pub peak: f64,
    /// The equation between voltages: `[x]` is the voltage of x, and a prime is a derivative in machine time.
    pub scaled_equation: String,
}

/// The peak of an output in a run of the scaled patch.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct OutputPeak {
    /// The element or the drive.
    pub output: String,
    /// What it computes: a quantity of the problem or an expression.
    pub quantity: String,
    /// The largest magnitude of its voltage.
    pub volts: f64,
    /// The reason why the peak is not from 50 to 95 V, if there is one.
    pub reason: Option<&'static str>,
}

/// Digits of a scale without the rounding of a conversion of units.
const EXACT_DIGITS: usize = 15;

impl OutputPeak {
    /// Whether the output uses the range of its amplifier: it peaks from 50 to 95 V.
    pub fn is_good(&self) -> bool {
        is_good(self.volts)
    }
}

/// Whether a peak in volts uses the range of an amplifier.
fn is_good(volts: f64) -> bool {
    (GOOD_VOLTS[0]..=GOOD_VOLTS[1]).contains(&volts)
}

/// What the tables are made from.
pub(super) struct Tables<'a> {
    pub plan: &'a Plan,
    pub problem: &'a Problem,
    pub circuit: &'a Circuit,
    pub scales: &'a Scales,
    pub synthesis: &'a Synthesis,
    /// The peak of each output of the synthesis in volts.
    pub volts: &'a [f64],
}

impl Tables<'_> {
    /// The scaling table.
    pub(super) fn quantities(&self) -> Vec<ScaledQuantity> {
        let constants = ConstantValues::new(&self.plan.symbols, self.circuit);
        let Scales { per_volt, time_scale } = self.scales;
        let equations = ScaledEquations::new(self.plan, per_volt, *time_scale, &constants);
        let row = |(name, node): (&str, NodeId)| {
            let declared = self.problem.quantities.get(name);
            let unit = self.synthesis.units[node.0 as usize].clone();
            let per_volt = unit.out_of_si(self.scales.per_volt[node.0 as usize]);
            let per_volt = round_significant(per_volt, EXACT_DIGITS);
            let peak = self.peak(node);
            ScaledQuantity {
                name: name.to_owned(),
                unit: unit.text().to_owned(),
                expected_maximum: declared.and_then(|declared| Some(declared.maximum.as_ref()?.value)),
                maximum: per_volt * peak,
                per_volt,
                peak,
                scaled_equation: equations.equation(node),
            }
        };
        let planned = self.plan.quantities.iter().map(|quantity| (quantity.name.as_str(), quantity.node));
        let further = equations.further().map(|node| (self.plan.node(node).name.as_str(), node));
        planned.chain(further).map(row).collect()
    }

    /// The peak of a node in volts; 0 if no output has it.
    fn peak(&self, node: NodeId) -> f64 {
        let outputs = self.synthesis.outputs.iter().zip(self.volts);
        outputs.filter(|((id, _), _)| *id == node).map(|(_, volts)| *volts).fold(0.0, f64::max)
    }

    /// The peaks of all outputs.
    pub(super) fn peaks(&self) -> Vec<OutputPeak> {
        let row = |((id, output), volts): (&(NodeId, String), &f64)| {
            let node = self.plan.nodes.get(id.0 as usize);
            let quantity = node.map_or_else(String::new, |node| node.name.clone());
            let reason = node.and_then(|node| self.reason(node, *volts));
            OutputPeak { output: output.clone(), quantity, volts: *volts, reason }
        };
        self.synthesis.outputs.iter().zip(self.volts).map(row).collect()
    }

    /// The reason why an output is not within 50 to 95 V. `None` if it is, or if no reason is known.
    fn reason(&self, node: &Node, volts: f64) -> Option<&'static str> {
        if is_good(volts) {
            return None;
        }
        if self.problem.quantities.get(&node.name).is_some_and(|quantity| quantity.per_volt.is_some()) {
            return Some("the problem prescribes its scale");
        }
        Some(match node.operation {
            _ if volts == 0.0 => "it is 0 in the whole run",
            Operation::Product(_) => "its factors are not large at the same time",
            Operation::Absolute(_) | Operation::Delay { .. } => "it has the scale of its input",
            Operation::Lower(_) | Operation::Higher(_) => "a diode pair has the scale of its inputs",
            Operation::DeadZone { .. } => "its scale follows from the diode network",
            Operation::Sum(_) | Operation::Limited { .. } => "the largest gain of an amplifier limits it",
            Operation::Function { .. } => "the settings of the function generator limit its scale",
            _ => return None,
        })
    }
}
