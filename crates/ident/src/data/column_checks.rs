//! Checks of every column against the scale of its drive or signal, and of its noise and its wild samples.
//!
//! The checks run if the experiment has no error so far. They report columns that never change, and columns that exceed
//! full scale or use almost nothing of it, often because of a wrong unit. They also report implausible noise, such as
//! noise above the span of its column, and single samples far from their neighbours.

use crate::data::codes;
use crate::data::examine::{estimate_noise, wild_samples};
use crate::data::experiment::Experiment;
use crate::data::experiment_document::{ColumnBinding, ExperimentDocument};
use crate::data::record::Record;
use crate::statistics::descriptive::extremes;
use patchcord_core::document::fields::Findings;
use patchcord_core::document::{Code, Diagnostic, Placed, format_number, unit_suffix};
use patchcord_core::machines::REFERENCE;
use patchcord_expr::Unit;

/// The minimum and maximum of samples. Without samples the minimum is +infinity and the maximum -infinity.
#[derive(Debug, Clone, Copy)]
struct SampleExtremes {
    minimum: f64,
    maximum: f64,
}

impl SampleExtremes {
    /// Returns the extremes of one column over all records. Missing samples are ignored.
    fn of<'r>(records: &'r [Record], samples: impl Fn(&'r Record) -> &'r [f64]) -> SampleExtremes {
        let [minimum, maximum] = extremes(records.iter().flat_map(samples).copied());
        SampleExtremes { minimum, maximum }
    }

    /// Whether the samples are not all equal.
    fn is_moving(self) -> bool {
        self.maximum > self.minimum
    }

    /// Returns the largest absolute value.
    fn magnitude(self) -> f64 {
        self.maximum.max(-self.minimum)
    }

    /// Returns the extremes of both sets of samples.
    fn union(self, other: SampleExtremes) -> SampleExtremes {
        SampleExtremes { minimum: self.minimum.min(other.minimum), maximum: self.maximum.max(other.maximum) }
    }
}

/// A column with its samples in all records, to be compared with its scale.
struct ScaledColumn<'a> {
    binding: &'a ColumnBinding,
    /// What the column belongs to in the patch: "drive" or "signal".
    noun: &'static str,
    /// The value of 1 V in `unit`.
    per_volt: f64,
    unit: &'a Unit,
    train: SampleExtremes,
    validation: SampleExtremes,
    /// The fraction of samples beyond [`OFF_SCALE_RATIO`] times full scale.
    off_scale_fraction: f64,
}

/// The ratio to full scale above which a sample is off scale. The margin of 5 % allows for noise. A chosen limit.
const OFF_SCALE_RATIO: f64 = 1.05;
/// The largest fraction of off-scale samples that is only a warning. A chosen limit: a recorder may record a few wrong
/// values.
const MAX_OFF_SCALE_FRACTION: f64 = 0.01;
/// The ratio to full scale above which a single sample is an error, 100 kV on the machine. No recorder with a suitable
/// range gives such a value.
const ABSURD_RATIO: f64 = 1000.0;
/// The least ratio of a column's magnitude to full scale. Below it, the unit of the column is probably wrong.
const MIN_SCALE_RATIO: f64 = 1e-3;

/// Checks every column of an experiment without errors. `document` is the document of the experiment; its bindings have
/// the same order as the drives and outputs of the experiment.
pub(crate) fn check_columns(experiment: &Experiment, document: &ExperimentDocument, findings: &mut Findings) {
    let column = |(binding, noun), per_volt, unit, samples: &dyn for<'r> Fn(&'r Record) -> &'r [f64]| {
        let [train, validation] =
            [&experiment.train, &experiment.validation].map(|records| SampleExtremes::of(records, samples));
        let all_samples = experiment.train.iter().chain(&experiment.validation).flat_map(samples);
        let limit = OFF_SCALE_RATIO * REFERENCE * f64::abs(per_volt);
        let off_scale_fraction = fraction(all_samples, |sample| sample.abs() > limit);
        ScaledColumn { binding, noun, per_volt, unit, train, validation, off_scale_fraction }
    };
    let mut bindings = document.bindings();
    let drives =
        experiment.drives.iter().zip(bindings.by_ref()).enumerate().map(|(index, (drive, binding))| {
            column(binding, drive.per_volt, &drive.unit, &|record| record.drives[index].as_slice())
        });
    let mut columns: Vec<ScaledColumn<'_>> = drives.collect();
    let outputs = experiment.outputs.iter().zip(bindings).enumerate().map(|(index, (output, binding))| {
        column(binding, output.per_volt, &output.unit, &|record| record.outputs[index].as_slice())
    });
    columns.extend(outputs);
    findings
        .extend(columns.iter().filter_map(|column| column.constant_fault().or_else(|| column.scale_fault())));
    findings.extend(unknown_noise(experiment, document));
    findings.extend(implausible_sigma(experiment, document));
    findings.extend(excessive_sigma(experiment, document));
    findings.extend(wild_sample_warnings(experiment, document));
}

/// The largest number of wild samples of a column that a warning lists with their times.
const MAX_LISTED_SAMPLES: usize = 3;

