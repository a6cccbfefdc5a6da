//! Traces as CSV in physical units.

use std::io::Write;

use super::Trace;

/// Why a trace could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write the table: {0}")]
pub struct CsvError(#[from] std::io::Error);

impl Trace {
    /// Writes the trace: units in `#` comment lines, then the column `t` in seconds and a column a signal;
    /// several sweeps are told apart by a column `run`, phases by a last column `phase`, both from 1. Numbers read
    /// back to the same bits.
    ///
    /// # Errors
    /// When the writer refuses.
    pub fn write_csv(&self, mut to: impl Write) -> Result<(), CsvError> {
        writeln!(to, "# t: s")?;
        for track in &self.tracks {
            writeln!(to, "# {}: {}", track.name, on_one_line(&track.unit))?;
        }
        let mut writer = csv::Writer::from_writer(&mut to);
        let names = self.tracks.iter().map(|track| track.name.as_str());
        let run = (self.sweeps.len() > 1).then_some("run");
        let phases = self.has_phases();
        let phase = phases.then_some("phase");
        writer.write_record(["t"].into_iter().chain(names).chain(run).chain(phase)).map_err(into_io)?;
        for sample in 0..self.len() {
            let phase = phases.then(|| (self.phase_of(sample) + 1).to_string());
            writer.write_record(self.row(sample).chain(phase)).map_err(into_io)?;
        }
        writer.flush()?;
        Ok(())
    }

    fn row(&self, sample: usize) -> impl Iterator<Item = String> + '_ {
        let values = self.tracks.iter().map(move |track| number(track.volts[sample] * track.per_volt));
        let run = (self.sweeps.len() > 1).then(|| (self.sweep_of(sample) + 1).to_string());
        [number(self.time[sample])].into_iter().chain(values).chain(run)
    }
}

/// A unit as a person may have written it, without what would break a comment line.
fn on_one_line(unit: &str) -> String {
    let words: Vec<_> = unit.split_whitespace().collect();
    words.join(" ").chars().filter(|letter| !letter.is_control()).collect()
}

/// The shortest text that reads back to the same number; -0 is 0.
pub fn number(value: f64) -> String {
    let text = format!("{:?}", value + 0.0);
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

fn into_io(error: csv::Error) -> std::io::Error {
    error.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::Track;

    #[test]
    fn a_unit_stays_on_its_line() {
        let trace = Trace { tracks: vec![Track::new("v", "mm\n/\ts\u{1b}2", 1.0)], ..Trace::default() };
        let mut table = Vec::new();
        trace.write_csv(&mut table).unwrap();
        assert_eq!(String::from_utf8(table).unwrap(), "# t: s\n# v: mm / s2\nt,v\n");
    }
}
