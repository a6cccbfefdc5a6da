//! The units of a data file: those that the file and the experiment specify, and conversions to the patch. A file gives
//! the unit of a column in a comment or in its name.

use super::{FileReader, RequestedColumn};
use crate::data::experiment_document::SampleTimes;
use patchcord_core::document::csv_table::{CsvFault, CsvTable, unclear_time, unclear_value};
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Placed, any_error};
use patchcord_core::patch::unreadable_unit;
use patchcord_expr::{ConversionError, Unit};

/// Returns the text of the unit of a column for messages: as the file has it, or else that of the unit.
fn unit_text<'t>(rows: &'t CsvTable, column: usize, unit: &'t str) -> &'t str {
    rows.units[column].as_ref().map_or(unit, |comment| comment.text.as_str())
}

impl FileReader<'_> {
    /// Returns the unit that the file specifies for a column. The outer None means that it is invalid, the inner None
    /// that the file does not specify it.
    fn unit_in_file(&self, rows: &CsvTable, column: usize, findings: &mut Findings) -> Option<Option<Unit>> {
        let Some(comment) = &rows.units[column] else { return Some(None) };
        let unit = comment.unit();
        if unit.is_none() {
            let fault = unreadable_unit(&rows.names[column], comment, &self.path, column);
            findings.push(self.diagnostic(Code::UNKNOWN_UNIT, fault));
        }
        unit.map(Some)
    }

    /// Returns the unit of a column, from the file or from the experiment. The outer None means that it is invalid or
    /// that the two differ, the inner None that neither specifies it.
    fn column_unit(
        &self,
        rows: &CsvTable,
        column: usize,
        in_experiment: Option<&Placed<Unit>>,
        findings: &mut Findings,
    ) -> Option<Option<Unit>> {
        let unit_in_file = self.unit_in_file(rows, column, findings)?;
        let (Some(in_file), Some(in_experiment)) = (&unit_in_file, in_experiment) else {
            return Some(unit_in_file.or_else(|| in_experiment.map(|unit| unit.value.clone())));
        };
        if !in_file.is_same_as(&in_experiment.value) {
            let message = format!(
                "the column {} has the unit {} in {}, but {} in the experiment",
                rows.names[column],
                unit_text(rows, column, in_file.text()),
                self.path.display(),
                in_experiment.value
            );
            let hint = "correct the wrong unit, or remove it";
            findings.push(Diagnostic::at(Code::UNIT_MISMATCH, in_experiment.span, message).hint(hint));
            return None;
        }
        Some(unit_in_file)
    }

    /// Returns the seconds per unit of time in the file; 1 if no unit is specified. None if the unit is invalid.
    pub(super) fn unit_seconds(&self, rows: &CsvTable, findings: &mut Findings) -> Option<f64> {
        match self.sample_times {
            SampleTimes::Interval { unit, .. } => Some(*unit),
            _ => {
                let in_experiment = match self.sample_times {
                    SampleTimes::Column { unit, .. } => unit.as_ref(),
                    _ => None,
                };
                let unit = self.column_unit(rows, 0, in_experiment, findings)?;
                if unit.is_none() {
                    let doubt = unclear_time(&rows.names[0], &self.path);
                    findings.extend(doubt.map(|doubt| self.unclear_unit(0, doubt)));
                }
                let second = Unit::parse("s").ok()?;
                let unit = unit.unwrap_or_else(|| second.clone());
                let is_time = unit.dimension() == second.dimension();
                if !is_time {
                    let message = format!(
                        "the column {} of {} must contain times, but its unit is {}",
                        rows.names[0],
                        self.path.display(),
                        unit_text(rows, 0, unit.text())
                    );
                    let hint = "name the column of the times with \"time\"";
                    findings.push(Diagnostic::at(Code::UNIT_MISMATCH, self.span(0), message).hint(hint));
                }
                is_time.then(|| unit.factor())
            }
        }
    }

    /// The warning about a column without a unit whose name seems to indicate another unit than the required one.
    fn unclear_unit(&self, column: usize, doubt: CsvFault) -> Diagnostic {
        Diagnostic::at(Code::UNCLEAR_UNIT, self.span(column), doubt.message).hint(doubt.hint)
    }

    /// Converts every requested column to the unit of the patch. Returns false if a column cannot be converted.
    pub(super) fn convert_columns(&self, rows: &mut CsvTable, findings: &mut Findings) -> bool {
        let reported = findings.len();
        for (index, requested) in self.requested.iter().enumerate() {
            let column = self.time_columns() + index;
            let Some(unit) = self.column_unit(rows, column, requested.unit, findings) else { continue };
            let Some(target) = requested.target_unit else { continue };
            let Some(unit) = unit else {
                let doubt = unclear_value(&rows.names[column], target, &self.path);
                findings.extend(doubt.map(|doubt| self.unclear_unit(column, doubt)));
                continue;
            };
            match unit.conversion_to(target) {
                Ok(conversion) if conversion.is_identity() => (),
                Ok(conversion) => {
                    if requested.has_sigma && requested.unit.is_none() {
                        findings.push(self.ambiguous_sigma(requested, &unit, target));
                    }
                    rows.columns[column].iter_mut().for_each(|number| *number = conversion.apply(*number));
                    findings.extend(self.overflow(rows, column, target));
                }
                Err(error) => findings.push(self.not_convertible(rows, column, requested, &error)),
            }
        }
        !any_error(&findings[reported..])
    }

    /// Reports the first value that is not finite after the conversion to the unit of the patch.
    fn overflow(&self, rows: &CsvTable, column: usize, target: &Unit) -> Option<Diagnostic> {
        let row = rows.columns[column].iter().position(|number| !number.is_finite())?;
        let message = format!(
            "line {} of {}: the value in the column {} is too large when converted to {target}",
            rows.lines[row],
            self.path.display(),
            rows.names[column]
        );
        Some(Diagnostic::at(Code::NOT_FINITE, self.span(column), message))
    }

    /// Reports a column whose unit cannot be converted to the unit of the patch.
    fn not_convertible(
        &self,
        rows: &CsvTable,
        column: usize,
        requested: &RequestedColumn<'_>,
        error: &ConversionError,
    ) -> Diagnostic {
        let (name, path, noun) = (&rows.names[column], self.path.display(), requested.noun);
        let (message, hint) = match error {
            ConversionError::Dimension { from, to } => (
                format!(
                    "the column {name} of {path} is in {}, but the {noun} {} of the patch is in {to}",
                    unit_text(rows, column, from),
                    requested.name
                ),
                format!("name another column or another {noun}"),
            ),
            ConversionError::Angle { hint, .. } => {
                (format!("the column {name} of {path}: {error}"), hint.clone())
            }
        };
        let span = requested.unit.map_or_else(|| self.span(column), |unit| unit.span);
        Diagnostic::at(Code::UNIT_MISMATCH, span, message).hint(hint)
    }

    /// Reports a "sigma" of unknown unit: the file and the patch use different units, and the experiment does not
    /// specify which of them applies.
    fn ambiguous_sigma(&self, requested: &RequestedColumn<'_>, unit: &Unit, target: &Unit) -> Diagnostic {
        let message = format!(
            "the unit of \"sigma\" for {} is ambiguous: the column is in {unit} in {}, but in {target} in the patch",
            requested.name,
            self.path.display()
        );
        let hint = format!("add \"unit\": \"{unit}\" to the entry, and specify \"sigma\" in {unit}");
        Diagnostic::at(Code::UNIT_MISMATCH, requested.column.span, message).hint(hint)
    }
}
