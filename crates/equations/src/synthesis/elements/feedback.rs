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
use super::super::notes::product_text;
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
    let product = product_text(design, id, divisor);
    let multiplier = Feedback { mode: "product", other: divisor_voltage, product, factor: feedback };
    add_with_multiplier(assembly, id, inputs, multiplier);
    Ok(())
}

/// Adds a square root. The squaring network gives 0 for a negative output, so the root is positive.
pub(super) fn add_root(assembly: &mut Assembly<'_>, id: NodeId, branches: &[Branch], feedback: f64) {
    let inputs = cords(assembly, branches, &|branch| -branch.sign);
    let product = format!("square of {}", assembly.design.input.plan.node(id).name);
    let multiplier =
        Feedback { mode: "sum-of-squares", other: "ground".to_owned(), product, factor: feedback };
    add_with_multiplier(assembly, id, inputs, multiplier);
}

/// The multiplier in the feedback of an open amplifier. Its first factor is the output of the amplifier.
struct Feedback {
    /// Its mode.
    mode: &'static str,
    /// The output that is its second factor.
    other: String,
    /// What it computes.
    product: String,
    /// The gain of the feedback.
    factor: f64,
}

/// Adds an open amplifier with a multiplier in its feedback.
fn add_with_multiplier(
    assembly: &mut Assembly<'_>,
    id: NodeId,
    mut inputs: Vec<(f64, String)>,
    feedback: Feedback,
) {
    let Feedback { mode, other, product, factor } = feedback;
    let output = assembly.output(id).to_owned();
    let name = assembly.next_name('M');
    let from = if factor < 1.0 {
        assembly.pot(&name, &json_number(factor), &format!("share of {name}, back to {output}"))
    } else {
        name.clone()
    };
    inputs.push((factor.max(1.0), from));
    assembly.add_output(id, open_amplifier(inputs));
    let multiplier = ElementBuilder::new("multiplier").set("mode", mode).cord("a", &output).cord("b", &other);
    assembly.add(name, multiplier.note(&format!("{product}, back to {output}")));
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
