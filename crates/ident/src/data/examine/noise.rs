//! Noise estimated without a model, from differences of successive samples.
//!
//! A difference of high order removes most of a smooth curve and keeps white noise. The difference of order d, divided
//! by the square root of (2d choose d), has the standard deviation of white noise. The orders are compared. If they
//! agree, the noise is white. If the estimates decrease with the order, the noise is slow, or the curve is not smooth
//! from sample to sample. If they increase, the noise is fast.
//!
//! Steps and kinks of the curve give outliers among the differences; these are left out. Missing samples remove the
//! differences that contain them.

use crate::statistics::descriptive::{NORMAL_QUARTILE, extremes, median};

/// The orders of the differences that are compared. A chosen range; order 2 already removes a linear trend.
const ORDERS: std::ops::RangeInclusive<usize> = 2..=6;
/// The least number of differences for an estimate. A chosen limit.
const MIN_DIFFERENCES: usize = 8;

/// The noise of a column.
///
/// # Examples
///
/// ```
/// use patchcord_ident::{NoiseKind, examine};
///
/// // A slow sine that a recorder has rounded to hundredths.
/// let rounded = |value: f64| 0.01 * (value / 0.01).round();
/// let samples: Vec<f64> = (0..4000).map(|index| rounded(2.0 * (f64::from(index) / 900.0).sin())).collect();
/// let noise = examine(&samples, 1.0).noise.ok_or("enough samples")?;
/// assert_eq!(noise.kind, NoiseKind::Rounding);
/// assert!((noise.sigma - 0.01 / 12.0_f64.sqrt()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// Standard deviation, in the unit of the column. If the samples are quantised, it is at least that of rounding,
    /// quantum / sqrt(12).
    pub sigma: f64,
    /// The spectrum of the noise.
    pub kind: NoiseKind,
    /// The estimates from differences of order 2, 3, ... 6. There are fewer if there are too few samples.
    pub by_order: Vec<f64>,
}

/// The spectrum of noise, as far as differences show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum NoiseKind {
    /// White: the estimates of all orders agree, or at least those of the highest orders.
    White,
    /// The estimates decrease with the order. The noise is mostly slow, or the curve is too fast for its samples. The
    /// standard deviation is an upper limit.
    Slow,
    /// The estimates increase with the order. The noise is mostly fast, for example in a differentiated signal. The
    /// standard deviation is an upper limit.
    Fast,
    /// Less than the rounding error of the recorder. The standard deviation is that of rounding.
    Rounding,
    /// No noise is visible. The standard deviation is 0.
    Absent,
}

impl NoiseKind {
    /// Returns the word for reports and JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            NoiseKind::White => "white",
            NoiseKind::Slow => "slow",
            NoiseKind::Fast => "fast",
            NoiseKind::Rounding => "rounding",
            NoiseKind::Absent => "none",
        }
    }
}

/// Estimates the noise of evenly spaced samples; NaN is a missing sample. `quantum` is the step of which the samples
/// are multiples, if there is one. None if there are too few consecutive samples for two orders.
pub(super) fn noise(samples: &[f64], quantum: Option<f64>) -> Option<Noise> {
    let estimates: Vec<NoiseEstimate> = ORDERS.map_while(|order| NoiseEstimate::of(samples, order)).collect();
    let [.., previous, last] = estimates.as_slice() else { return None };
    let magnitude = samples.iter().copied().fold(0.0, |largest: f64, sample| largest.max(sample.abs()));
    let is_digit_noise = last.sigma <= DIGIT_NOISE_RATIO * magnitude;
    let is_curve =
        last.sigma <= MAX_CURVE_RATIO * range_of(samples) && last.sigma <= DECREASING_RATIO * previous.sigma;
    let (sigma, kind) = match white_sigma(&estimates) {
        _ if is_digit_noise || is_curve => (0.0, NoiseKind::Absent),
        Some(sigma) => (sigma, NoiseKind::White),
        None if last.sigma > previous.sigma => (last.sigma, NoiseKind::Fast),
        None => (last.sigma, NoiseKind::Slow),
    };
    let rounding = quantum.map_or(0.0, |quantum| quantum / 12f64.sqrt());
    let (sigma, kind) = if sigma < rounding { (rounding, NoiseKind::Rounding) } else { (sigma, kind) };
    Some(Noise { sigma, kind, by_order: estimates.iter().map(|estimate| estimate.sigma).collect() })
}

