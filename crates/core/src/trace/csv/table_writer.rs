//! Writes the table of a run while the run is recorded.
//!
//! Only the complete run shows whether its table has the columns `run` and `phase`. So the rows are first written
//! without them. If the table has them, the rows are copied at the end, and the columns are added.

use std::io::{self, BufRead, BufReader, BufWriter, Read, Seek, SeekFrom, Write};

use super::{CsvError, RunColumns, first_not_finite, header, into_io, not_finite, row};
use crate::trace::{Trace, Track};

/// Writes the samples of a run as CSV, block by block. The table is that of [`Trace::write_csv`].
///
/// # Examples
///
/// ```
/// use std::io::Cursor;
///
/// use patchcord_core::trace::{TableWriter, Trace, Track};
///
/// let mut run = Trace { tracks: vec![Track::new("x", "mm", 2.0)], ..Trace::default() };
/// let mut table = TableWriter::new(Cursor::new(Vec::new()), &run.tracks)?;
/// for (time, volts) in [(0.0, 1.5), (0.1, 2.0)] {
///     (run.time, run.tracks[0].volts) = (vec![time], vec![volts]);
///     table.write(&run)?;
/// }
/// let csv = table.finish(&run, || Ok(Cursor::new(Vec::new())))?.into_inner();
/// assert_eq!(String::from_utf8(csv)?, "# t: s\n# x: mm\nt,x\n0,3\n0.1,4\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TableWriter<W: Write> {
    /// Writes the rows.
    rows: csv::Writer<W>,
    /// Number of bytes before the first row.
    header_bytes: u64,
    /// The index of the first track with a value that is not finite, and the time of its first such sample in seconds.
    not_finite: Option<(usize, f64)>,
}

impl<W: Write> TableWriter<W> {
    /// Begins a table: writes the units and the names of the columns.
    ///
    /// # Errors
    /// If the writer reports an error.
    pub fn new(mut to: W, tracks: &[Track]) -> Result<Self, CsvError> {
        let header = header(tracks, &[])?;
        to.write_all(&header)?;
        let header_bytes = header.len() as u64;
        Ok(TableWriter { rows: csv::Writer::from_writer(to), header_bytes, not_finite: None })
    }

    /// Writes the next samples. After a value that is not finite, nothing more is written.
    ///
    /// # Errors
    /// If the writer reports an error.
    pub fn write(&mut self, block: &Trace) -> Result<(), CsvError> {
        let fault = first_not_finite(block);
        let is_first = |(track, _): &(usize, f64)| self.not_finite.is_none_or(|(known, _)| *track < known);
        self.not_finite = fault.filter(is_first).or(self.not_finite);
        if self.not_finite.is_some() {
            return Ok(());
        }
        for sample in 0..block.len() {
            self.rows.write_record(row(block, sample)).map_err(into_io)?;
        }
        Ok(())
    }
}

impl<W: Write + Read + Seek> TableWriter<W> {
    /// Ends the table and returns its writer. `run` has the repetitions and phases of the complete run, and need not
    /// have its samples. If the table has the columns `run` or `phase`, the rows are copied to a writer that `create`
    /// returns.
    ///
    /// # Errors
    /// If a value was not a finite number, or if a writer reports an error.
    pub fn finish(self, run: &Trace, create: impl FnOnce() -> io::Result<W>) -> Result<W, CsvError> {
        if let Some((track, time)) = self.not_finite {
            return Err(not_finite(&run.tracks[track], time));
        }
        let columns = RunColumns::of(run);
        let mut rows = self.rows.into_inner().map_err(|error| error.into_error())?;
        if columns.names().is_empty() {
            return Ok(rows);
        }
        rows.seek(SeekFrom::Start(self.header_bytes))?;
        add_columns(run, columns, rows, create()?)
    }
}

/// Writes the table of a run from its rows without the columns of runs and phases. Returns the writer.
fn add_columns<W: Write>(run: &Trace, columns: RunColumns, rows: impl Read, to: W) -> Result<W, CsvError> {
    let mut to = BufWriter::new(to);
    to.write_all(&header(&run.tracks, &columns.names())?)?;
    for (sample, row) in BufReader::new(rows).lines().enumerate() {
        let cells = columns.cells(run, sample);
        to.write_all(cells.fold(row?, |row, cell| row + "," + &cell).as_bytes())?;
        to.write_all(b"\n")?;
    }
    to.into_inner().map_err(|error| error.into_error().into())
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::trace::{PhaseEnd, PhaseKind, PhaseRecord, Repetition};

    /// A trace of two signals with this number of samples, without runs and phases.
    fn trace(samples: usize) -> Trace {
        let mut tracks = [("x", 2.0), ("y", -0.1)].map(|(name, scale)| Track::new(name, "mm", scale));
        for (index, track) in tracks.iter_mut().enumerate() {
            track.volts = (0..samples).map(|sample| 0.1 * sample as f64 + index as f64).collect();
        }
        let time = (0..samples).map(|sample| 1e-3 * sample as f64).collect();
        Trace { time, tracks: tracks.to_vec(), ..Trace::default() }
    }

    /// The table of a trace that is written in blocks of this number of samples.
    fn in_blocks(whole: &Trace, samples: usize) -> Result<Vec<u8>, CsvError> {
        let mut table = TableWriter::new(Cursor::new(Vec::new()), &whole.tracks).unwrap();
        let mut run = whole.clone();
        for first in (0..whole.len()).step_by(samples) {
            let block = first..whole.len().min(first + samples);
            run.time = whole.time[block.clone()].to_vec();
            for (part, track) in run.tracks.iter_mut().zip(&whole.tracks) {
                part.volts = track.volts[block.clone()].to_vec();
            }
            table.write(&run).unwrap();
        }
        Ok(table.finish(&run, || Ok(Cursor::new(Vec::new())))?.into_inner())
    }

    /// Asserts that blocks of all sizes give the table of the whole trace.
    fn check_blocks(whole: &Trace) {
        let mut expected = Vec::new();
        whole.write_csv(&mut expected).unwrap();
        for samples in [1, 3, 7, 100] {
            let found = in_blocks(whole, samples).unwrap();
            assert_eq!(String::from_utf8_lossy(&found), String::from_utf8_lossy(&expected), "{samples}");
        }
    }

    #[test]
    fn blocks_give_the_table_of_the_whole_trace() {
        check_blocks(&trace(0));
        check_blocks(&trace(20));
        let repetitions = [0, 6, 14].map(|first| Repetition { first, ..Repetition::default() });
        let repeated = Trace { repetitions: repetitions.to_vec(), ..trace(20) };
        check_blocks(&repeated);
        let kinds = [(PhaseKind::InitialCondition, 0), (PhaseKind::Hold, 0), (PhaseKind::Hold, 11)];
        let phases = kinds.map(|(phase, sample)| PhaseRecord {
            phase,
            repetition: 0,
            begin: 0.0,
            end: 0.0,
            problem_time: 0.0,
            sample,
            ended: PhaseEnd::Time,
        });
        check_blocks(&Trace { phase_records: phases.to_vec(), ..repeated });
    }

    #[test]
    fn the_first_column_that_is_not_finite_is_reported_as_for_the_whole_trace() {
        let mut whole = trace(20);
        whole.tracks[1].volts[3] = f64::INFINITY;
        for faulty in [15, 12, 3] {
            whole.tracks[0].volts[faulty] = f64::NAN;
            let expected = whole.write_csv(&mut Vec::new()).unwrap_err().to_string();
            for samples in [1, 4, 100] {
                assert_eq!(in_blocks(&whole, samples).unwrap_err().to_string(), expected);
            }
        }
    }
}
