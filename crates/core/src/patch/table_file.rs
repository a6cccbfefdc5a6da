//! Reads the points of settings from CSV files: `{"csv": file, "x": column, "y": column}`.
//!
//! The decoder notes each reference to a file as a [`TableFile`]. After macros are expanded, [`read_tables`] reads the
//! files, converts columns with another unit, checks the points and puts them into the settings. Each reference is read
//! once, even if many instances of a macro use it.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::decode_curve::{PointList, SORT_HINT, Symmetry, checked_curve, checked_time_points};
use super::document::{Amount, Patch};
use super::table_access::TableAccess;
use crate::document::csv_table::{self, ColumnSelector, CsvFault, CsvTable, UnitComment, excerpt};
use crate::document::fields::{Fields, Findings, string};
use crate::document::tree::Node;
use crate::document::{Code, Diagnostic, Placed, Report, Span};
use patchcord_expr::{ConversionError, Unit};

/// A reference from a setting to a CSV file.
#[derive(Debug, Clone)]
pub(crate) struct TableFile {
    /// Index of the setting in its kind.
    setting_index: usize,
    /// Path of the file, relative to the folder of the patch.
    file: Placed<String>,
    /// The names of the columns for x and y. `None` if the document does not specify the column.
    columns: [Option<Placed<String>>; 2],
    /// The purpose of the points, which decides their units and checks.
    pub(super) purpose: TablePurpose,
    /// Position of the reference in the document.
    span: Span,
}

/// The purpose of points.
#[derive(Debug, Clone, Copy)]
pub(super) enum TablePurpose {
    /// Values of a drive, in the unit of its scale, at times in problem seconds.
    Time,
    /// A curve from volts to volts.
    Curve(Symmetry),
}

/// Decodes a reference to a CSV file. `None` if the name of the file cannot be read.
pub(super) fn decode_table_file(
    node: &Node,
    setting_index: usize,
    purpose: TablePurpose,
    findings: &mut Findings,
) -> Option<TableFile> {
    let mut fields = Fields::of(node, "a table in a file", findings)?;
    let file = fields.require("csv", "the file with the table, relative to the folder of the patch");
    let file = file.and_then(|node| string(node, "csv", findings));
    let columns = ["x", "y"].map(|key| fields.take(key).and_then(|node| string(node, key, findings)));
    fields.finish(findings);
    Some(TableFile { setting_index, file: file?, columns, purpose, span: node.span })
}

/// Largest number of points in the tables of a patch, counting a table once for each setting that uses it. At 16 bytes
/// per point this limits the tables to 160 MB.
const MAX_TABLE_POINTS: usize = 10_000_000;

/// The points that were read from files, by the position of the reference. Instances of a macro share a position.
/// `None` if the file could not be read, which has been reported.
pub(super) type PointsBySpan = HashMap<Span, Option<Vec<[f64; 2]>>>;

/// Reads the files to which drives and elements of a patch refer, as far as its access permits.
///
/// A reference that the patch has read before is not read again: edited patches keep their tables.
pub(super) fn read_tables(patch: &mut Patch) {
    let Patch { scales, drives, elements, table_access, tables, table_files, findings, .. } = patch;
    // The drives of an edited patch have their points already.
    let present = drives.values().flat_map(|drive| &drive.settings).flatten();
    let present = present.map(|setting| match &setting.value {
        Amount::Points(points) if tables.contains_key(&setting.span) => points.len(),
        _ => 0,
    });
    let remaining_points = MAX_TABLE_POINTS.checked_sub(present.sum());
    let mut reader = TableReader { access: table_access, tables, files: table_files, remaining_points };
    for entry in drives.values_mut().chain(elements.values_mut()) {
        let scale = entry.scale.as_ref().and_then(|scale| scales.get(&scale.value));
        for table_file in std::mem::take(&mut entry.table_files) {
            let points = reader.points(&table_file, scale.map(|scale| &scale.unit), findings);
            entry.settings[table_file.setting_index] =
                points.map(|points| Placed { value: Amount::Points(points), span: table_file.span });
        }
    }
}