/// The ratio to the largest sample up to which noise is the rounding of floating-point numbers. Doubles have 16 digits,
/// and differences of high order amplify their rounding.
const DIGIT_NOISE_RATIO: f64 = 1e-13;
/// The ratio to the range of the samples up to which the highest differences are a remainder of the curve, if the
/// estimates still decrease with the order. A chosen limit.
const MAX_CURVE_RATIO: f64 = 1e-5;
/// The ratio of the last estimate to the one before, up to which the estimates still decrease. A chosen limit.
const DECREASING_RATIO: f64 = 0.7;
/// The least factor by which the variance that a curve contributes decreases with each order. With six samples per
/// period the factor is 3.3 to 3.7 for orders 2 to 6; the curve contributes (4 sin^2(pi/6))^d / (2d choose d). If the
/// noise is not white, the decrease is slower.
const MIN_CURVE_DECREASE: f64 = 3.0;

/// Returns the standard deviation of white noise. None if the noise is not white.
///
/// The noise is white if the estimates of all orders agree with that of the highest order. It is also white if only
/// those from some order on agree, provided that the excess of the lower orders decreases as that of a curve does. Of
/// the estimates that agree, the second is returned, because it contains less of the curve than the first.
fn white_sigma(estimates: &[NoiseEstimate]) -> Option<f64> {
    let (last, lower) = estimates.split_last()?;
    let disagrees = |estimate: &NoiseEstimate| !estimate.agrees_with(last);
    let first = lower.iter().rposition(disagrees).map_or(0, |index| index + 1);
    let excess = |estimate: &NoiseEstimate| estimate.sigma * estimate.sigma - last.sigma * last.sigma;
    let is_curve_below =
        first == 0 || excess(&estimates[first - 1]) >= MIN_CURVE_DECREASE * excess(&estimates[first]).abs();
    (first < lower.len() && is_curve_below).then(|| estimates[first + 1].sigma)
}

/// Returns the difference between the largest and the smallest sample.
fn range_of(samples: &[f64]) -> f64 {
    let [minimum, maximum] = extremes(samples.iter().copied());
    maximum - minimum
}

/// The standard deviation of noise estimated from differences of one order.
struct NoiseEstimate {
    order: usize,
    sigma: f64,
    /// The number of differences used.
    count: f64,
}

impl NoiseEstimate {
    /// Estimates the noise from differences of an order. None if there are too few.
    fn of(samples: &[f64], order: usize) -> Option<NoiseEstimate> {
        let weights = difference_weights(order);
        let difference =
            |window: &[f64]| window.iter().zip(&weights).map(|(sample, weight)| sample * weight).sum::<f64>();
        let differences: Vec<f64> = samples.windows(order + 1).map(difference).collect();
        let count = differences.iter().filter(|value| !value.is_nan()).count();
        let estimate = || {
            let (sigma, count) = robust_deviation(&differences, order);
            NoiseEstimate { order, sigma, count }
        };
        (count >= MIN_DIFFERENCES).then(estimate)
    }

    /// Whether both estimates are consistent with the same white noise.
    ///
    /// Both use the same samples, so their errors are correlated. Let p(a, b) be the sum of the products of the
    /// correlations of the differences of orders a and b:
    /// p(a, b) = (2(a+b) choose a+b) / ((2a choose a) (2b choose b)).
    ///
    /// For white noise, the ratio of the two estimates then has the variance (p(a, a) + p(b, b) - 2 p(a, b)) / (2 n),
    /// with n differences.
    fn agrees_with(&self, other: &NoiseEstimate) -> bool {
        let products =
            |a: usize, b: usize| central_binomial(a + b) / (central_binomial(a) * central_binomial(b));
        let (a, b) = (self.order, other.order);
        let variance = products(a, a) + products(b, b) - 2.0 * products(a, b);
        let tolerance = TRIMMING_TOLERANCE + AGREEMENT_Z * (0.5 * variance / other.count).sqrt();
        (self.sigma - other.sigma).abs() <= tolerance * other.sigma
    }
}

