//! The split of a data file into training samples and validation samples.
//!
//! The ranges under the keys "train" and "test" of the experiment decide; "test" specifies the validation data. If only
//! one of them is given, the other part is what remains. If neither is given, the first three quarters are training
//! data. All ranges are ranges of indices into the even times of the file.

use std::ops::Range;

use crate::data::experiment_document::ValidationData;
use crate::data::measured_file::MeasuredFile;
use crate::data::record::MIN_RECORD_SAMPLES;
use patchcord_core::document::{Placed, Span};

/// What the samples of a range are used for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum RecordPurpose {
    /// The parameters are fitted to them.
    Training,
    /// The fitted model is compared with them.
    Validation,
}

/// A range of samples and its purpose.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RecordRange {
    /// Indices of even times; the end is excluded.
    pub samples: Range<usize>,
    /// What the samples are used for.
    pub purpose: RecordPurpose,
    /// The position in the experiment that specifies the range.
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
    /// The position in the experiment that names the file.
    pub span: Span,
}

impl RecordSplit<'_> {
    /// Returns all samples of the record.
    pub(crate) fn all_samples(&self) -> Range<usize> {
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
    pub(crate) fn whole_record(&self, purpose: RecordPurpose) -> RecordRange {
        let span = self.range.map_or(self.span, |range| range.span);
        RecordRange { samples: self.all_samples(), purpose, span }
    }

    /// Returns the training range and the validation range, in this order. If `validation` lists separate records, only
    /// the training range is returned. The ranges may overlap if the experiment specifies both.
    pub(crate) fn split(
        &self,
        train: Option<&Placed<(f64, f64)>>,
        validation: &ValidationData,
    ) -> Vec<RecordRange> {
        let all = self.all_samples();
        let training = train.map(|range| self.range_within(range, RecordPurpose::Training));
        let validation = match validation {
            ValidationData::Records(_) => {
                return vec![training.unwrap_or_else(|| self.whole_record(RecordPurpose::Training))];
            }
            ValidationData::Range(range) => Some(self.range_within(range, RecordPurpose::Validation)),
            ValidationData::Remainder => None,
        };
        let (training, validation) = match (training, validation) {
            (Some(training), Some(validation)) => (training, validation),
            (Some(training), None) => {
                let samples = training.samples.end..all.end;
                let validation =
                    RecordRange { samples, purpose: RecordPurpose::Validation, span: training.span };
                (training, validation)
            }
            (None, Some(validation)) => {
                let before = all.start..validation.samples.start;
                let after = validation.samples.end..all.end;
                let has_enough_rows = self.measured.rows_in(&before).len() >= MIN_RECORD_SAMPLES;
                let samples = if has_enough_rows { before } else { after };
                (RecordRange { samples, purpose: RecordPurpose::Training, span: validation.span }, validation)
            }
            (None, None) => {
                let boundary = all.start + all.len() * TRAINING_QUARTERS / 4;
                let range = |samples, purpose| RecordRange { samples, purpose, span: self.span };
                let training = range(all.start..boundary, RecordPurpose::Training);
                (training, range(boundary..all.end, RecordPurpose::Validation))
            }
        };
        vec![training, validation]
    }
}

/// Returns the number of samples that two ranges share.
pub(crate) fn shared_samples(one: &Range<usize>, other: &Range<usize>) -> usize {
    one.end.min(other.end).saturating_sub(one.start.max(other.start))
}

/// Removes the sample at which a training range and a validation range meet from the validation range. Returns the
/// number of samples that the ranges share afterwards: 0 if they only met, otherwise the ranges are unchanged.
pub(crate) fn separate_validation_range(training: &Range<usize>, validation: &mut Range<usize>) -> usize {
    let shared = shared_samples(training, validation);
    if shared != 1 || validation.len() < 2 {
        return shared;
    }
    if validation.start + 1 == training.end {
        validation.start += 1;
    } else {
        validation.end -= 1;
    }
    0
}
