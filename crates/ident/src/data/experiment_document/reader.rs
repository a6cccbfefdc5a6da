//! Reads an experiment document into typed entries.
//!
//! This module checks keys, types, numbers and units. Every fault is added to the findings, and reading continues, so
//! that one report lists all faults.

use crate::data::experiment_document::{
    ColumnBinding, DriveBinding, ExperimentDocument, Hold, OutputBinding, RecordSource, SampleTimes,
    ValidationData,
};
use patchcord_core::document::fields::{
    Fields, Findings, flag, non_negative, positive, string, strings, wrong_type,
};
use patchcord_core::document::tree::{Content, KeyValue, Node};
use patchcord_core::document::{Code, Diagnostic, Placed, parse_unit, range, suggestion};
use patchcord_expr::{Dimension, Unit};

/// Reads the document from its tree. None if the root is not an object. Invalid entries are reported and omitted.
pub(crate) fn read_document(root: &Node, findings: &mut Findings) -> Option<ExperimentDocument> {
    let mut fields = Fields::of(root, "the experiment", findings)?;
    let title = fields.text("title", findings);
    fields.text("note", findings);
    let patch = fields.require("patch", "the patch file, relative to the folder of the experiment");
    let patch = patch.and_then(|node| string(node, "patch", findings));
    let data = fields.require("data", "the CSV file of the measured data, or a list of such files");
    let data = data.map(|node| sources(node, "data", findings)).unwrap_or_default();
    let sample_times =
        fields.take("time").map_or(Some(SampleTimes::DefaultColumn), |node| sample_times(node, findings));
    let drives = named_entries(fields.take("drives"), "drives", findings, drive);
    let outputs = fields.require("outputs", "the column that measures each signal: {\"x\": \"column\"}");
    if let Some(node) =
        outputs.filter(|node| matches!(&node.value, Content::Object(names) if names.is_empty()))
    {
        let message = "the experiment has no outputs";
        let hint = "name a signal of the patch and the column that measures it: {\"x\": \"column\"}";
        findings.push(Diagnostic::at(Code::MISSING_KEY, node.span, message).hint(hint));
    }
    let outputs = named_entries(outputs, "outputs", findings, output);
    let fit = fields.take("fit").map(|node| strings(node, "fit", findings));
    let train = fields.take("train").and_then(|node| time_range(node, "train", findings));
    let validation = fields
        .take("test")
        .and_then(|node| validation_data(node, findings))
        .unwrap_or(ValidationData::Remainder);
    let piece_duration = positive(&mut fields, "pieces", findings);
    fields.finish(findings);
    Some(ExperimentDocument {
        title,
        patch,
        data,
        sample_times,
        drives,
        outputs,
        fit,
        train,
        validation,
        piece_duration,
    })
}

/// Reads one record or a list of records.
fn sources(node: &Node, key: &str, findings: &mut Findings) -> Vec<RecordSource> {
    match &node.value {
        Content::List(items) if items.is_empty() => {
            let message = format!("\"{key}\" is an empty list");
            findings.push(Diagnostic::at(Code::MISSING_KEY, node.span, message).hint("name a CSV file"));
            Vec::new()
        }
        Content::List(items) => items.iter().filter_map(|item| source(item, key, findings)).collect(),
        _ => source(node, key, findings).into_iter().collect(),
    }
}

/// Reads a record: the name of a file, or an object with "data" and optionally "range" and "columns".
fn source(node: &Node, key: &str, findings: &mut Findings) -> Option<RecordSource> {
    match &node.value {
        Content::Text(_) => {
            Some(RecordSource { file: string(node, key, findings)?, range: None, columns: Vec::new() })
        }
        Content::Object(_) => {
            let mut fields = Fields::of(node, "a record", findings)?;
            let file = fields
                .require("data", "the CSV file of the record, relative to the folder of the experiment");
            let file = file.and_then(|node| string(node, "data", findings));
            let range = fields.take("range").and_then(|node| time_range(node, "range", findings));
            let columns = named_entries(fields.take("columns"), "columns", findings, |entry, findings| {
                Some((entry.key.clone(), string(&entry.value, &entry.key, findings)?))
            });
            fields.text("note", findings);
            fields.finish(findings);
            Some(RecordSource { file: file?, range, columns })
        }
        other => {
            findings.push(wrong_type(node, key, "the name of a CSV file, or an object with \"data\"", other));
            None
        }
    }
}