/// Estimates of two orders disagree if they differ by more than this many standard deviations. A chosen limit.
const AGREEMENT_Z: f64 = 5.0;
/// The relative difference between two orders that the removal of outliers beyond four standard deviations may cause.
const TRIMMING_TOLERANCE: f64 = 0.005;

/// Returns the central binomial coefficient, 2n choose n.
fn central_binomial(n: usize) -> f64 {
    (1..=n).map(|step| (n + step) as f64 / step as f64).product()
}

/// Returns the weights of the difference of an order, with alternating signs. The sum of their squares is 1, so that
/// the difference of white noise has the standard deviation of the noise.
fn difference_weights(order: usize) -> Vec<f64> {
    let mut weights = vec![1.0];
    for step in 0..order {
        let last = weights[step];
        weights.push(-last * (order - step) as f64 / (step + 1) as f64);
    }
    let norm = weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
    weights.iter().map(|weight| weight / norm).collect()
}

/// Returns the standard deviation about 0 of normally distributed differences with outliers, and the number of
/// differences used. NaN is a missing difference.
///
/// The median of the absolute values gives a first estimate. A difference beyond four times that is an outlier: a step
/// or a kink of the curve. All differences that share a sample with an outlier are left out. If fewer than half remain,
/// only the outliers themselves are left out.
fn robust_deviation(differences: &[f64], order: usize) -> (f64, f64) {
    let sizes: Vec<f64> = differences.iter().map(|value| value.abs()).filter(|size| !size.is_nan()).collect();
    let rough_sigma = median(&sizes) / NORMAL_QUARTILE;
    let limit = if rough_sigma > 0.0 { OUTLIER_Z * rough_sigma } else { f64::INFINITY };
    let mut inliers = without_outliers(differences, limit, order);
    if inliers.len() < sizes.len() / 2 {
        inliers = sizes.into_iter().filter(|size| *size <= limit).collect();
    }
    let squares: f64 = inliers.iter().map(|value| value * value).sum();
    let count = inliers.len() as f64;
    ((squares / count).sqrt() / TRIMMED_NORMAL_RMS, count)
}

/// A difference beyond this many standard deviations is an outlier. A chosen limit.
const OUTLIER_Z: f64 = 4.0;
/// The rms of a standard normal variable truncated at four standard deviations, by integration of its density.
const TRIMMED_NORMAL_RMS: f64 = 0.999_465;

