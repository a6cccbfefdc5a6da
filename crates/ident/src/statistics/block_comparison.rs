//! Comparison of two fits of the same data: by how much one is better, and whether that may be chance.
//!
//! The squared residuals of the two fits are subtracted sample by sample. The records are cut into about 20 blocks, and
//! the differences are summed for each block. The spread of the blocks gives the standard error of the total. Residuals
//! are often correlated over many samples, so a standard error from single samples would be too small.
//!
//! Residuals are indexed by record, output and sample. NaN is a missing sample.

use std::ops::AddAssign;

use crate::statistics::descriptive::student_95;

/// By how much one fit is better than another, with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advantage {
    /// The sum of squared residuals of the worse fit minus that of the better one. Negative if the supposedly better
    /// fit is worse.
    pub sum: f64,
    /// The standard error of the sum, from the spread of the blocks.
    pub standard_error: f64,
    /// The degrees of freedom of the standard error: the number of blocks minus 1.
    pub degrees_of_freedom: usize,
}

impl Advantage {
    /// Sums the blocks. The spread is that about the value that each block would have if the advantage were evenly
    /// distributed over all samples.
    fn of(blocks: &[Block]) -> Advantage {
        let mut total = Block::default();
        blocks.iter().for_each(|block| total += *block);
        let count = blocks.len() as f64;
        let mean_per_sample = total.sum / total.samples.max(1.0);
        let variance: f64 =
            blocks.iter().map(|block| (block.sum - mean_per_sample * block.samples).powi(2)).sum::<f64>()
                / (count - 1.0).max(1.0);
        Advantage {
            sum: total.sum,
            standard_error: (variance * count).sqrt(),
            degrees_of_freedom: blocks.len().saturating_sub(1),
        }
    }

    /// Returns the advantage over this data and other data together.
    pub fn combined(self, other: Advantage) -> Advantage {
        Advantage {
            sum: self.sum + other.sum,
            standard_error: self.standard_error.hypot(other.standard_error),
            degrees_of_freedom: self.degrees_of_freedom + other.degrees_of_freedom,
        }
    }

    /// Returns the 95 % confidence interval of the sum, with Student's t.
    pub fn confidence_interval(self) -> [f64; 2] {
        [-1.0, 1.0].map(|side| self.sum + side * student_95(self.degrees_of_freedom) * self.standard_error)
    }

    /// Returns the sum in standard errors. Zero if the standard error is 0.
    pub fn z_score(self) -> f64 {
        if self.standard_error > 0.0 { self.sum / self.standard_error } else { 0.0 }
    }
}

/// The sum of the values of a block.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    sum: f64,
    /// The number of values.
    samples: f64,
}

impl FromIterator<f64> for Block {
    fn from_iter<T: IntoIterator<Item = f64>>(values: T) -> Block {
        let add = |block: Block, value| Block { sum: block.sum + value, samples: block.samples + 1.0 };
        values.into_iter().fold(Block::default(), add)
    }
}

impl AddAssign for Block {
    fn add_assign(&mut self, other: Block) {
        *self = Block { sum: self.sum + other.sum, samples: self.samples + other.samples };
    }
}

/// The number of blocks into which all records together are cut. A chosen number: enough for a standard error, and few
/// enough to be long compared with the correlation of residuals. Blocks are as equal as possible, but each record has
/// at least one.
const BLOCKS: usize = 20;