/// Reads a range of times: two numbers, the smaller one first.
fn time_range(node: &Node, key: &str, findings: &mut Findings) -> Option<Placed<(f64, f64)>> {
    let (from, to) = range(node, key, findings)?;
    if from == to {
        let message = format!("\"{key}\" is empty: its two times are equal");
        findings.push(
            Diagnostic::at(Code::BAD_NUMBER, node.span, message)
                .hint("specify two different times, the earlier one first"),
        );
        return None;
    }
    Some(Placed { value: (from, to), span: node.span })
}

/// Reads "test": a list of two numbers is a range of every record, anything else is a list of separate records.
fn validation_data(node: &Node, findings: &mut Findings) -> Option<ValidationData> {
    let is_number = |item: &Node| matches!(item.value, Content::Number(_));
    match &node.value {
        Content::List(items) if items.iter().any(is_number) => {
            Some(ValidationData::Range(time_range(node, "test", findings)?))
        }
        _ => Some(ValidationData::Records(sources(node, "test", findings))),
    }
}

/// Reads "time": the name of a column, {"column", "unit"} or {"interval", "unit"}.
fn sample_times(node: &Node, findings: &mut Findings) -> Option<SampleTimes> {
    if let Content::Text(_) = node.value {
        return Some(SampleTimes::Column { name: string(node, "time", findings)?, unit: None });
    }
    if !matches!(node.value, Content::Object(_)) {
        let expected = "the name of a column, or an object with \"column\" or \"interval\"";
        findings.push(wrong_type(node, "time", expected, &node.value));
        return None;
    }
    let mut fields = Fields::of(node, "\"time\"", findings)?;
    let unit = time_unit(&mut fields, findings);
    if fields.entries.iter().any(|(entry, _)| entry.key == "interval") {
        return fixed_interval(fields, unit, findings);
    }
    let name =
        fields.require("column", "the column of the times, or \"interval\" with the time between samples");
    let name = name.and_then(|node| string(node, "column", findings));
    fields.finish(findings);
    Some(SampleTimes::Column { name: name?, unit: unit? })
}

/// Reads "time" with an "interval". The outer None of `unit` means that the unit is invalid, the inner None that it is
/// not specified.
fn fixed_interval(
    mut fields: Fields<'_>,
    unit: Option<Option<Placed<Unit>>>,
    findings: &mut Findings,
) -> Option<SampleTimes> {
    let interval = positive(&mut fields, "interval", findings);
    if let Some((span, _)) = fields.take_with_key("column") {
        let message = "\"column\" and \"interval\" both specify the sample times";
        findings.push(Diagnostic::at(Code::EXCLUDING_KEYS, span, message));
    }
    fields.finish(findings);
    let (interval, unit) = (interval?, unit?);
    let unit = unit.map_or(1.0, |unit| unit.value.factor());
    let seconds = interval.value * unit;
    if !seconds.is_normal() {
        let message = format!("the interval between samples is too small or too large: {seconds:e} s");
        findings.push(Diagnostic::at(Code::BAD_NUMBER, interval.span, message));
        return None;
    }
    Some(SampleTimes::Interval { seconds, unit })
}

