//! Points that stand in a CSV file instead of the patch.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use super::decode_curve::{Mirror, Points, SORT, curve_of, points_of};
use super::document::{Amount, Patch};
use crate::document::csv_rows::{self, Asked, Fault, Rows, Told, excerpt};
use crate::document::fields::{Fields, Findings, word};
use crate::document::tree::Node;
use crate::document::{Code, Diagnostic, Placed, Span};
use patchcord_expr::Unit;

/// The file that a setting asks for, and what its points are for.
#[derive(Debug, Clone)]
pub(crate) struct TableFile {
    setting: usize,
    file: Placed<String>,
    /// The names of the columns along x and y.
    columns: [Option<Placed<String>>; 2],
    pub(super) purpose: Purpose,
    span: Span,
}

/// What points are for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    /// Values of a drive at problem times.
    InTime,
    /// A curve in volts.
    Curve(Mirror),
}

/// Reads what a setting asks for: {"csv": file, "x": column, "y": column}.
pub(super) fn asked(
    node: &Node,
    setting: usize,
    purpose: Purpose,
    findings: &mut Findings,
) -> Option<TableFile> {
    let mut fields = Fields::of(node, "a table in a file", findings)?;
    let file = fields.need("csv", "the file that holds the table, from the folder of the patch");
    let file = file.and_then(|node| word(node, "csv", findings));
    let columns = ["x", "y"].map(|key| fields.take(key).and_then(|node| word(node, key, findings)));
    fields.finish(findings);
    Some(TableFile { setting, file: file?, columns, purpose, span: node.span })
}

/// The tables of a patch hold no more points than this, however often one is used.
const MOST_POINTS: usize = 10_000_000;

/// The points that were read from files, by the place that names the file: the instances of a macro share them. `None` if a
/// file could not be read, which has been reported.
pub(super) type Tables = HashMap<Span, Option<Vec<[f64; 2]>>>;

/// Reads every file that the drives and elements of a patch still ask for, from a folder. What the patch has read before is
/// not read again.
pub(super) fn read_all(patch: &mut Patch, folder: &Path) {
    let Patch { scales, drives, elements, tables, findings, .. } = patch;
    // An edited patch has the points of its drives already.
    let present = drives.values().flat_map(|drive| &drive.settings).flatten();
    let present = present.map(|setting| match &setting.value {
        Amount::Points(points) if tables.contains_key(&setting.span) => points.len(),
        _ => 0,
    });
    let room = MOST_POINTS.checked_sub(present.sum());
    let mut files = Files { folder, read: tables, room };
    for entry in drives.values_mut().chain(elements.values_mut()) {
        let scale = entry.scale.as_ref().and_then(|scale| scales.get(&scale.value));
        for asked in std::mem::take(&mut entry.files) {
            let points = files.points(&asked, scale.map(|scale| &scale.unit), findings);
            entry.settings[asked.setting] =
                points.map(|points| Placed { value: Amount::Points(points), span: asked.span });
        }
    }
}

/// Files that are being read.
struct Files<'f> {
    folder: &'f Path,
    /// The points that were read so far.
    read: &'f mut Arc<Tables>,
    /// Points that the patch may still hold; `None` once that many were asked for.
    room: Option<usize>,
}

impl Files<'_> {
    /// The points that a place asks for.
    fn points(
        &mut self,
        asked: &TableFile,
        unit: Option<&Unit>,
        findings: &mut Findings,
    ) -> Option<Vec<[f64; 2]>> {
        let room = self.room?;
        if !self.read.contains_key(&asked.span) {
            let points = asked.read(self.folder, unit, findings);
            Arc::make_mut(self.read).insert(asked.span, points);
        }
        let points = self.read.get(&asked.span)?.as_ref()?;
        self.room = room.checked_sub(points.len());
        if self.room.is_none() {
            let message = format!("the tables of the patch hold more than {MOST_POINTS} points together");
            let hint = "record less often, or use one table in fewer places";
            findings.push(Diagnostic::at(Code::BadTable, asked.span, message).hint(hint));
            return None;
        }
        Some(points.clone())
    }
}

impl TableFile {
    /// Bytes of its texts.
    pub(super) fn size(&self) -> usize {
        let texts = self.columns.iter().flatten().chain([&self.file]);
        texts.map(|text| text.value.len()).sum()
    }

    fn read(&self, folder: &Path, unit: Option<&Unit>, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
        let path = folder.join(&self.file.value);
        match csv_rows::read(&path, &self.asked()).and_then(|rows| self.in_units(rows, unit, &path)) {
            Ok(rows) => self.judged(rows, &path, findings),
            Err(faults) => {
                findings.extend(faults.into_iter().map(|fault| self.diagnostic(fault)));
                None
            }
        }
    }

