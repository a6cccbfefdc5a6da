//! Combines an experiment document with its patch and its data files.
//!
//! The builder works in this order. It reads and compiles the patch. It finds the drive or signal of every column. It
//! reads the data files and splits them into training and validation records. Then it checks the drives that no column
//! feeds, and selects the parameters to fit. If there is no error so far, it compares the columns with their scales.
//! Data files are also read if the patch has errors, so that one report lists the faults of both.
//!
//! `checks` has the checks of these steps.

mod checks;

use std::collections::HashSet;
use std::path::PathBuf;

use crate::data::checked_patch::{BindingTarget, CheckedPatch};
use crate::data::codes;
use crate::data::column_checks::check_columns;
use crate::data::experiment::{Experiment, MeasuredDrive, MeasuredOutput};
use crate::data::experiment_document::{
    ColumnBinding, DriveBinding, ExperimentDocument, Hold, OutputBinding, RecordSource, ValidationData,
};
use crate::data::file_source::FileSource;
use crate::data::fittable::parameters_to_fit;
use crate::data::measured_file::{MeasuredFile, RequestedColumn, read_file};
use crate::data::record::{MIN_RECORD_SAMPLES, Record};
use crate::data::record_split::{RecordPurpose, RecordRange, RecordSplit, separate_validation_range};
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Report, any_error, format_number, plural};
use patchcord_expr::Unit;

/// Builds an experiment from its document.
pub(crate) struct ExperimentBuilder<'a> {
    /// Where the patch and the data files are.
    pub source: FileSource<'a>,
    /// The document.
    pub document: &'a ExperimentDocument,
    /// All faults found so far.
    pub findings: &'a mut Findings,
}

/// A data file of the experiment after reading.
struct RecordFile<'a> {
    /// The canonical path, so that two paths to one file are recognised.
    path: PathBuf,
    source: &'a RecordSource,
    measured: MeasuredFile,
    /// Seconds per unit of time in the file.
    unit_seconds: f64,
}

impl RecordFile<'_> {
    /// Returns the file as input of the split.
    fn record_split(&self) -> RecordSplit<'_> {
        RecordSplit {
            measured: &self.measured,
            unit_seconds: self.unit_seconds,
            range: self.source.range.as_ref(),
            span: self.source.file.span,
        }
    }

    /// Returns the first time, the last time and the interval of the samples, in the unit of the times.
    fn first_last_interval(&self) -> [f64; 3] {
        let MeasuredFile { begin, interval, .. } = self.measured;
        [begin, begin + self.measured.duration(), interval].map(|seconds| seconds / self.unit_seconds)
    }

    /// Whether both have the same samples: the same columns of the same file.
    fn is_same_data(&self, other: &RecordFile<'_>) -> bool {
        self.path == other.path && self.source.has_same_columns(other.source)
    }
}

/// A range of a data file.
struct FileRange<'r> {
    file: &'r RecordFile<'r>,
    range: RecordRange,
}

impl FileRange<'_> {
    /// The number of rows in the range. Missing rows do not count.
    fn row_count(&self) -> usize {
        self.file.measured.rows_in(&self.range.samples).len()
    }
}

impl<'a> ExperimentBuilder<'a> {
    /// Builds the experiment. Its `file` and `warnings` are empty. If the findings contain an error, the experiment
    /// must not be used.
    ///
    /// # Errors
    /// If the patch cannot be read or has errors. The error is the report of the patch, if there is one.
    pub(crate) fn build(mut self) -> Result<Experiment, Option<Box<Report>>> {
        let document = self.document;
        let patch = match &document.patch {
            Some(named) => CheckedPatch::read(self.source, named, self.findings),
            None => Err(None),
        };
        self.check_bindings();
        let valid_patch = patch.as_ref().ok();
        let drives: Vec<_> = document.drives.iter().map(|drive| self.drive(drive, valid_patch)).collect();
        let outputs: Vec<_> =
            document.outputs.iter().map(|output| self.output(output, valid_patch)).collect();
        // Data are read even if the patch has errors.
        let ([train, validation], unit_seconds) = self.records(&drives, &outputs);
        let piece_duration =
            document.piece_duration.as_ref().zip(unit_seconds).map(|(duration, unit)| duration.value * unit);
        self.check_pieces(piece_duration, &train, &validation);
        let patch = patch?;
        self.check_restarting_drives(patch.patch(), [&train, &validation]);
        self.check_record_start(patch.patch());
        let is_fed = |name: &str| document.is_fed(name);
        let fit = parameters_to_fit(patch.patch(), &is_fed, document.fit.as_deref(), self.findings);
        self.check_fit(&fit);
        let experiment = Experiment {
            file: String::new(),
            title: document.title.clone(),
            patch: patch.patch().clone(),
            patch_name: document.patch.as_ref().map_or_else(String::new, |named| named.value.clone()),
            drives: drives.into_iter().flatten().collect(),
            outputs: outputs.into_iter().flatten().collect(),
            fit,
            train,
            validation,
            files: self.data_files(),
            piece_duration,
            warnings: Report::new("", "", Vec::new()),
        };
        if !any_error(self.findings) {
            check_columns(&experiment, document, self.findings);
        }
        if !any_error(self.findings) {
            self.check_motionless_drives(&experiment.patch);
        }
        Ok(experiment)
    }

