//! How much better one fit is than another, and whether that can be chance.

use super::fit::Fitted;

/// The residuals of all records and outputs one after the other, where there are data.
fn series(fitted: &Fitted) -> impl Iterator<Item = Vec<f64>> + '_ {
    let tracks = fitted.residuals.iter().flatten();
    tracks.map(|track| track.iter().copied().filter(|value| !value.is_nan()).collect())
}

/// Over how many samples residuals remember: 1 + 2 (sum of the autocorrelations), up to where these are lost in chance.
pub fn memory(fitted: &Fitted) -> f64 {
    let times = series(fitted).map(|track| {
        let lost = 2.0 / (track.len() as f64).sqrt();
        let correlated = autocorrelations(&track, track.len() / 4).take_while(|own| *own > lost);
        (1.0 + 2.0 * correlated.sum::<f64>(), track.len() as f64)
    });
    let (sum, weight) =
        times.fold((0.0, 0.0), |(sum, all), (time, weight)| (sum + time * weight, all + weight));
    if weight > 0.0 { sum / weight } else { 1.0 }
}

/// The autocorrelations of a track at 1, 2, ... samples.
fn autocorrelations(track: &[f64], most: usize) -> impl Iterator<Item = f64> + '_ {
    let mean = track.iter().sum::<f64>() / track.len().max(1) as f64;
    let power: f64 = track.iter().map(|value| (value - mean).powi(2)).sum();
    (1..most.max(1)).map(move |lag| {
        let pairs = track.iter().zip(track.iter().skip(lag));
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / power
    })
}

/// How far the residuals are from white noise, in standard deviations of what chance would bring: Ljung and Box over lags
/// up to a hundredth of the record, 20 at least.
pub fn colour(fitted: &Fitted) -> f64 {
    let all = series(fitted).map(|track| {
        let count = track.len() as f64;
        let lags = (track.len() / 100).max(20);
        let sum: f64 = autocorrelations(&track, lags + 1)
            .enumerate()
            .map(|(place, own)| own * own / (count - place as f64 - 1.0))
            .sum();
        (count * (count + 2.0) * sum - lags as f64) / (2.0 * lags as f64).sqrt()
    });
    all.fold(f64::NEG_INFINITY, f64::max)
}

/// By how much one fit lies above another, block by block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advantage {
    /// The sum of the differences of squares.
    pub sum: f64,
    /// Its standard error, from the spread of the blocks.
    pub error: f64,
}

impl Advantage {
    /// What blocks come to.
    fn of(blocks: &[f64]) -> Advantage {
        let (count, sum) = (blocks.len() as f64, blocks.iter().sum::<f64>());
        let mean = sum / count.max(1.0);
        let spread: f64 = blocks.iter().map(|own| (own - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        Advantage { sum, error: (spread * count).sqrt() }
    }

    /// Both over different data.
    pub fn and(self, other: Advantage) -> Advantage {
        Advantage { sum: self.sum + other.sum, error: self.error.hypot(other.error) }
    }

    /// In standard errors.
    pub fn ratio(self) -> f64 {
        if self.error > 0.0 { self.sum / self.error } else { 0.0 }
    }
}

/// So many blocks the records are cut into, together.
const BLOCKS: usize = 20;

/// The squares of one fit less those of another, over the same data.
pub fn advantage(worse: &Fitted, better: &Fitted) -> Advantage {
    let records = worse.residuals.len();
    let tracks = worse.residuals.iter().flatten().zip(better.residuals.iter().flatten());
    let blocks = tracks.flat_map(|(before, after)| {
        let chunks = in_blocks(before, records).zip(in_blocks(after, records));
        chunks.map(|(before, after)| {
            let pairs = before.iter().zip(after).filter(|(a, b)| !a.is_nan() && !b.is_nan());
            pairs.map(|(a, b)| a * a - b * b).sum::<f64>()
        })
    });
    Advantage::of(&blocks.collect::<Vec<_>>())
}

/// The advantage to be expected of a fit that leaves noise of such a variance over one that leaves these differences as well,
/// of so many records.
pub fn expected(differences: &[&[f64]], records: usize, noise: f64) -> Advantage {
    let blocks = differences.iter().flat_map(|track| in_blocks(track, records));
    let blocks: Vec<f64> = blocks.map(|block| block.iter().map(|own| own * own).sum()).collect();
    let shape = Advantage::of(&blocks);
    Advantage { error: shape.error.hypot(2.0 * (noise * shape.sum).sqrt()), ..shape }
}

/// A track of one of so many records in the blocks that are compared.
fn in_blocks(track: &[f64], records: usize) -> impl Iterator<Item = &[f64]> {
    track.chunks(track.len().div_ceil(BLOCKS.div_ceil(records)).max(1))
}