/// Returns the differences that have no sample in common with a difference beyond the limit. A difference of an order
/// contains order + 1 samples.
fn without_outliers(differences: &[f64], limit: f64, order: usize) -> Vec<f64> {
    let mut is_excluded = vec![false; differences.len()];
    for index in (0..differences.len()).filter(|index| differences[*index].abs() > limit) {
        let end = (index + order + 1).min(differences.len());
        is_excluded[index.saturating_sub(order)..end].fill(true);
    }
    let inliers =
        differences.iter().zip(is_excluded).filter(|(value, is_excluded)| !is_excluded && !value.is_nan());
    inliers.map(|(value, _)| *value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rng::standard_normal;

    /// A smooth curve with kinks and a step; its fastest period has 60 samples.
    fn curve(count: usize) -> Vec<f64> {
        let value = |index: usize| {
            let time = index as f64;
            let smooth = 3.0 * libm::sin(time / 31.0) + libm::sin(0.3 + time / 9.5);
            smooth + if index > count / 2 { 2.0 } else { 0.0 } + (time / 70.0 % 2.0 - 1.0).abs()
        };
        (0..count).map(value).collect()
    }

    fn noisy(sigma: f64, seed: u64, count: usize) -> Vec<f64> {
        curve(count)
            .iter()
            .zip(standard_normal(seed, count))
            .map(|(value, random)| value + sigma * random)
            .collect()
    }

    #[test]
    fn white_noise_on_a_curve_is_estimated_within_five_percent() {
        for (seed, sigma) in [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0].into_iter().enumerate() {
            let estimate = noise(&noisy(sigma, seed as u64, 4000), None).unwrap();
            assert_eq!(estimate.kind, NoiseKind::White, "{sigma} {estimate:?}");
            assert!((estimate.sigma / sigma - 1.0).abs() < 0.05, "{sigma} {estimate:?}");
        }
    }

    #[test]
    fn the_estimate_is_unbiased_within_two_percent_over_many_seeds() {
        let ratios: Vec<f64> =
            (0..40).map(|seed| noise(&noisy(0.01, seed, 1000), None).unwrap().sigma / 0.01).collect();
        let mean = ratios.iter().sum::<f64>() / 40.0;
        let largest_error = ratios.iter().map(|ratio| (ratio - 1.0).abs()).fold(0.0, f64::max);
        assert!((mean - 1.0).abs() < 0.02 && largest_error < 0.12, "{mean} {largest_error}");
    }

    #[test]
    fn missing_samples_are_ignored() {
        let mut samples = noisy(0.01, 3, 4000);
        samples.iter_mut().skip(5).step_by(29).for_each(|sample| *sample = f64::NAN);
        let estimate = noise(&samples, None).unwrap();
        assert!((estimate.sigma / 0.01 - 1.0).abs() < 0.05, "{estimate:?}");
        assert_eq!(noise(&[1.0, f64::NAN, 2.0].repeat(20), None), None, "no three consecutive samples");
    }

    #[test]
    fn noise_and_rounding_of_quantised_samples_add_in_squares() {
        for (step, sigma) in [(0.01, 0.01), (0.01, 0.02), (0.02, 0.01)] {
            let rounded: Vec<f64> =
                noisy(sigma, 9, 4000).iter().map(|value| step * (value / step).round()).collect();
            let estimate = noise(&rounded, Some(step)).unwrap();
            let expected = (sigma * sigma + step * step / 12.0_f64).sqrt();
            assert_eq!(estimate.kind, NoiseKind::White, "{estimate:?}");
            assert!((estimate.sigma / expected - 1.0).abs() < 0.05, "{step} {sigma} {estimate:?}");
        }
    }

    #[test]
    fn quantised_samples_without_noise_have_the_deviation_of_rounding() {
        let step = 1e-2;
        let slow: Vec<f64> = (0..4000)
            .map(|index| step * (2.0 * libm::sin(f64::from(index) / 900.0) / step).round())
            .collect();
        let estimate = noise(&slow, Some(step)).unwrap();
        assert_eq!(
            (estimate.kind, estimate.sigma),
            (NoiseKind::Rounding, step / 12f64.sqrt()),
            "{estimate:?}"
        );
    }

    #[test]
    fn smooth_curves_have_no_noise() {
        let smooth: Vec<f64> = (0..4000).map(|index| 3.0 * libm::sin(f64::from(index) / 31.0)).collect();
        let estimate = noise(&smooth, None).unwrap();
        assert_eq!((estimate.sigma, estimate.kind), (0.0, NoiseKind::Absent), "{estimate:?}");
        let straight: Vec<f64> = (0..50).map(f64::from).collect();
        assert_eq!(noise(&straight, None).unwrap().sigma, 0.0);
    }

    #[test]
    fn differentiated_noise_is_fast_and_autoregressive_noise_is_slow() {
        let white = standard_normal(4, 8001);
        let fast: Vec<f64> = white.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut slow = vec![0.0];
        white.iter().for_each(|random| slow.push(0.9 * slow[slow.len() - 1] + random));
        assert_eq!(noise(&fast, None).unwrap().kind, NoiseKind::Fast);
        assert_eq!(noise(&slow, None).unwrap().kind, NoiseKind::Slow);
    }

    #[test]
    fn too_few_samples_give_no_estimate() {
        assert_eq!(noise(&[1.0, 2.0, 1.0, 3.0], None), None);
        assert_eq!(noise(&standard_normal(1, 10), None), None);
        assert_eq!(noise(&standard_normal(1, 11), None).unwrap().by_order.len(), 2);
    }
}
