//! The experiment as its author wrote it: typed entries, each with its position in the text.
//!
//! `reader` reads them from the document. It checks only the document itself and opens no other file. The experiment
//! builder compares the entries with the patch and with the data files afterwards.

mod reader;

use patchcord_core::document::Placed;
use patchcord_expr::Unit;

pub(crate) use reader::read_document;

/// The entries of an experiment document.
#[derive(Debug)]
pub(crate) struct ExperimentDocument {
    /// The title; empty if the document has none.
    pub title: String,
    /// The patch file, relative to the folder of the experiment. None if the key is missing or invalid.
    pub patch: Option<Placed<String>>,
    /// The records under "data", in the order of the document.
    pub data: Vec<RecordSource>,
    /// Where the sample times are. None if the entry is invalid.
    pub sample_times: Option<SampleTimes>,
    /// The drives that columns feed, in the order of the document.
    pub drives: Vec<DriveBinding>,
    /// The signals that columns measure, in the order of the document.
    pub outputs: Vec<OutputBinding>,
    /// The names of the parameters to fit. None if the document does not specify them.
    pub fit: Option<Vec<Placed<String>>>,
    /// The training range, in the unit of the times. None if the document does not specify it.
    pub train: Option<Placed<(f64, f64)>>,
    /// The validation data, under the key "test".
    pub validation: ValidationData,
    /// The duration of the pieces into which records are split, in the unit of the times. Each piece is a separate run.
    /// None if records are not split.
    pub piece_duration: Option<Placed<f64>>,
}

/// A file of measured data, or a range of it.
#[derive(Debug)]
pub(crate) struct RecordSource {
    /// The CSV file, relative to the folder of the experiment.
    pub file: Placed<String>,
    /// The first and last time of the record, in the unit of the times. None if the record is the whole file.
    pub range: Option<Placed<(f64, f64)>>,
    /// Columns with a different name in this file: the name in the experiment, then the name in the file.
    pub columns: Vec<(String, Placed<String>)>,
}

impl RecordSource {
    /// Returns the different name of a column in this file. None if the file uses the name of the experiment.
    pub(crate) fn alias_of(&self, column: &str) -> Option<&Placed<String>> {
        self.columns.iter().find(|(in_experiment, _)| in_experiment == column).map(|(_, in_file)| in_file)
    }

    /// Returns the name of a column in this file.
    pub(crate) fn name_in_file<'s>(&'s self, column: &'s str) -> &'s str {
        self.alias_of(column).map_or(column, |in_file| &in_file.value)
    }

    /// Whether both sources read the same columns of their files.
    pub(crate) fn has_same_columns(&self, other: &RecordSource) -> bool {
        let mut all_aliases = self.columns.iter().chain(&other.columns);
        all_aliases.all(|(column, _)| self.name_in_file(column) == other.name_in_file(column))
    }
}

/// Where the sample times of the data files are.
#[derive(Debug)]
pub(crate) enum SampleTimes {
    /// In the column "t", which recorded runs have. This is the default.
    DefaultColumn,
    /// In the column `name`. `unit` is None if the experiment does not specify it.
    Column { name: Placed<String>, unit: Option<Placed<Unit>> },
    /// Nowhere: the first sample is at 0 and all samples are `seconds` apart. `unit` is the unit of times in the
    /// document, in seconds.
    Interval { seconds: f64, unit: f64 },
}

impl SampleTimes {
    /// Returns the column of the times. None if the samples have a fixed interval.
    pub(crate) fn column(&self) -> Option<&str> {
        match self {
            SampleTimes::DefaultColumn => Some("t"),
            SampleTimes::Column { name, .. } => Some(&name.value),
            SampleTimes::Interval { .. } => None,
        }
    }
}

/// The validation data: no parameter is fitted to them, and the fitted model is compared with them.
#[derive(Debug)]
pub(crate) enum ValidationData {
    /// The samples of each record that training does not use. This is the default.
    Remainder,
    /// A range of every record, in the unit of the times.
    Range(Placed<(f64, f64)>),
    /// Separate records.
    Records(Vec<RecordSource>),
}

/// A column of the data, and the drive or signal of the patch to which it belongs.
#[derive(Debug)]
pub(crate) struct ColumnBinding {
    /// The name of the drive or signal in the patch.
    pub name: Placed<String>,
    /// The name of the column.
    pub column: Placed<String>,
    /// The unit of the column. None if the experiment does not specify it.
    pub unit: Option<Placed<Unit>>,
}

/// A drive that a column feeds.
#[derive(Debug)]
pub(crate) struct DriveBinding {
    /// The column and the drive.
    pub binding: ColumnBinding,
    /// What the drive does between samples.
    pub hold: Hold,
    /// Standard deviation of the noise, at least 0, in the unit of the column.
    pub sigma: Option<Placed<f64>>,
}

/// A signal that a column measures.
#[derive(Debug)]
pub(crate) struct OutputBinding {
    /// The column and the signal.
    pub binding: ColumnBinding,
    /// Standard deviation of the noise, above 0, in the unit of the column.
    pub sigma: Option<Placed<f64>>,
    /// Whether the column may differ from the signal by an unknown constant.
    pub has_offset: bool,
}

/// What a drive does between two samples.
///
/// # Examples
///
/// ```
/// use patchcord_ident::Hold;
///
/// assert_eq!(Hold::ALL.map(|(word, _)| word), ["linear", "previous", "smooth"]);
/// assert_eq!(Hold::Previous.as_str(), "previous");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// It changes linearly from one sample to the next (first-order hold).
    Linear,
    /// It keeps the value of the previous sample (zero-order hold), like the output of a sampled controller.
    Previous,
    /// It follows the polynomial through six neighbouring samples. Suitable for an oscillation with few samples per
    /// period.
    Smooth,
}

impl Hold {
    /// Every variant with its keyword in the document.
    pub const ALL: [(&str, Hold); 3] =
        [("linear", Hold::Linear), ("previous", Hold::Previous), ("smooth", Hold::Smooth)];

    /// Returns the keyword in the document.
    pub fn as_str(self) -> &'static str {
        match self {
            Hold::Linear => "linear",
            Hold::Previous => "previous",
            Hold::Smooth => "smooth",
        }
    }

    /// Returns the "hold" of the drive table that represents the samples. The table of a smooth drive has extra points
    /// between the samples, connected by straight lines.
    pub(crate) fn table_hold(self) -> &'static str {
        match self {
            Hold::Linear | Hold::Smooth => "linear",
            Hold::Previous => "previous",
        }
    }
}

impl ExperimentDocument {
    /// Returns all bindings, drives before outputs, each with its noun in messages: "drive" or "signal".
    pub(crate) fn bindings(&self) -> impl Iterator<Item = (&ColumnBinding, &'static str)> {
        let drives = self.drives.iter().map(|drive| (&drive.binding, "drive"));
        drives.chain(self.outputs.iter().map(|output| (&output.binding, "signal")))
    }

    /// Whether a column feeds the drive of this name.
    pub(crate) fn is_fed(&self, drive: &str) -> bool {
        self.drives.iter().any(|entry| entry.binding.name.value == drive)
    }
}