/// Reads the unit of the times. The outer None means that the unit is invalid, the inner None that it is not specified.
fn time_unit(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Option<Placed<Unit>>> {
    let Some(node) = fields.take("unit") else { return Some(None) };
    let unit = placed_unit(node, findings)?;
    if unit.value.dimension() != Dimension::TIME {
        let message = format!("{} is not a unit of time", unit.value);
        findings.push(
            Diagnostic::at(Code::UNIT_MISMATCH, unit.span, message)
                .hint("write \"s\", \"ms\", \"min\" or \"h\""),
        );
        return None;
    }
    Some(Some(unit))
}

/// Reads a unit with its position. None if the text is not a unit.
fn placed_unit(node: &Node, findings: &mut Findings) -> Option<Placed<Unit>> {
    Some(Placed { value: parse_unit(node, findings)?, span: node.span })
}

/// Reads every entry of an object with `read`, in the order of the document. Invalid entries are omitted. `node` is
/// None if the document does not have the object.
fn named_entries<'n, T>(
    node: Option<&'n Node>,
    section: &str,
    findings: &mut Findings,
    read: impl Fn(&'n KeyValue, &mut Findings) -> Option<T>,
) -> Vec<T> {
    let fields = node.and_then(|node| Fields::of(node, format!("\"{section}\""), findings));
    let entries: Vec<_> = fields.iter().flat_map(Fields::remaining).collect();
    entries.into_iter().filter_map(|entry| read(entry, findings)).collect()
}

/// Reads what drives and outputs have in common: the name of a column, or an object with "column". `read_more` reads
/// the other keys of the object; it gets None if the entry is only the name of a column.
fn binding<T>(
    entry: &KeyValue,
    noun: &str,
    findings: &mut Findings,
    read_more: impl FnOnce(Option<&mut Fields<'_>>, &mut Findings) -> T,
) -> Option<(ColumnBinding, T)> {
    let name = Placed { value: entry.key.clone(), span: entry.key_span };
    if let Content::Text(_) = entry.value.value {
        let column = string(&entry.value, &entry.key, findings)?;
        return Some((ColumnBinding { name, column, unit: None }, read_more(None, findings)));
    }
    if !matches!(entry.value.value, Content::Object(_)) {
        let expected = "the name of a column, or an object with \"column\"";
        findings.push(wrong_type(&entry.value, &entry.key, expected, &entry.value.value));
        return None;
    }
    let mut fields = Fields::of(&entry.value, format!("the {noun} {}", entry.key), findings)?;
    let column = fields.require("column", "the name of its column in the data");
    let column = column.and_then(|node| string(node, "column", findings));
    let unit = fields.take("unit").and_then(|node| placed_unit(node, findings));
    let more = read_more(Some(&mut fields), findings);
    fields.text("note", findings);
    fields.finish(findings);
    Some((ColumnBinding { name, column: column?, unit }, more))
}

/// Reads an entry of "drives". The default of "hold" is linear.
fn drive(entry: &KeyValue, findings: &mut Findings) -> Option<DriveBinding> {
    let (binding, (hold, sigma)) = binding(entry, "drive", findings, |fields, findings| {
        let Some(fields) = fields else { return (None, None) };
        let hold = fields.take("hold").and_then(|node| hold(node, findings));
        (hold, non_negative(fields, "sigma", findings))
    })?;
    Some(DriveBinding { binding, hold: hold.unwrap_or(Hold::Linear), sigma })
}

/// Reads "hold". None if the keyword is unknown.
fn hold(node: &Node, findings: &mut Findings) -> Option<Hold> {
    let chosen = string(node, "hold", findings)?;
    let hold = Hold::ALL.iter().find(|(keyword, _)| *keyword == chosen.value);
    if hold.is_none() {
        let known = Hold::ALL.map(|(keyword, _)| keyword);
        let message = format!("\"{}\" is not a value of \"hold\"", chosen.value);
        findings.push(
            Diagnostic::at(Code::UNKNOWN_NAME, chosen.span, message)
                .maybe_hint(suggestion(&chosen.value, &known)),
        );
    }
    hold.map(|(_, hold)| *hold)
}

/// Reads an entry of "outputs". By default the column has no offset.
fn output(entry: &KeyValue, findings: &mut Findings) -> Option<OutputBinding> {
    let (binding, (sigma, has_offset)) = binding(entry, "output", findings, |fields, findings| {
        let Some(fields) = fields else { return (None, None) };
        let sigma = positive(fields, "sigma", findings);
        (sigma, fields.take("offset").and_then(|node| flag(node, "offset", findings)))
    })?;
    let has_offset = has_offset.unwrap_or(false);
    Some(OutputBinding { binding, sigma, has_offset })
}