/// Compares two fits by their residuals on the same data. A sample that is missing in either of them is ignored.
///
/// # Examples
///
/// ```
/// use patchcord_ident::statistics::block_comparison::advantage;
///
/// // One record of one output with 40 samples.
/// let (worse, better) = (vec![vec![vec![1.0; 40]]], vec![vec![vec![0.5; 40]]]);
/// let result = advantage(&worse, &better);
/// assert_eq!((result.sum, result.standard_error), (30.0, 0.0));
/// assert_eq!(result.confidence_interval(), [30.0, 30.0]);
/// ```
pub fn advantage(worse: &[Vec<Vec<f64>>], better: &[Vec<Vec<f64>>]) -> Advantage {
    let samples = total_samples(worse);
    let difference = |(worse, better): (&[f64], &[f64])| {
        let pairs = worse.iter().zip(better).filter(|(a, b)| !a.is_nan() && !b.is_nan());
        pairs.map(|(a, b)| a * a - b * b).collect::<Block>()
    };
    let records = worse.iter().zip(better);
    let blocks = records.flat_map(|(worse, better)| {
        let outputs = worse.iter().zip(better);
        let outputs = outputs.map(|(worse, better)| {
            blocks_of(worse, samples).zip(blocks_of(better, samples)).map(difference).collect()
        });
        sum_outputs(outputs)
    });
    Advantage::of(&blocks.collect::<Vec<_>>())
}

/// Returns the advantage to expect of a fit that leaves only noise over a fit that also leaves these differences.
/// `differences` are indexed by record and output, in standard deviations of the noise. `noise_variance` is the
/// variance of what counts as noise, in the same unit squared.
///
/// The standard error contains the spread of the blocks, and the noise: its product with the differences has the
/// variance 4 `noise_variance` sum.
///
/// # Examples
///
/// ```
/// use patchcord_ident::statistics::block_comparison::expected_advantage;
///
/// // A difference of half a standard deviation of the noise over 100 samples.
/// let difference = [0.5; 100];
/// let expected = expected_advantage(&[vec![difference.as_slice()]], 1.0);
/// assert_eq!((expected.sum, expected.standard_error), (25.0, 10.0));
/// assert_eq!((expected.z_score(), expected.degrees_of_freedom), (2.5, 19));
/// ```
pub fn expected_advantage(differences: &[Vec<&[f64]>], noise_variance: f64) -> Advantage {
    let samples = total_samples(differences);
    let squares = |block: &[f64]| block.iter().map(|value| value * value).collect::<Block>();
    let blocks = differences.iter().flat_map(|outputs| {
        sum_outputs(outputs.iter().map(|signal| blocks_of(signal, samples).map(squares).collect()))
    });
    let noiseless = Advantage::of(&blocks.collect::<Vec<_>>());
    let noise_error = 2.0 * (noise_variance * noiseless.sum).sqrt();
    Advantage { standard_error: noiseless.standard_error.hypot(noise_error), ..noiseless }
}

/// Returns the number of samples of all records together. The outputs of a record have the same number.
fn total_samples<T: AsRef<[f64]>>(records: &[Vec<T>]) -> usize {
    records.iter().filter_map(|outputs| outputs.first()).map(|signal| signal.as_ref().len()).sum()
}

/// Cuts the signal of one record into blocks. `total_samples` is the number of samples of all records together.
pub(crate) fn blocks_of(signal: &[f64], total_samples: usize) -> impl Iterator<Item = &[f64]> {
    let blocks = (BLOCKS * signal.len()).div_ceil(total_samples.max(1)).max(1);
    signal.chunks(signal.len().div_ceil(blocks).max(1))
}

