//! Synthesis: makes a patch from a plan, the ranges of its nodes, and options.
//!
//! 1. `scales` chooses the value of one volt of every node, with round numbers from `round`, estimates from `unknown`,
//!    and the rule for the time scale from `time_scale`.
//! 2. `design` determines the circuit of every node: pots, gains and cords by the gain rule (eq. 4-8), from `gains`.
//! 3. `polarity` chooses the sign of every output, so that few inverters are necessary.
//! 4. `elements` and `assembly` make the elements with their notes, in the order of `flow`.
//! 5. `document` and `layout` write the patch.
//!
//! The scales of multipliers, diode networks and delay lines follow from those of their inputs; see `rescaled` and
//! `scale_table`. `centred`, `exponents` and `rescaled` add nodes to the plan where that is not possible otherwise.
//! Settings are formulas of parameters and scales, which `formula` writes. `names` and `short_names` name scales and
//! elements.

mod assembly;
mod centred;
mod design;
mod document;
mod elements;
mod exponents;
mod expressions;
mod flow;
mod formula;
mod gains;
mod input;
mod layout;
mod names;
mod needs;
mod notes;
mod polarity;
mod reason;
mod rescaled;
mod round;
mod scale_table;
mod scales;
mod short_names;
mod significant;
#[cfg(test)]
mod tests;
mod time_scale;
mod unknown;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::Diagnostic;
use patchcord_core::machines::{DEFAULT_MACHINE, MachineModel};
use patchcord_core::patch::{Patch, Problem};
use patchcord_expr::{Unit, format_significant};

use crate::graph::{NodeId, Plan};
use crate::peaks::Ranges;
use assembly::Assembly;
use centred::wide_angles;
use design::{Block, Design};
pub(crate) use document::{with_ranges, with_step};
use input::Input;
pub(crate) use notes::GainStep;
pub(crate) use patchcord_core::machines::GOOD_VOLTS;
pub(crate) use reason::ScaleReason;
pub(crate) use scales::{choose_scales, exceeds_reference, improved_scales, is_good_peak, suitable_scale};

/// What a scaled patch should be like.
///
/// # Examples
///
/// ```
/// use patchcord_equations::ScaleOptions;
///
/// let options = ScaleOptions { time_scale: Some(10.0), ..ScaleOptions::default() };
/// assert_eq!(options.machine.name, "unlimited");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct ScaleOptions {
    /// The machine for which the patch is made.
    pub machine: &'static MachineModel,
    /// Machine seconds per problem second. `None` if it is chosen.
    pub time_scale: Option<f64>,
    /// Whether a stated maximum is always represented by 100 V. Otherwise its scale changes if the peak is below 50 V or
    /// above 95 V.
    pub keeps_maxima: bool,
}

impl Default for ScaleOptions {
    fn default() -> Self {
        ScaleOptions { machine: DEFAULT_MACHINE, time_scale: None, keeps_maxima: false }
    }
}

/// The scales of a patch.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scales {
    /// The value of one volt of each node in SI units. Nodes that the synthesis adds to the plan are at the end.
    pub per_volt: Vec<f64>,
    /// What determines the scale of each node. `None` if its peak does.
    pub reasons: Vec<Option<ScaleReason>>,
    /// Machine seconds per problem second.
    pub time_scale: f64,
}

impl Scales {
    /// Whether the values are the same, whatever determines them.
    pub(crate) fn has_values_of(&self, other: &Scales) -> bool {
        self.per_volt == other.per_volt && self.time_scale == other.time_scale
    }
}

/// A patch that solves a problem.
#[derive(Debug)]
pub(crate) struct Synthesis {
    /// The patch. The parts of the machine are not counted yet.
    pub patch: Patch,
    /// The elements and drives with the values of nodes, for reading peaks, in the order of the signal flow. Nodes that
    /// the synthesis adds to the plan have the largest indices.
    pub outputs: Vec<(NodeId, String)>,
    /// The gain rule for each input of the integrators, summers and pots, in the order of the elements.
    pub steps: Vec<GainStep>,
    /// The name of each node.
    pub names: Vec<String>,
    /// The unit of each node.
    pub units: Vec<Unit>,
    /// The unit of each quantity of the plan. Two quantities with one node can have different units.
    pub quantity_units: Vec<Unit>,
}

/// Makes the patch of a plan with these scales, which [`choose_scales`] or [`improved_scales`] gives.
///
/// # Errors
/// For each node without a circuit: what prevents it, and what to do. Examples are a divisor that becomes 0, a gain that
/// the machine does not have, and an initial value above 100 V.
pub(crate) fn synthesise(
    plan: &Plan,
    problem: &Problem,
    circuit: &Circuit,
    ranges: &Ranges,
    scales: &Scales,
    options: &ScaleOptions,
) -> Result<Synthesis, Vec<Diagnostic>> {
    let input = Input::new(plan, problem, circuit, ranges, options);
    check_angles(&input, wide_angles(plan, &ranges.nodes))?;
    let design = Design::new(&input, scales);
    let blocks = blocks(&design)?;
    let assembly = Assembly::of(&design, &blocks)?;
    let output = |id: NodeId| Some((id, assembly.output_of(id)?.to_owned()));
    let outputs = flow::signal_flow(&input.plan).into_iter().filter_map(output).collect();
    let steps = assembly.steps.clone();
    let names = input.plan.nodes.iter().map(|node| node.name.clone()).collect();
    let units = input.plan.ids().map(|id| input.unit(id)).collect();
    let quantities = plan.quantities.iter();
    let quantity_units =
        quantities.map(|quantity| input.unit_of_quantity(&quantity.name, quantity.node)).collect();
    Ok(Synthesis { patch: document::patch(assembly)?, outputs, steps, names, units, quantity_units })
}

/// Checks that there are no angles that turn by half a turn or more. Each has its width in rad.
///
/// # Errors
/// For each angle.
fn check_angles(input: &Input<'_>, wide: Vec<(NodeId, f64)>) -> Result<(), Vec<Diagnostic>> {
    let fault = |(id, width): (NodeId, f64)| {
        let name = &input.plan.node(id).name;
        let width = format_significant(width, 3);
        let message =
            format!("the angle {name} turns through {width} rad, and an open amplifier finds less than pi");
        let hint = "integrate its derivative: that of atan2(y, x) is (x y' - y x')/(x^2 + y^2)";
        input.fault(id, message, hint)
    };
    let faults: Vec<Diagnostic> = wide.into_iter().map(fault).collect();
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

/// The circuits of all nodes.
///
/// # Errors
/// For each node that has none.
fn blocks(design: &Design<'_>) -> Result<Vec<Block>, Vec<Diagnostic>> {
    let (mut blocks, mut faults) = (Vec::new(), Vec::new());
    for id in design.input.plan.ids() {
        match checked_scale(design, id).and_then(|()| design.block(id)) {
            Ok(block) => blocks.push(block),
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() { Ok(blocks) } else { Err(faults) }
}

/// Checks that the scale of a node is a positive number.
///
/// # Errors
/// If it is not: it is too large or too small for a number.
fn checked_scale(design: &Design<'_>, id: NodeId) -> Result<(), Diagnostic> {
    let scale = design.table.value(id);
    if scale.is_normal() && scale > 0.0 {
        return Ok(());
    }
    let name = &design.input.plan.node(id).name;
    let message = format!("the scale of {name} is {scale} per volt");
    let hint = format!("give {name} and the quantities on which it depends a \"maximum\"");
    Err(design.input.fault(id, message, &hint))
}
