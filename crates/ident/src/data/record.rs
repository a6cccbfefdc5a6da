//! A record: evenly sampled data in the units of the patch.
//!
//! A record begins and ends with a measured sample. In between, rows may be missing. Outputs are NaN there, so that no
//! residual uses them. Drives must have a value at every time, so their missing samples are filled according to the
//! hold of the drive. A record can be split into shorter ones that keep the clock of the file.

use std::ops::Range;

use crate::data::experiment_document::Hold;
use crate::data::interpolation::fill_gaps;
use crate::data::measured_file::MeasuredFile;

/// The least number of samples of a training or validation record. A chosen limit. Missing samples do not count when an
/// experiment is read, but they count when a record is split into pieces.
pub const MIN_RECORD_SAMPLES: usize = 10;

/// Evenly sampled data of one experiment or of a part of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// The file as the experiment names it. If columns have different names in this file, they follow in parentheses.
    pub name: String,
    /// The time of the first sample by the clock of the file, in seconds.
    pub begin: f64,
    /// The time from the first sample of the file to the first sample of the record, in seconds.
    pub start_in_file: f64,
    /// The time between two samples, in seconds.
    pub interval: f64,
    /// The largest difference between the time of a sample and its even time, as a fraction of the interval.
    pub jitter: f64,
    /// The samples of every drive, in the unit of its scale. Missing samples are interpolated linearly between their
    /// neighbours, or equal to the previous sample if the hold of the drive is `Previous`.
    pub drives: Vec<Vec<f64>>,
    /// The samples of every output, in the unit of its signal. A missing sample is NaN.
    pub outputs: Vec<Vec<f64>>,
}

impl Record {
    /// Extracts the record between two even times of a file. `samples` are indices of even times. `holds` has one entry
    /// for each drive. The record is empty if the file has no row in the range.
    pub(crate) fn extract(measured: &MeasuredFile, samples: Range<usize>, holds: &[Hold]) -> Record {
        let rows = measured.rows_in(&samples);
        let first = measured.sample_indices.get(rows.start).copied().unwrap_or_default();
        let index_of = |row: usize| measured.sample_indices[row] - first;
        let count = rows.clone().next_back().map_or(0, |last| index_of(last) + 1);
        let spread = |column: &Vec<f64>| {
            let mut samples = vec![f64::NAN; count];
            rows.clone().for_each(|row| samples[index_of(row)] = column[row]);
            samples
        };
        let (drives, outputs) = measured.columns.split_at(holds.len());
        let filled = |(column, hold): (&Vec<f64>, &Hold)| {
            let mut samples = spread(column);
            fill_gaps(&mut samples, *hold);
            samples
        };
        Record {
            name: measured.name.clone(),
            begin: measured.time(first),
            start_in_file: measured.time(first) - measured.begin,
            interval: measured.interval,
            jitter: measured.jitter,
            drives: drives.iter().zip(holds).map(filled).collect(),
            outputs: outputs.iter().map(spread).collect(),
        }
    }