/// Sums the blocks of all outputs of a record, block by block. A disturbance appears in several outputs at the same
/// time, so these are not independent evidence.
pub(crate) fn sum_outputs<T: AddAssign>(outputs: impl Iterator<Item = Vec<T>>) -> Vec<T> {
    let add = |mut sums: Vec<T>, blocks: Vec<T>| {
        sums.iter_mut().zip(blocks).for_each(|(sum, block)| *sum += block);
        sums
    };
    outputs.reduce(add).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::descriptive::about_mean;
    use crate::statistics::rng::standard_normal;
    use crate::statistics::whiteness::ljung_box_z;

    #[test]
    fn missing_samples_do_not_change_the_mean() {
        assert_eq!(about_mean(&[1.0, f64::NAN, 4.0, 1.0]), [-1.0, 2.0, -1.0]);
        assert!(about_mean(&[]).is_empty());
    }

    /// A signal without visible period.
    fn chirp(count: u32) -> Vec<f64> {
        (0..count).map(|k| (1.3 * f64::from(k * k)).sin()).collect()
    }

    #[test]
    fn two_outputs_with_the_same_residuals_are_one_piece_of_evidence() {
        let halved = |signal: &[f64]| signal.iter().map(|value| 0.5 * value).collect::<Vec<_>>();
        let signal = chirp(400);
        let single = advantage(&[vec![signal.clone()]], &[vec![halved(&signal)]]);
        let repeated = |signal: &[f64]| [vec![signal.to_vec(), signal.to_vec()]];
        let double = advantage(&repeated(&signal), &repeated(&halved(&signal)));
        assert!((double.sum - 2.0 * single.sum).abs() < 1e-9);
        assert!(
            (double.z_score() - single.z_score()).abs() < 1e-9,
            "{} {}",
            double.z_score(),
            single.z_score()
        );
        let signals = [signal.as_slice(), &signal];
        let [single, double] =
            [vec![signals[0]], signals.to_vec()].map(|outputs| expected_advantage(&[outputs], 0.0).z_score());
        assert!((double - single).abs() < 1e-9, "{double} {single}");
    }

    #[test]
    fn an_even_advantage_has_no_standard_error_for_any_lengths_of_records() {
        let records = |value: f64| -> Vec<Vec<Vec<f64>>> {
            [10_000, 100, 100, 37].into_iter().map(|length| vec![vec![value; length]]).collect()
        };
        let even = advantage(&records(2.0), &records(1.0));
        assert!((even.sum - 3.0 * 10_237.0).abs() < 1e-6 && even.standard_error < 1e-6, "{even:?}");
        let signals = records(1.0);
        let signals: Vec<Vec<&[f64]>> = signals.iter().map(|outputs| vec![outputs[0].as_slice()]).collect();
        assert!(expected_advantage(&signals, 0.0).standard_error < 1e-6);
        // Additional records without any difference must not increase the evidence.
        let noise = |seed| standard_normal(seed, 10_000);
        let silent = vec![vec![0.0; 100]];
        let [alone, with_silent] = [vec![], vec![silent; 5]].map(|others: Vec<Vec<Vec<f64>>>| {
            let records = |seed| [vec![vec![noise(seed)]], others.clone()].concat();
            advantage(&records(1), &records(2)).z_score().abs()
        });
        assert!((alone - with_silent).abs() < 0.25 * alone, "{alone} {with_silent}");
    }

    #[test]
    fn many_records_of_white_noise_are_as_white_as_one() {
        let records = |seed: u64, count: usize, length: usize| {
            let drawn = standard_normal(seed, count * length);
            drawn.chunks(length).map(|signal| vec![signal.to_vec()]).collect::<Vec<_>>()
        };
        let coloured =
            |count, length| (0..20).filter(|seed| ljung_box_z(&records(*seed, count, length)) > 4.0).count();
        assert_eq!([coloured(1, 400), coloured(50, 40), coloured(250, 40), coloured(50, 400)], [0; 4]);
        let filtered =
            |signal: &[f64]| signal.windows(2).map(|pair| pair[1] + 0.6 * pair[0]).collect::<Vec<_>>();
        let correlated: Vec<_> =
            records(0, 50, 40).iter().map(|outputs| vec![filtered(&outputs[0])]).collect();
        assert!(ljung_box_z(&correlated) > 6.0);
    }

    #[test]
    fn short_and_long_white_signals_are_white() {
        let z_scores: Vec<f64> =
            [12, 20, 40, 400].into_iter().map(|count| ljung_box_z(&[vec![chirp(count)]])).collect();
        assert!(z_scores.iter().all(|z| z.is_finite() && z.abs() < 4.0), "{z_scores:?}");
        let slow = (0..30).map(|k| (0.2 * f64::from(k)).sin()).collect();
        assert!(ljung_box_z(&[vec![slow]]) > 4.0);
    }
}
