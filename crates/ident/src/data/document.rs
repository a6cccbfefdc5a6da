//! The experiment as a person wrote it, read but not yet held against patch and data.

use patchcord_core::document::fields::{
    Fields, Findings, flag, not_negative, positive, word, words, wrong_type,
};
use patchcord_core::document::tree::{Content, Entry, Node};
use patchcord_core::document::{Code, Diagnostic, Placed, range, suggestion, unit_of};
use patchcord_expr::{Dimension, Unit};

/// What the file says.
#[derive(Debug)]
pub(crate) struct Document {
    pub title: String,
    pub patch: Option<Placed<String>>,
    pub data: Vec<Source>,
    /// `None` where it cannot be read.
    pub clock: Option<Clock>,
    pub drives: Vec<DriveWire>,
    pub outputs: Vec<OutputWire>,
    /// The parameters to fit; `None` where it does not say.
    pub fit: Option<Vec<Placed<String>>>,
    pub train: Option<Placed<(f64, f64)>>,
    pub test: Held,
    /// After how long runs begin anew, in the unit of the times.
    pub pieces: Option<Placed<f64>>,
}

/// A file of measured data, or a part of it.
#[derive(Debug)]
pub(crate) struct Source {
    pub file: Placed<String>,
    pub range: Option<Placed<(f64, f64)>>,
    /// Columns that have another name in this file: the name elsewhere, and that here.
    pub columns: Vec<(String, Placed<String>)>,
}

impl Source {
    /// The other name that a column has in this file, if it has one.
    pub fn renamed(&self, column: &str) -> Option<&Placed<String>> {
        self.columns.iter().find(|(elsewhere, _)| elsewhere == column).map(|(_, here)| here)
    }

    /// The name that a column has in this file.
    pub fn here<'s>(&'s self, column: &'s str) -> &'s str {
        self.renamed(column).map_or(column, |here| &here.value)
    }

    /// Whether both read the same columns.
    pub fn reads_as(&self, other: &Source) -> bool {
        let mut either = self.columns.iter().chain(&other.columns);
        either.all(|(column, _)| self.here(column) == other.here(column))
    }
}

/// When the samples were taken.
#[derive(Debug)]
pub(crate) enum Clock {
    /// The times stand in the column that recorded runs have for them.
    Usual,
    /// The times stand in a column.
    Column { name: Placed<String>, unit: Option<Placed<Unit>> },
    /// They follow each other evenly, from 0, so far apart. `unit` is that of times, in seconds.
    Even { seconds: f64, unit: f64 },
}

impl Clock {
    /// The column of the times, if there is one.
    pub fn column(&self) -> Option<&str> {
        match self {
            Clock::Usual => Some("t"),
            Clock::Column { name, .. } => Some(&name.value),
            Clock::Even { .. } => None,
        }
    }
}

/// What is held back for the test.
#[derive(Debug)]
pub(crate) enum Held {
    /// What training leaves.
    Rest,
    /// A range of every record.
    Part(Placed<(f64, f64)>),
    /// Records of its own.
    Records(Vec<Source>),
}

/// A column and what it is of the patch.
#[derive(Debug)]
pub(crate) struct Wire {
    /// A drive or a signal.
    pub name: Placed<String>,
    pub column: Placed<String>,
    pub unit: Option<Placed<Unit>>,
}

/// A drive that a column feeds.
#[derive(Debug)]
pub(crate) struct DriveWire {
    pub wire: Wire,
    pub hold: Hold,
    pub sigma: Option<f64>,
}

/// A signal that a column measures.
#[derive(Debug)]
pub(crate) struct OutputWire {
    pub wire: Wire,
    pub sigma: Option<f64>,
    pub offset: bool,
}

/// What a drive does between two samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// It goes straight from one to the other.
    Linear,
    /// It stays at the one before: what a sampled controller puts out.
    Previous,
    /// It goes on smoothly, on the curve through six samples: what swings and was sampled at few places.
    Smooth,
}

