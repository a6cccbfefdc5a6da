//! Tables that are written while a run is recorded, so that the run need not keep its samples. If the run has pictures,
//! their samples are selected at the same time.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::outputs::{Outputs, begin_copy, publish, write_failure};
use patchcord::draw::TraceEnvelope;
use patchcord::output::PendingFile;
use patchcord::trace::{CsvError, TableWriter, Trace};

/// The tables of a run while it is recorded. The files appear under their names at the end.
pub(super) struct StreamedTables<'f> {
    /// Creates the files.
    outputs: &'f Outputs,
    /// The paths of the tables.
    paths: &'f [PathBuf],
    /// The tables in the order of their paths, or the failure that ended the writing. Empty before the first sample.
    tables: Result<Vec<TableWriter<PendingFile>>, Failure>,
    /// The envelope for the pictures; `None` if there are none.
    envelope: Option<TraceEnvelope>,
    /// Number of samples so far.
    samples: usize,
    /// Time of the last sample in seconds; `None` before the first sample.
    last_time: Option<f64>,
}

impl<'f> StreamedTables<'f> {
    /// Tables with these paths, and the envelope of a run that has not begun. No file is created before the first
    /// sample.
    pub(super) fn new(outputs: &'f Outputs, paths: &'f [PathBuf], envelope: Option<TraceEnvelope>) -> Self {
        StreamedTables { outputs, paths, tables: Ok(Vec::new()), envelope, samples: 0, last_time: None }
    }

    /// Number of samples so far.
    pub(super) fn samples(&self) -> usize {
        self.samples
    }

    /// Time of the last sample in seconds; `None` if there are no samples.
    pub(super) fn last_time(&self) -> Option<f64> {
        self.last_time
    }

    /// Writes the next samples of the run. After a failure, nothing is written, and the run need not continue.
    pub(super) fn write(&mut self, block: &Trace) -> ControlFlow<()> {
        self.samples += block.len();
        self.last_time = block.time.last().copied().or(self.last_time);
        if let Some(envelope) = &mut self.envelope {
            envelope.add(block);
        }
        if let Err(failure) = self.try_write(block) {
            self.tables = Err(failure);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    /// Writes the next samples of the run, unless a table has failed before.
    fn try_write(&mut self, block: &Trace) -> Result<(), Failure> {
        let Ok(tables) = &mut self.tables else { return Ok(()) };
        if tables.is_empty() {
            let begin = |path: &PathBuf| begin_table(self.outputs, path, block);
            *tables = self.paths.iter().map(begin).collect::<Result<_, _>>()?;
        }
        let mut pairs = self.paths.iter().zip(tables);
        pairs.try_for_each(|(path, table)| table.write(block).map_err(|error| table_failure(path, error)))
    }

    /// Ends the tables. `run` has the repetitions and phases of the run. Returns the trace for the pictures; `None` if
    /// there are none.
    ///
    /// # Errors
    /// If a table could not be written. Its file is then unchanged.
    pub(super) fn finish(mut self, run: &Trace) -> Result<Option<Trace>, Failure> {
        // A run without samples has tables without rows.
        self.try_write(run)?;
        for (path, table) in self.paths.iter().zip(self.tables?) {
            let file = table.finish(run, || begin_copy(path));
            publish(path, file.map_err(|error| table_failure(path, error))?)?;
        }
        Ok(self.envelope.map(|envelope| envelope.into_trace(run)))
    }
}

/// Begins a table with the signals of a block.
fn begin_table(outputs: &Outputs, path: &Path, block: &Trace) -> Result<TableWriter<PendingFile>, Failure> {
    let table = TableWriter::new(outputs.begin(path)?, &block.tracks);
    table.map_err(|error| table_failure(path, error))
}

/// The failure for a table that cannot be written.
fn table_failure(path: &Path, error: CsvError) -> Failure {
    match error {
        CsvError::Io(error) => write_failure(path, &error),
        error => Failure::data(error.to_string()),
    }
}
