//! Open amplifiers: quotients and roots with a multiplier in the feedback, and solutions of equations.
//!
//! An open amplifier moves its output until its inputs cancel. If the inputs are the product of its output and a divisor,
//! and the negative dividend, the output is the quotient.

use patchcord_core::document::Diagnostic;
use patchcord_core::patch::ElementBuilder;
use serde_json::Value;

use super::super::assembly::Assembly;
use super::super::design::Branch;
use super::super::formula::json_number;
use super::super::needs::divisor_sign;
use super::linear::{amplifier, cords};
use crate::graph::NodeId;

/// The amplification of open amplifiers: the largest one that they can have. A quotient with the divisor d has the
/// relative error 100 V / (d x gain of the feedback x amplification). With the default of 1e6 it would be above 1e-6, and
/// a motion can amplify it a thousandfold.
const AMPLIFICATION: i64 = 1_000_000_000;

/// Adds a quotient.
///
/// # Errors
/// If the divisor is 0 at some time of the run.
pub(super) fn add_quotient(
    assembly: &mut Assembly<'_>,
    id: NodeId,
    divisor: NodeId,
    branches: &[Branch],
    feedback: f64,
) -> Result<(), Diagnostic> {
    let design = assembly.design;
    let name = |id: NodeId| &design.input.plan.node(id).name;
    let [low, high] = design.input.ranges[divisor.0 as usize];
    // This is false for NaN too.
    let has_sign = low > 0.0 || high < 0.0;
    if !has_sign {
        let message = format!("the divisor {} of {} is 0 at some time of the run", name(divisor), name(id));
        let hint =
            "write the equation without this division, or change the initial values or the length of the run";
        return Err(design.input.fault(id, message, hint));
    }
    let sign = divisor_sign(design, divisor);
    let polarity = assembly.polarity(id);
    let divisor_voltage = assembly.voltage(divisor, sign);
    let inputs = cords(assembly, branches, &|branch| -branch.sign * polarity * sign);
    let note = format!("{} x {}, back to {}", name(id), name(divisor), assembly.output(id));
    let multiplier = multiplier(&note).set("mode", "product").cord("b", &divisor_voltage);
    add_with_multiplier(assembly, id, inputs, multiplier, feedback);
    Ok(())
}

/// Adds a square root. The squaring network gives 0 for a negative output, so the root is positive.
pub(super) fn add_root(assembly: &mut Assembly<'_>, id: NodeId, branches: &[Branch], feedback: f64) {
    let design = assembly.design;
    let inputs = cords(assembly, branches, &|branch| -branch.sign);
    let name = &design.input.plan.node(id).name;
    let note = format!("square of {name}, back to {}", assembly.output(id));
    let multiplier = multiplier(&note).set("mode", "sum-of-squares").cord("b", "ground");
    add_with_multiplier(assembly, id, inputs, multiplier, feedback);
}

/// A multiplier with a note. Its mode and its cords follow.
fn multiplier(note: &str) -> ElementBuilder {
    ElementBuilder::new("multiplier").note(note)
}

/// Adds an open amplifier with a multiplier in its feedback, whose first factor is the output. `feedback` is the gain of
/// the feedback.
fn add_with_multiplier(
    assembly: &mut Assembly<'_>,
    id: NodeId,
    mut inputs: Vec<(f64, String)>,
    multiplier: ElementBuilder,
    feedback: f64,
) {
    let output = assembly.output(id).to_owned();
    let name = assembly.next_name('M');
    let from = if feedback < 1.0 {
        assembly.pot(&name, &json_number(feedback), &format!("share of {name}, back to {output}"))
    } else {
        name.clone()
    };
    inputs.push((feedback.max(1.0), from));
    assembly.add_output(id, open_amplifier(inputs));
    assembly.add(name, multiplier.cord("a", &output));
}

/// Adds the solution of an equation: the value at which the inputs cancel.
pub(super) fn add_zero(assembly: &mut Assembly<'_>, id: NodeId, branches: &[Branch]) {
    let polarity = assembly.polarity(id);
    let inputs = cords(assembly, branches, &|branch| branch.sign * polarity);
    assembly.add_output(id, open_amplifier(inputs));
}

/// An open amplifier with these cords.
fn open_amplifier(inputs: Vec<(f64, String)>) -> ElementBuilder {
    amplifier("open-amplifier", inputs).set("amplification", Value::from(AMPLIFICATION))
}