impl Hold {
    /// Every way, by the word for it.
    pub const ALL: [(&str, Hold); 3] =
        [("linear", Hold::Linear), ("previous", Hold::Previous), ("smooth", Hold::Smooth)];

    /// The word for it.
    pub fn as_str(self) -> &'static str {
        match self {
            Hold::Linear => "linear",
            Hold::Previous => "previous",
            Hold::Smooth => "smooth",
        }
    }

    /// How a table holds the points that stand for it.
    pub(crate) fn of_table(self) -> &'static str {
        match self {
            Hold::Linear | Hold::Smooth => "linear",
            Hold::Previous => "previous",
        }
    }
}

impl Document {
    /// Everything that a column is needed for: drives, then outputs, each with what the patch calls it.
    pub fn wires(&self) -> impl Iterator<Item = (&Wire, &'static str)> {
        let drives = self.drives.iter().map(|drive| (&drive.wire, "drive"));
        drives.chain(self.outputs.iter().map(|output| (&output.wire, "signal")))
    }

    /// Whether a column feeds a drive of this name.
    pub fn feeds(&self, drive: &str) -> bool {
        self.drives.iter().any(|own| own.wire.name.value == drive)
    }
}

/// Reads the tree of the text; `None` where it is no object.
pub(crate) fn document(root: &Node, findings: &mut Findings) -> Option<Document> {
    let mut fields = Fields::of(root, "the experiment", findings)?;
    let all = findings;
    let title = fields.text("title", all);
    fields.text("note", all);
    let patch = fields.need("patch", "the file of the patch, from the folder of the experiment");
    let patch = patch.and_then(|node| word(node, "patch", all));
    let data = fields.need("data", "the CSV file of what was measured, or a list of them");
    let data = data.map(|node| sources(node, "data", all)).unwrap_or_default();
    let clock = fields.take("time").map_or(Some(Clock::Usual), |node| clock(node, all));
    let drives = named(fields.take("drives"), "drives", all, drive);
    let outputs =
        fields.need("outputs", "which signal of the patch each column measures: {\"x\": \"column\"}");
    if let Some(node) =
        outputs.filter(|node| matches!(&node.value, Content::Object(names) if names.is_empty()))
    {
        let message = "an experiment without outputs measures nothing";
        let hint = "name a signal of the patch and the column that measures it: {\"x\": \"column\"}";
        all.push(Diagnostic::at(Code::MissingKey, node.span, message).hint(hint));
    }
    let outputs = named(outputs, "outputs", all, output);
    let fit = fields.take("fit").map(|node| words(node, "fit", all));
    let train = fields.take("train").and_then(|node| times(node, "train", all));
    let test = fields.take("test").and_then(|node| held(node, all)).unwrap_or(Held::Rest);
    let pieces = positive(&mut fields, "pieces", all);
    fields.finish(all);
    Some(Document { title, patch, data, clock, drives, outputs, fit, train, test, pieces })
}

/// One record or a list of them.
fn sources(node: &Node, key: &str, findings: &mut Findings) -> Vec<Source> {
    match &node.value {
        Content::List(items) if items.is_empty() => {
            let message = format!("\"{key}\" lists no record");
            findings.push(Diagnostic::at(Code::MissingKey, node.span, message).hint("name a CSV file"));
            Vec::new()
        }
        Content::List(items) => items.iter().filter_map(|item| source(item, key, findings)).collect(),
        _ => source(node, key, findings).into_iter().collect(),
    }
}

