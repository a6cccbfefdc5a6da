//! A file of measured data: its columns converted to the units of the patch, its rows assigned to even times.
//!
//! Reading has five steps. The requested columns are read. The unit of the times is determined. Every column is
//! converted to the unit that the patch needs. An even grid of times is fitted to the times of the rows. Rows that are
//! missing in the grid, and a last row that is left out, are reported. Each step adds its faults to the findings, and
//! later steps run if they can.
//!
//! `units` has the second and the third step, `even_times` the last two.

mod even_times;
mod units;

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::data::codes;
use crate::data::experiment_document::{RecordSource, SampleTimes};
use crate::data::file_source::FileSource;
use crate::data::measured_file::even_times::MAX_JITTER;
use patchcord_core::document::csv_table::{ColumnSelector, CsvFault, CsvTable};
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Placed, Span, plural};
use patchcord_expr::Unit;

/// A column to read, with what the experiment and the patch specify for it.
pub(crate) struct RequestedColumn<'a> {
    /// The name of the column in the experiment.
    pub column: &'a Placed<String>,
    /// What the column belongs to in the patch: "drive" or "signal".
    pub noun: &'static str,
    /// The name of the drive or signal.
    pub name: &'a str,
    /// The unit that the experiment specifies. None if it does not.
    pub unit: Option<&'a Placed<Unit>>,
    /// The unit that the patch needs. None if the patch has errors.
    pub target_unit: Option<&'a Unit>,
    /// Whether the experiment specifies the noise of the column.
    pub has_sigma: bool,
}

/// The data of a file.
#[derive(Debug)]
pub(crate) struct MeasuredFile {
    /// The file as the experiment names it. If columns have different names in this file, they follow in parentheses.
    pub name: String,
    /// The time of the first row, in seconds.
    pub begin: f64,
    /// The time between two even times, in seconds.
    pub interval: f64,
    /// The largest difference between the time of a row and its even time, as a fraction of the interval.
    pub jitter: f64,
    /// The index of the even time of each row, strictly increasing from 0. Missing rows leave gaps.
    pub sample_indices: Vec<usize>,
    /// The values of each requested column, row by row: drives first, then outputs.
    pub columns: Vec<Vec<f64>>,
}

impl MeasuredFile {
    /// Returns an even time, in seconds.
    pub(crate) fn time(&self, sample: usize) -> f64 {
        self.begin + sample as f64 * self.interval
    }

    /// The time from the first row to the last, in seconds.
    pub(crate) fn duration(&self) -> f64 {
        self.interval * self.len().saturating_sub(1) as f64
    }

    /// The number of even times, including those without a row.
    pub(crate) fn len(&self) -> usize {
        self.sample_indices.last().map_or(0, |last| last + 1)
    }

    /// Returns the indices of the even times between two times in seconds, both included. Empty if there are none.
    pub(crate) fn samples_within(&self, (from, to): (f64, f64)) -> Range<usize> {
        // Times that are rounded to few digits must not exclude the sample at the end of the range.
        let tolerance = MAX_JITTER * self.interval;
        let position = |time: f64| ((time - self.begin) / self.interval).clamp(-1.0, self.len() as f64);
        let first = position(from - tolerance).ceil().max(0.0) as usize;
        let end = (position(to + tolerance).floor() + 1.0).max(0.0) as usize;
        first..end.min(self.len()).max(first)
    }

    /// Returns the rows at a range of even times.
    pub(crate) fn rows_in(&self, samples: &Range<usize>) -> Range<usize> {
        let rows_before = |limit: usize| self.sample_indices.partition_point(|sample| *sample < limit);
        rows_before(samples.start)..rows_before(samples.end)
    }
}

/// Reads the requested columns of a file. Returns the data and the seconds per unit of time in the file. None if the
/// file has an error; the findings then contain it.
pub(crate) fn read_file(
    files: FileSource<'_>,
    source: &RecordSource,
    sample_times: &SampleTimes,
    requested: &[RequestedColumn<'_>],
    findings: &mut Findings,
) -> Option<(MeasuredFile, f64)> {
    let path = files.path(&source.file.value);
    FileReader { files, path, source, sample_times, requested }.read(findings)
}

/// The message about a file with fewer than the two rows that an even grid of times needs. None if it has enough.
pub(crate) fn too_few_rows(path: &Path, rows: &CsvTable) -> Option<String> {
    let count = rows.lines.len();
    (count < 2).then(|| format!("{} has {} of data, but needs 2", path.display(), plural(count, "row")))
}

/// The inputs for reading one file.
struct FileReader<'a> {
    /// Where the file is.
    files: FileSource<'a>,
    /// The path of the file in messages.
    path: PathBuf,
    source: &'a RecordSource,
    sample_times: &'a SampleTimes,
    requested: &'a [RequestedColumn<'a>],
}

