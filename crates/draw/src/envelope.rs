//! The envelope of a long record: few samples with which its curves against time look the same.
//!
//! In a picture of a long record, many samples share a column of pixels. Only the range of each signal is visible
//! there, so a pair of samples has all that the column shows.

use std::ops::Range;

use patchcord_core::trace::{Trace, Track};

/// Number of samples of two groups.
const SAMPLES_OF_PAIR: usize = 4;

/// The envelope of a record, made from the blocks of
/// [`run_in_blocks`](patchcord_core::solve::run_in_blocks).
///
/// The samples of every run are divided into groups. Their number of samples doubles whenever there are too many
/// groups, and only the last group of a run may have fewer samples. The envelope has two samples for each group, with
/// the first and the last time of the group. Every signal has its minimum and its maximum of the group in them, in the
/// order of time. So an extreme moves in time, but it stays between the first and the last sample of its group.
///
/// The signals of a group reach their extremes at different times. So the envelope is for curves against time only, not
/// for curves of one signal against another one.
///
/// # Examples
///
/// ```
/// use patchcord_draw::TraceEnvelope;
/// use patchcord_core::trace::{Repetition, Trace, Track};
///
/// let track = Track { volts: vec![0.0, 7.0, -5.0, 2.0, 3.0], ..Track::new("x", "mm", 1.0) };
/// let time = vec![0.0, 0.1, 0.2, 0.3, 0.4];
/// let run = Trace { time, tracks: vec![track], repetitions: vec![Repetition::default()], ..Trace::default() };
/// let mut envelope = TraceEnvelope::new(1);
/// envelope.add(&run);
/// let envelope = envelope.into_trace(&run);
/// // One group has the first four samples, another one has the last sample.
/// assert_eq!(envelope.time, [0.0, 0.3, 0.4, 0.4]);
/// assert_eq!(envelope.tracks[0].volts, [7.0, -5.0, 3.0, 3.0]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TraceEnvelope {
    /// Largest number of groups, apart from one for every run.
    max_groups: usize,
    /// Number of samples of a group.
    group_samples: usize,
    /// Number of samples of the record so far.
    seen: usize,
    /// Number of samples of the present run so far.
    seen_in_run: usize,
    /// For every run, the number of samples of the envelope before it.
    begins: Vec<usize>,
    /// The times of the envelope in seconds.
    time: Vec<f64>,
    /// The values of the envelope for every track.
    volts: Vec<Vec<f64>>,
}

impl TraceEnvelope {
    /// The envelope of a record without samples. It will have at most this number of groups, and one more for every
    /// run.
    pub fn new(max_groups: usize) -> Self {
        TraceEnvelope {
            max_groups,
            group_samples: 1,
            seen: 0,
            seen_in_run: 0,
            begins: Vec::new(),
            time: Vec::new(),
            volts: Vec::new(),
        }
    }

    /// Adds the next samples of the record. The block has the repetitions of the record so far.
    pub fn add(&mut self, block: &Trace) {
        self.volts.resize_with(block.tracks.len(), Vec::new);
        let mut run = block.repetitions.partition_point(|repetition| repetition.first < self.seen);
        for (sample, time) in block.time.iter().enumerate() {
            let begins_run = block.repetitions.get(run).is_some_and(|next| next.first == self.seen);
            run += usize::from(begins_run);
            if begins_run || self.begins.is_empty() {
                self.seen_in_run = 0;
                self.begins.push(self.time.len());
            }
            self.add_sample(*time, block.tracks.iter().map(|track| track.volts[sample]));
            if self.time.len() / 2 - self.begins.len() > self.max_groups {
                self.merge_groups();
            }
        }
    }

    /// Adds a sample to the last group, or begins a group with it.
    fn add_sample(&mut self, time: f64, values: impl Iterator<Item = f64>) {
        let pairs = self.volts.iter_mut().zip(values);
        if self.seen_in_run.is_multiple_of(self.group_samples) {
            self.time.extend([time; 2]);
            pairs.for_each(|(volts, value)| volts.extend([value; 2]));
        } else {
            if let Some(last) = self.time.last_mut() {
                *last = time;
            }
            for (volts, value) in pairs {
                if let Some(extremes) = volts.last_chunk_mut::<2>() {
                    *extremes = extended(*extremes, value);
                }
            }
        }
        self.seen_in_run += 1;
        self.seen += 1;
    }