    /// Reads all records. Returns the training records, the validation records, and the seconds per unit of time. The
    /// last one is None if there is no file, or if the files differ and records must be split into pieces.
    fn records(
        &mut self,
        drives: &[Option<MeasuredDrive>],
        outputs: &[Option<MeasuredOutput>],
    ) -> ([Vec<Record>; 2], Option<f64>) {
        let document = self.document;
        let drive_units = drives.iter().map(|drive| drive.as_ref().map(|drive| &drive.unit));
        let output_units = outputs.iter().map(|output| output.as_ref().map(|output| &output.unit));
        let requested = requested_columns(document, drive_units.chain(output_units));
        let data_files = self.read_files(&document.data, &requested);
        let validation_files = match &document.validation {
            ValidationData::Records(sources) => self.read_files(sources, &requested),
            _ => Vec::new(),
        };
        let holds: Vec<Hold> = document.drives.iter().map(|drive| drive.hold).collect();
        self.check_ranges(&data_files, &validation_files);
        let ranges = self.file_ranges(&data_files, &validation_files);
        let records = [RecordPurpose::Training, RecordPurpose::Validation].map(|purpose| {
            let with_purpose = ranges.iter().filter(|entry| entry.range.purpose == purpose);
            let extract = |entry: &FileRange<'_>| {
                Record::extract(&entry.file.measured, entry.range.samples.clone(), &holds)
            };
            with_purpose.map(extract).collect()
        });
        (records, self.unit_seconds(data_files.iter().chain(&validation_files)))
    }

    /// Returns the seconds per unit of time of the first file. None if there is no file. Reports files with different
    /// units if the experiment specifies the duration of pieces, because that has no unit then; the result is None.
    fn unit_seconds<'r>(&mut self, mut files: impl Iterator<Item = &'r RecordFile<'r>>) -> Option<f64> {
        let first = files.next()?;
        let other = files.find(|file| file.unit_seconds != first.unit_seconds);
        if let Some((duration, other)) = self.document.piece_duration.as_ref().zip(other) {
            let [first_unit, other_unit] = [first, other].map(|file| format_number(file.unit_seconds));
            let message = format!(
                "the unit of \"pieces\" is ambiguous: times are in {first_unit} s in {} and {other_unit} s in {}",
                first.measured.name, other.measured.name
            );
            let finding = Diagnostic::at(Code::UNIT_MISMATCH, duration.span, message);
            self.findings.push(finding.hint("use the same unit of time in all files"));
            return None;
        }
        Some(first.unit_seconds)
    }

    /// Finds the drive of a column. None if the patch has errors or does not have the drive.
    fn drive(&mut self, drive: &DriveBinding, patch: Option<&CheckedPatch>) -> Option<MeasuredDrive> {
        let target = patch?.drive(&drive.binding, self.findings)?;
        let BindingTarget { name, unit, per_volt } = target;
        let sigma = drive.sigma.as_ref().map(|sigma| in_target_unit(sigma.value, &drive.binding, &unit));
        let column = drive.binding.column.value.clone();
        Some(MeasuredDrive { drive: name, column, hold: drive.hold, sigma, unit, per_volt })
    }

    /// Finds the signal of a column. None if the patch has errors or does not have the signal.
    fn output(&mut self, output: &OutputBinding, patch: Option<&CheckedPatch>) -> Option<MeasuredOutput> {
        let BindingTarget { name, unit, per_volt } = patch?.signal(&output.binding, self.findings)?;
        let sigma = output.sigma.as_ref().map(|sigma| in_target_unit(sigma.value, &output.binding, &unit));
        let column = output.binding.column.value.clone();
        Some(MeasuredOutput { signal: name, column, sigma, has_offset: output.has_offset, unit, per_volt })
    }

    /// Returns the paths of all data files.
    fn data_files(&self) -> Vec<PathBuf> {
        let validation_sources = match &self.document.validation {
            ValidationData::Records(sources) => sources.as_slice(),
            _ => &[],
        };
        let sources = self.document.data.iter().chain(validation_sources);
        sources.map(|source| self.source.path(&source.file.value)).collect()
    }

    /// Reads data files. Files with errors are omitted.
    fn read_files(
        &mut self,
        sources: &'a [RecordSource],
        requested: &[RequestedColumn<'_>],
    ) -> Vec<RecordFile<'a>> {
        let mut files = Vec::new();
        let Some(sample_times) = &self.document.sample_times else { return files };
        for source in sources {
            self.check_aliases(source, sample_times);
            let read = read_file(self.source, source, sample_times, requested, self.findings);
            let path = self.source.canonical_path(&source.file.value);
            files.extend(read.map(|(measured, unit_seconds)| RecordFile {
                path,
                source,
                measured,
                unit_seconds,
            }));
        }
        files
    }

    /// Returns the ranges of all files with their purpose. Ranges with too few samples are reported.
    fn file_ranges<'r>(
        &mut self,
        data_files: &'r [RecordFile<'r>],
        validation_files: &'r [RecordFile<'r>],
    ) -> Vec<FileRange<'r>> {
        let document = self.document;
        let split = |file: &'r RecordFile<'r>| {
            let ranges = file.record_split().split(document.train.as_ref(), &document.validation);
            ranges.into_iter().map(move |range| FileRange { file, range })
        };
        let whole = |file: &'r RecordFile<'r>| {
            let range = file.record_split().whole_record(RecordPurpose::Validation);
            FileRange { file, range }
        };
        let mut ranges: Vec<_> =
            data_files.iter().flat_map(split).chain(validation_files.iter().map(whole)).collect();
        self.separate_validation_data(&mut ranges);
        [data_files, validation_files].into_iter().for_each(|files| self.check_duplicates(files));
        let mut reported_spans = HashSet::new();
        for range in ranges.iter().filter(|range| range.row_count() < MIN_RECORD_SAMPLES) {
            // If both ranges of a record are too short, one report is enough.
            if reported_spans.insert(range.range.span) {
                self.findings.push(self.too_few_samples(range));
            }
        }
        ranges
    }

    /// Separates validation ranges from the training ranges that they meet, and reports those that overlap.
    fn separate_validation_data(&mut self, ranges: &mut [FileRange<'_>]) {
        let training: Vec<_> = ranges
            .iter()
            .filter(|entry| entry.range.purpose == RecordPurpose::Training)
            .map(|entry| (entry.file, entry.range.samples.clone()))
            .collect();
        for validation in ranges.iter_mut().filter(|entry| entry.range.purpose == RecordPurpose::Validation) {
            for (file, samples) in training.iter().filter(|(file, _)| file.is_same_data(validation.file)) {
                let shared = separate_validation_range(samples, &mut validation.range.samples);
                if shared > 0 {
                    let message = format!(
                        "{shared} samples of {} are used for both training and validation",
                        file.measured.name
                    );
                    self.findings.push(Diagnostic::at(codes::SHARED_SAMPLES, validation.range.span, message));
                }
            }
        }
    }

    /// Reports a range with too few samples.
    fn too_few_samples(&self, entry: &FileRange<'_>) -> Diagnostic {
        let (measured, range) = (&entry.file.measured, &entry.range);
        let unit_seconds = entry.file.unit_seconds;
        let (purpose, more) = match (range.purpose, &self.document.validation) {
            (RecordPurpose::Validation, ValidationData::Remainder) => {
                ("validation", "; end \"train\" earlier, or specify a separate file as \"test\"")
            }
            (RecordPurpose::Validation, _) => ("validation", ""),
            (RecordPurpose::Training, _) => ("training", ""),
        };
        let [from, to] = [0, measured.len().saturating_sub(1)]
            .map(|sample| format_number(measured.time(sample) / unit_seconds));
        let message = format!(
            "{} has {} for {purpose}, but needs {MIN_RECORD_SAMPLES}",
            measured.name,
            plural(entry.row_count(), "sample")
        );
        let hint = format!(
            "the file has {}, at times from {from} to {to}{more}",
            plural(measured.sample_indices.len(), "sample")
        );
        Diagnostic::at(codes::TOO_FEW_SAMPLES, range.span, message).hint(hint)
    }
}

/// Converts a standard deviation to the unit of the patch. It is in the unit that the experiment specifies for the
/// column, or in the unit of the patch if there is none. A unit that cannot be converted has been reported.
fn in_target_unit(sigma: f64, binding: &ColumnBinding, target: &Unit) -> f64 {
    let source = binding.unit.as_ref().map_or(target, |unit| &unit.value);
    source.conversion_to(target).map_or(sigma, |conversion| conversion.apply(sigma))
}

/// Returns the columns to read: drives, then outputs. `targets` has the unit of the patch for each of them.
fn requested_columns<'d>(
    document: &'d ExperimentDocument,
    targets: impl Iterator<Item = Option<&'d Unit>>,
) -> Vec<RequestedColumn<'d>> {
    let has_sigmas = document
        .drives
        .iter()
        .map(|drive| drive.sigma.is_some())
        .chain(document.outputs.iter().map(|output| output.sigma.is_some()));
    let entries = document.bindings().zip(targets).zip(has_sigmas);
    entries
        .map(|(((binding, noun), target_unit), has_sigma)| RequestedColumn {
            column: &binding.column,
            noun,
            name: &binding.name.value,
            unit: binding.unit.as_ref(),
            target_unit,
            has_sigma,
        })
        .collect()
}
