//! The experiment: a checked patch, the measured records, and the parameters that may be fitted.

use std::path::PathBuf;

use crate::data::experiment_document::Hold;
use crate::data::record::Record;
use patchcord_core::document::Report;
use patchcord_core::patch::{EditError, Patch, PatchEditor};
use patchcord_expr::Unit;

/// A patch and the data measured on the system that it models.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// The path of the experiment file as the caller specified it.
    pub file: String,
    /// The title; empty if the experiment has none.
    pub title: String,
    /// The patch as written, without errors.
    pub patch: Patch,
    /// The drives that columns feed. The other drives of the patch keep their definition.
    pub drives: Vec<MeasuredDrive>,
    /// The measured signals.
    pub outputs: Vec<MeasuredOutput>,
    /// The names of the parameters to fit; each has a range.
    pub fit: Vec<String>,
    /// The records to fit.
    pub train: Vec<Record>,
    /// The records to test on. No fit uses them.
    pub test: Vec<Record>,
    /// The data files of all records.
    pub files: Vec<PathBuf>,
    /// The duration in seconds of the pieces into which records are split; every piece is a run of its own. None if
    /// records are not split.
    pub piece_duration: Option<f64>,
    /// Warnings that the user should read. The experiment can be used nevertheless.
    pub warnings: Report,
}

/// A drive of the patch that a column feeds.
#[derive(Debug, Clone)]
pub struct MeasuredDrive {
    /// The name of the drive in the patch.
    pub drive: String,
    /// The name of the column in the experiment.
    pub column: String,
    /// What the drive does between samples.
    pub hold: Hold,
    /// Standard deviation of the noise of the column, in `unit`. None if the experiment does not specify it.
    pub sigma: Option<f64>,
    /// The unit of the drive's scale. Records have their samples in this unit.
    pub unit: Unit,
    /// The value of 1 V in `unit`, with the parameters of the patch.
    pub per_volt: f64,
}

/// A signal of the patch that a column measures.
#[derive(Debug, Clone)]
pub struct MeasuredOutput {
    /// The name under which the patch records the signal.
    pub signal: String,
    /// The name of the column in the experiment.
    pub column: String,
    /// Standard deviation of the noise, in `unit`. None if the experiment does not specify it.
    pub sigma: Option<f64>,
    /// Whether the column may differ from the signal by an unknown constant.
    pub has_offset: bool,
    /// The unit of the signal. Records have their samples in this unit.
    pub unit: Unit,
    /// The value of 1 V in `unit`, with the parameters of the patch. Negative if the signal is inverted.
    pub per_volt: f64,
}

impl Experiment {
    /// Returns the patch with a table of one point, zero, in place of every drive that a column feeds. The samples of a
    /// record then go into the tables with [`solve::set_drive_table`](patchcord_core::solve::set_drive_table).
    ///
    /// # Errors
    /// If the patch does not have one of the drives. The drives of an experiment that was read from a file exist.
    pub fn patch_with_drive_tables(&self) -> Result<Patch, EditError> {
        let mut editor = self.patch.edit();
        replace_with_tables(&mut editor, &self.drives)?;
        editor.finish(self.patch.file())
    }
}

/// Replaces every drive that a column feeds by a table of one point, zero, with the drive's hold.
///
/// # Errors
/// If the patch does not have one of the drives.
pub(crate) fn replace_with_tables(
    editor: &mut PatchEditor,
    drives: &[MeasuredDrive],
) -> Result<(), EditError> {
    drives.iter().try_for_each(|entry| editor.put_table_drive(&entry.drive, entry.hold.table_hold()))
}
