//! Whether residuals are white: their autocorrelation, the test of Ljung and Box, and how long they remember.

use crate::statistics::descriptive::{mean, there};

/// Over how many samples residuals remember: 1 + 2 (sum of the autocorrelations), up to where these are lost in chance.
pub fn memory(residuals: &[Vec<Vec<f64>>]) -> f64 {
    let times = residuals.iter().flatten().map(|track| there(track)).map(|track| {
        let lost = 2.0 / (track.len() as f64).sqrt();
        let correlated = autocorrelations(&track, track.len() / 4).take_while(|own| *own > lost);
        (1.0 + 2.0 * correlated.sum::<f64>(), track.len() as f64)
    });
    let (sum, weight) =
        times.fold((0.0, 0.0), |(sum, all), (time, weight)| (sum + time * weight, all + weight));
    if weight > 0.0 { sum / weight } else { 1.0 }
}

/// The autocorrelations of a track at 1, 2, ... samples.
pub(crate) fn autocorrelations(track: &[f64], most: usize) -> impl Iterator<Item = f64> + '_ {
    let mean = mean(track);
    let power: f64 = track.iter().map(|value| (value - mean).powi(2)).sum();
    (1..most.max(1)).map(move |lag| {
        let pairs = track.iter().zip(track.iter().skip(lag));
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / power
    })
}

/// Up to how many samples apart residuals of a record of so many are looked at: a hundredth of it, 20 at least, and half of it at
/// most.
pub(crate) fn lags(samples: usize) -> usize {
    (samples / 100).max(20).min(samples / 2)
}

/// How far the residuals are from white noise, in standard deviations of what chance would bring: Ljung and Box over
/// `lags`, of every output the sum over all records, and of the outputs the largest. Q of n records is distributed as
/// chi-squared with the sum of their lags: its mean, half its variance.
pub fn colour(residuals: &[Vec<Vec<f64>>]) -> f64 {
    let outputs = residuals.first().map_or(0, Vec::len);
    let all = (0..outputs).map(|output| {
        let tracks = residuals.iter().map(|record| there(&record[output]));
        // A track that is left without a rest tells nothing.
        let told = tracks.map(|track| ljung_box(&track)).filter(|(sum, _)| !sum.is_nan());
        let (sum, lags) = told.fold((0.0, 0.0), |(sum, all), (own, lags)| (sum + own, all + lags));
        (sum - lags) / f64::sqrt(2.0 * lags)
    });
    all.fold(f64::NEG_INFINITY, f64::max)
}

/// Ljung and Box's Q of a track, and over how many lags.
fn ljung_box(track: &[f64]) -> (f64, f64) {
    let count = track.len() as f64;
    let lags = lags(track.len());
    let sum: f64 = autocorrelations(track, lags + 1)
        .enumerate()
        .map(|(place, own)| own * own / (count - place as f64 - 1.0))
        .sum();
    (count * (count + 2.0) * sum, lags as f64)
}
