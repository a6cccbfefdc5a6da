//! Writes traces as CSV in physical units.
//!
//! The comment lines at the top give the unit of each column. Numbers are printed with as few digits as read back to
//! the same bits, so a file can be compared with a later run byte by byte. Times are first rounded to short decimals if
//! only rounding errors separate them ([`rounded_time`]). `table_writer` writes the same table while the run is
//! recorded.

mod table_writer;

pub use table_writer::TableWriter;

use std::io::Write;

use super::{Trace, Track};
use patchcord_expr::round_significant;

/// Number of significant digits to which times are rounded. Times of at most 13 digits are written without their
/// rounding error. With this number, hardly any other time is close enough to the rounded one.
const TIME_DIGITS: usize = 13;

/// Largest relative difference of a time from the rounded one: the rounding errors of a multiple of a decimal interval,
/// at most 4 units in the last place.
const MAX_TIME_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Why a trace could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CsvError {
    /// The writer reports an error.
    #[error("cannot write the table: {0}")]
    Io(#[from] std::io::Error),
    /// A value is too large for a number in the unit of its column.
    #[error("cannot write the table: {column} is not finite at t = {time} s; check its scale")]
    NotFinite {
        /// The name of the column.
        column: String,
        /// The time of the first such sample in seconds.
        time: f64,
    },
}

impl Trace {
    /// Writes the trace as CSV.
    ///
    /// The first lines are `#` comments with the unit of each column. The header follows: `t` in seconds, one column
    /// per signal, `run` if the trace has several repetitions, and `phase` if it has phases. Runs and phases count
    /// from 1. Numbers read back to the same bits, times to those of [`rounded_time`].
    ///
    /// # Errors
    /// If a value is not a finite number, or if the writer reports an error. In the first case nothing is written.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::trace::{Trace, Track};
    ///
    /// let mut x = Track::new("x", "mm", 2.0);
    /// x.record(0, 0.0, 1.5);
    /// x.record(0, 0.1, 2.0);
    /// let trace = Trace { time: vec![0.0, 0.1], tracks: vec![x], ..Trace::default() };
    /// let mut csv = Vec::new();
    /// trace.write_csv(&mut csv)?;
    /// assert_eq!(String::from_utf8(csv)?, "# t: s\n# x: mm\nt,x\n0,3\n0.1,4\n");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn write_csv(&self, mut to: impl Write) -> Result<(), CsvError> {
        if let Some((track, time)) = first_not_finite(self) {
            return Err(not_finite(&self.tracks[track], time));
        }
        let columns = RunColumns::of(self);
        to.write_all(&header(&self.tracks, &columns.names())?)?;
        let mut rows = csv::Writer::from_writer(to);
        for sample in 0..self.len() {
            rows.write_record(row(self, sample).chain(columns.cells(self, sample))).map_err(into_io)?;
        }
        rows.flush()?;
        Ok(())
    }
}

/// The columns after the signals.
#[derive(Debug, Clone, Copy)]
struct RunColumns {
    /// Whether there is a column with the number of the run: the trace has several repetitions.
    run: bool,
    /// Whether there is a column with the number of the phase: the trace has phases.
    phase: bool,
}

impl RunColumns {
    /// The columns of a complete trace.
    fn of(trace: &Trace) -> Self {
        RunColumns { run: trace.repetitions.len() > 1, phase: trace.has_phases() }
    }

    /// The names of the columns; empty if there are none.
    fn names(self) -> Vec<&'static str> {
        let run = self.run.then_some("run");
        run.into_iter().chain(self.phase.then_some("phase")).collect()
    }

    /// The cells of one sample in the columns.
    fn cells(self, trace: &Trace, sample: usize) -> impl Iterator<Item = String> {
        let run = self.run.then(|| (trace.repetition_of(sample) + 1).to_string());
        run.into_iter().chain(self.phase.then(|| (trace.phase_of(sample) + 1).to_string()))
    }
}

/// The comment lines with the units and the line of names. The columns `more` follow those of the tracks.
fn header<'t>(tracks: &'t [Track], more: &[&'t str]) -> Result<Vec<u8>, CsvError> {
    let mut bytes = b"# t: s\n".to_vec();
    for track in tracks {
        writeln!(bytes, "# {}: {}", track.name, on_one_line(&track.unit))?;
    }
    let names = tracks.iter().map(|track| track.name.as_str());
    let mut line = csv::Writer::from_writer(bytes);
    line.write_record(["t"].into_iter().chain(names).chain(more.iter().copied())).map_err(into_io)?;
    line.into_inner().map_err(|error| error.into_error().into())
}

