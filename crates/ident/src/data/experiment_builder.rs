//! Combines an experiment document with its patch and its data files.
//!
//! The builder works in this order. It reads and compiles the patch. It finds the drive or signal of every column. It
//! reads the data files and splits them into training and test records. Then it checks the drives that no column feeds,
//! and selects the parameters to fit. If there is no error so far, it compares the columns with their scales. Data
//! files are also read if the patch has errors, so that one report lists the faults of both.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::data::checked_patch::{BindingTarget, CheckedPatch};
use crate::data::codes;
use crate::data::column_checks::check_columns;
use crate::data::drive_timing::{DriveTiming, RECORD_START, drive_timings, restarting_drives};
use crate::data::experiment::{Experiment, MeasuredDrive, MeasuredOutput};
use crate::data::experiment_document::{
    ColumnBinding, DriveBinding, ExperimentDocument, Hold, OutputBinding,
};
use crate::data::experiment_document::{RecordSource, SampleTimes, TestData};
use crate::data::fittable::parameters_to_fit;
use crate::data::measured_file::{MeasuredFile, RequestedColumn, plural, read_file};
use crate::data::record::{MIN_RECORD_SAMPLES, Record};
use crate::data::record_split::{
    RecordPurpose, RecordRange, RecordSplit, separate_test_range, shared_samples,
};
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Placed, Report, any_error, format_number, suggestion};
use patchcord_core::patch::Patch;
use patchcord_expr::Unit;

