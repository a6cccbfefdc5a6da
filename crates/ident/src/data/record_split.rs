//! The split of a data file into samples to train on and samples to test on.
//!
//! The ranges of "train" and "test" in the experiment decide. If only one of them is given, the other part is what
//! remains. If neither is given, the first three quarters are training data. All ranges are ranges of indices into the
//! even times of the file.

use std::ops::Range;

use crate::data::experiment_document::TestData;
use crate::data::measured_file::MeasuredFile;
use crate::data::record::MIN_RECORD_SAMPLES;
use patchcord_core::document::{Placed, Span};

/// What the samples of a range are used for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum RecordPurpose {
    /// The fit uses them.
    Train,
    /// They test the fitted model.
    Test,
}

/// A range of samples and its purpose.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RecordRange {
    /// Indices of even times; the end is excluded.
    pub samples: Range<usize>,
    /// What the samples are used for.
    pub purpose: RecordPurpose,
    /// The place in the experiment that specifies the range.
    pub span: Span,
}

/// Quarters of a record that are training data if the experiment specifies neither "train" nor "test". A chosen share.
const TRAINING_QUARTERS: usize = 3;

/// A data file with the part of it that is the record, ready to be split.
pub(crate) struct RecordSplit<'a> {
    /// The data.
    pub measured: &'a MeasuredFile,
    /// Seconds per unit of time in the file and in the ranges.
    pub unit_seconds: f64,
    /// The part of the file that is the record. None if it is the whole file.
    pub range: Option<&'a Placed<(f64, f64)>>,
    /// The place in the experiment that names the file.
    pub span: Span,
}

impl RecordSplit<'_> {
    /// Returns all samples of the record.
    pub fn all_samples(&self) -> Range<usize> {
        self.range.map_or(0..self.measured.len(), |range| self.samples_within(range))
    }

    /// Returns the samples of the file within a range of times.
    fn samples_within(&self, range: &Placed<(f64, f64)>) -> Range<usize> {
        let (from, to) = range.value;
        self.measured.samples_within((from * self.unit_seconds, to * self.unit_seconds))
    }

    /// Returns the samples of the record within a range of times.
    fn range_within(&self, range: &Placed<(f64, f64)>, purpose: RecordPurpose) -> RecordRange {
        let (requested, all) = (self.samples_within(range), self.all_samples());
        let start = requested.start.max(all.start);
        RecordRange { samples: start..requested.end.min(all.end).max(start), purpose, span: range.span }
    }

    /// Returns the whole record for one purpose.
    pub fn whole_record(&self, purpose: RecordPurpose) -> RecordRange {
        let span = self.range.map_or(self.span, |range| range.span);
        RecordRange { samples: self.all_samples(), purpose, span }
    }

    /// Returns the range to train on and the range to test on, in this order. If "test" lists separate records, only
    /// the range to train on is returned. The ranges may overlap if the experiment specifies both.
    pub fn split(&self, train: Option<&Placed<(f64, f64)>>, test: &TestData) -> Vec<RecordRange> {
        let all = self.all_samples();
        let training = train.map(|range| self.range_within(range, RecordPurpose::Train));
        let testing = match test {
            TestData::Records(_) => {
                return vec![training.unwrap_or_else(|| self.whole_record(RecordPurpose::Train))];
            }
            TestData::Range(range) => Some(self.range_within(range, RecordPurpose::Test)),
            TestData::Remainder => None,
        };
        let (training, testing) = match (training, testing) {
            (Some(training), Some(testing)) => (training, testing),
            (Some(training), None) => {
                let samples = training.samples.end..all.end;
                let testing = RecordRange { samples, purpose: RecordPurpose::Test, span: training.span };
                (training, testing)
            }
            (None, Some(testing)) => {
                let before = all.start..testing.samples.start;
                let after = testing.samples.end..all.end;
                let samples = if before.len() < MIN_RECORD_SAMPLES { after } else { before };
                (RecordRange { samples, purpose: RecordPurpose::Train, span: testing.span }, testing)
            }
            (None, None) => {
                let boundary = all.start + all.len() * TRAINING_QUARTERS / 4;
                let range = |samples, purpose| RecordRange { samples, purpose, span: self.span };
                let training = range(all.start..boundary, RecordPurpose::Train);
                (training, range(boundary..all.end, RecordPurpose::Test))
            }
        };
        vec![training, testing]
    }
}

/// Returns the number of samples that two ranges share.
pub(crate) fn shared_samples(one: &Range<usize>, other: &Range<usize>) -> usize {
    one.end.min(other.end).saturating_sub(one.start.max(other.start))
}

/// Removes the sample at which a training range and a test range meet from the test range. Returns the number of
/// samples that the ranges share afterwards: 0 if they only met, otherwise the ranges are unchanged.
pub(crate) fn separate_test_range(training: &Range<usize>, testing: &mut Range<usize>) -> usize {
    let shared = shared_samples(training, testing);
    if shared != 1 || testing.len() < 2 {
        return shared;
    }
    if testing.start + 1 == training.end {
        testing.start += 1;
    } else {
        testing.end -= 1;
    }
    0
}