/// A file by its name, or with what is to be known of it.
fn source(node: &Node, key: &str, findings: &mut Findings) -> Option<Source> {
    match &node.value {
        Content::Text(_) => {
            Some(Source { file: word(node, key, findings)?, range: None, columns: Vec::new() })
        }
        Content::Object(_) => {
            let mut fields = Fields::of(node, "a record", findings)?;
            let file = fields.need("data", "the CSV file of the record, from the folder of the experiment");
            let file = file.and_then(|node| word(node, "data", findings));
            let range = fields.take("range").and_then(|node| times(node, "range", findings));
            let columns = named(fields.take("columns"), "columns", findings, |entry, findings| {
                Some((entry.key.clone(), word(&entry.value, &entry.key, findings)?))
            });
            fields.text("note", findings);
            fields.finish(findings);
            Some(Source { file: file?, range, columns })
        }
        other => {
            findings.push(wrong_type(node, key, "the name of a CSV file, or an object with \"data\"", other));
            None
        }
    }
}

/// Two times of which the first comes first.
fn times(node: &Node, key: &str, findings: &mut Findings) -> Option<Placed<(f64, f64)>> {
    let (from, to) = range(node, key, findings)?;
    if from == to {
        let message = format!("\"{key}\" ends where it begins");
        findings.push(
            Diagnostic::at(Code::BadNumber, node.span, message).hint("give two times, the later one last"),
        );
        return None;
    }
    Some(Placed { value: (from, to), span: node.span })
}

/// A range of every record, or records of its own: a list of two numbers is a range.
fn held(node: &Node, findings: &mut Findings) -> Option<Held> {
    let is_number = |item: &Node| matches!(item.value, Content::Number(_));
    match &node.value {
        Content::List(items) if items.iter().any(is_number) => {
            Some(Held::Part(times(node, "test", findings)?))
        }
        _ => Some(Held::Records(sources(node, "test", findings))),
    }
}

/// The name of a column, or {"column", "unit"}, or {"interval", "unit"}.
fn clock(node: &Node, findings: &mut Findings) -> Option<Clock> {
    if let Content::Text(_) = node.value {
        return Some(Clock::Column { name: word(node, "time", findings)?, unit: None });
    }
    if !matches!(node.value, Content::Object(_)) {
        let wanted = "the name of a column, or an object with \"column\" or \"interval\"";
        findings.push(wrong_type(node, "time", wanted, &node.value));
        return None;
    }
    let mut fields = Fields::of(node, "\"time\"", findings)?;
    let unit = time_unit(&mut fields, findings);
    if fields.entries.iter().any(|(entry, _)| entry.key == "interval") {
        return even(fields, unit, findings);
    }
    let name = fields.need("column", "the column of the times; or \"interval\", the time between samples");
    let name = name.and_then(|node| word(node, "column", findings));
    fields.finish(findings);
    Some(Clock::Column { name: name?, unit: unit? })
}

/// Samples that follow each other evenly: then no column has their times.
fn even(
    mut fields: Fields<'_>,
    unit: Option<Option<Placed<Unit>>>,
    findings: &mut Findings,
) -> Option<Clock> {
    let interval = positive(&mut fields, "interval", findings);
    if let Some((span, _)) = fields.take_with_key("column") {
        let message = "\"column\" and \"interval\" both say when samples were taken";
        findings.push(Diagnostic::at(Code::ExcludingKeys, span, message));
    }
    fields.finish(findings);
    let (interval, unit) = (interval?, unit?);
    let unit = unit.map_or(1.0, |unit| unit.value.factor());
    let seconds = interval.value * unit;
    if !seconds.is_normal() {
        let message = format!("samples cannot be {seconds:e} s apart");
        findings.push(Diagnostic::at(Code::BadNumber, interval.span, message));
        return None;
    }
    Some(Clock::Even { seconds, unit })
}

