//! The digital voltmeter: start, end, minimum and maximum of every recorded signal.

use patchcord_core::trace::{Extremum, SignalExtremes, Trace, Track};

/// The readings of one signal in one run, in the unit of the signal.
#[derive(Debug, Clone, PartialEq)]
pub struct VoltmeterReading {
    /// Index of the run, from 0.
    pub run: usize,
    /// Name of the signal.
    pub signal: String,
    /// Its unit as text, such as "m/s".
    pub unit: String,
    /// Value at the start of the run.
    pub start: f64,
    /// Value at the end of the run.
    pub end: f64,
    /// Smallest value.
    pub least: Extreme,
    /// Largest value.
    pub most: Extreme,
}

/// An extreme value of a signal and the first time at which it occurs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extreme {
    /// In the signal's unit.
    pub value: f64,
    /// In problem seconds.
    pub time: f64,
}

impl VoltmeterReading {
    /// The largest absolute value.
    pub fn largest(&self) -> f64 {
        self.least.value.abs().max(self.most.value.abs())
    }
}

/// Reads every recorded signal in every run, run by run. Extremes between samples count if the solver located them.
/// A signal without samples in a run has no reading.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::readings;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // dx/dt = -x, from x = 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("Decay").element("A1", decay).run(1.0, 1e-3).record(["A1"]).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let trace = run(&program, &RunSettings::of(&circuit)?)?;
///
/// let reading = &readings(&trace)[0];
/// assert_eq!((reading.signal.as_str(), reading.unit.as_str()), ("A1", "V"));
/// assert_eq!((reading.start, reading.most.value, reading.most.time), (50.0, 50.0, 0.0));
/// assert!((reading.end - 50.0 * (-1.0f64).exp()).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
pub fn readings(trace: &Trace) -> Vec<VoltmeterReading> {
    let of_run = |run| {
        trace.tracks.iter().filter_map(move |track| Some(reading(run, track, track.extremes.get(run)?)))
    };
    (0..trace.repetitions.len()).flat_map(of_run).collect()
}

/// The reading of one track in one run, converted to the unit of the track.
fn reading(run: usize, track: &Track, extremes: &SignalExtremes) -> VoltmeterReading {
    let extreme = |moment: Extremum| Extreme { time: moment.time, value: moment.volts * track.per_volt };
    let (lower, upper) = (extreme(extremes.least), extreme(extremes.most));
    // A negative scale exchanges minimum and maximum.
    let (least, most) = if track.per_volt < 0.0 { (upper, lower) } else { (lower, upper) };
    VoltmeterReading {
        run,
        signal: track.name.clone(),
        unit: track.unit.clone(),
        start: extremes.start * track.per_volt,
        end: extremes.end * track.per_volt,
        least,
        most,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::trace::Repetition;

    fn trace(track: Track) -> Trace {
        let repetitions = vec![Repetition::default(); track.extremes.len()];
        Trace { tracks: vec![track], repetitions, ..Trace::default() }
    }

    #[test]
    fn extremes_have_the_time_of_their_first_occurrence() {
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
    fn extremes_between_samples_count() {
        let mut track = Track::new("x", "m", 1.0);
        track.record(0, 0.0, 1.0);
        track.observe(0, 0.5, 7.0);
        track.record(0, 1.0, 1.0);
        track.observe(0, 1.5, 2.0);
        let reading = &readings(&trace(track))[0];
        assert_eq!((reading.most.value, reading.most.time, reading.end), (7.0, 0.5, 2.0));
    }

    #[test]
    fn every_run_is_read_separately() {
        let mut track = Track::new("x", "m", 1.0);
        for (run, time, volts) in [(0, 0.0, 5.0), (0, 1.0, 9.0), (1, 0.0, 4.0), (1, 2.0, -3.0)] {
            track.record(run, time, volts);
        }
        let readings = readings(&trace(track));
        let values =
            |reading: &VoltmeterReading| (reading.run, reading.start, reading.end, reading.most.value);
        assert_eq!(
            readings.iter().map(values).collect::<Vec<_>>(),
            [(0, 5.0, 9.0, 9.0), (1, 4.0, -3.0, 4.0)]
        );
    }

    #[test]
    fn an_empty_trace_has_no_readings() {
        assert!(readings(&trace(Track::new("x", "m", 1.0))).is_empty());
    }
}
