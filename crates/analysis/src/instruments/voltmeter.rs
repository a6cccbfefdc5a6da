//! The digital voltmeter: what a signal was at the start and the end, and how far it went.

use patchcord_core::trace::{Course, Moment, Trace, Track};

/// A signal's reading in one run, in the signal's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The run, counted from 0.
    pub run: usize,
    /// Name of the signal.
    pub signal: String,
    /// Text of its unit.
    pub unit: String,
    /// Value at its beginning.
    pub start: f64,
    /// Value at its end.
    pub end: f64,
    /// Its least value.
    pub least: Extreme,
    /// Its largest value.
    pub most: Extreme,
}

/// An extreme value of a signal and when it was met first.
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

/// Reads every recorded signal in every run, one run after the other, between its samples too; nothing where
/// nothing was seen.
pub fn readings(trace: &Trace) -> Vec<Reading> {
    let of_run =
        |run| trace.tracks.iter().filter_map(move |track| Some(reading(run, track, track.courses.get(run)?)));
    (0..trace.sweeps.len()).flat_map(of_run).collect()
}

fn reading(run: usize, track: &Track, course: &Course) -> Reading {
    let extreme = |moment: Moment| Extreme { time: moment.time, value: moment.volts * track.per_volt };
    let (lower, upper) = (extreme(course.least), extreme(course.most));
    // A scale below 0 turns what is up down.
    let (least, most) = if track.per_volt < 0.0 { (upper, lower) } else { (lower, upper) };
    Reading {
        run,
        signal: track.name.clone(),
        unit: track.unit.clone(),
        start: course.start * track.per_volt,
        end: course.end * track.per_volt,
        least,
        most,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::trace::Sweep;

    fn trace(track: Track) -> Trace {
        let sweeps = vec![Sweep::default(); track.courses.len()];
        Trace { tracks: vec![track], sweeps, ..Trace::default() }
    }

    #[test]
    fn extremes_are_found_with_their_first_time() {
        let mut track = Track::new("x", "m", -2.0);
        for (time, volts) in [(0.0, 0.0), (1.0, 3.0), (2.0, -1.0), (3.0, 3.0)] {
            track.record(0, time, volts);
        }
        let reading = &readings(&trace(track))[0];
        assert_eq!((reading.start, reading.end), (0.0, -6.0));
        assert_eq!((reading.least.value, reading.least.time), (-6.0, 1.0));
        assert_eq!((reading.most.value, reading.most.time), (2.0, 2.0));
    }

    #[test]
    fn what_is_seen_between_samples_counts() {
        let mut track = Track::new("x", "m", 1.0);
        track.record(0, 0.0, 1.0);
        track.see(0, 0.5, 7.0);
        track.record(0, 1.0, 1.0);
        track.see(0, 1.5, 2.0);
        let reading = &readings(&trace(track))[0];
        assert_eq!((reading.most.value, reading.most.time, reading.end), (7.0, 0.5, 2.0));
    }

    #[test]
    fn every_run_is_read_by_itself() {
        let mut track = Track::new("x", "m", 1.0);
        for (run, time, volts) in [(0, 0.0, 5.0), (0, 1.0, 9.0), (1, 0.0, 4.0), (1, 2.0, -3.0)] {
            track.record(run, time, volts);
        }
        let readings = readings(&trace(track));
        let told = |reading: &Reading| (reading.run, reading.start, reading.end, reading.most.value);
        assert_eq!(readings.iter().map(told).collect::<Vec<_>>(), [(0, 5.0, 9.0, 9.0), (1, 4.0, -3.0, 4.0)]);
    }

    #[test]
    fn an_empty_trace_has_no_readings() {
        assert!(readings(&trace(Track::new("x", "m", 1.0))).is_empty());
    }
}
