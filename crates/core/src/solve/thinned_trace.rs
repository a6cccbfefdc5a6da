//! A bounded selection of the samples of a run, with which the run can be compared with another one.

use crate::trace::{Trace, Track};

/// Number of voltages that a selection has at most, over all signals. They take 4 MB.
const MAX_VOLTAGES: usize = 500_000;
/// Number of samples that a selection may always have, for any number of signals.
const ALWAYS_KEPT: usize = 100;

/// Samples of a run at equal distances in the record. The distance doubles whenever there are too many samples.
pub(super) struct ThinnedTrace {
    /// The selected samples of all signals, without derivatives.
    pub trace: Trace,
    /// The distance: samples are selected whose index in the run is a multiple of this number.
    interval: usize,
    /// Number of samples of the run so far.
    seen: usize,
    /// The number of voltages above which the distance doubles.
    max_voltages: usize,
    /// The largest number of samples. Later ones are not selected.
    max_samples: usize,
}

impl ThinnedTrace {
    /// A selection without samples.
    pub(super) fn new() -> Self {
        ThinnedTrace {
            trace: Trace::default(),
            interval: 1,
            seen: 0,
            max_voltages: MAX_VOLTAGES,
            max_samples: usize::MAX,
        }
    }

    /// A selection of the same samples of another run, without samples yet. It has at most `max_samples`, also if the
    /// other run is longer.
    pub(super) fn for_other_run(&self, max_samples: usize) -> Self {
        let interval = self.interval;
        ThinnedTrace { interval, max_voltages: usize::MAX, max_samples, ..ThinnedTrace::new() }
    }

    /// Selects from the next samples of the run.
    pub(super) fn add(&mut self, block: &Trace) {
        let signals = block.tracks.iter().filter(|track| track.derivative.is_none());
        if self.seen == 0 {
            let empty = |track: &Track| Track::new(&track.name, &track.unit, track.per_volt);
            self.trace.tracks = signals.clone().map(empty).collect();
        }
        let skipped = self.seen.next_multiple_of(self.interval) - self.seen;
        self.seen += block.len();
        let missing = self.max_samples - self.trace.len();
        self.trace.time.extend(block.time.iter().skip(skipped).step_by(self.interval).take(missing));
        for (selected, track) in self.trace.tracks.iter_mut().zip(signals) {
            selected.volts.extend(track.volts.iter().skip(skipped).step_by(self.interval).take(missing));
        }
        let thinned_above = self.max_voltages / self.trace.tracks.len().max(1);
        while self.trace.len() > thinned_above.max(ALWAYS_KEPT) {
            self.double_interval();
        }
    }

    /// Doubles the distance of the selected samples.
    fn double_interval(&mut self) {
        self.interval *= 2;
        remove_every_second(&mut self.trace.time);
        self.trace.tracks.iter_mut().for_each(|track| remove_every_second(&mut track.volts));
    }
}

/// Removes the second number, the fourth, the sixth and so on.
fn remove_every_second(values: &mut Vec<f64>) {
    let mut is_kept = false;
    values.retain(|_| {
        is_kept = !is_kept;
        is_kept
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Adds samples of a signal, whose voltages are their indices, in blocks of different lengths.
    fn add(thinned: &mut ThinnedTrace, samples: usize) {
        let (mut first, mut length) = (0, 1);
        while first < samples {
            let block: Vec<f64> = (first..samples.min(first + length)).map(|index| index as f64).collect();
            (first, length) = (first + block.len(), length % 50 + 7);
            let track = Track { volts: block.clone(), ..Track::new("x", "V", 1.0) };
            let derivative = Track { volts: block.clone(), ..track.differentiated("k", 1.0, "1") };
            thinned.add(&Trace { time: block, tracks: vec![track, derivative], ..Trace::default() });
        }
    }

    #[test]
    fn a_few_samples_at_equal_distances_are_selected() {
        for (samples, interval) in [(1, 1), (100, 1), (101, 2), (200, 2), (201, 4), (5000, 64)] {
            let mut thinned = ThinnedTrace { max_voltages: 10, ..ThinnedTrace::new() };
            add(&mut thinned, samples);
            let expected: Vec<f64> = (0..samples).step_by(interval).map(|index| index as f64).collect();
            assert_eq!((&thinned.trace.time, thinned.trace.tracks.len()), (&expected, 1), "{samples}");
            assert_eq!(thinned.trace.tracks[0].volts, expected);
            // A longer run has the same ones.
            let mut other = thinned.for_other_run(expected.len());
            add(&mut other, 2 * samples + 3);
            assert_eq!((&other.trace.time, &other.trace.tracks[0].volts), (&expected, &expected));
        }
    }
}