/// Reports the columns with wild samples: single samples far from their neighbours.
fn wild_sample_warnings(experiment: &Experiment, document: &ExperimentDocument) -> Vec<Diagnostic> {
    let drive_count = experiment.drives.len();
    let warnings = document.bindings().enumerate().filter_map(|(index, (binding, _))| {
        let wild_times = |record: &Record| {
            let samples = record.drives.get(index).unwrap_or_else(|| &record.outputs[index - drive_count]);
            let noise = estimate_noise(samples).map_or(0.0, |noise| noise.sigma);
            let (name, begin, interval) = (record.name.clone(), record.begin, record.interval);
            let wild = wild_samples(samples, noise).into_iter();
            wild.map(move |sample| format!("{} s in {name}", format_number(begin + sample as f64 * interval)))
        };
        let all: Vec<String> =
            experiment.train.iter().chain(&experiment.validation).flat_map(wild_times).collect();
        let column = &binding.column;
        let more = match all.len() {
            count if count > MAX_LISTED_SAMPLES => format!(", {count} in total"),
            _ => String::new(),
        };
        let times = all[..all.len().min(MAX_LISTED_SAMPLES)].join(", ");
        let message = || {
            format!("samples of the column {} are far from their neighbours: at {times}{more}", column.value)
        };
        (!all.is_empty()).then(|| Diagnostic::at(codes::WILD_SAMPLE, column.span, message()))
    });
    warnings.collect()
}

/// The least ratio of "sigma" to the magnitude of an output. Numbers in CSV files have fewer digits than that.
const MIN_SIGMA_RATIO: f64 = 1e-12;

/// Reports outputs with a "sigma" below the resolution of their numbers.
fn implausible_sigma(experiment: &Experiment, document: &ExperimentDocument) -> Vec<Diagnostic> {
    let outputs = experiment.outputs.iter().zip(&document.outputs).enumerate();
    let faults = outputs.filter_map(|(index, (output, entry))| {
        let sigma = output.sigma?;
        let magnitude =
            SampleExtremes::of(&experiment.train, |record| record.outputs[index].as_slice()).magnitude();
        let column = &entry.binding.column;
        let message = || {
            let (sigma, magnitude, unit) =
                (format_number(sigma), format_number(magnitude), unit_suffix(output.unit.text()));
            format!(
                "the \"sigma\" of {} is too small: it is {sigma}{unit} for values up to {magnitude}{unit}",
                column.value
            )
        };
        let hint = "specify the standard deviation of the noise, or omit \"sigma\" to have it estimated";
        (sigma < MIN_SIGMA_RATIO * magnitude)
            .then(|| Diagnostic::at(Code::BAD_NUMBER, column.span, message()).hint(hint))
    });
    faults.collect()
}

/// Reports columns with a "sigma" that is larger than their span.
fn excessive_sigma(experiment: &Experiment, document: &ExperimentDocument) -> Vec<Diagnostic> {
    let drives = experiment.drives.iter().zip(&document.drives).enumerate();
    let of_drives = drives.filter_map(|(index, (drive, entry))| {
        let extremes = all_extremes(experiment, |record| record.drives[index].as_slice());
        let sigma = drive.sigma.zip(entry.sigma.as_ref())?;
        sigma_above_span(&entry.binding, sigma, &drive.unit, extremes)
    });
    let outputs = experiment.outputs.iter().zip(&document.outputs).enumerate();
    let of_outputs = outputs.filter_map(|(index, (output, entry))| {
        let extremes = all_extremes(experiment, |record| record.outputs[index].as_slice());
        let sigma = output.sigma.zip(entry.sigma.as_ref())?;
        sigma_above_span(&entry.binding, sigma, &output.unit, extremes)
    });
    of_drives.chain(of_outputs).collect()
}

/// The extremes of one column over the training and validation records.
fn all_extremes(experiment: &Experiment, samples: impl Fn(&Record) -> &[f64]) -> SampleExtremes {
    let [train, validation] =
        [&experiment.train, &experiment.validation].map(|records| SampleExtremes::of(records, &samples));
    train.union(validation)
}

/// Reports a "sigma" that is larger than the span of its column, in the unit in which it is written. `sigma` is its
/// value in `unit`, which is also that of the extremes, and the value as written. A constant column has its own report.
fn sigma_above_span(
    binding: &ColumnBinding,
    (sigma, written): (f64, &Placed<f64>),
    unit: &Unit,
    extremes: SampleExtremes,
) -> Option<Diagnostic> {
    let span = extremes.maximum - extremes.minimum;
    if sigma <= span || !extremes.is_moving() {
        return None;
    }
    let as_written = |value: f64| format_number(value * written.value / sigma);
    let unit = unit_suffix(binding.unit.as_ref().map_or(unit, |unit| &unit.value).text());
    let message = format!(
        "the \"sigma\" of {} is {}{unit}, but the column spans only {}{unit}, from {} to {}{unit}",
        binding.column.value,
        format_number(written.value),
        as_written(span),
        as_written(extremes.minimum),
        as_written(extremes.maximum)
    );
    let hint =
        "specify the standard deviation of the noise in this unit, or omit \"sigma\" to have it estimated";
    Some(Diagnostic::at(Code::BAD_NUMBER, written.span, message).hint(hint))
}