impl FileReader<'_> {
    /// Reads the file. Returns the data and the seconds per unit of time.
    fn read(&self, findings: &mut Findings) -> Option<(MeasuredFile, f64)> {
        let mut rows = match self.table(&self.csv_columns()) {
            Ok(rows) => rows,
            Err(faults) => {
                self.check_times(findings);
                findings.extend(faults.into_iter().map(|fault| self.diagnostic(codes::BAD_DATA, fault)));
                return None;
            }
        };
        self.check_row_count(&rows).map_err(|finding| findings.push(finding)).ok()?;
        let unit_seconds = self.unit_seconds(&rows, findings);
        let is_converted = self.convert_columns(&mut rows, findings);
        let even_times =
            self.even_times(&rows, unit_seconds?).map_err(|finding| findings.push(finding)).ok()?;
        findings.extend(self.missing_rows(&even_times, &rows.lines, unit_seconds?));
        findings.extend(self.early_last_row(&even_times, &rows));
        rows.columns.drain(..self.time_columns());
        rows.columns.iter_mut().for_each(|column| column.truncate(even_times.sample_indices.len()));
        let measured = MeasuredFile {
            name: self.record_name(),
            begin: even_times.begin,
            interval: even_times.interval,
            jitter: even_times.jitter,
            sample_indices: even_times.sample_indices,
            columns: rows.columns,
        };
        is_converted.then_some((measured, unit_seconds?))
    }

    /// Reads columns of the file.
    ///
    /// # Errors
    /// The faults of the file, at most ten.
    fn table(&self, selectors: &[ColumnSelector<'_>]) -> Result<CsvTable, Vec<CsvFault>> {
        self.files.table(&self.source.file.value, selectors)
    }

    /// Checks that the file has at least two rows, which an even grid of times needs.
    fn check_row_count(&self, rows: &CsvTable) -> Result<(), Diagnostic> {
        match too_few_rows(&self.path, rows) {
            Some(message) => Err(Diagnostic::at(codes::TOO_FEW_SAMPLES, self.source.file.span, message)),
            None => Ok(()),
        }
    }

    /// Reports faults of the times of a file that has a fault in another column.
    fn check_times(&self, findings: &mut Findings) {
        let Ok(times) = self.table(&self.csv_columns()[..self.time_columns()]) else {
            return;
        };
        if let Err(finding) = self.check_row_count(&times) {
            return findings.push(finding);
        }
        let Some(unit_seconds) = self.unit_seconds(&times, findings) else { return };
        findings.extend(self.even_times(&times, unit_seconds).err());
    }

    /// Returns the file, followed by the different names of its columns: "b.csv (x2, u2)".
    fn record_name(&self) -> String {
        let aliases: Vec<_> = self.source.columns.iter().map(|(_, in_file)| in_file.value.as_str()).collect();
        let file = &self.source.file.value;
        if aliases.is_empty() { file.clone() } else { format!("{file} ({})", aliases.join(", ")) }
    }

    /// Returns the number of columns with times: 1, or 0 if the samples have a fixed interval.
    fn time_columns(&self) -> usize {
        usize::from(self.sample_times.column().is_some())
    }

    /// Returns the columns to read: first the times, if there is a column of times, then the requested ones.
    fn csv_columns(&self) -> Vec<ColumnSelector<'_>> {
        let requested = self.requested.iter().map(|requested| requested.column.value.as_str());
        let columns = self.sample_times.column().into_iter().chain(requested);
        columns.map(|column| ColumnSelector::Named(self.source.name_in_file(column))).collect()
    }

    /// Returns the position in the experiment that names a column, counted as in `csv_columns`. It is that of the file
    /// if the experiment does not name the column.
    fn span(&self, column: usize) -> Span {
        let requested = column.checked_sub(self.time_columns()).and_then(|index| self.requested.get(index));
        let named = match (requested, self.sample_times) {
            (Some(requested), _) => Some(requested.column),
            (None, SampleTimes::Column { name, .. }) => Some(name),
            (None, _) => None,
        };
        let name = named.map_or(self.sample_times.column(), |named| Some(named.value.as_str()));
        let alias = name.and_then(|name| self.source.alias_of(name));
        alias.or(named).map_or(self.source.file.span, |name| name.span)
    }

    /// Converts a fault of the file to a diagnostic at the position that names the column or the file.
    fn diagnostic(&self, code: Code, fault: CsvFault) -> Diagnostic {
        let span = fault.column.map_or(self.source.file.span, |column| self.span(column));
        let is_default_time =
            matches!(self.sample_times, SampleTimes::DefaultColumn) && fault.column == Some(0);
        let more = if is_default_time { "; name the column of the times with \"time\": \"...\"" } else { "" };
        Diagnostic::at(code, span, fault.message).hint(fault.hint + more)
    }
}