impl Patch {
    /// The text of the document with the points of tables in place of the references to CSV files, for a reader that has
    /// only the text. All other places are as in [`Patch::text`].
    ///
    /// # Errors
    /// If a table could not be read. The report has the findings about tables.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    /// use std::fs;
    ///
    /// let folder = tempfile::tempdir()?;
    /// fs::write(folder.path().join("pump.csv"), "t (ms),u\n0,0\n500,50\n")?;
    /// let text = r#"{"patchcord": 1, "scales": {"volt": {"per_volt": 1, "unit": "V"}},
    ///     "drives": {"u": {"kind": "table", "scale": "volt", "points": {"csv": "pump.csv"}}}}"#;
    /// let patch = Patch::parse_in(folder.path(), "p.json", text)?;
    /// assert_eq!(patch.text_with_tables()?, text.replace(r#"{"csv": "pump.csv"}"#, "[[0.0,0.0],[0.5,50.0]]"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn text_with_tables(&self) -> Result<String, Box<Report>> {
        if let Some(reread) = self.reread() {
            return reread?.text_with_tables();
        }
        if self.tables.values().any(Option::is_none) {
            let findings = self.findings.iter().filter(|finding| finding.code == Code::BAD_TABLE);
            return Err(Box::new(Report::new(&self.file, self.text(), findings.cloned().collect())));
        }
        let mut tables: Vec<(Span, &Vec<[f64; 2]>)> =
            self.tables.iter().filter_map(|(span, points)| Some((*span, points.as_ref()?))).collect();
        tables.sort_by_key(|(span, _)| span.start);
        let (mut text, mut end) = (String::new(), 0);
        for (span, points) in tables {
            text += &self.text()[end..span.start];
            text += &serde_json::json!(points).to_string();
            end = span.end;
        }
        Ok(text + &self.text()[end..])
    }
}

/// Reads the files of a patch and counts their points.
struct TableReader<'f> {
    /// Which files may be read.
    access: &'f TableAccess,
    /// The points that have been read.
    tables: &'f mut Arc<PointsBySpan>,
    /// The files that have been read, each once.
    files: &'f mut Vec<PathBuf>,
    /// Number of points that the patch may still contain. `None` once the limit is exceeded.
    remaining_points: Option<usize>,
}

impl TableReader<'_> {
    /// The points of a reference. `unit` is that of the drive's scale. `None` if they cannot be read, or if the tables
    /// of the patch exceed the limit.
    fn points(
        &mut self,
        table_file: &TableFile,
        unit: Option<&Unit>,
        findings: &mut Findings,
    ) -> Option<Vec<[f64; 2]>> {
        let remaining_points = self.remaining_points?;
        if !self.tables.contains_key(&table_file.span) {
            let points = self.read(table_file, unit, findings);
            Arc::make_mut(self.tables).insert(table_file.span, points);
        }
        let points = self.tables.get(&table_file.span)?.as_ref()?;
        self.remaining_points = remaining_points.checked_sub(points.len());
        if self.remaining_points.is_none() {
            let message =
                format!("the tables of the patch have more than {MAX_TABLE_POINTS} points in total");
            let hint = "use fewer rows, or fewer elements with tables";
            findings.push(Diagnostic::at(Code::BAD_TABLE, table_file.span, message).hint(hint));
            return None;
        }
        Some(points.clone())
    }

    /// Reads the file of a reference, if that is permitted. `None` after a report.
    fn read(
        &mut self,
        table_file: &TableFile,
        unit: Option<&Unit>,
        findings: &mut Findings,
    ) -> Option<Vec<[f64; 2]>> {
        let path = match self.access.path(&table_file.file.value) {
            Ok(path) => path,
            Err(fault) => {
                findings.push(table_file.diagnostic(fault));
                return None;
            }
        };
        let points = table_file.read(&path, unit, findings);
        if !self.files.contains(&path) {
            self.files.push(path);
        }
        points
    }
}

