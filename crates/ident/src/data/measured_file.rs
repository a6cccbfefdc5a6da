//! A file of measured data: its columns converted to the units of the patch, its rows assigned to even times.
//!
//! Reading has five steps. The requested columns are read. The unit of the times is determined. Every column is
//! converted to the unit that the patch needs. An even grid of times is fitted to the times of the rows. Rows that are
//! missing in the grid are reported. Each step adds its faults to the findings, and later steps run if they can.

use std::ops::Range;
use std::path::Path;

use crate::data::codes;
use crate::data::experiment_document::{RecordSource, SampleTimes};
use crate::statistics::descriptive::median;
use patchcord_core::document::csv_table::{ColumnSelector, CsvFault, CsvTable};
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Placed, Span, csv_table, format_number};
use patchcord_core::patch::{time_order_hint, unreadable_unit};
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
    pub fn time(&self, sample: usize) -> f64 {
        self.begin + sample as f64 * self.interval
    }

    /// The time from the first row to the last, in seconds.
    pub fn duration(&self) -> f64 {
        self.interval * self.len().saturating_sub(1) as f64
    }

    /// The number of even times, including those without a row.
    pub fn len(&self) -> usize {
        self.sample_indices.last().map_or(0, |last| last + 1)
    }

    /// Returns the indices of the even times between two times in seconds, both included. Empty if there are none.
    pub fn samples_within(&self, (from, to): (f64, f64)) -> Range<usize> {
        // Times that are rounded to few digits must not exclude the sample at the end of the range.
        let tolerance = MAX_JITTER * self.interval;
        let position = |time: f64| ((time - self.begin) / self.interval).clamp(-1.0, self.len() as f64);
        let first = position(from - tolerance).ceil().max(0.0) as usize;
        let end = (position(to + tolerance).floor() + 1.0).max(0.0) as usize;
        first..end.min(self.len()).max(first)
    }

    /// Returns the rows at a range of even times.
    pub fn rows_in(&self, samples: &Range<usize>) -> Range<usize> {
        let rows_before = |limit: usize| self.sample_indices.partition_point(|sample| *sample < limit);
        rows_before(samples.start)..rows_before(samples.end)
    }
}

/// The largest difference between the time of a row and its even time, as a fraction of the interval. It allows for
/// times that are rounded to few digits.
const MAX_JITTER: f64 = 0.05;

/// The largest number of even times per row of a file. A chosen limit: with more missing rows than that, the even times
/// are not credible.
const MAX_TIMES_PER_ROW: usize = 4;

/// Reads the requested columns of a file. Returns the data and the seconds per unit of time in the file. None if the
/// file has an error; the findings then contain it.
pub(crate) fn read_file(
    folder: &Path,
    source: &RecordSource,
    sample_times: &SampleTimes,
    requested: &[RequestedColumn<'_>],
    findings: &mut Findings,
) -> Option<(MeasuredFile, f64)> {
    FileReader { path: &folder.join(&source.file.value), source, sample_times, requested }.read(findings)
}

/// The inputs for reading one file.
struct FileReader<'a> {
    path: &'a Path,
    source: &'a RecordSource,
    sample_times: &'a SampleTimes,
    requested: &'a [RequestedColumn<'a>],
}