/// Reports outputs whose noise is neither specified nor possible to estimate.
fn unknown_noise(experiment: &Experiment, document: &ExperimentDocument) -> Vec<Diagnostic> {
    let is_unknown = |index: usize| {
        let noise = |record: &Record| estimate_noise(&record.outputs[index]);
        experiment.outputs[index].sigma.is_none()
            && experiment.train.iter().all(|record| noise(record).is_none())
    };
    let outputs = document.outputs.iter().enumerate().filter(|(index, _)| is_unknown(*index));
    let faults = outputs.map(|(_, output)| {
        let column = &output.binding.column;
        let message = format!("{} has too few consecutive samples to estimate its noise", column.value);
        let hint = "specify the noise: {\"column\": ..., \"sigma\": ...}";
        Diagnostic::at(codes::TOO_FEW_SAMPLES, column.span, message).hint(hint)
    });
    faults.collect()
}

impl ScaledColumn<'_> {
    /// Reports a column that is constant everywhere, or in the training or validation data. A drive may be constant
    /// in the validation data.
    fn constant_fault(&self) -> Option<Diagnostic> {
        let is_drive = self.noun == "drive";
        let warning = |message| Some(Diagnostic::at(codes::STILL_PART, self.binding.column.span, message));
        match [self.train.is_moving(), self.validation.is_moving()] {
            _ if !self.train.union(self.validation).is_moving() => Some(self.constant_everywhere()),
            [false, _] if is_drive => warning(self.constant_message(self.train, "training")),
            [false, _] => {
                let constant = self.constant_message(self.train, "training");
                let message = format!("{constant}: nothing can be fitted to it");
                let finding = Diagnostic::at(codes::CONSTANT_COLUMN, self.binding.column.span, message);
                Some(finding.hint("train on a range in which it changes, or remove it"))
            }
            [true, false] if !is_drive => warning(self.constant_message(self.validation, "validation")),
            [true, _] => None,
        }
    }

    /// Formats a message about a column that is constant in some of the data. `purpose` is "training" or "validation".
    fn constant_message(&self, extremes: SampleExtremes, purpose: &str) -> String {
        let (column, value) = (&self.binding.column.value, self.format_minimum(extremes));
        format!("the column {column} is constantly {value} in the {purpose} data")
    }

    /// Formats the minimum with its unit.
    fn format_minimum(&self, extremes: SampleExtremes) -> String {
        format!("{}{}", format_number(extremes.minimum), unit_suffix(self.unit.text()))
    }

    /// Reports a column that is constant in all records.
    fn constant_everywhere(&self) -> Diagnostic {
        let ColumnBinding { name, column, .. } = self.binding;
        let value = self.format_minimum(self.train);
        let message = format!("the column {} is constantly {value}", column.value);
        let hint = match self.noun {
            "drive" => format!(
                "name the column that was meant; if {} was constant, remove it and set this value in the patch",
                name.value
            ),
            _ => "name the column that was meant, or remove it: a constant output determines nothing"
                .to_owned(),
        };
        Diagnostic::at(codes::CONSTANT_COLUMN, column.span, message).hint(hint)
    }

    /// Reports a column that exceeds full scale, or that uses so little of it that its unit is probably wrong.
    fn scale_fault(&self) -> Option<Diagnostic> {
        let ColumnBinding { name, column, .. } = self.binding;
        let (magnitude, full_scale) =
            (self.train.union(self.validation).magnitude(), REFERENCE * self.per_volt.abs());
        let is_off_scale =
            self.off_scale_fraction > MAX_OFF_SCALE_FRACTION || magnitude > ABSURD_RATIO * full_scale;
        let (code, verb) = match magnitude {
            magnitude if magnitude < MIN_SCALE_RATIO * full_scale => (codes::BELOW_SCALE, "reaches only"),
            magnitude if magnitude <= full_scale => return None,
            _ if is_off_scale => (codes::OFF_SCALE, "reaches"),
            _ => (codes::BEYOND_SCALE, "reaches"),
        };
        let unit = unit_suffix(self.unit.text());
        let message = format!(
            "the column {} {verb} {}{unit}, but full scale (100 V) of the {} {} is {}{unit}",
            column.value,
            format_number(magnitude),
            self.noun,
            name.value,
            format_number(full_scale)
        );
        Some(Diagnostic::at(code, column.span, message))
    }
}

/// Returns the fraction of samples that satisfy a condition. Missing samples count as samples that do not. Zero without
/// samples.
fn fraction<'r>(samples: impl Iterator<Item = &'r f64>, condition: impl Fn(&f64) -> bool) -> f64 {
    let (matching, others): (Vec<&f64>, Vec<&f64>) = samples.partition(|sample| condition(sample));
    matching.len() as f64 / (matching.len() + others.len()).max(1) as f64
}
