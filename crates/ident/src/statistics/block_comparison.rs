//! How much better one fit is than another, and whether that can be chance.

use std::ops::AddAssign;

use crate::statistics::descriptive::student_95;

/// By how much one fit lies above another, block by block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advantage {
    /// The sum of the differences of squares.
    pub sum: f64,
    /// Its standard error, from the spread of the blocks.
    pub error: f64,
    /// From how many degrees of freedom that is.
    pub freedom: usize,
}

impl Advantage {
    /// What blocks come to: the spread is that about what each would hold, were all of it even over the data.
    fn of(blocks: &[Block]) -> Advantage {
        let mut all = Block::default();
        blocks.iter().for_each(|own| all += *own);
        let count = blocks.len() as f64;
        let even = all.sum / all.data.max(1.0);
        let spread: f64 = blocks.iter().map(|own| (own.sum - even * own.data).powi(2)).sum::<f64>()
            / (count - 1.0).max(1.0);
        Advantage { sum: all.sum, error: (spread * count).sqrt(), freedom: blocks.len().saturating_sub(1) }
    }

    /// Both over different data.
    pub fn and(self, other: Advantage) -> Advantage {
        Advantage {
            sum: self.sum + other.sum,
            error: self.error.hypot(other.error),
            freedom: self.freedom + other.freedom,
        }
    }

    /// Between which values it lies in 95 of 100 cases.
    pub fn interval(self) -> [f64; 2] {
        [-1.0, 1.0].map(|side| self.sum + side * student_95(self.freedom) * self.error)
    }

    /// In standard errors.
    pub fn ratio(self) -> f64 {
        if self.error > 0.0 { self.sum / self.error } else { 0.0 }
    }
}

/// What the data of a block hold.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    sum: f64,
    /// How many these are.
    data: f64,
}

impl FromIterator<f64> for Block {
    fn from_iter<T: IntoIterator<Item = f64>>(values: T) -> Block {
        let both = |all: Block, own| Block { sum: all.sum + own, data: all.data + 1.0 };
        values.into_iter().fold(Block::default(), both)
    }
}

impl AddAssign for Block {
    fn add_assign(&mut self, other: Block) {
        *self = Block { sum: self.sum + other.sum, data: self.data + other.data };
    }
}

/// So many blocks the records are cut into, together, as long as one another as far as whole ones go: at least one of each record,
/// and none of less than a sample.
const BLOCKS: usize = 20;

/// The squares of one fit less those of another, over the same data.
pub fn advantage(worse: &[Vec<Vec<f64>>], better: &[Vec<Vec<f64>>]) -> Advantage {
    let samples = samples(worse);
    let differ = |(before, after): (&[f64], &[f64])| {
        let pairs = before.iter().zip(after).filter(|(a, b)| !a.is_nan() && !b.is_nan());
        pairs.map(|(a, b)| a * a - b * b).collect::<Block>()
    };
    let records = worse.iter().zip(better);
    let blocks = records.flat_map(|(before, after)| {
        let outputs = before.iter().zip(after);
        let outputs = outputs.map(|(before, after)| {
            in_blocks(before, samples).zip(in_blocks(after, samples)).map(differ).collect()
        });
        together(outputs)
    });
    Advantage::of(&blocks.collect::<Vec<_>>())
}

/// The advantage to be expected of a fit that leaves noise of such a variance over one that leaves these differences as well: by
/// record, of every output.
pub fn expected(differences: &[Vec<&[f64]>], noise: f64) -> Advantage {
    let samples = samples(differences);
    let square = |block: &[f64]| block.iter().map(|own| own * own).collect::<Block>();
    let blocks = differences.iter().flat_map(|outputs| {
        together(outputs.iter().map(|track| in_blocks(track, samples).map(square).collect()))
    });
    let shape = Advantage::of(&blocks.collect::<Vec<_>>());
    Advantage { error: shape.error.hypot(2.0 * (noise * shape.sum).sqrt()), ..shape }
}

/// How many samples the tracks of records have, together: by record, of every output.
fn samples<T: AsRef<[f64]>>(records: &[Vec<T>]) -> usize {
    records.iter().filter_map(|outputs| outputs.first()).map(|track| track.as_ref().len()).sum()
}

/// A track of records that have so many samples, together, in the blocks that are compared.
pub(crate) fn in_blocks(track: &[f64], samples: usize) -> impl Iterator<Item = &[f64]> {
    let blocks = (BLOCKS * track.len()).div_ceil(samples.max(1)).max(1);
    track.chunks(track.len().div_ceil(blocks).max(1))
}

