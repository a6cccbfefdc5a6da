//! The digital voltmeter: what a signal was at the start and the end, and how far it went.

use crate::trace::{Trace, Track};

/// A signal's reading, in the signal's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Name of the signal.
    pub signal: String,
    /// Text of its unit.
    pub unit: String,
    /// First sample.
    pub start: f64,
    /// Last sample.
    pub end: f64,
    /// Least sample.
    pub least: Extreme,
    /// Largest sample.
    pub most: Extreme,
}

/// An extreme value of a signal and when it was recorded first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extreme {
    /// In the signal's unit.
    pub value: f64,
    /// In problem seconds.
    pub time: f64,
}

impl Reading {
    /// The largest value without sign.
    pub fn largest(&self) -> f64 {
        self.least.value.abs().max(self.most.value.abs())
    }
}

/// Reads every recorded signal; nothing where nothing was recorded.
pub fn readings(trace: &Trace) -> Vec<Reading> {
    trace.tracks.iter().filter_map(|track| reading(trace, track)).collect()
}

fn reading(trace: &Trace, track: &Track) -> Option<Reading> {
    let samples = || trace.time.iter().copied().zip(track.values());
    // The first of equal extremes counts: min_by keeps the first, so the largest is the least of the opposite.
    let least = samples().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let most = samples().min_by(|a, b| b.1.total_cmp(&a.1))?;
    Some(Reading {
        signal: track.name.clone(),
        unit: track.unit.clone(),
        start: track.values().next()?,
        end: track.values().last()?,
        least: Extreme { time: least.0, value: least.1 },
        most: Extreme { time: most.0, value: most.1 },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_are_found_with_their_first_time() {
        let track =
            Track { name: "x".into(), unit: "m".into(), per_volt: -2.0, volts: vec![0.0, 3.0, -1.0, 3.0] };
        let trace = Trace { time: vec![0.0, 1.0, 2.0, 3.0], tracks: vec![track], ..Trace::default() };
        let reading = &readings(&trace)[0];
        assert_eq!((reading.start, reading.end), (0.0, -6.0));
        assert_eq!((reading.least.value, reading.least.time), (-6.0, 1.0));
        assert_eq!((reading.most.value, reading.most.time), (2.0, 2.0));
    }

    #[test]
    fn an_empty_trace_has_no_readings() {
        let track = Track { name: "x".into(), unit: "m".into(), per_volt: 1.0, volts: Vec::new() };
        assert!(readings(&Trace { tracks: vec![track], ..Trace::default() }).is_empty());
    }
}