/// Builds an experiment from its document.
pub(crate) struct ExperimentBuilder<'a> {
    /// The folder of the experiment, to which all its paths are relative.
    pub folder: &'a Path,
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
    pub fn build(mut self) -> Result<Experiment, Option<Box<Report>>> {
        let document = self.document;
        let patch = match &document.patch {
            Some(named) => CheckedPatch::read(self.folder, named, self.findings),
            None => Err(None),
        };
        self.check_bindings();
        let valid_patch = patch.as_ref().ok();
        let drives: Vec<_> = document.drives.iter().map(|drive| self.drive(drive, valid_patch)).collect();
        let outputs: Vec<_> =
            document.outputs.iter().map(|output| self.output(output, valid_patch)).collect();
        // Data are read even if the patch has errors.
        let ([train, test], unit_seconds) = self.records(&drives, &outputs);
        let piece_duration =
            document.piece_duration.as_ref().zip(unit_seconds).map(|(duration, unit)| duration.value * unit);
        self.check_pieces(piece_duration, &train, &test);
        let patch = patch?;
        self.check_restarting_drives(patch.patch(), [&train, &test]);
        self.check_record_start(patch.patch());
        let is_fed = |name: &str| document.is_fed(name);
        let fit = parameters_to_fit(patch.patch(), &is_fed, document.fit.as_deref(), self.findings);
        self.check_fit(&fit);
        let experiment = Experiment {
            file: String::new(),
            title: document.title.clone(),
            patch: patch.patch().clone(),
            drives: drives.into_iter().flatten().collect(),
            outputs: outputs.into_iter().flatten().collect(),
            fit,
            train,
            test,
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

    /// Reports columns with two bindings, and outputs that columns feed. Such an output always agrees with its column,
    /// whatever the patch computes.
    fn check_bindings(&mut self) {
        let document = self.document;
        let bindings: Vec<&ColumnBinding> = document.bindings().map(|(binding, _)| binding).collect();
        let shared = bindings.iter().enumerate().filter_map(|(index, binding)| {
            let has_other_name = |earlier: &&&ColumnBinding| earlier.name.value != binding.name.value;
            let mut earlier = bindings[..index].iter().filter(has_other_name);
            let first = earlier.find(|earlier| earlier.column.value == binding.column.value)?;
            let (column, first, name) = (&binding.column, &first.name.value, &binding.name.value);
            let message = format!("the column {} is used for both {first} and {name}", column.value);
            Some(Diagnostic::at(codes::SHARED_COLUMN, column.span, message))
        });
        self.findings.extend(shared);
        let is_fed = |output: &&OutputBinding| document.is_fed(&output.binding.name.value);
        let fed_outputs = document.outputs.iter().filter(is_fed).map(|output| {
            let Placed { value: name, span } = &output.binding.name;
            let message = format!("{name} is fed from the data, so as an output it does not test the patch");
            Diagnostic::at(Code::DUPLICATE_NAME, *span, message).hint("remove it from \"outputs\"")
        });
        self.findings.extend(fed_outputs);
    }

    /// Reads all records. Returns the records to train on, the records to test on, and the seconds per unit of time.
    /// The last one is None if there is no file, or if the files differ and records must be split into pieces.
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
        let test_files = match &document.test {
            TestData::Records(sources) => self.read_files(sources, &requested),
            _ => Vec::new(),
        };
        let holds: Vec<Hold> = document.drives.iter().map(|drive| drive.hold).collect();
        self.check_ranges(&data_files, &test_files);
        let ranges = self.file_ranges(&data_files, &test_files);
        let records = [RecordPurpose::Train, RecordPurpose::Test].map(|purpose| {
            let with_purpose = ranges.iter().filter(|entry| entry.range.purpose == purpose);
            let extract = |entry: &FileRange<'_>| {
                Record::extract(&entry.file.measured, entry.range.samples.clone(), &holds)
            };
            with_purpose.map(extract).collect()
        });
        (records, self.unit_seconds(data_files.iter().chain(&test_files)))
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

    /// Reports ranges that extend beyond the data.
    fn check_ranges(&mut self, data_files: &[RecordFile<'_>], test_files: &[RecordFile<'_>]) {
        let test = match &self.document.test {
            TestData::Range(range) => Some(range),
            _ => None,
        };
        // "train" and "test" apply to all data files: one file that covers the range is sufficient.
        let of_all_files = self.document.train.iter().chain(test).map(|range| (range, data_files));
        let of_one_file = data_files
            .iter()
            .chain(test_files)
            .filter_map(|file| Some((file.source.range.as_ref()?, std::slice::from_ref(file))));
        let beyond = of_all_files.chain(of_one_file).filter_map(|(range, files)| beyond_data(range, files));
        self.findings.extend(beyond.collect::<Vec<_>>());
    }

    /// Reports pieces that are longer than every record, and pieces with fewer samples than a record needs.
    /// `piece_duration` is in seconds.
    fn check_pieces(&mut self, piece_duration: Option<f64>, train: &[Record], test: &[Record]) {
        let Some((entry, seconds)) = self.document.piece_duration.as_ref().zip(piece_duration) else {
            return;
        };
        let longest = train.iter().chain(test).map(Record::duration).fold(0.0, f64::max);
        if longest > 0.0 && seconds > longest {
            let message = format!(
                "a piece of {} s is longer than every record: the longest is {} s",
                format_number(seconds),
                format_number(longest)
            );
            self.findings
                .push(Diagnostic::at(codes::BEYOND_DATA, entry.span, message).hint("remove \"pieces\""));
        }
        let min_duration = |record: &Record| record.interval * MIN_RECORD_SAMPLES as f64;
        if let Some(record) = train.iter().chain(test).find(|record| seconds < min_duration(record)) {
            let message = format!("a piece of {} has fewer than {MIN_RECORD_SAMPLES} samples", record.name);
            let hint = format!("its samples are {} s apart", format_number(record.interval));
            self.findings.push(Diagnostic::at(codes::TOO_FEW_SAMPLES, entry.span, message).hint(hint));
        }
    }

    /// Reports drives that every run restarts and that no column feeds. That is a warning if every record begins with
    /// its file. It is an error if a record or a piece begins later, because the drive would be out of phase there.
    fn check_restarting_drives(&mut self, patch: &Patch, records: [&[Record]; 2]) {
        let document = self.document;
        let restarting: Vec<&str> = restarting_drives(patch, |name| document.is_fed(name)).collect();
        // If "drives" has an unknown name, that may be the name of one of these drives.
        let has_known_names =
            document.drives.iter().all(|drive| patch.drives.contains_key(&drive.binding.name.value));
        let is_reported = !restarting.is_empty() && has_known_names;
        let Some(named) = document.patch.as_ref().filter(|_| is_reported) else { return };
        let names = restarting.join(", ");
        let later_record = records.into_iter().flatten().find(|record| record.start_in_file > 0.0);
        let out_of_phase = match document.piece_duration {
            Some(_) => Some("a later piece of a record".to_owned()),
            None => later_record.map(|record| {
                format!("the record that begins at {} s in {}", format_number(record.begin), record.name)
            }),
        };
        let (code, consequence) = match out_of_phase {
            Some(record) => {
                let consequence = format!("and every record restarts it, which is wrong for {record}");
                (codes::DRIVE_RESTARTS, consequence)
            }
            None => (codes::UNFED_DRIVES, "beginning at the start of each record".to_owned()),
        };
        let message =
            format!("no column feeds {names} of the patch: the patch generates the motion, {consequence}");
        self.findings.push(Diagnostic::at(code, named.span, message));
    }

    /// Reports a parameter [`RECORD_START`] whose unit is not s, because every run sets it in seconds.
    fn check_record_start(&mut self, patch: &Patch) {
        let start = patch.parameters.get(RECORD_START).filter(|start| start.unit.text() != "s");
        let Some((named, start)) = self.document.patch.as_ref().zip(start) else { return };
        let message =
            format!("the unit of {RECORD_START} must be s, but the patch specifies {}", start.unit.text());
        let finding = Diagnostic::at(Code::UNIT_MISMATCH, named.span, message);
        self.findings.push(finding.hint("give it the unit \"s\" in the patch"));
    }

    /// Reports a patch whose drives are all constant if no column feeds any of them.
    fn check_motionless_drives(&mut self, patch: &Patch) {
        let document = self.document;
        let is_constant = drive_timings(patch).all(|(_, timing)| timing == DriveTiming::Constant);
        let is_motionless = document.drives.is_empty() && !patch.drives.is_empty() && is_constant;
        let Some(named) = document.patch.as_ref().filter(|_| is_motionless) else { return };
        let drives: Vec<&str> = patch.drives.keys().map(String::as_str).collect();
        let message = format!(
            "no column feeds a drive, and all drives of the patch are constant: {}",
            drives.join(", ")
        );
        self.findings.push(Diagnostic::at(codes::UNFED_DRIVES, named.span, message));
    }

    /// Reports that nothing is fitted, unless the experiment specifies that.
    fn check_fit(&mut self, fit: &[String]) {
        let named = self.document.patch.as_ref().filter(|_| self.document.fit.is_none() && fit.is_empty());
        let message = "nothing is fitted: no parameter of the patch both has a range and is read";
        self.findings.extend(named.map(|named| Diagnostic::at(codes::NOTHING_TO_FIT, named.span, message)));
    }

    /// Finds the drive of a column. None if the patch has errors or does not have the drive.
    fn drive(&mut self, drive: &DriveBinding, patch: Option<&CheckedPatch>) -> Option<MeasuredDrive> {
        let target = patch?.drive(&drive.binding, self.findings)?;
        let BindingTarget { name, unit, per_volt } = target;
        let sigma = drive.sigma.map(|sigma| in_target_unit(sigma, &drive.binding, &unit));
        let column = drive.binding.column.value.clone();
        Some(MeasuredDrive { drive: name, column, hold: drive.hold, sigma, unit, per_volt })
    }

    /// Finds the signal of a column. None if the patch has errors or does not have the signal.
    fn output(&mut self, output: &OutputBinding, patch: Option<&CheckedPatch>) -> Option<MeasuredOutput> {
        let BindingTarget { name, unit, per_volt } = patch?.signal(&output.binding, self.findings)?;
        let sigma = output.sigma.map(|sigma| in_target_unit(sigma, &output.binding, &unit));
        let column = output.binding.column.value.clone();
        Some(MeasuredOutput { signal: name, column, sigma, has_offset: output.has_offset, unit, per_volt })
    }

    /// Returns the paths of all data files.
    fn data_files(&self) -> Vec<PathBuf> {
        let test_sources = match &self.document.test {
            TestData::Records(sources) => sources.as_slice(),
            _ => &[],
        };
        let sources = self.document.data.iter().chain(test_sources);
        sources.map(|source| self.folder.join(&source.file.value)).collect()
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
            let read = read_file(self.folder, source, sample_times, requested, self.findings);
            let path = self.folder.join(&source.file.value);
            let path = fs::canonicalize(&path).unwrap_or(path);
            files.extend(read.map(|(measured, unit_seconds)| RecordFile {
                path,
                source,
                measured,
                unit_seconds,
            }));
        }
        files
    }

    /// Reports different names for columns that the experiment does not read.
    fn check_aliases(&mut self, source: &RecordSource, sample_times: &SampleTimes) {
        let known: Vec<_> = sample_times
            .column()
            .into_iter()
            .chain(self.document.bindings().map(|(binding, _)| binding.column.value.as_str()))
            .collect();
        for (in_experiment, in_file) in
            source.columns.iter().filter(|(in_experiment, _)| !known.contains(&in_experiment.as_str()))
        {
            let message = format!("the experiment reads no column {in_experiment}");
            let hint = suggestion(in_experiment, &known);
            self.findings.push(Diagnostic::at(Code::UNKNOWN_NAME, in_file.span, message).maybe_hint(hint));
        }
    }

    /// Returns the ranges of all files with their purpose. Ranges with too few samples are reported.
    fn file_ranges<'r>(
        &mut self,
        data_files: &'r [RecordFile<'r>],
        test_files: &'r [RecordFile<'r>],
    ) -> Vec<FileRange<'r>> {
        let document = self.document;
        let split = |file: &'r RecordFile<'r>| {
            let ranges = file.record_split().split(document.train.as_ref(), &document.test);
            ranges.into_iter().map(move |range| FileRange { file, range })
        };
        let whole = |file: &'r RecordFile<'r>| {
            let range = file.record_split().whole_record(RecordPurpose::Test);
            FileRange { file, range }
        };
        let mut ranges: Vec<_> =
            data_files.iter().flat_map(split).chain(test_files.iter().map(whole)).collect();
        self.separate_test_data(&mut ranges);
        [data_files, test_files].into_iter().for_each(|files| self.check_duplicates(files));
        let mut reported_spans = HashSet::new();
        for range in ranges.iter().filter(|range| range.row_count() < MIN_RECORD_SAMPLES) {
            // If both ranges of a record are too short, one report is enough.
            if reported_spans.insert(range.range.span) {
                self.findings.push(self.too_few_samples(range));
            }
        }
        ranges
    }

    /// Separates test ranges from the training ranges that they meet, and reports those that overlap.
    fn separate_test_data(&mut self, ranges: &mut [FileRange<'_>]) {
        let training: Vec<_> = ranges
            .iter()
            .filter(|entry| entry.range.purpose == RecordPurpose::Train)
            .map(|entry| (entry.file, entry.range.samples.clone()))
            .collect();
        for test in ranges.iter_mut().filter(|entry| entry.range.purpose == RecordPurpose::Test) {
            for (file, samples) in training.iter().filter(|(file, _)| file.is_same_data(test.file)) {
                let shared = separate_test_range(samples, &mut test.range.samples);
                if shared > 0 {
                    let message = format!(
                        "{shared} samples of {} are used both to train and to test",
                        file.measured.name
                    );
                    self.findings.push(Diagnostic::at(codes::SHARED_SAMPLES, test.range.span, message));
                }
            }
        }
    }

    /// Reports samples that a list of records contains twice. They would count as more data than there are.
    fn check_duplicates(&mut self, files: &[RecordFile<'_>]) {
        for (index, file) in files.iter().enumerate() {
            let samples = file.record_split().all_samples();
            let earlier_files = files[..index].iter().filter(|earlier| earlier.is_same_data(file));
            let shared = earlier_files
                .map(|earlier| shared_samples(&earlier.record_split().all_samples(), &samples))
                .max()
                .unwrap_or(0);
            // Two ranges that meet share one sample. That is not a duplicate.
            if shared > 1 {
                let message = format!("{shared} samples of {} are listed twice", file.measured.name);
                let finding = Diagnostic::at(codes::SHARED_SAMPLES, file.record_split().span, message);
                self.findings.push(finding.hint("list them once: duplicates count as additional data"));
            }
        }
    }

    /// Reports a range with too few samples.
    fn too_few_samples(&self, entry: &FileRange<'_>) -> Diagnostic {
        let (measured, range) = (&entry.file.measured, &entry.range);
        let unit_seconds = entry.file.unit_seconds;
        let (verb, more) = match (range.purpose, &self.document.test) {
            (RecordPurpose::Test, TestData::Remainder) => {
                ("test", "; end \"train\" earlier, or specify a separate file as \"test\"")
            }
            (RecordPurpose::Test, _) => ("test", ""),
            (RecordPurpose::Train, _) => ("train", ""),
        };
        let [from, to] = [0, measured.len().saturating_sub(1)]
            .map(|sample| format_number(measured.time(sample) / unit_seconds));
        let message = format!(
            "{} has {} to {verb} on, but needs {MIN_RECORD_SAMPLES}",
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
/// column, or in the unit of the patch if there is none.
fn in_target_unit(sigma: f64, binding: &ColumnBinding, target: &Unit) -> f64 {
    let source = binding.unit.as_ref().map_or(target, |unit| &unit.value);
    target.out_of_si(source.to_si(sigma))
}

/// Reports a range that extends beyond the data of all these files by more than one sample. None if a file covers the
/// range, and also if the range contains no data of the longest file: that is reported as too few samples.
fn beyond_data(range: &Placed<(f64, f64)>, files: &[RecordFile<'_>]) -> Option<Diagnostic> {
    let longest = files.iter().max_by(|a, b| a.measured.duration().total_cmp(&b.measured.duration()))?;
    let (from, to) = range.value;
    let covers_range = |file: &RecordFile<'_>| {
        let [begin, end, interval] = file.first_last_interval();
        from >= begin - interval && to <= end + interval
    };
    let [begin, end, _] = longest.first_last_interval();
    let has_no_data = from > end || to < begin;
    let message = || {
        let [from, to, begin, end] = [from, to, begin, end].map(format_number);
        let name = &longest.measured.name;
        format!("the range is from {from} to {to}, but the data of {name} are from {begin} to {end}")
    };
    (!has_no_data && !files.iter().any(covers_range))
        .then(|| Diagnostic::at(codes::BEYOND_DATA, range.span, message()))
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