/// The unit that is told for times; `None` where it cannot be read.
fn time_unit(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Option<Placed<Unit>>> {
    let Some(node) = fields.take("unit") else { return Some(None) };
    let unit = placed_unit(node, findings)?;
    if unit.value.dimension() != Dimension::TIME {
        let message = format!("times are not measured in {}", unit.value);
        findings.push(
            Diagnostic::at(Code::UnitMismatch, unit.span, message)
                .hint("write \"s\", \"ms\", \"min\" or \"h\""),
        );
        return None;
    }
    Some(Some(unit))
}

fn placed_unit(node: &Node, findings: &mut Findings) -> Option<Placed<Unit>> {
    Some(Placed { value: unit_of(node, findings)?, span: node.span })
}

/// Everything that stands under names.
fn named<'n, T>(
    node: Option<&'n Node>,
    section: &str,
    findings: &mut Findings,
    read: impl Fn(&'n Entry, &mut Findings) -> Option<T>,
) -> Vec<T> {
    let fields = node.and_then(|node| Fields::of(node, format!("\"{section}\""), findings));
    let entries: Vec<_> = fields.iter().flat_map(Fields::rest).collect();
    entries.into_iter().filter_map(|entry| read(entry, findings)).collect()
}

/// What both drives and outputs say: the name of a column, or an object whose other keys `more` reads.
fn wire<T>(
    entry: &Entry,
    noun: &str,
    findings: &mut Findings,
    more: impl FnOnce(Option<&mut Fields<'_>>, &mut Findings) -> T,
) -> Option<(Wire, T)> {
    let name = Placed { value: entry.key.clone(), span: entry.key_span };
    if let Content::Text(_) = entry.value.value {
        let column = word(&entry.value, &entry.key, findings)?;
        return Some((Wire { name, column, unit: None }, more(None, findings)));
    }
    if !matches!(entry.value.value, Content::Object(_)) {
        let wanted = "the name of a column, or an object with \"column\"";
        findings.push(wrong_type(&entry.value, &entry.key, wanted, &entry.value.value));
        return None;
    }
    let mut fields = Fields::of(&entry.value, format!("the {noun} {}", entry.key), findings)?;
    let column = fields.need("column", "the name of its column in the data");
    let column = column.and_then(|node| word(node, "column", findings));
    let unit = fields.take("unit").and_then(|node| placed_unit(node, findings));
    let more = more(Some(&mut fields), findings);
    fields.text("note", findings);
    fields.finish(findings);
    Some((Wire { name, column: column?, unit }, more))
}

fn drive(entry: &Entry, findings: &mut Findings) -> Option<DriveWire> {
    let (wire, (hold, sigma)) = wire(entry, "drive", findings, |fields, findings| {
        let Some(fields) = fields else { return (None, None) };
        let hold = fields.take("hold").and_then(|node| hold(node, findings));
        (hold, not_negative(fields, "sigma", findings))
    })?;
    let sigma = sigma.map(|sigma| sigma.value);
    Some(DriveWire { wire, hold: hold.unwrap_or(Hold::Linear), sigma })
}

fn hold(node: &Node, findings: &mut Findings) -> Option<Hold> {
    let chosen = word(node, "hold", findings)?;
    let found = Hold::ALL.iter().find(|(known, _)| *known == chosen.value);
    if found.is_none() {
        let known = Hold::ALL.map(|(known, _)| known);
        let message = format!("\"{}\" is no way to hold a drive between samples", chosen.value);
        findings.push(
            Diagnostic::at(Code::UnknownName, chosen.span, message)
                .maybe_hint(suggestion(&chosen.value, &known)),
        );
    }
    found.map(|(_, hold)| *hold)
}

fn output(entry: &Entry, findings: &mut Findings) -> Option<OutputWire> {
    let (wire, (sigma, offset)) = wire(entry, "output", findings, |fields, findings| {
        let Some(fields) = fields else { return (None, None) };
        let sigma = positive(fields, "sigma", findings);
        (sigma, fields.take("offset").and_then(|node| flag(node, "offset", findings)))
    })?;
    Some(OutputWire { wire, sigma: sigma.map(|sigma| sigma.value), offset: offset.unwrap_or(false) })
}