/// The cells of one sample: its time and the values of all tracks.
fn row(trace: &Trace, sample: usize) -> impl Iterator<Item = String> {
    let values = trace.tracks.iter().map(move |track| format_exact(track.volts[sample] * track.per_volt));
    [format_exact(rounded_time(trace.time[sample]))].into_iter().chain(values)
}

/// The index of the first track with a value that is not finite in its unit, and the time of its first such sample in
/// seconds.
fn first_not_finite(trace: &Trace) -> Option<(usize, f64)> {
    trace.tracks.iter().enumerate().find_map(|(index, track)| {
        let sample = track.values().position(|value| !value.is_finite())?;
        Some((index, trace.time[sample]))
    })
}

/// The error of a track with a value that is not finite at this time in seconds.
fn not_finite(track: &Track, time: f64) -> CsvError {
    CsvError::NotFinite { column: track.name.clone(), time }
}

/// A unit as the patch writes it, without line breaks and control characters: these would end the comment line.
fn on_one_line(unit: &str) -> String {
    let words: Vec<_> = unit.split_whitespace().collect();
    words.join(" ").chars().filter(|letter| !letter.is_control()).collect()
}

/// The short decimal that a time in seconds has apart from rounding errors. A time without one is returned unchanged.
///
/// The third multiple of 0.3 s is 0.8999999999999999 s in floating point. A table has 0.9 for it.
///
/// # Examples
///
/// ```
/// use patchcord_core::trace::rounded_time;
///
/// assert_eq!(rounded_time(3.0 * 0.3), 0.9);
/// assert_eq!(rounded_time(1.0 / 3.0), 1.0 / 3.0);
/// ```
pub fn rounded_time(seconds: f64) -> f64 {
    let rounded = round_significant(seconds, TIME_DIGITS);
    if (rounded - seconds).abs() <= MAX_TIME_ROUNDING * seconds.abs() { rounded } else { seconds }
}

/// The shortest text that reads back to the same number; -0 is printed as 0.
///
/// # Examples
///
/// ```
/// use patchcord_core::trace::format_exact;
///
/// assert_eq!(format_exact(3.0), "3");
/// assert_eq!(format_exact(-0.0), "0");
/// assert_eq!(format_exact(0.1), "0.1");
/// assert_eq!(format_exact(1e-9), "1e-9");
/// ```
pub fn format_exact(value: f64) -> String {
    let text = format!("{:?}", value + 0.0);
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// The error of the writer behind an error of the CSV library.
fn into_io(error: csv::Error) -> std::io::Error {
    error.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_not_finite_is_refused_before_anything_is_written() {
        let mut track = Track::new("x", "m", 1e308);
        [(0.0, 1.0), (0.5, 50.0)].into_iter().for_each(|(time, volts)| track.record(0, time, volts));
        let trace = Trace { time: vec![0.0, 0.5], tracks: vec![track], ..Trace::default() };
        let mut table = Vec::new();
        let error = trace.write_csv(&mut table).unwrap_err();
        assert!(matches!(&error, CsvError::NotFinite { column, time: 0.5 } if column == "x"), "{error}");
        assert!(table.is_empty());
    }

    #[test]
    fn multiples_of_decimal_intervals_are_short_decimals() {
        for (interval, exponent) in [(3, -1), (7, -4), (15, -3), (123_456, -9)] {
            let every: f64 = format!("{interval}e{exponent}").parse().unwrap();
            for index in 0..10_000 {
                let decimal: f64 = format!("{}e{exponent}", index * interval).parse().unwrap();
                assert_eq!(rounded_time(index as f64 * every), decimal, "{index} x {every}");
            }
        }
        assert_eq!(format_exact(rounded_time(3.0 * 0.3)), "0.9");
    }

    #[test]
    fn other_times_keep_their_bits_and_no_time_moves_past_another() {
        for time in [0.0, 1.0 / 3.0, 0.1234567890123456, 8.466_666_666_666_667, 1e-300, f64::INFINITY] {
            assert_eq!(rounded_time(time), time);
        }
        let neighbours: Vec<f64> = (0..64).map(|bits| f64::from_bits(0.9f64.to_bits() - 32 + bits)).collect();
        assert!(neighbours.windows(2).all(|pair| rounded_time(pair[0]) <= rounded_time(pair[1])));
        let moved = |time: &&f64| rounded_time(**time) != **time;
        assert!((4..=10).contains(&neighbours.iter().filter(moved).count()));
    }

    #[test]
    fn a_unit_stays_on_its_line() {
        let trace = Trace { tracks: vec![Track::new("v", "mm\n/\ts\u{1b}2", 1.0)], ..Trace::default() };
        let mut table = Vec::new();
        trace.write_csv(&mut table).unwrap();
        assert_eq!(String::from_utf8(table).unwrap(), "# t: s\n# v: mm / s2\nt,v\n");
    }
}
