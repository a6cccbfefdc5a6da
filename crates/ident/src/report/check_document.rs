//! The report of `patchcord gap --check` as a JSON document for programs.
//!
//! The fields of the structs are the keys of the JSON text, in the same order. A number that is not finite becomes
//! null.

use patchcord_core::document::{DiagnosticDocument, json_value};
use serde::Serialize;
use serde_json::Value;

use crate::data::columns::{RecordColumn, record_columns};
use crate::data::examine::{Noise, POWER_FRACTIONS};
use crate::data::experiment::Experiment;
use crate::data::record::Record;
use crate::design::detectability::Detectability;
use crate::effects::effect_sites::EffectSites;
use crate::report::check::parts_and_records;
use crate::report::detection_limits::DetectionLimitDocument;
use crate::report::fit_quality::StepsDocument;
use crate::report::rounds::SkippedTrialDocument;

/// The check of an experiment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckDocument<'a> {
    /// True: an experiment with errors has no check.
    pub ok: bool,
    /// The file of the experiment.
    pub experiment: &'a str,
    /// Its title; empty if it has none.
    pub title: &'a str,
    /// The file of the patch.
    pub patch: &'a str,
    /// The warnings of the experiment.
    pub diagnostics: Vec<DiagnosticDocument>,
    /// The parameters to fit.
    pub fit: &'a [String],
    /// The records, first those for training.
    pub records: Vec<CheckedRecordDocument<'a>>,
    /// The sites of every effect.
    pub effects: Vec<SitesDocument<'a>>,
    /// The effects for which the patch has no site.
    pub nowhere: Vec<&'a str>,
    /// The integrators at which no effect is tried, because their output has no scale.
    pub nameless: &'a [String],
    /// The residual of the fitted patch in training, rms over the noise.
    pub leaves: f64,
    /// The steps of the solver along the fitted patch, and their error.
    pub solver: StepsDocument,
    /// The smallest detectable effects.
    pub limits: Vec<DetectionLimitDocument>,
    /// Effects that could not be tried at a site.
    pub left_out: Vec<SkippedTrialDocument>,
}

impl<'a> CheckDocument<'a> {
    /// The document of an experiment, the sites of effects in its patch, and the detection limits.
    pub fn of(experiment: &'a Experiment, sites: &'a EffectSites, detectability: &Detectability) -> Self {
        let records = parts_and_records(experiment);
        let effects = sites.effects.iter().map(|(name, junctions)| SitesDocument { name, junctions });
        let left_out = detectability.skipped.iter().map(|skipped| SkippedTrialDocument::of(skipped, None));
        CheckDocument {
            ok: true,
            experiment: &experiment.file,
            title: &experiment.title,
            patch: &experiment.patch_name,
            diagnostics: experiment.warnings.documents(),
            fit: &experiment.fit,
            records: records
                .map(|(part, record)| CheckedRecordDocument::of(experiment, part, record))
                .collect(),
            effects: effects.collect(),
            nowhere: sites.inapplicable_effects(),
            nameless: &sites.unscaled_integrators,
            leaves: detectability.residual_rms,
            solver: StepsDocument::from(&detectability.step_refinement),
            limits: detectability.limits.iter().map(DetectionLimitDocument::from).collect(),
            left_out: left_out.collect(),
        }
    }

    /// The document as a JSON value.
    pub fn json(&self) -> Value {
        json_value(self)
    }
}

/// The elements of a patch at which an effect can act.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SitesDocument<'a> {
    /// The effect.
    pub name: &'a str,
    /// The names of the elements; empty if there is none.
    pub junctions: &'a [String],
}

/// A record with the statistics of its columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckedRecordDocument<'a> {
    /// The purpose: "train" or "test".
    pub part: &'static str,
    /// Its file.
    pub name: &'a str,
    /// Time of the first sample, in seconds.
    pub begin: f64,
    /// Time between two samples, in seconds.
    pub interval: f64,
    /// Number of samples.
    pub samples: usize,
    /// Number of missing values.
    pub missing: usize,
    /// Largest deviation of a time from the even grid, as a fraction of the interval.
    pub jitter: f64,
    /// The columns: first the drives, then the signals.
    pub columns: Vec<ColumnDocument<'a>>,
}

impl<'a> CheckedRecordDocument<'a> {
    /// The document of a record. `part` is "train" or "test".
    fn of(experiment: &'a Experiment, part: &'static str, record: &'a Record) -> Self {
        CheckedRecordDocument {
            part,
            name: &record.name,
            begin: record.begin,
            interval: record.interval,
            samples: record.len(),
            missing: record.missing(),
            jitter: record.jitter,
            columns: record_columns(experiment, record).iter().map(ColumnDocument::from).collect(),
        }
    }
}

/// A column with its statistics, which are in its unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnDocument<'a> {
    /// The name of the column in the experiment.
    pub column: &'a str,
    /// The drive that it feeds; absent if it measures a signal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive: Option<&'a str>,
    /// The signal that it measures; absent if it feeds a drive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signal: Option<&'a str>,
    /// The unit.
    pub unit: &'a str,
    /// Standard deviation of the noise that the experiment specifies; null if it does not.
    pub sigma: Option<f64>,
    /// The smallest sample.
    pub least: f64,
    /// The largest sample.
    pub most: f64,
    /// Root mean square about the mean.
    pub rms: f64,
    /// The estimated noise; null if there are too few samples.
    pub noise: Option<NoiseDocument>,
    /// The step of which all samples are multiples; null if there is none.
    pub step: Option<f64>,
    /// The fraction of samples that are equal to their predecessor.
    pub repeated: f64,
    /// The frequencies below which most of the power is; null if they cannot be determined.
    pub power_below: Option<Vec<PowerDocument>>,
    /// Samples per period of the frequency below which 90 % of the power is; null without such a frequency.
    pub samples_a_period: Option<f64>,
}

impl<'a> From<&RecordColumn<'a>> for ColumnDocument<'a> {
    /// The key "drive" or "signal" has the name of what the column belongs to.
    fn from(column: &RecordColumn<'a>) -> Self {
        let statistics = &column.statistics;
        let power_below = |frequencies: [f64; POWER_FRACTIONS.len()]| {
            let pairs = POWER_FRACTIONS.into_iter().zip(frequencies);
            pairs.map(|(share, frequency)| PowerDocument { share, frequency }).collect()
        };
        let is_drive = column.noun == "drive";
        ColumnDocument {
            column: column.column,
            drive: is_drive.then_some(column.name),
            signal: (!is_drive).then_some(column.name),
            unit: column.unit,
            sigma: column.sigma,
            least: statistics.minimum,
            most: statistics.maximum,
            rms: statistics.rms,
            noise: statistics.noise.as_ref().map(NoiseDocument::from),
            step: statistics.quantum,
            repeated: statistics.repeated_fraction,
            power_below: statistics.power_frequencies.map(power_below),
            samples_a_period: statistics.samples_per_period(column.interval),
        }
    }
}

/// Estimated noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseDocument {
    /// Standard deviation.
    pub sigma: f64,
    /// The spectrum: "white", "slow", "fast", "rounding" or "none".
    pub kind: &'static str,
    /// The estimates by the order of differences, from 2.
    pub by_order: Vec<f64>,
}

impl From<&Noise> for NoiseDocument {
    fn from(noise: &Noise) -> Self {
        NoiseDocument { sigma: noise.sigma, kind: noise.kind.as_str(), by_order: noise.by_order.clone() }
    }
}

/// A frequency below which a share of the power is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PowerDocument {
    /// The share.
    pub share: f64,
    /// The frequency in Hz.
    pub frequency: f64,
}