    /// Merges the groups of every run in pairs. If their number is odd, the last one stays, and takes the next samples.
    fn merge_groups(&mut self) {
        self.group_samples *= 2;
        let ends = self.begins.iter().skip(1).copied().chain([self.time.len()]);
        let runs: Vec<Range<usize>> = self.begins.iter().zip(ends).map(|(begin, end)| *begin..end).collect();
        self.time = merged(&self.time, &runs, |times| [times[0], times[times.len() - 1]]);
        for volts in &mut self.volts {
            *volts = merged(volts, &runs, |values| {
                values[2..].iter().fold([values[0], values[1]], |pair, value| extended(pair, *value))
            });
        }
        let mut count = 0;
        for (begin, run) in self.begins.iter_mut().zip(runs) {
            *begin = count;
            count += 2 * run.len().div_ceil(SAMPLES_OF_PAIR);
        }
    }

    /// The trace with the samples of the envelope. `run` has the tracks, the repetitions, the phases and the curves of the
    /// whole record. Indices of samples are those of the envelope.
    pub fn into_trace(self, run: &Trace) -> Trace {
        let mut trace = run.without_tracks();
        for repetition in &mut trace.repetitions {
            repetition.first = self.index_of(repetition.first, run);
        }
        for record in &mut trace.phase_records {
            record.sample = self.index_of(record.sample, run);
        }
        let mut volts = self.volts.into_iter();
        let track = |track: &Track| Track { volts: volts.next().unwrap_or_default(), ..track.clone() };
        trace.tracks = run.tracks.iter().map(track).collect();
        Trace { time: self.time, curves: run.curves.clone(), ..trace }
    }

    /// The index in the envelope of the group of a sample. It is the length of the envelope for a sample after the last
    /// one: a phase that takes no time at the end of the record has no sample.
    fn index_of(&self, sample: usize, run: &Trace) -> usize {
        let repetition = run.repetition_of(sample);
        match (self.begins.get(repetition), run.repetitions.get(repetition)) {
            (Some(begin), Some(repetition)) if sample < self.seen => {
                begin + 2 * (sample.saturating_sub(repetition.first) / self.group_samples)
            }
            _ => self.time.len(),
        }
    }
}

/// The numbers of the groups of all runs, merged in pairs. `merge` takes the numbers of two groups, or of one.
fn merged(numbers: &[f64], runs: &[Range<usize>], merge: impl Fn(&[f64]) -> [f64; 2]) -> Vec<f64> {
    runs.iter().flat_map(|run| numbers[run.clone()].chunks(SAMPLES_OF_PAIR)).flat_map(merge).collect()
}