impl FileReader<'_> {
    /// Reads the file. Returns the data and the seconds per unit of time.
    fn read(&self, findings: &mut Findings) -> Option<(MeasuredFile, f64)> {
        let mut rows = match csv_table::read(self.path, &self.csv_columns()) {
            Ok(rows) => rows,
            Err(faults) => {
                self.check_times(findings);
                findings.extend(faults.into_iter().map(|fault| self.diagnostic(codes::BAD_DATA, fault)));
                return None;
            }
        };
        if rows.lines.len() < 2 {
            let message = format!(
                "{} has {} of data, but needs 2",
                self.path.display(),
                plural(rows.lines.len(), "row")
            );
            findings.push(Diagnostic::at(codes::TOO_FEW_SAMPLES, self.source.file.span, message));
            return None;
        }
        let unit_seconds = self.unit_seconds(&rows, findings);
        let is_converted = self.convert_columns(&mut rows, findings);
        let even_times =
            self.even_times(&rows, unit_seconds?).map_err(|finding| findings.push(finding)).ok()?;
        findings.extend(self.missing_rows(&even_times, &rows.lines, unit_seconds?));
        rows.columns.drain(..self.time_columns());
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

    /// Reports faults of the times of a file that has a fault in another column.
    fn check_times(&self, findings: &mut Findings) {
        let Ok(times) = csv_table::read(self.path, &self.csv_columns()[..self.time_columns()]) else {
            return;
        };
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

    /// Returns the place in the experiment that names a column, counted as in `csv_columns`. It is the place of the
    /// file if the experiment does not name the column.
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

    /// Converts a fault of the file to a diagnostic at the place that names the column or the file.
    fn diagnostic(&self, code: Code, fault: CsvFault) -> Diagnostic {
        let span = fault.column.map_or(self.source.file.span, |column| self.span(column));
        let is_default_time =
            matches!(self.sample_times, SampleTimes::DefaultColumn) && fault.column == Some(0);
        let more = if is_default_time { "; name the column of the times with \"time\": \"...\"" } else { "" };
        Diagnostic::at(code, span, fault.message).hint(fault.hint + more)
    }

    /// Returns the unit that a comment of the file specifies for a column. The outer None means that it is invalid, the
    /// inner None that there is no comment.
    fn unit_in_comment(
        &self,
        rows: &CsvTable,
        column: usize,
        findings: &mut Findings,
    ) -> Option<Option<Unit>> {
        let Some(comment) = &rows.units[column] else { return Some(None) };
        let unit = Unit::parse(&comment.text).ok().filter(|_| !comment.text.trim().is_empty());
        if unit.is_none() {
            let fault = unreadable_unit(&rows.names[column], comment, self.path, column);
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
        let in_comment = self.unit_in_comment(rows, column, findings)?;
        let (Some(in_file), Some(in_experiment)) = (&in_comment, in_experiment) else {
            return Some(in_comment.or_else(|| in_experiment.map(|unit| unit.value.clone())));
        };
        if !is_same_unit(in_file, &in_experiment.value) {
            let message = format!(
                "the column {} has the unit {in_file} in {}, but {} in the experiment",
                rows.names[column],
                self.path.display(),
                in_experiment.value
            );
            let hint = "correct the wrong unit, or remove it";
            findings.push(Diagnostic::at(Code::UNIT_MISMATCH, in_experiment.span, message).hint(hint));
            return None;
        }
        Some(in_comment)
    }

    /// Returns the seconds per unit of time in the file; 1 if no unit is specified. None if the unit is invalid.
    fn unit_seconds(&self, rows: &CsvTable, findings: &mut Findings) -> Option<f64> {
        match self.sample_times {
            SampleTimes::Interval { unit, .. } => Some(*unit),
            _ => {
                let in_experiment = match self.sample_times {
                    SampleTimes::Column { unit, .. } => unit.as_ref(),
                    _ => None,
                };
                let unit = self.column_unit(rows, 0, in_experiment, findings)?;
                let second = Unit::parse("s").ok()?;
                let unit = unit.unwrap_or_else(|| second.clone());
                let is_time = unit.dimension() == second.dimension();
                if !is_time {
                    let message = format!(
                        "the column {} of {} must contain times, but its unit is {unit}",
                        rows.names[0],
                        self.path.display()
                    );
                    let hint = "name the column of the times with \"time\"";
                    findings.push(Diagnostic::at(Code::UNIT_MISMATCH, self.span(0), message).hint(hint));
                }
                is_time.then(|| unit.factor())
            }
        }
    }

    /// Converts every requested column to the unit of the patch. Returns false if a column cannot be converted.
    fn convert_columns(&self, rows: &mut CsvTable, findings: &mut Findings) -> bool {
        let reported = findings.len();
        for (index, requested) in self.requested.iter().enumerate() {
            let column = self.time_columns() + index;
            let Some(Some(unit)) = self.column_unit(rows, column, requested.unit, findings) else { continue };
            let Some(target) = requested.target_unit else { continue };
            if unit.dimension() != target.dimension() {
                findings.push(self.wrong_dimension(rows, column, requested, &unit, target));
            } else if !is_same_unit(&unit, target) {
                if requested.has_sigma && requested.unit.is_none() {
                    findings.push(self.ambiguous_sigma(requested, &unit, target));
                }
                rows.columns[column]
                    .iter_mut()
                    .for_each(|number| *number = target.out_of_si(unit.to_si(*number)));
                findings.extend(self.overflow(rows, column, target));
            }
        }
        findings.len() == reported
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
    fn wrong_dimension(
        &self,
        rows: &CsvTable,
        column: usize,
        requested: &RequestedColumn<'_>,
        unit: &Unit,
        target: &Unit,
    ) -> Diagnostic {
        let message = format!(
            "the column {} of {} is in {unit}, but the {} {} of the patch is in {target}",
            rows.names[column],
            self.path.display(),
            requested.noun,
            requested.name
        );
        let span = requested.unit.map_or_else(|| self.span(column), |unit| unit.span);
        let hint = format!("name another column or another {}", requested.noun);
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

    /// Returns the even times of the rows.
    fn even_times(&self, rows: &CsvTable, unit_seconds: f64) -> Result<EvenTimes, Diagnostic> {
        match self.sample_times {
            SampleTimes::Interval { seconds, .. } => Ok(EvenTimes {
                begin: 0.0,
                interval: *seconds,
                jitter: 0.0,
                sample_indices: (0..rows.lines.len()).collect(),
            }),
            _ => {
                self.check_order(rows)?;
                let times: Vec<f64> = rows.columns[0].iter().map(|time| time * unit_seconds).collect();
                EvenTimes::fit(&times).ok_or_else(|| self.uneven_sampling(&times, &rows.lines))
            }
        }
    }

    /// Checks that the times increase strictly.
    fn check_order(&self, rows: &CsvTable) -> Result<(), Diagnostic> {
        let times = &rows.columns[0];
        let Some(row) = (1..times.len()).find(|row| times[*row] <= times[row - 1]) else { return Ok(()) };
        let (previous, time) = (format_number(times[row - 1]), format_number(times[row]));
        let fault = if times[row] == times[row - 1] {
            format!("stays at {time}")
        } else {
            format!("decreases from {previous} to {time}")
        };
        let message = format!(
            "line {} of {}: the time in the column {} {fault}",
            rows.lines[row],
            self.path.display(),
            rows.names[0]
        );
        let sort = "sort the rows by time, and keep only one row for each time";
        let hint = time_order_hint(rows).unwrap_or(sort);
        Err(Diagnostic::at(codes::BAD_DATA, self.source.file.span, message).hint(hint))
    }

    /// Reports uneven times, with the shortest, the longest and the median interval in seconds.
    fn uneven_sampling(&self, times: &[f64], lines: &[usize]) -> Diagnostic {
        let intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let by_length = |a: &usize, b: &usize| intervals[*a].total_cmp(&intervals[*b]);
        let [shortest, longest] =
            [(0..intervals.len()).min_by(by_length), (0..intervals.len()).max_by(by_length)].map(|row| {
                let row = row.unwrap_or_default();
                format!("{} s (before line {})", format_number(intervals[row]), lines[row + 1])
            });
        let message = format!(
            "the samples of {} are not evenly spaced: intervals are from {shortest} to {longest}, mostly {} s",
            self.path.display(),
            format_number(median(&intervals))
        );
        Diagnostic::at(codes::UNEVEN_SAMPLING, self.source.file.span, message)
    }

    /// Reports missing rows within the range of the record. None if no row is missing there.
    fn missing_rows(&self, even_times: &EvenTimes, lines: &[usize], unit_seconds: f64) -> Option<Diagnostic> {
        let indices = &even_times.sample_indices;
        let gap_before = |row: &usize| indices[*row] - indices[row - 1] - 1;
        // A gap counts only if it is completely within the range.
        let is_within_range = |row: &usize| {
            let time = |position: f64| (even_times.begin + position * even_times.interval) / unit_seconds;
            let [from, to] = [indices[row - 1] as f64 + 0.5, indices[*row] as f64 - 0.5].map(time);
            self.source.range.as_ref().is_none_or(|range| range.value.0 < from && to < range.value.1)
        };
        let gaps: Vec<usize> =
            (1..indices.len()).filter(|row| gap_before(row) > 0 && is_within_range(row)).collect();
        let missing: usize = gaps.iter().map(gap_before).sum();
        let longest = *gaps.iter().max_by_key(|row| (gap_before(row), usize::MAX - **row))?;
        let message = || {
            format!(
                "{} missing in {}, in {}; the longest gap ({}) is before line {}; drives are interpolated there",
                if missing == 1 { "1 row is".to_owned() } else { format!("{missing} rows are") },
                self.path.display(),
                plural(gaps.len(), "gap"),
                plural(gap_before(&longest), "row"),
                lines[longest]
            )
        };
        let finding = Diagnostic::at(codes::SAMPLING_GAP, self.source.file.span, message());
        Some(if gap_before(&longest) < LONG_GAP_ROWS { finding } else { finding.hint(LONG_GAP_HINT) })
    }
}

/// Missing rows from which a gap is long: over as many rows, interpolated drives are not credible. A chosen limit.
const LONG_GAP_ROWS: usize = 10;
/// The hint for a long gap.
const LONG_GAP_HINT: &str = "list the data before and after the gap as two records of this file, each with its \"range\": interpolated drives may look like an unknown force";

/// Formats a count with its noun: "1 row", "2 rows".
pub(crate) fn plural(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// Whether two units measure the same quantity with the same factor, whatever their texts.
fn is_same_unit(unit: &Unit, other: &Unit) -> bool {
    unit.dimension() == other.dimension() && unit.factor() == other.factor()
}

/// An even grid of times, and the index in the grid of every row of a file.
struct EvenTimes {
    begin: f64,
    interval: f64,
    jitter: f64,
    sample_indices: Vec<usize>,
}

impl EvenTimes {
    /// Fits a grid to strictly increasing times in seconds. Rows may be missing. None if the times are not even: a row
    /// is more than [`MAX_JITTER`] from its even time, or too many rows are missing.
    ///
    /// The mean of the intervals near the median estimates the interval and so the index of each row. The first and the
    /// last row then define the grid.
    fn fit(times: &[f64]) -> Option<EvenTimes> {
        let intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let median_interval = median(&intervals);
        let (sum, count) = intervals
            .iter()
            .filter(|interval| (**interval / median_interval).round() == 1.0)
            .fold((0.0, 0.0), |(sum, count), interval| (sum + interval, count + 1.0));
        let usual_interval = sum / count;
        let mut sample_indices = vec![0];
        for interval in &intervals {
            let steps = (interval / usual_interval).round();
            if !(1.0..=times.len() as f64 * MAX_TIMES_PER_ROW as f64).contains(&steps) {
                return None;
            }
            sample_indices.push(sample_indices[sample_indices.len() - 1] + steps as usize);
        }
        let (begin, last) = (*times.first()?, *sample_indices.last()?);
        if last > MAX_TIMES_PER_ROW * times.len() {
            return None;
        }
        let interval = (times.last()? - begin) / last as f64;
        let deviation = |(time, index): (&f64, &usize)| ((time - begin) / interval - *index as f64).abs();
        let jitter = times.iter().zip(&sample_indices).map(deviation).fold(0.0, f64::max);
        (jitter <= MAX_JITTER).then_some(EvenTimes { begin, interval, jitter, sample_indices })
    }
}
