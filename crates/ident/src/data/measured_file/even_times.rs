//! The even times of a data file: an even grid is fitted to the times of the rows. Missing rows and a last row that
//! is left out are reported.

use super::FileReader;
use crate::data::codes;
use crate::data::experiment_document::SampleTimes;
use crate::statistics::descriptive::median;
use patchcord_core::document::csv_table::CsvTable;
use patchcord_core::document::{Diagnostic, format_number, plural};
use patchcord_core::patch::time_order_hint;

/// The largest difference between the time of a row and its even time, as a fraction of the interval. It allows for
/// times that are rounded to few digits.
pub(super) const MAX_JITTER: f64 = 0.05;

/// The largest number of even times per row of a file. A chosen limit: with more missing rows than that, the even times
/// are not credible.
const MAX_TIMES_PER_ROW: usize = 4;

/// An even grid of times, and the index in the grid of every row of a file.
pub(super) struct EvenTimes {
    /// The first time, in seconds.
    pub(super) begin: f64,
    /// The time between two even times, in seconds.
    pub(super) interval: f64,
    /// The largest difference between the time of a row and its even time, as a fraction of the interval.
    pub(super) jitter: f64,
    /// The index of the even time of each row, without a last row that is left out.
    pub(super) sample_indices: Vec<usize>,
}

impl EvenTimes {
    /// Fits a grid to strictly increasing times in seconds. The last row is left out if it is early and all others are
    /// even: a run records its end even if its length is not a whole number of intervals. None if the times are not
    /// even.
    fn fit(times: &[f64]) -> Option<EvenTimes> {
        EvenTimes::fit_all(times).or_else(|| {
            let (last, others) = times.split_last()?;
            let even_times = EvenTimes::fit_all(others)?;
            (last - others.last()? < even_times.interval).then_some(even_times)
        })
    }

    /// Fits a grid to all of these times. Rows may be missing. None if the times are not even: a row is more than
    /// [`MAX_JITTER`] from its even time, or too many rows are missing.
    ///
    /// The mean of the intervals near the median estimates the interval and so the index of each row. The first and the
    /// last row then define the grid.
    fn fit_all(times: &[f64]) -> Option<EvenTimes> {
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

impl FileReader<'_> {
    /// Returns the even times of the rows.
    pub(super) fn even_times(&self, rows: &CsvTable, unit_seconds: f64) -> Result<EvenTimes, Diagnostic> {
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
    pub(super) fn missing_rows(
        &self,
        even_times: &EvenTimes,
        lines: &[usize],
        unit_seconds: f64,
    ) -> Option<Diagnostic> {
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

    /// Reports a last row that is left out because it is early. None if all rows have even times, or if this row is
    /// after the range of the record.
    pub(super) fn early_last_row(&self, even_times: &EvenTimes, rows: &CsvTable) -> Option<Diagnostic> {
        let row = even_times.sample_indices.len();
        let (line, time) = (rows.lines.get(row)?, rows.columns.first()?.get(row)?);
        let is_within_range = self.source.range.as_ref().is_none_or(|range| *time <= range.value.1);
        let message = format!(
            "the last row of {}, in line {line}, follows after less than an interval and is left out",
            self.path.display()
        );
        is_within_range.then(|| Diagnostic::at(codes::EARLY_LAST_ROW, self.source.file.span, message))
    }
}

/// Missing rows from which a gap is long: over as many rows, interpolated drives are not credible. A chosen limit.
const LONG_GAP_ROWS: usize = 10;
/// The hint for a long gap.
const LONG_GAP_HINT: &str = "list the data before and after the gap as two records of this file, each with its \"range\": interpolated drives may look like an unknown force";

#[cfg(test)]
mod tests {
    use super::*;

    /// Twenty times from 0 with an interval of 0.1 s, and one more.
    fn times_with(last: f64) -> Vec<f64> {
        (0..20).map(|index| 0.1 * f64::from(index)).chain([last]).collect()
    }

    #[test]
    fn an_early_last_row_is_left_out() {
        let found = EvenTimes::fit(&times_with(1.93)).unwrap();
        assert!(found.sample_indices.iter().copied().eq(0..20) && (found.interval - 0.1).abs() < 1e-12);
        assert_eq!(EvenTimes::fit(&times_with(2.0)).unwrap().sample_indices.len(), 21);
    }

    #[test]
    fn a_late_last_row_and_an_early_row_between_others_are_uneven() {
        assert!(EvenTimes::fit(&times_with(2.03)).is_none());
        let mut times = times_with(2.0);
        times.insert(5, 0.43);
        assert!(EvenTimes::fit(&times).is_none());
    }
}
