//! Decodes the entries of a problem that patches do not have: quantities, tables, and drives with a unit.

use serde_json::json;

use super::key_synonyms::{quantity_advice, table_advice};
use super::{ProblemQuantity, ProblemTable};
use crate::document::fields::{Fields, Findings, positive};
use crate::document::tree::{Content, KeyValue};
use crate::document::{Code, Diagnostic, Placed, formula_in, parse_unit};
use crate::elements::Family;
use crate::patch::ElementEntry;
use crate::patch::decode::unit;
use crate::patch::decode_curve::table_points;
use crate::patch::decode_entry::{SignalUnits, entry_with};
use patchcord_expr::Unit;

/// Decodes an entry of "quantities". `None` if the unit cannot be read.
pub(super) fn quantity(entry: &KeyValue, findings: &mut Findings) -> Option<ProblemQuantity> {
    let noun = format!("the quantity {}", entry.key);
    let mut fields = Fields::of_with_hint(&entry.value, noun, quantity_hint(entry), findings)?;
    let unit_node = fields.require("unit", "such as \"mm\", or \"1\" for a pure number");
    let unit = unit_node.and_then(|node| parse_unit(node, findings));
    let initial = fields.take("initial");
    let initial =
        initial.and_then(|node| formula_in(node, "initial", unit.as_ref().map(Unit::text), findings));
    let maximum = positive_in(&mut fields, "maximum", unit.as_ref(), findings);
    let per_volt = positive_in(&mut fields, "per_volt", unit.as_ref(), findings);
    let description = fields.text("description", findings);
    fields.text("note", findings);
    fields.finish_with_advice(&quantity_advice, findings);
    let (span, unit_span) = (entry.key_span, unit_node?.span);
    Some(ProblemQuantity { unit: unit?, initial, maximum, per_volt, description, span, unit_span })
}

/// The hint for a quantity in a short form: only its unit or its initial value. `None` for other values.
fn quantity_hint(entry: &KeyValue) -> Option<String> {
    let name = json!(entry.key);
    match &entry.value.value {
        Content::Text(unit) => Some(format!("write {name}: {{\"unit\": {}}}", json!(unit))),
        Content::Number(number) => Some(format!(
            "write {name}: {{\"unit\": \"1\", \"initial\": {number}}}, with its unit in place of \"1\""
        )),
        _ => None,
    }
}

/// Reads the optional number of a key, in the unit of the quantity. It must be above 0, also in SI units.
fn positive_in(
    fields: &mut Fields<'_>,
    key: &'static str,
    unit: Option<&Unit>,
    findings: &mut Findings,
) -> Option<Placed<f64>> {
    let number = positive(fields, key, findings)?;
    let in_si = unit.map_or(number.value, |unit| unit.to_si(number.value));
    if in_si.is_finite() && in_si > 0.0 {
        return Some(number);
    }
    let message = format!("\"{key}\" is too large or too small in SI units");
    findings.push(Diagnostic::at(Code::NOT_FINITE, number.span, message));
    None
}

/// Decodes an entry of "tables". `None` if a unit or the points cannot be read.
pub(super) fn table(entry: &KeyValue, findings: &mut Findings) -> Option<ProblemTable> {
    let mut fields = Fields::of(&entry.value, format!("the table {}", entry.key), findings)?;
    let input_unit = fields.require("in", "the unit of the argument, such as \"mm\"");
    let input_unit = input_unit.and_then(|node| parse_unit(node, findings));
    let output_unit = fields.require("out", "the unit of the value, such as \"N\"");
    let output_unit = output_unit.and_then(|node| parse_unit(node, findings));
    let points_node = fields.require("points", "a list of points [argument, value]: [[0, 0], [1, 2]]");
    let points = points_node.and_then(|node| table_points(node, "points", findings));
    fields.text("description", findings);
    fields.text("note", findings);
    fields.finish_with_advice(&table_advice, findings);
    let (span, points_span) = (entry.key_span, points_node?.span);
    let table = ProblemTable { input_unit: input_unit?, output_unit: output_unit?, points: points?, span };
    if !is_function_in_si(&table) {
        let message = "the points are too large in SI units, or too near to each other";
        findings.push(Diagnostic::at(Code::NOT_FINITE, points_span, message));
        return None;
    }
    Some(table)
}

/// Whether the points are finite in SI units, and their arguments are still strictly increasing there.
fn is_function_in_si(table: &ProblemTable) -> bool {
    let arguments = table.points.iter().map(|[argument, _]| table.input_unit.to_si(*argument));
    let arguments: Vec<f64> = arguments.collect();
    let mut values = table.points.iter().map(|[_, value]| table.output_unit.to_si(*value));
    arguments.iter().all(|argument| argument.is_finite())
        && arguments.windows(2).all(|pair| pair[0] < pair[1])
        && values.all(f64::is_finite)
}

/// Decodes an entry of "drives", which has a unit in place of a scale. Its scale gets the name of the drive.
///
/// `None` if the kind or the unit cannot be read.
pub(super) fn drive(entry: &KeyValue, findings: &mut Findings) -> Option<(ElementEntry, Unit)> {
    let mut unit = None;
    let scale = Placed { value: entry.key.clone(), span: entry.key_span };
    let [value, rate] = stated_units(entry);
    let units = SignalUnits { value: &value, rate: &rate };
    let drive = entry_with(entry, Family::Drive, units, findings, |fields, drive, findings| {
        unit = drive_unit(fields, findings);
        drive.scale = Some(scale);
    })?;
    Some((drive, unit?))
}

/// The unit of a drive and that of its rate for hints, also in words if the unit cannot be read.
fn stated_units(entry: &KeyValue) -> [String; 2] {
    let unit = entry.value.child("unit").and_then(|node| match &node.value {
        Content::Text(text) => Unit::parse(text).ok(),
        _ => None,
    });
    match unit {
        Some(unit) => [unit.text().to_owned(), unit.per_second().text().to_owned()],
        None => ["unit of the drive", "unit of the drive per s"].map(str::to_owned),
    }
}

/// Decodes the required unit of a drive. Reports a scale.
fn drive_unit(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Unit> {
    // A key that is taken counts as known, and a problem has no scales.
    let has_scale = fields.remaining().any(|entry| entry.key == "scale");
    let scale = has_scale.then(|| fields.take_with_key("scale")).flatten();
    let Some((span, _)) = scale else { return unit(fields, findings) };
    fields.take("unit");
    let message = "a drive of a problem has a \"unit\" in place of a \"scale\"";
    let hint = "write \"unit\", the unit of its settings: `patchcord scale` chooses the scale";
    findings.push(Diagnostic::at(Code::UNKNOWN_KEY, span, message).hint(hint));
    None
}