/// The two extremes of a group in the order of time, with a later value included.
fn extended(extremes: [f64; 2], value: f64) -> [f64; 2] {
    let [least, most] = [extremes[0].min(extremes[1]), extremes[0].max(extremes[1])];
    if value < least {
        [most, value]
    } else if value > most {
        [least, value]
    } else {
        extremes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::thin;
    use patchcord_core::trace::{PhaseEnd, PhaseKind, PhaseRecord, Repetition};

    /// The voltage of a fast signal at a sample.
    fn fast(index: f64) -> f64 {
        (index * 0.7).sin() + (index * 1e-4).cos()
    }

    /// The voltage of a slow signal at a sample.
    fn slow(index: f64) -> f64 {
        (index * 0.013).cos()
    }

    /// Two runs of these lengths with two signals. All times of a run are between 0 and 1.
    fn record(lengths: [usize; 2]) -> Trace {
        let samples = lengths[0] + lengths[1];
        let track = |name: &str, wave: fn(f64) -> f64| Track {
            volts: (0..samples).map(|index| wave(index as f64)).collect(),
            ..Track::new(name, "mm", 2.0)
        };
        let times = lengths.iter().flat_map(|length| {
            let length = *length;
            (0..length).map(move |index| (index as f64 + 0.5) / length as f64)
        });
        let repetitions =
            [0, lengths[0]].map(|first| Repetition { first, end: 1.0, ..Repetition::default() });
        let phase = |repetition: usize, sample: usize| PhaseRecord {
            phase: PhaseKind::Operate { until: None },
            repetition,
            begin: 0.0,
            end: 1.0,
            problem_time: 0.0,
            sample,
            ended: PhaseEnd::Time,
        };
        Trace {
            time: times.collect(),
            tracks: vec![track("x", fast), track("y", slow)],
            repetitions: repetitions.to_vec(),
            phase_records: vec![
                phase(0, 0),
                phase(1, lengths[0]),
                phase(1, lengths[0] + 25),
                phase(1, samples),
            ],
            ..Trace::default()
        }
    }

    /// The envelope of a record that arrives in blocks of different lengths. As in a run, a block has the repetitions
    /// that have begun.
    fn envelope(whole: &Trace, max_groups: usize) -> Trace {
        let mut envelope = TraceEnvelope::new(max_groups);
        let (mut first, mut length) = (0, 1);
        while first < whole.len() {
            let samples = first..whole.len().min(first + length);
            let track = |track: &Track| Track {
                volts: track.volts[samples.clone()].to_vec(),
                ..Track::new(&track.name, &track.unit, track.per_volt)
            };
            let begun = whole.repetitions.iter().filter(|repetition| repetition.first < samples.end);
            envelope.add(&Trace {
                time: whole.time[samples.clone()].to_vec(),
                tracks: whole.tracks.iter().map(track).collect(),
                repetitions: begun.cloned().collect(),
                ..Trace::default()
            });
            (first, length) = (samples.end, length % 50 + 7);
        }
        envelope.into_trace(whole)
    }

    #[test]
    fn groups_keep_their_extremes_in_order_and_their_times() {
        let (whole, group) = (record([103, 60]), 8);
        let envelope = envelope(&whole, 20);
        // The groups do not extend over the beginning of a run.
        let begins = (0..103).step_by(group).chain((103..163).step_by(group));
        let ends = begins.clone().skip(1).chain([163]);
        let groups: Vec<_> = begins.zip(ends).collect();
        assert_eq!(envelope.len(), 2 * groups.len());
        for (index, (begin, end)) in groups.into_iter().enumerate() {
            let pair = 2 * index..2 * index + 2;
            assert_eq!(envelope.time[pair.clone()], [whole.time[begin], whole.time[end - 1]]);
            for (kept, track) in envelope.tracks.iter().zip(&whole.tracks) {
                let volts = &track.volts[begin..end];
                let by_size = |one: &&f64, other: &&f64| one.total_cmp(other);
                let extremes =
                    [volts.iter().min_by(by_size), volts.iter().max_by(by_size)].map(Option::unwrap);
                let position = |extreme: &f64| volts.iter().position(|volts| volts == extreme);
                let mut expected = extremes.map(|extreme| (position(extreme), *extreme));
                expected.sort_by_key(|(position, _)| *position);
                assert_eq!(kept.volts[pair.clone()], expected.map(|(_, extreme)| extreme), "{begin}");
            }
        }
    }

    #[test]
    fn indices_of_samples_are_those_of_the_envelope() {
        let envelope = envelope(&record([103, 60]), 20);
        let firsts: Vec<_> = envelope.repetitions.iter().map(|repetition| repetition.first).collect();
        let samples: Vec<_> = envelope.phase_records.iter().map(|record| record.sample).collect();
        assert_eq!((firsts, samples), (vec![0, 26], vec![0, 26, 32, 42]));
        assert_eq!((envelope.time[25], envelope.time[26]), (102.5 / 103.0, 0.5 / 60.0));
        assert_eq!(envelope.tracks[1].per_volt, 2.0);
    }

    #[test]
    fn a_short_record_keeps_every_sample() {
        let (whole, envelope) = (record([5, 3]), envelope(&record([5, 3]), 6));
        let kept: Vec<_> = envelope.tracks[0].volts.iter().copied().step_by(2).collect();
        assert_eq!(kept, whole.tracks[0].volts);
    }

    #[test]
    fn every_run_has_a_group() {
        let (whole, envelope) = (record([5000, 3]), envelope(&record([5000, 3]), 0));
        let last = whole.time.len() - 1;
        assert_eq!(envelope.time, [whole.time[0], whole.time[4999], whole.time[5000], whole.time[last]]);
    }

    #[test]
    fn a_record_without_samples_has_tracks() {
        let run = Trace { tracks: vec![Track::new("x", "V", 1.0)], ..Trace::default() };
        assert_eq!(TraceEnvelope::new(10).into_trace(&run), run);
    }

    #[test]
    fn every_column_of_pixels_shows_the_same_range() {
        let whole = record([320_000, 96_000]);
        let envelope = envelope(&whole, 13_000);
        assert_eq!(envelope.len(), 26_000);
        let ranges = |trace: &Trace, track: usize| {
            let points = |run: std::ops::Range<usize>| {
                let volts = &trace.tracks[track].volts[run.clone()];
                let points: Vec<_> = trace.time[run].iter().copied().zip(volts.iter().copied()).collect();
                let shown = thin(&points, 0.0, 1.0, 1000);
                let columns = shown.chunk_by(|one, next| (one.0 * 1e3).floor() == (next.0 * 1e3).floor());
                let range = |column: &[(f64, f64)]| {
                    let volts = || column.iter().map(|point| point.1);
                    (volts().fold(f64::INFINITY, f64::min), volts().fold(f64::NEG_INFINITY, f64::max))
                };
                columns.map(range).collect::<Vec<_>>()
            };
            let second = trace.repetitions[1].first;
            [points(0..second), points(second..trace.len())]
        };
        for track in 0..2 {
            let [expected, found] = [&whole, &envelope].map(|trace| ranges(trace, track));
            assert!(expected[0].len() == 1000 && expected == found, "{track}");
        }
    }
}