    /// Splits the record into `count` pieces whose lengths differ by at most one sample. There are fewer pieces if a
    /// piece would have fewer than `min_samples` samples, and at least one.
    pub(crate) fn split(
        &self,
        count: usize,
        min_samples: usize,
    ) -> impl ExactSizeIterator<Item = Record> + '_ {
        let count = count.min(self.len() / min_samples).max(1);
        let edge = move |piece: usize| piece * self.len() / count;
        (0..count).map(move |piece| self.sub_record(edge(piece)..edge(piece + 1)))
    }

    /// Splits the record into pieces of approximately `seconds` each. The number of pieces is rounded, and every piece
    /// has at least [`MIN_RECORD_SAMPLES`] samples if the record has.
    pub(crate) fn split_by_duration(&self, seconds: f64) -> impl Iterator<Item = Record> + '_ {
        let count = (self.duration() / seconds).round().max(1.0);
        self.split(count as usize, MIN_RECORD_SAMPLES)
    }

    /// Returns the first part of the record, at least two samples long. `fraction` is between 0 and 1.
    pub(crate) fn truncated(&self, fraction: f64) -> Record {
        let samples = (fraction * self.len() as f64).ceil() as usize;
        self.sub_record(0..samples.max(2).min(self.len()))
    }

    /// Returns a range of the samples as a record with the same clock.
    fn sub_record(&self, samples: Range<usize>) -> Record {
        let seconds_before = samples.start as f64 * self.interval;
        let slice =
            |columns: &[Vec<f64>]| columns.iter().map(|column| column[samples.clone()].to_vec()).collect();
        Record {
            name: self.name.clone(),
            begin: self.begin + seconds_before,
            start_in_file: self.start_in_file + seconds_before,
            drives: slice(&self.drives),
            outputs: slice(&self.outputs),
            ..*self
        }
    }

    /// The number of samples, including missing ones.
    pub fn len(&self) -> usize {
        self.outputs.first().map_or(0, Vec::len)
    }

    /// Whether the record has no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of missing rows.
    pub fn missing(&self) -> usize {
        self.outputs.first().map_or(0, |samples| samples.iter().filter(|sample| sample.is_nan()).count())
    }

    /// The time from the first sample to the last, in seconds. Zero for an empty record.
    pub fn duration(&self) -> f64 {
        self.interval * self.len().saturating_sub(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MISSING: f64 = f64::NAN;

    fn measured() -> MeasuredFile {
        MeasuredFile {
            name: "a.csv".to_owned(),
            begin: 2.0,
            interval: 0.5,
            jitter: 0.0,
            sample_indices: vec![0, 1, 4, 5],
            columns: vec![vec![0.0, 1.0, 4.0, 5.0], vec![0.0, 10.0, 40.0, 50.0]],
        }
    }

    /// Compares bits, because NaN is not equal to itself.
    fn assert_same_bits(actual: &[f64], expected: &[f64]) {
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(actual), bits(expected), "{actual:?}");
    }

    #[test]
    fn missing_rows_are_filled_in_drives_and_nan_in_outputs() {
        let record = Record::extract(&measured(), 1..6, &[Hold::Linear]);
        assert_eq!((record.begin, record.len(), record.missing(), record.duration()), (2.5, 5, 2, 2.0));
        assert_same_bits(&record.drives[0], &[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_same_bits(&record.outputs[0], &[10.0, MISSING, MISSING, 40.0, 50.0]);
        let record = Record::extract(&measured(), 1..6, &[Hold::Previous]);
        assert_same_bits(&record.drives[0], &[1.0, 1.0, 1.0, 4.0, 5.0]);
    }

    #[test]
    fn pieces_are_consecutive_and_keep_the_clock_of_the_file() {
        let record = Record::extract(&measured(), 0..6, &[Hold::Linear]);
        let pieces: Vec<Record> = record.split(3, 1).collect();
        assert_eq!(pieces.iter().map(|piece| piece.start_in_file).collect::<Vec<_>>(), [0.0, 1.0, 2.0]);
        let joined = pieces.iter().flat_map(|piece| piece.drives[0].clone()).collect::<Vec<_>>();
        assert_same_bits(&joined, &record.drives[0]);
        let lengths = |count, min_samples| {
            record.split(count, min_samples).map(|piece| piece.len()).collect::<Vec<_>>()
        };
        assert_eq!((lengths(4, 1), lengths(4, 4), lengths(2, 9)), (vec![1, 2, 1, 2], vec![6], vec![6]));
    }

    #[test]
    fn a_record_begins_and_ends_with_a_measured_sample() {
        let record = Record::extract(&measured(), 2..5, &[Hold::Linear]);
        assert_eq!((record.begin, record.len()), (4.0, 1));
        assert!(Record::extract(&measured(), 2..4, &[Hold::Linear]).is_empty());
    }
}
