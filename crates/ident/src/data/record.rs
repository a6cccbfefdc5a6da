//! A stretch of evenly sampled data, in the units of the patch.

use std::ops::Range;

use crate::data::document::Hold;
use crate::data::measured::Measured;

/// What was measured from one instant to another, evenly sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// The file, as the experiment names it; with columns of other names, these behind it.
    pub name: String,
    /// When the first sample was taken, in seconds by the clock of the file.
    pub begin: f64,
    /// Seconds before that by the same clock, from where the file begins.
    pub since: f64,
    /// Seconds from sample to sample.
    pub interval: f64,
    /// How far a sample was taken off its even time at most, in intervals.
    pub jitter: f64,
    /// The samples of every drive, in the unit of its scale. Where rows are missing, straight from the sample before to the
    /// one behind, or as the one before where the drive is held so.
    pub drives: Vec<Vec<f64>>,
    /// The samples of every output, in the unit of its signal; NaN where a row is missing.
    pub outputs: Vec<Vec<f64>>,
}

impl Record {
    /// The samples of a stretch of the even times; `holds` say what each drive does where rows are missing.
    pub(crate) fn cut(measured: &Measured, places: Range<usize>, holds: &[Hold]) -> Record {
        let rows = measured.rows_in(&places);
        let first = measured.places.get(rows.start).copied().unwrap_or_default();
        let place = |row: usize| measured.places[row] - first;
        let count = rows.clone().next_back().map_or(0, |last| place(last) + 1);
        let spread = |column: &Vec<f64>| {
            let mut samples = vec![f64::NAN; count];
            rows.clone().for_each(|row| samples[place(row)] = column[row]);
            samples
        };
        let (drives, outputs) = measured.columns.split_at(holds.len());
        let filled = |(column, hold): (&Vec<f64>, &Hold)| {
            let mut samples = spread(column);
            fill(&mut samples, *hold);
            samples
        };
        Record {
            name: measured.name.clone(),
            begin: measured.time(first),
            since: measured.time(first) - measured.begin,
            interval: measured.interval,
            jitter: measured.jitter,
            drives: drives.iter().zip(holds).map(filled).collect(),
            outputs: outputs.iter().map(spread).collect(),
        }
    }

    /// The same in so many pieces, as even as whole samples allow; in fewer where one would be shorter than `least` samples.
    pub(crate) fn pieces(&self, count: usize, least: usize) -> impl ExactSizeIterator<Item = Record> + '_ {
        let count = count.min(self.len() / least).max(1);
        let edge = move |piece: usize| piece * self.len() / count;
        (0..count).map(move |piece| self.piece(edge(piece)..edge(piece + 1)))
    }

    /// The same in pieces of so many seconds.
    pub(crate) fn pieces_of(&self, seconds: f64) -> impl Iterator<Item = Record> + '_ {
        let count = (self.duration() / seconds).round().max(1.0);
        self.pieces(count as usize, LEAST_SAMPLES)
    }

    /// So large a share of it, from its beginning.
    pub(crate) fn beginning(&self, share: f64) -> Record {
        let samples = (share * self.len() as f64).ceil() as usize;
        self.piece(0..samples.max(2).min(self.len()))
    }

    fn piece(&self, places: Range<usize>) -> Record {
        let before = places.start as f64 * self.interval;
        let own =
            |columns: &[Vec<f64>]| columns.iter().map(|column| column[places.clone()].to_vec()).collect();
        Record {
            name: self.name.clone(),
            begin: self.begin + before,
            since: self.since + before,
            drives: own(&self.drives),
            outputs: own(&self.outputs),
            ..*self
        }
    }

    /// How many samples there are, missing ones counted.
    pub fn len(&self) -> usize {
        self.outputs.first().map_or(0, Vec::len)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many rows are missing.
    pub fn missing(&self) -> usize {
        self.outputs.first().map_or(0, |samples| samples.iter().filter(|sample| sample.is_nan()).count())
    }

    /// Seconds from the first sample to the last.
    pub fn duration(&self) -> f64 {
        self.interval * self.len().saturating_sub(1) as f64
    }
}

/// Fills what is missing between samples.
fn fill(samples: &mut [f64], hold: Hold) {
    let there: Vec<usize> = (0..samples.len()).filter(|place| !samples[*place].is_nan()).collect();
    for pair in there.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (before, behind) = (samples[from], samples[to]);
        for (steps, sample) in samples[from..to].iter_mut().enumerate().skip(1) {
            let share = steps as f64 / (to - from) as f64;
            *sample = match hold {
                Hold::Linear | Hold::Smooth => before + share * (behind - before),
                Hold::Previous => before,
            };
        }
    }
}

/// Fewer samples than this are neither trained nor tested on.
pub const LEAST_SAMPLES: usize = 10;

#[cfg(test)]
mod tests {
    use super::*;

    const GONE: f64 = f64::NAN;

    fn measured() -> Measured {
        Measured {
            name: "a.csv".to_owned(),
            begin: 2.0,
            interval: 0.5,
            jitter: 0.0,
            places: vec![0, 1, 4, 5],
            columns: vec![vec![0.0, 1.0, 4.0, 5.0], vec![0.0, 10.0, 40.0, 50.0]],
        }
    }

    fn same(found: &[f64], wanted: &[f64]) {
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(found), bits(wanted), "{found:?}");
    }

    #[test]
    fn drives_go_on_where_rows_are_missing_and_outputs_do_not() {
        let record = Record::cut(&measured(), 1..6, &[Hold::Linear]);
        assert_eq!((record.begin, record.len(), record.missing(), record.duration()), (2.5, 5, 2, 2.0));
        same(&record.drives[0], &[1.0, 2.0, 3.0, 4.0, 5.0]);
        same(&record.outputs[0], &[10.0, GONE, GONE, 40.0, 50.0]);
        let record = Record::cut(&measured(), 1..6, &[Hold::Previous]);
        same(&record.drives[0], &[1.0, 1.0, 1.0, 4.0, 5.0]);
    }

    #[test]
    fn pieces_follow_one_another_and_keep_the_clock() {
        let record = Record::cut(&measured(), 0..6, &[Hold::Linear]);
        let pieces: Vec<Record> = record.pieces(3, 1).collect();
        assert_eq!(pieces.iter().map(|piece| piece.since).collect::<Vec<_>>(), [0.0, 1.0, 2.0]);
        same(&pieces.iter().flat_map(|piece| piece.drives[0].clone()).collect::<Vec<_>>(), &record.drives[0]);
        let lengths = |count, least| record.pieces(count, least).map(|piece| piece.len()).collect::<Vec<_>>();
        assert_eq!((lengths(4, 1), lengths(4, 4), lengths(2, 9)), (vec![1, 2, 1, 2], vec![6], vec![6]));
    }

    #[test]
    fn a_record_begins_and_ends_with_a_sample() {
        let record = Record::cut(&measured(), 2..5, &[Hold::Linear]);
        assert_eq!((record.begin, record.len()), (4.0, 1));
        assert!(Record::cut(&measured(), 2..4, &[Hold::Linear]).is_empty());
    }
}
