//! The experiment of a search in its JSON document: file, patch, drives, outputs and records.

use indexmap::IndexMap;
use serde::Serialize;

use crate::data::experiment::{Experiment, MeasuredDrive, MeasuredOutput};
use crate::data::record::Record;
use crate::fit::problem::Problem;

/// The experiment that was searched, and the seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExperimentSummary {
    /// The file, as the reader wrote it.
    pub file: String,
    /// Its title; empty if it has none.
    pub title: String,
    /// The file of the patch, as the experiment specifies it.
    pub patch: String,
    /// The drives that the data feed, by name.
    pub drives: IndexMap<String, DriveDocument>,
    /// The measured signals, by name.
    pub outputs: IndexMap<String, OutputDocument>,
    /// The parameters that are fitted.
    pub fit: Vec<String>,
    /// The training records.
    pub train: Vec<RecordDocument>,
    /// The validation records.
    #[serde(rename = "test")]
    pub validation: Vec<RecordDocument>,
    /// The length of the pieces into which the experiment divides its records, in seconds; null if it does not.
    pub pieces: Option<f64>,
    /// The seed of all random numbers.
    pub seed: u64,
}

impl ExperimentSummary {
    /// The document of an experiment that is searched with a seed.
    ///
    /// Noise is that of the problem, which is specified or estimated. `seed` is that of the search.
    pub fn of(experiment: &Experiment, problem: &Problem, seed: u64) -> Self {
        let drives = experiment.drives.iter().zip(&problem.drive_sigma);
        let outputs = experiment.outputs.iter().zip(&problem.sigma);
        ExperimentSummary {
            file: experiment.file.clone(),
            title: experiment.title.clone(),
            patch: experiment.patch_name.clone(),
            drives: drives
                .map(|(drive, sigma)| (drive.drive.clone(), DriveDocument::of(drive, *sigma)))
                .collect(),
            outputs: outputs
                .map(|(output, sigma)| (output.signal.clone(), OutputDocument::of(output, *sigma)))
                .collect(),
            fit: experiment.fit.clone(),
            train: experiment.train.iter().map(RecordDocument::from).collect(),
            validation: experiment.validation.iter().map(RecordDocument::from).collect(),
            pieces: experiment.piece_duration,
            seed,
        }
    }
}

/// A drive that data feed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriveDocument {
    /// The column that feeds it.
    pub column: String,
    /// Its unit.
    pub unit: String,
    /// The interpolation between samples: "linear", "previous" or "smooth".
    pub hold: &'static str,
    /// Standard deviation of its noise, in its unit.
    pub sigma: f64,
    /// Whether the experiment specifies `sigma`; if not, it is estimated.
    #[serde(rename = "sigma_told")]
    pub is_sigma_specified: bool,
}

impl DriveDocument {
    /// Makes the document of a drive with the standard deviation of its noise, which is 0 for a drive without noise.
    fn of(drive: &MeasuredDrive, sigma: f64) -> Self {
        DriveDocument {
            column: drive.column.clone(),
            unit: drive.unit.text().to_owned(),
            hold: drive.hold.as_str(),
            sigma,
            is_sigma_specified: drive.sigma.is_some(),
        }
    }
}

/// A measured signal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputDocument {
    /// The column that measures it.
    pub column: String,
    /// Its unit.
    pub unit: String,
    /// Standard deviation of its noise, in its unit.
    pub sigma: f64,
    /// Whether the experiment specifies `sigma`; if not, it is estimated.
    #[serde(rename = "sigma_told")]
    pub is_sigma_specified: bool,
    /// Whether the column may have a constant offset.
    pub offset: bool,
}

impl OutputDocument {
    /// Makes the document of an output with the standard deviation of its noise.
    fn of(output: &MeasuredOutput, sigma: f64) -> Self {
        OutputDocument {
            column: output.column.clone(),
            unit: output.unit.text().to_owned(),
            sigma,
            is_sigma_specified: output.sigma.is_some(),
            offset: output.has_offset,
        }
    }
}

/// A record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordDocument {
    /// Its file.
    pub data: String,
    /// Time of the first sample by its clock, in seconds.
    pub from: f64,
    /// Time of the last sample, in seconds.
    pub to: f64,
    /// Number of samples.
    pub samples: usize,
    /// Number of missing values.
    pub missing: usize,
}

impl From<&Record> for RecordDocument {
    /// Times are those of the clock of the file, so `from` need not be 0.
    fn from(record: &Record) -> Self {
        RecordDocument {
            data: record.name.clone(),
            from: record.begin,
            to: record.begin + record.duration(),
            samples: record.len(),
            missing: record.missing(),
        }
    }
}