    /// The columns by name, or the first and the one beside that along x.
    fn asked(&self) -> [Asked<'_>; 2] {
        let named = |axis: usize| self.columns[axis].as_ref().map(|name| Asked::Named(&name.value));
        [named(0).unwrap_or(Asked::First), named(1).unwrap_or(Asked::Beside)]
    }

    fn diagnostic(&self, fault: Fault) -> Diagnostic {
        let named = fault.column.and_then(|axis| self.columns[axis].as_ref());
        let span = named.map_or(self.file.span, |name| name.span);
        Diagnostic::at(Code::BadTable, span, fault.message).hint(fault.hint)
    }

    /// The rows in the units of their place, where the file tells others.
    fn in_units(&self, mut rows: Rows, unit: Option<&Unit>, path: &Path) -> Result<Rows, Vec<Fault>> {
        let volts = Unit::parse("V").ok();
        let seconds = Unit::parse("s").ok();
        let places = match self.purpose {
            Purpose::InTime => [seconds.as_ref(), unit],
            Purpose::Curve(_) => [volts.as_ref(), volts.as_ref()],
        };
        let mut faults = Vec::new();
        for axis in [0, 1] {
            let Some(comment) = &rows.units[axis] else { continue };
            let told = Unit::parse(&comment.text).ok().filter(|_| !comment.text.trim().is_empty());
            let Some(told) = told else {
                faults.push(no_unit(&rows.names[axis], comment, path, axis));
                continue;
            };
            let Some(place) = places[axis] else { continue };
            if told.dimension() != place.dimension() {
                faults.push(other_unit(&rows.names[axis], &told, place, path, axis));
            } else if told.factor() != place.factor() {
                rows.columns[axis]
                    .iter_mut()
                    .for_each(|number| *number = place.out_of_si(told.to_si(*number)));
            }
        }
        if faults.is_empty() { Ok(rows) } else { Err(faults) }
    }

    /// The points, once they are found fit for their purpose.
    fn judged(&self, rows: Rows, path: &Path, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
        let place =
            |index: usize| (self.file.span, format!(", in line {} of {}", rows.lines[index], path.display()));
        let order_hint = order_hint(&rows).unwrap_or(SORT);
        let points = Points {
            points: rows.columns[0].iter().zip(&rows.columns[1]).map(|(x, y)| [*x, *y]).collect(),
            place: &place,
            span: self.file.span,
            code: Code::BadTable,
            order_hint,
        };
        match self.purpose {
            Purpose::InTime => points_of(points, findings),
            Purpose::Curve(mirror) => curve_of(points, "points", mirror, findings),
        }
    }
}

/// The fault of a comment whose unit cannot be read.
pub fn no_unit(name: &str, comment: &Told, path: &Path, axis: usize) -> Fault {
    let message = format!(
        "line {} of {} tells \"{}\" as the unit of the column {name}, which is no unit",
        comment.line,
        path.display(),
        excerpt(&comment.text)
    );
    let hint = format!("write \"# {name}: unit\" with nothing behind the unit, or a comment without a colon");
    Fault { column: Some(axis), ..Fault::new(message, hint) }
}

/// What to do where the first column does not rise: a recorded run tells by its columns why its times do not.
pub fn order_hint(rows: &Rows) -> Option<&'static str> {
    let has = |column: &str| rows.names[0] == "t" && rows.all_names.iter().any(|name| name == column);
    let pair = rows.columns[0].windows(2).find(|pair| pair[1] <= pair[0])?;
    let begins_anew = pair[1] < pair[0] || pair[1] == 0.0;
    if begins_anew && has("run") {
        Some(SEVERAL_RUNS)
    } else if pair[1] == pair[0] && has("phase") {
        Some(JUMP)
    } else {
        None
    }
}

const SEVERAL_RUNS: &str = "the table holds several runs (initial_condition, repeat), and t begins anew with each: keep the \
                            lines of one \"run\"";
const JUMP: &str = "a phase that ends with a relay (until) or changes a parameter (set) writes a jump as two lines of \
                    one time: keep one of them, or make the second a little later";

fn other_unit(name: &str, told: &Unit, place: &Unit, path: &Path, axis: usize) -> Fault {
    let message = format!(
        "the column {name} of {} is in {}, and {} is needed here",
        path.display(),
        told.text(),
        place.text()
    );
    let hint = format!("take another column or scale, or correct the line \"# {name}: {}\"", told.text());
    Fault { column: Some(axis), ..Fault::new(message, hint) }
}