impl TableFile {
    /// Size of its texts in bytes. The expansion of macros counts it.
    pub(super) fn size(&self) -> usize {
        let texts = self.columns.iter().flatten().chain([&self.file]);
        texts.map(|text| text.value.len()).sum()
    }

    /// Reads the columns of the file at `path`, converts their units and checks the points. `None` after a report.
    fn read(&self, path: &Path, unit: Option<&Unit>, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
        match csv_table::read(path, &self.column_selectors())
            .and_then(|rows| self.converted(rows, unit, path))
        {
            Ok(rows) => {
                findings.extend(self.unclear_units(&rows, unit, path));
                self.checked_points(rows, path, findings)
            }
            Err(faults) => {
                findings.extend(faults.into_iter().map(|fault| self.diagnostic(fault)));
                None
            }
        }
    }

    /// The columns to read: by name, or by default the first column for x and the one to the right of x for y.
    fn column_selectors(&self) -> [ColumnSelector<'_>; 2] {
        let named = |axis: usize| self.columns[axis].as_ref().map(|name| ColumnSelector::Named(&name.value));
        [named(0).unwrap_or(ColumnSelector::First), named(1).unwrap_or(ColumnSelector::Next)]
    }

    /// Converts a fault of the file to a diagnostic at the name of the column or of the file.
    fn diagnostic(&self, fault: CsvFault) -> Diagnostic {
        let named = fault.column.and_then(|axis| self.columns[axis].as_ref());
        let span = named.map_or(self.file.span, |name| name.span);
        Diagnostic::at(Code::BAD_TABLE, span, fault.message).hint(fault.hint)
    }

    /// The warnings about columns without a unit whose names seem to indicate another unit than the required one.
    fn unclear_units(&self, rows: &CsvTable, unit: Option<&Unit>, path: &Path) -> Vec<Diagnostic> {
        let required_units = self.required_units(unit);
        let warning = |axis: usize| {
            let (name, required) = (&rows.names[axis], required_units[axis].as_ref()?);
            let doubt = match (self.purpose, axis) {
                _ if rows.units[axis].is_some() => None,
                (TablePurpose::Time, 0) => csv_table::unclear_time(name, path),
                _ => csv_table::unclear_value(name, required, path),
            };
            let doubt = doubt?;
            let span = self.columns[axis].as_ref().map_or(self.file.span, |name| name.span);
            Some(Diagnostic::at(Code::UNCLEAR_UNIT, span, doubt.message).hint(doubt.hint))
        };
        [0, 1].into_iter().filter_map(warning).collect()
    }

    /// The units of the points: seconds and the unit of the drive's scale for a table in time, volts for a curve.
    fn required_units(&self, unit: Option<&Unit>) -> [Option<Unit>; 2] {
        let parsed = |text: &str| Unit::parse(text).ok();
        match self.purpose {
            TablePurpose::Time => [parsed("s"), unit.cloned()],
            TablePurpose::Curve(_) => [parsed("V"), parsed("V")],
        }
    }

    /// Converts columns to the required unit if the file gives another one, in a comment line or in the name. Columns
    /// without a unit remain as they are.
    ///
    /// # Errors
    /// If the unit of a column cannot be read, or cannot be converted to the required unit.
    fn converted(
        &self,
        mut rows: CsvTable,
        unit: Option<&Unit>,
        path: &Path,
    ) -> Result<CsvTable, Vec<CsvFault>> {
        let required_units = self.required_units(unit);
        let mut faults = Vec::new();
        for axis in [0, 1] {
            let Some(comment) = &rows.units[axis] else { continue };
            let Some(column_unit) = comment.unit() else {
                faults.push(unreadable_unit(&rows.names[axis], comment, path, axis));
                continue;
            };
            let Some(required) = &required_units[axis] else { continue };
            match column_unit.conversion_to(required) {
                Ok(conversion) if conversion.is_identity() => (),
                Ok(conversion) => {
                    rows.columns[axis].iter_mut().for_each(|number| *number = conversion.apply(*number));
                }
                Err(error) => {
                    faults.push(not_convertible(&rows.names[axis], (comment, &error), path, axis));
                }
            }
        }
        if faults.is_empty() { Ok(rows) } else { Err(faults) }
    }

