//! The audit of amplitude scaling of `patchcord check --scaling`: its table and its document.

use indexmap::IndexSet;
use serde::Serialize;

use super::table::{Table, decimals};
use patchcord::circuit::Circuit;
use patchcord::equations::{AuditedGain, GainDecision};
use patchcord::expr::format_significant;

/// Significant digits of a block gain, whose size depends on its unit.
const BLOCK_DIGITS: usize = 6;

/// The table of amplitude scaling, and the reasons for rows about which nothing decides.
///
/// The computer gain should be input scale x block gain / output scale.
pub(super) fn scaling_text(circuit: &Circuit, gains: &[AuditedGain]) -> String {
    let headings = [
        "element",
        "from",
        "to",
        "computer gain",
        "block gain",
        "unit",
        "block formula",
        "required gain",
        "difference",
        "decided by",
    ];
    let mut table = Table::new(headings);
    for gain in gains {
        let row = &gain.row;
        table.row([
            row.element.clone(),
            row.input.clone(),
            row.output.clone(),
            decimals(row.computer_gain, 6),
            format_significant(row.block_gain, BLOCK_DIGITS),
            row.unit.clone(),
            block(gain),
            gain.required_gain().map(|gain| decimals(gain, 6)).unwrap_or_default(),
            gain.relative_error().map(percent).unwrap_or_default(),
            decided_by(circuit, gain).unwrap_or("not decided").to_owned(),
        ]);
    }
    table.text() + &remarks(gains)
}

/// A share in percent.
fn percent(share: f64) -> String {
    decimals(100.0 * share, 2) + " %"
}

/// The block gain as a formula: that of an equation, or in parentheses one that has the same value by chance or by
/// intention.
fn block(gain: &AuditedGain) -> String {
    match &gain.decision {
        GainDecision::Equation { block, .. } => block.clone(),
        GainDecision::Integral { .. } => "1".to_owned(),
        _ => gain.row.block.as_ref().map(|block| format!("({block})")).unwrap_or_default(),
    }
}

/// What decides about a gain: the text of an equation, or "units". `None` if nothing does.
fn decided_by<'c>(circuit: &'c Circuit, gain: &AuditedGain) -> Option<&'c str> {
    match &gain.decision {
        GainDecision::Equation { index, .. } => Some(circuit.equations()[*index].value.text()),
        GainDecision::Integral { .. } => Some("units: integral"),
        _ => None,
    }
}

/// The reason for a gain about which nothing decides.
fn reason(gain: &AuditedGain) -> Option<&str> {
    match &gain.decision {
        GainDecision::Undecided(reason) => Some(reason),
        _ => None,
    }
}

/// The lines under the table: each reason once, and the meaning of parentheses.
fn remarks(gains: &[AuditedGain]) -> String {
    let reasons: IndexSet<&str> = gains.iter().filter_map(reason).collect();
    let mut text: String = reasons.iter().map(|reason| format!("not decided: {reason}\n")).collect();
    if gains.iter().any(|gain| reason(gain).is_some() && gain.row.block.is_some()) {
        text +=
            "a block in parentheses has the value of the block gain; only an equation says if it is right\n";
    }
    text
}

/// A row of the audit of amplitude scaling. Scales are physical units per volt. `difference` is relative; it is null
/// without a required gain. `reason` says why nothing decides.
#[derive(Serialize)]
pub(super) struct ScalingDocument<'a> {
    element: &'a str,
    input: &'a str,
    output: &'a str,
    integrations: usize,
    computer_gain: f64,
    input_scale: f64,
    output_scale: f64,
    block_gain: f64,
    unit: &'a str,
    block: Option<&'a str>,
    #[serde(rename = "wanted_computer_gain")]
    required_gain: Option<f64>,
    difference: Option<f64>,
    decided_by: Option<&'a str>,
    reason: Option<&'a str>,
}

impl<'a> ScalingDocument<'a> {
    /// The documents of all gains.
    pub(super) fn all(circuit: &'a Circuit, gains: &'a [AuditedGain]) -> Vec<Self> {
        gains.iter().map(|gain| ScalingDocument::of(circuit, gain)).collect()
    }

    /// The document of a gain.
    fn of(circuit: &'a Circuit, gain: &'a AuditedGain) -> Self {
        let row = &gain.row;
        let block = match &gain.decision {
            GainDecision::Equation { block, .. } => Some(block.as_str()),
            _ => row.block.as_deref(),
        };
        ScalingDocument {
            element: &row.element,
            input: &row.input,
            output: &row.output,
            integrations: row.integrations,
            computer_gain: row.computer_gain,
            input_scale: row.input_scale,
            output_scale: row.output_scale,
            block_gain: row.block_gain,
            unit: &row.unit,
            block,
            required_gain: gain.required_gain(),
            difference: gain.relative_error(),
            decided_by: decided_by(circuit, gain),
            reason: reason(gain),
        }
    }
}
