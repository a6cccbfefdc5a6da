//! The tables that explain the scales of a patch.

use std::collections::BTreeSet;

use patchcord_expr::{Unit, round_significant};
use serde::Serialize;

use super::attempt::{Attempt, Basis};
use super::scaled_equation::ScaledEquations;
use crate::graph::{ConstantValues, NodeId, Operation};
use crate::synthesis::{ScaleReason, Scales, is_good_peak};

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

/// A drive with its scale. The scaled equations contain its voltage.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ScaledDrive {
    /// The name.
    pub name: String,
    /// The text of the unit.
    pub unit: String,
    /// The largest magnitude in a run of the scaled patch, in the unit.
    pub maximum: f64,
    /// The value of one volt in the unit.
    pub per_volt: f64,
    /// The largest magnitude in volts.
    pub peak: f64,
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
    /// The reason why the peak is not from 50 to 95 V. `None` if it is.
    pub reason: Option<&'static str>,
}

/// Digits of a scale without the rounding of a conversion of units.
const EXACT_DIGITS: usize = 15;

impl OutputPeak {
    /// Whether the output uses the range of its amplifier: it peaks from 50 to 95 V.
    pub fn is_good(&self) -> bool {
        is_good_peak(self.volts)
    }
}

/// The reason for a scale that the peak determines, although another one would use more of the range.
const NO_BETTER_SCALE: &str = "no run suggested a better scale";

/// The scaling table.
pub(super) fn quantities(basis: &Basis<'_>, attempt: &Attempt) -> Vec<ScaledQuantity> {
    let Basis { plan, problem, circuit, .. } = *basis;
    let constants = ConstantValues::new(&plan.symbols, circuit);
    let Scales { per_volt, time_scale, .. } = &attempt.scales;
    let equations = ScaledEquations::new(plan, problem, per_volt, *time_scale, &constants);
    let row = |(name, node, unit): (&str, NodeId, &Unit)| {
        let declared = problem.quantities.get(name);
        let (per_volt, peak) = (in_unit(per_volt[node.0 as usize], unit), peak(attempt, node));
        ScaledQuantity {
            name: name.to_owned(),
            unit: unit.text().to_owned(),
            expected_maximum: declared.and_then(|declared| Some(declared.maximum.as_ref()?.value)),
            maximum: per_volt * peak,
            per_volt,
            peak,
            scaled_equation: equations.text(name, node),
        }
    };
    let units = &attempt.synthesis.quantity_units;
    let planned = plan.quantities.iter().zip(units);
    let planned = planned.map(|(quantity, unit)| (quantity.name.as_str(), quantity.node, unit));
    let unit_of = |node: NodeId| &attempt.synthesis.units[node.0 as usize];
    let further = equations.further().map(|node| (plan.node(node).name.as_str(), node, unit_of(node)));
    planned.chain(further).map(row).collect()
}

/// The drives that the circuit uses, in the order of the plan.
pub(super) fn drives(basis: &Basis<'_>, attempt: &Attempt) -> Vec<ScaledDrive> {
    let row = |node: NodeId| {
        let Operation::Drive(name) = &basis.plan.node(node).operation else { return None };
        let unit = &attempt.synthesis.units[node.0 as usize];
        let per_volt = in_unit(attempt.scales.per_volt[node.0 as usize], unit);
        let peak = peak(attempt, node);
        let (name, unit) = (name.clone(), unit.text().to_owned());
        Some(ScaledDrive { name, unit, maximum: per_volt * peak, per_volt, peak })
    };
    basis.plan.ids().filter_map(row).collect()
}

/// A scale in a unit, without the rounding of the conversion.
fn in_unit(per_volt: f64, unit: &Unit) -> f64 {
    round_significant(unit.out_of_si(per_volt), EXACT_DIGITS)
}

/// The peak of a node in volts; 0 if no output has it.
fn peak(attempt: &Attempt, node: NodeId) -> f64 {
    let outputs = attempt.synthesis.outputs.iter().zip(&attempt.measured.volts);
    outputs.filter(|((id, _), _)| *id == node).map(|(_, volts)| *volts).fold(0.0, f64::max)
}

/// The peaks of all outputs. An output with the values of several nodes has the name of the first.
pub(super) fn peaks(attempt: &Attempt) -> Vec<OutputPeak> {
    let mut known = BTreeSet::new();
    let outputs = attempt.synthesis.outputs.iter().zip(&attempt.measured.volts);
    let first = outputs.filter(|((_, output), _)| known.insert(output.as_str()));
    let row = |((id, output), volts): (&(NodeId, String), &f64)| OutputPeak {
        output: output.clone(),
        quantity: attempt.synthesis.names[id.0 as usize].clone(),
        volts: *volts,
        reason: reason(&attempt.scales, *id, *volts),
    };
    first.map(row).collect()
}

/// The reason why an output is not within 50 to 95 V. `None` if it is.
fn reason(scales: &Scales, node: NodeId, volts: f64) -> Option<&'static str> {
    let recorded = || scales.reasons[node.0 as usize].map(ScaleReason::text);
    (!is_good_peak(volts)).then(|| recorded().unwrap_or(NO_BETTER_SCALE))
}