    /// Makes points from the rows and checks them for their purpose. Reports give the line of the file. `None` after a
    /// report.
    fn checked_points(&self, rows: CsvTable, path: &Path, findings: &mut Findings) -> Option<Vec<[f64; 2]>> {
        let locate =
            |index: usize| (self.file.span, format!(", in line {} of {}", rows.lines[index], path.display()));
        let order_hint = time_order_hint(&rows).unwrap_or(SORT_HINT);
        let points = PointList {
            points: rows.columns[0].iter().zip(&rows.columns[1]).map(|(x, y)| [*x, *y]).collect(),
            locate: &locate,
            span: self.file.span,
            code: Code::BAD_TABLE,
            order_hint,
        };
        match self.purpose {
            TablePurpose::Time => checked_time_points(points, findings),
            TablePurpose::Curve(symmetry) => checked_curve(points, "points", symmetry, findings),
        }
    }
}

/// The fault of a comment line whose unit cannot be read.
///
/// `name` is the name of the column, and `axis` is its index among the requested columns.
pub fn unreadable_unit(name: &str, comment: &UnitComment, path: impl AsRef<Path>, axis: usize) -> CsvFault {
    let message = format!(
        "line {} of {} gives \"{}\" as the unit of the column {name}, which is not a unit",
        comment.line,
        path.as_ref().display(),
        excerpt(&comment.text)
    );
    let hint = format!("write \"# {name}: unit\" with nothing after the unit, or a comment without a colon");
    CsvFault { column: Some(axis), ..CsvFault::new(message, hint) }
}

/// The hint if the first column is not strictly increasing and the file is a recorded run.
///
/// A recorded run has the columns "t" and "run" or "phase". The time restarts with each run, and a jump has two lines
/// with the same time. `None` if neither is the cause.
pub fn time_order_hint(rows: &CsvTable) -> Option<&'static str> {
    let has_column = |column: &str| rows.names[0] == "t" && rows.all_names.iter().any(|name| name == column);
    let pair = rows.columns[0].windows(2).find(|pair| pair[1] <= pair[0])?;
    let is_restart = pair[1] < pair[0] || pair[1] == 0.0;
    if is_restart && has_column("run") {
        Some(SEVERAL_RUNS_HINT)
    } else if pair[1] == pair[0] && has_column("phase") {
        Some(JUMP_HINT)
    } else {
        None
    }
}

/// The hint for a recorded table with several runs.
const SEVERAL_RUNS_HINT: &str = "the table contains several runs (initial_condition, repeat), and t restarts with \
                                 each: keep the lines of one \"run\"";

/// The hint for a recorded table with a jump.
const JUMP_HINT: &str = "a phase that ends with a relay (until) or changes a parameter (set) writes a jump as two \
                         lines with the same time: keep one of them, or make the second slightly later";

/// The fault of a column whose unit cannot be converted to the required unit. `comment` has the unit of the column.
fn not_convertible(
    name: &str,
    (comment, error): (&UnitComment, &ConversionError),
    path: &Path,
    axis: usize,
) -> CsvFault {
    let fault = match error {
        ConversionError::Dimension { to, .. } => {
            // The text of the file, not the unit: the file may have "sec" for "s".
            let from = excerpt(&comment.text);
            let message =
                format!("the column {name} of {} is in {from}, but {to} is needed here", path.display());
            let place = match csv_table::split_unit(name) {
                Some(_) => "unit in the name of the column".to_owned(),
                None => format!("line \"# {name}: {from}\""),
            };
            CsvFault::new(message, format!("use another column or scale, or correct the {place}"))
        }
        ConversionError::Angle { hint, .. } => {
            CsvFault::new(format!("the column {name} of {}: {error}", path.display()), hint)
        }
    };
    CsvFault { column: Some(axis), ..fault }
}
