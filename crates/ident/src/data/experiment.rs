//! An experiment: a patch, what was measured, and what may be fitted.

use std::path::PathBuf;

use crate::data::document::Hold;
use crate::data::record::Record;
use patchcord_core::document::Report;
use patchcord_core::patch::{EditError, Patch, PatchEditor};
use patchcord_expr::Unit;

/// A patch and what was measured on the thing that it stands for.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// The file, as the reader wrote it.
    pub file: String,
    /// Its title; empty where it has none.
    pub title: String,
    /// The patch as it was written, found right.
    pub patch: Patch,
    /// The drives that data feed; those of the patch that are not among them stay as they are.
    pub drives: Vec<Feed>,
    /// What was measured.
    pub outputs: Vec<Output>,
    /// The names of the parameters to fit; each has a range.
    pub fit: Vec<String>,
    /// What to fit to.
    pub train: Vec<Record>,
    /// What is held back.
    pub test: Vec<Record>,
    /// The files that all of these come from.
    pub files: Vec<PathBuf>,
    /// After so many seconds runs begin anew, where the experiment asks for that.
    pub pieces: Option<f64>,
    /// What the reader should know although the experiment can be worked with.
    pub warnings: Report,
}

/// A drive of the patch that a column feeds.
#[derive(Debug, Clone)]
pub struct Feed {
    /// Its name in the patch.
    pub drive: String,
    /// The column, as the experiment names it.
    pub column: String,
    /// What it does between samples.
    pub hold: Hold,
    /// Standard deviation of the noise of the column, in `unit`, where the experiment tells it.
    pub sigma: Option<f64>,
    /// The unit of its scale, in which records hold it.
    pub unit: Unit,
    /// What a volt stands for, in this unit, with the parameters of the patch.
    pub per_volt: f64,
}

/// A signal of the patch that a column measures.
#[derive(Debug, Clone)]
pub struct Output {
    /// The name under which the patch records it.
    pub signal: String,
    /// The column, as the experiment names it.
    pub column: String,
    /// Standard deviation of the noise, in `unit`, where the experiment tells it.
    pub sigma: Option<f64>,
    /// Whether the column may be off by a constant that says nothing about the thing measured.
    pub offset: bool,
    /// The unit of the signal, in which records hold it.
    pub unit: Unit,
    /// What a volt stands for, in this unit and with its sign, with the parameters of the patch.
    pub per_volt: f64,
}

impl Experiment {
    /// The patch with a table of one point, zero, in place of every drive that data feed, held as the experiment says: what
    /// [`solve::set_drive_table`](patchcord_core::solve::set_drive_table) takes.
    ///
    /// # Errors
    /// None that is known: what is put in place of a drive is one.
    pub fn patch_to_feed(&self) -> Result<Patch, EditError> {
        let mut editor = self.patch.edit();
        put_tables(&mut editor, &self.drives)?;
        editor.finish(self.patch.file())
    }
}

/// Puts a table of one point, zero, in place of every drive that records feed, held as they say.
///
/// # Errors
/// If the patch has no drive of a name.
pub(crate) fn put_tables(editor: &mut PatchEditor, drives: &[Feed]) -> Result<(), EditError> {
    drives.iter().try_for_each(|feed| editor.feed_drive(&feed.drive, feed.hold.of_table()))
}
