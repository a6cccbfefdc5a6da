//! Whether residuals are white noise: their autocorrelation, the Ljung-Box test, and the autocorrelation time.
//!
//! Residuals are indexed by record, output and sample. NaN is a missing sample; it is removed, and its neighbours count
//! as adjacent.

use crate::statistics::descriptive::{mean, present};

/// Returns the integrated autocorrelation time in samples: 1 + 2 (sum of the autocorrelations). The sum ends before the
/// first autocorrelation that is not significant. The time is 1 for white noise.
///
/// The result is the mean over all records and outputs, weighted by the number of samples. Without samples it is 1.
///
/// # Examples
///
/// ```
/// use patchcord_ident::statistics::whiteness::integrated_autocorrelation_time;
///
/// let alternating: Vec<f64> = (0..100).map(|index| if index % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// assert_eq!(integrated_autocorrelation_time(&[vec![alternating]]), 1.0);
///
/// let slow: Vec<f64> = (0..1000).map(|index| (0.01 * f64::from(index)).sin()).collect();
/// assert!(integrated_autocorrelation_time(&[vec![slow]]) > 20.0);
/// ```
pub fn integrated_autocorrelation_time(residuals: &[Vec<Vec<f64>>]) -> f64 {
    let times = residuals.iter().flatten().map(|residual| present(residual)).map(|residual| {
        // Two standard errors of an autocorrelation of white noise.
        let significant = 2.0 / (residual.len() as f64).sqrt();
        let correlations = autocorrelations(&residual, residual.len() / 4)
            .take_while(|correlation| *correlation > significant);
        (1.0 + 2.0 * correlations.sum::<f64>(), residual.len() as f64)
    });
    let (sum, weight) =
        times.fold((0.0, 0.0), |(sum, all), (time, weight)| (sum + time * weight, all + weight));
    if weight > 0.0 { sum / weight } else { 1.0 }
}

/// Returns the autocorrelations at lags of 1, 2, ... samples, below `end`. They are NaN if all samples are equal.
pub(crate) fn autocorrelations(samples: &[f64], end: usize) -> impl Iterator<Item = f64> + '_ {
    let mean = mean(samples);
    let power: f64 = samples.iter().map(|value| (value - mean).powi(2)).sum();
    (1..end.max(1)).map(move |lag| {
        let pairs = samples.iter().zip(samples.iter().skip(lag));
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / power
    })
}

/// Returns the number of lags that are tested for this number of samples: a hundredth of the samples, but at least 20,
/// and at most half of the samples.
pub(crate) fn lag_count(samples: usize) -> usize {
    (samples / 100).max(20).min(samples / 2)
}

/// Returns how far the residuals are from white noise, in standard deviations of the Ljung-Box statistic Q.
///
/// For each output, Q is summed over all records. For white noise, the sum has a chi-squared distribution whose degrees
/// of freedom f are the sum of the lags. Its mean is f and its variance 2 f. The result is the largest (Q - f) /
/// sqrt(2 f) of all outputs. Constant residuals are ignored. Without outputs the result is negative infinity.
///
/// Source: G. M. Ljung and G. E. P. Box, On a measure of lack of fit in time series models, Biometrika 65 (1978).
///
/// # Examples
///
/// ```
/// use patchcord_ident::statistics::whiteness::ljung_box_z;
///
/// // A slow sine is as far from white noise as possible.
/// let slow: Vec<f64> = (0..1000).map(|index| (0.01 * f64::from(index)).sin()).collect();
/// assert!(ljung_box_z(&[vec![slow]]) > 100.0);
/// assert_eq!(ljung_box_z(&[]), f64::NEG_INFINITY);
/// ```
pub fn ljung_box_z(residuals: &[Vec<Vec<f64>>]) -> f64 {
    let outputs = residuals.first().map_or(0, Vec::len);
    let z_scores = (0..outputs).map(|output| {
        let of_records = residuals.iter().map(|record| present(&record[output]));
        // Q is NaN if all residuals of a record are equal.
        let statistics = of_records.map(|residual| ljung_box(&residual)).filter(|(q, _)| !q.is_nan());
        let (sum, freedom) =
            statistics.fold((0.0, 0.0), |(sum, freedom), (q, lags)| (sum + q, freedom + lags));
        (sum - freedom) / f64::sqrt(2.0 * freedom)
    });
    z_scores.fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the Ljung-Box statistic Q = n (n + 2) sum of r_k^2 / (n - k), and the number of lags k.
fn ljung_box(residual: &[f64]) -> (f64, f64) {
    let count = residual.len() as f64;
    let lags = lag_count(residual.len());
    let sum: f64 = autocorrelations(residual, lags + 1)
        .enumerate()
        .map(|(index, correlation)| correlation * correlation / (count - index as f64 - 1.0))
        .sum();
    (count * (count + 2.0) * sum, lags as f64)
}
