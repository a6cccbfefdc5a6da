//! The checks of an experiment that need the patch or the data files: bindings, ranges, pieces and drives.
//!
//! `build` calls each of them once. Every fault is added to the findings, and building continues.

use super::{ExperimentBuilder, RecordFile};
use crate::data::codes;
use crate::data::drive_timing::{DriveTiming, RECORD_START, drive_timings, restarting_drives};
use crate::data::experiment_document::{
    ColumnBinding, OutputBinding, RecordSource, SampleTimes, ValidationData,
};
use crate::data::record::{MIN_RECORD_SAMPLES, Record};
use crate::data::record_split::shared_samples;
use patchcord_core::document::{Code, Diagnostic, Placed, format_distinct, format_number, suggestion};
use patchcord_core::patch::Patch;

impl ExperimentBuilder<'_> {
    /// Reports columns with two bindings, and outputs that columns feed. Such an output always agrees with its column,
    /// whatever the patch computes.
    pub(super) fn check_bindings(&mut self) {
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

    /// Reports ranges that extend beyond the data.
    pub(super) fn check_ranges(
        &mut self,
        data_files: &[RecordFile<'_>],
        validation_files: &[RecordFile<'_>],
    ) {
        let validation = match &self.document.validation {
            ValidationData::Range(range) => Some(range),
            _ => None,
        };
        // "train" and "test" apply to all data files: one file that covers the range is sufficient.
        let of_all_files = self.document.train.iter().chain(validation).map(|range| (range, data_files));
        let of_one_file = data_files
            .iter()
            .chain(validation_files)
            .filter_map(|file| Some((file.source.range.as_ref()?, std::slice::from_ref(file))));
        let beyond = of_all_files.chain(of_one_file).filter_map(|(range, files)| beyond_data(range, files));
        self.findings.extend(beyond.collect::<Vec<_>>());
    }

    /// Reports pieces that are longer than every record, and pieces with fewer samples than a record needs.
    /// `piece_duration` is in seconds.
    pub(super) fn check_pieces(
        &mut self,
        piece_duration: Option<f64>,
        train: &[Record],
        validation: &[Record],
    ) {
        let Some((entry, seconds)) = self.document.piece_duration.as_ref().zip(piece_duration) else {
            return;
        };
        let longest = train.iter().chain(validation).map(Record::duration).fold(0.0, f64::max);
        if longest > 0.0 && seconds > longest {
            let message = format!(
                "a piece of {} s is longer than every record: the longest is {} s",
                format_distinct(seconds, longest),
                format_distinct(longest, seconds)
            );
            self.findings
                .push(Diagnostic::at(codes::BEYOND_DATA, entry.span, message).hint("remove \"pieces\""));
        }
        let min_duration = |record: &Record| record.interval * MIN_RECORD_SAMPLES as f64;
        if let Some(record) = train.iter().chain(validation).find(|record| seconds < min_duration(record)) {
            let message = format!("a piece of {} has fewer than {MIN_RECORD_SAMPLES} samples", record.name);
            let hint = format!("its samples are {} s apart", format_number(record.interval));
            self.findings.push(Diagnostic::at(codes::TOO_FEW_SAMPLES, entry.span, message).hint(hint));
        }
    }

    /// Reports drives that every run restarts and that no column feeds. That is a warning if every record begins with
    /// its file. It is an error if a record or a piece begins later, because the drive would be out of phase there.
    pub(super) fn check_restarting_drives(&mut self, patch: &Patch, records: [&[Record]; 2]) {
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
    pub(super) fn check_record_start(&mut self, patch: &Patch) {
        let start = patch.parameters.get(RECORD_START).filter(|start| start.unit.text() != "s");
        let Some((named, start)) = self.document.patch.as_ref().zip(start) else { return };
        let message =
            format!("the unit of {RECORD_START} must be s, but the patch specifies {}", start.unit.text());
        let finding = Diagnostic::at(Code::UNIT_MISMATCH, named.span, message);
        self.findings.push(finding.hint("give it the unit \"s\" in the patch"));
    }

    /// Reports a patch whose drives are all constant if no column feeds any of them.
    pub(super) fn check_motionless_drives(&mut self, patch: &Patch) {
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
    pub(super) fn check_fit(&mut self, fit: &[String]) {
        let named = self.document.patch.as_ref().filter(|_| self.document.fit.is_none() && fit.is_empty());
        let message = "nothing is fitted: no parameter of the patch both has a range and is read";
        self.findings.extend(named.map(|named| Diagnostic::at(codes::NOTHING_TO_FIT, named.span, message)));
    }

    /// Reports different names for columns that the experiment does not read.
    pub(super) fn check_aliases(&mut self, source: &RecordSource, sample_times: &SampleTimes) {
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

    /// Reports samples that a list of records contains twice. They would count as more data than there are.
    pub(super) fn check_duplicates(&mut self, files: &[RecordFile<'_>]) {
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
