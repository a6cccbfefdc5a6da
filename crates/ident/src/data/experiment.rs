//! The experiment: a checked patch, the measured records, and the parameters that may be fitted.

use std::path::PathBuf;

use crate::data::experiment_document::Hold;
use crate::data::record::Record;
use patchcord_core::document::Report;
use patchcord_core::patch::{EditError, Patch, PatchEditor};
use patchcord_expr::Unit;

/// A patch and the data measured on the system that it models.
///
/// [`Experiment::read`] reads it from a file, [`Experiment::parse_in`] from a text, and [`Experiment::parse_given`]
/// from a text whose patch and data are in memory. An experiment that was read is consistent: the patch has all
/// drives, outputs and parameters that the experiment names, and all records have data.
///
/// # Examples
///
/// ```
/// use patchcord_ident::Experiment;
///
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// assert!(experiment.drives.is_empty());
/// assert_eq!(experiment.outputs[0].signal, "x");
/// let records = [&experiment.train[0], &experiment.validation[0]];
/// assert!(records.iter().all(|record| record.missing() == 0 && record.outputs.len() == 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Experiment {
    /// The path of the experiment file as the caller specified it.
    pub file: String,
    /// The title; empty if the experiment has none.
    pub title: String,
    /// The patch as written, without errors. Its file is the path from the caller's folder.
    pub patch: Patch,
    /// The path of the patch as the experiment specifies it. Results name the patch so.
    pub patch_name: String,
    /// The drives that columns feed. The other drives of the patch keep their definition.
    pub drives: Vec<MeasuredDrive>,
    /// The measured signals.
    pub outputs: Vec<MeasuredOutput>,
    /// The names of the parameters to fit; each has a range.
    pub fit: Vec<String>,
    /// The training records, to which the parameters are fitted.
    pub train: Vec<Record>,
    /// The validation records. No parameter is fitted to them.
    pub validation: Vec<Record>,
    /// The data files of all records.
    pub files: Vec<PathBuf>,
    /// The duration in seconds of the pieces into which records are split; every piece is a separate run. None if
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fed_drive_becomes_a_table_with_its_scale_and_hold() {
        let file = "tests/base.json";
        let patch = Patch::parse(file, &std::fs::read_to_string(file).unwrap()).unwrap();
        let force = MeasuredDrive {
            drive: "F".to_owned(),
            column: "F".to_owned(),
            hold: Hold::Previous,
            sigma: None,
            unit: Unit::parse("N").unwrap(),
            per_volt: 0.1,
        };
        let mut editor = patch.edit();
        replace_with_tables(&mut editor, &[force]).unwrap();
        let fed = editor.finish(file).unwrap();
        assert_eq!((patch.drives["F"].kind.name, fed.drives["F"].kind.name), ("step", "table"));
        assert_eq!(fed.drives["F"].scale.as_ref().map(|scale| scale.value.as_str()), Some("force"));
        assert_eq!(fed.value()["drives"]["F"]["hold"], "previous");
    }
}