/// The blocks of a record: what its outputs hold at the same time is one, as what happens there shows in all of them.
pub(crate) fn together<T: AddAssign>(outputs: impl Iterator<Item = Vec<T>>) -> Vec<T> {
    let both = |mut all: Vec<T>, own: Vec<T>| {
        all.iter_mut().zip(own).for_each(|(all, own)| *all += own);
        all
    };
    outputs.reduce(both).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::descriptive::about_mean;
    use crate::statistics::rng::normal;
    use crate::statistics::whiteness::colour;

    #[test]
    fn a_mean_is_that_of_the_samples_that_are_there() {
        assert_eq!(about_mean(&[1.0, f64::NAN, 4.0, 1.0]), [-1.0, 2.0, -1.0]);
        assert!(about_mean(&[]).is_empty());
    }

    fn wave(count: u32) -> Vec<f64> {
        (0..count).map(|k| (1.3 * f64::from(k * k)).sin()).collect()
    }

    #[test]
    fn what_two_outputs_show_at_the_same_time_is_one_piece_of_evidence() {
        let halved = |track: &[f64]| track.iter().map(|own| 0.5 * own).collect::<Vec<_>>();
        let track = wave(400);
        let alone = advantage(&[vec![track.clone()]], &[vec![halved(&track)]]);
        let twice = |own: &[f64]| [vec![own.to_vec(), own.to_vec()]];
        let both = advantage(&twice(&track), &twice(&halved(&track)));
        assert!((both.sum - 2.0 * alone.sum).abs() < 1e-9);
        assert!((both.ratio() - alone.ratio()).abs() < 1e-9, "{} {}", both.ratio(), alone.ratio());
        let tracks = [track.as_slice(), &track];
        let [alone, both] = [vec![tracks[0]], tracks.to_vec()].map(|own| expected(&[own], 0.0).ratio());
        assert!((both - alone).abs() < 1e-9, "{both} {alone}");
    }

    #[test]
    fn what_is_even_over_the_data_is_no_chance_however_long_records_are() {
        let records = |value: f64| -> Vec<Vec<Vec<f64>>> {
            [10_000, 100, 100, 37].into_iter().map(|length| vec![vec![value; length]]).collect()
        };
        let even = advantage(&records(2.0), &records(1.0));
        assert!((even.sum - 3.0 * 10_237.0).abs() < 1e-6 && even.error < 1e-6, "{even:?}");
        let tracks = records(1.0);
        let tracks: Vec<Vec<&[f64]>> = tracks.iter().map(|own| vec![own[0].as_slice()]).collect();
        assert!(expected(&tracks, 0.0).error < 1e-6);
        // One record more of what makes no difference: evidence does not grow by it.
        let noisy = |seed| normal(seed, 10_000);
        let short = vec![vec![0.0; 100]];
        let [alone, beside] = [vec![], vec![short; 5]].map(|others: Vec<Vec<Vec<f64>>>| {
            let with = |seed| [vec![vec![noisy(seed)]], others.clone()].concat();
            advantage(&with(1), &with(2)).ratio().abs()
        });
        assert!((alone - beside).abs() < 0.25 * alone, "{alone} {beside}");
    }

    #[test]
    fn many_records_of_noise_are_no_further_from_it_than_one() {
        let records = |seed: u64, count: usize, length: usize| {
            let drawn = normal(seed, count * length);
            drawn.chunks(length).map(|own| vec![own.to_vec()]).collect::<Vec<_>>()
        };
        let told =
            |count, length| (0..20).filter(|seed| colour(&records(*seed, count, length)) > 4.0).count();
        assert_eq!([told(1, 400), told(50, 40), told(250, 40), told(50, 400)], [0; 4]);
        let slow = |own: &[f64]| own.windows(2).map(|pair| pair[1] + 0.6 * pair[0]).collect::<Vec<_>>();
        let remembers: Vec<_> = records(0, 50, 40).iter().map(|own| vec![slow(&own[0])]).collect();
        assert!(colour(&remembers) > 6.0);
    }

    #[test]
    fn a_short_track_is_no_further_from_noise_than_a_long_one() {
        let colours: Vec<f64> =
            [12, 20, 40, 400].into_iter().map(|count| colour(&[vec![wave(count)]])).collect();
        assert!(colours.iter().all(|own| own.is_finite() && own.abs() < 4.0), "{colours:?}");
        let slow = (0..30).map(|k| (0.2 * f64::from(k)).sin()).collect();
        assert!(colour(&[vec![slow]]) > 4.0);
    }
}
