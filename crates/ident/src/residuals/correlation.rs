//! Correlations of the residuals with every drive and signal, at several lags.
//!
//! A correlation hints at the cause of a residual: a residual that follows the magnitude of a speed, for example, looks
//! like friction. Each correlation is reported with the limit that chance exceeds in 5 % of the cases. The limit takes
//! account of the number of lags and of the autocorrelation of both quantities.

use crate::fit::fitted_model::FittedModel;
use crate::fit::model::{ModelError, OutputTrajectory};
use crate::fit::problem::Problem;
use crate::fit::trajectories::all_trajectories;
use crate::statistics::whiteness::{autocorrelations, lag_count};
use patchcord_analysis::parallel;

/// The correlation of the residual of an output with a drive or signal.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Name of the output.
    pub output: String,
    /// Name of the drive or signal.
    pub quantity: String,
    /// The correlation with the quantity, at the lag where it is strongest.
    pub signed: LaggedCorrelation,
    /// The correlation with the magnitude of the quantity, at the lag where it is strongest.
    pub magnitude: LaggedCorrelation,
    /// The 95 % limit of chance for the stronger of both, over all lags. From 0 to 1.
    pub chance_limit: f64,
}

/// A correlation of a residual with an earlier value of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaggedCorrelation {
    /// The correlation coefficient, from -1 to 1.
    pub value: f64,
    /// How much earlier the quantity is, in seconds. Not negative.
    pub lag: f64,
}

impl Correlation {
    /// The magnitude of the stronger of both correlations, from 0 to 1.
    pub fn strongest(&self) -> f64 {
        self.signed.value.abs().max(self.magnitude.value.abs())
    }
}

/// The correlations of the training residuals with every drive and signal: output by output, the strongest first.
/// Records along which the signals cannot be computed are left out.
///
/// # Errors
/// If the patch cannot be run along the records.
pub fn residual_correlations(
    problem: &Problem,
    fitted: &FittedModel,
) -> Result<Vec<Correlation>, ModelError> {
    let (names, trajectories) = all_trajectories(problem, fitted)?;
    let pairs: Vec<(usize, usize)> = (0..problem.outputs.len())
        .flat_map(|output| (0..names.len()).map(move |quantity| (output, quantity)))
        .collect();
    let mut all = parallel::map_indices(pairs.len(), |index| {
        let (output, quantity) = pairs[index];
        let signed = pair_tracks(problem, fitted, &trajectories, output, quantity);
        let magnitudes: Vec<TrackPair<'_>> = signed.iter().map(|pair| pair.map_quantity(f64::abs)).collect();
        let correlation = Correlation {
            output: problem.outputs[output].clone(),
            quantity: names[quantity].clone(),
            signed: strongest(&signed),
            magnitude: strongest(&magnitudes),
            chance_limit: chance_limit(&signed).max(chance_limit(&magnitudes)),
        };
        (output, correlation)
    });
    all.sort_by(|(output_a, a), (output_b, b)| {
        output_a.cmp(output_b).then(b.strongest().total_cmp(&a.strongest()))
    });
    Ok(all.into_iter().map(|(_, correlation)| correlation).collect())
}

/// The residual of an output and the trajectory of a quantity, record by record.
fn pair_tracks<'s>(
    problem: &Problem,
    fitted: &'s FittedModel,
    trajectories: &[OutputTrajectory],
    output: usize,
    quantity: usize,
) -> Vec<TrackPair<'s>> {
    let records = fitted.train.residuals.iter().zip(trajectories).zip(&problem.train);
    let pairs = records.filter_map(|((residuals, trajectory), record)| {
        let quantity = trajectory.get(quantity)?.clone();
        Some(TrackPair { residual: &residuals[output], quantity, interval: record.interval })
    });
    pairs.collect()
}

/// The residual of an output and a quantity in one record, sampled at the same times.
struct TrackPair<'r> {
    /// The residual, in units of sigma. NaN if the datum is missing.
    residual: &'r [f64],
    /// The quantity, in its unit.
    quantity: Vec<f64>,
    /// The sampling interval, in seconds.
    interval: f64,
}

impl TrackPair<'_> {
    /// The same pair with a function applied to the quantity.
    fn map_quantity(&self, function: impl Fn(f64) -> f64) -> Self {
        TrackPair { quantity: self.quantity.iter().map(|value| function(*value)).collect(), ..*self }
    }

    /// Pairs of the residual and the quantity `lag` seconds earlier, without missing values. The lag is rounded to
    /// whole samples.
    fn lagged(&self, lag: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let pairs = self.residual.iter().skip((lag / self.interval).round() as usize).zip(&self.quantity);
        pairs
            .map(|(residual, quantity)| (*residual, *quantity))
            .filter(|(residual, quantity)| residual.is_finite() && quantity.is_finite())
    }
}

/// The largest number of lags, in addition to zero.
const MAX_LAGS: usize = 64;

/// The record with the most samples; of several that with the longest interval. It does not depend on the order of the
/// records.
fn longest<'t, 'r>(tracks: &'t [TrackPair<'r>]) -> Option<&'t TrackPair<'r>> {
    tracks.iter().max_by(|a, b| {
        a.residual.len().cmp(&b.residual.len()).then_with(|| a.interval.total_cmp(&b.interval))
    })
}

/// The lags at which correlations are computed, in seconds. They are evenly distributed from zero to the last lag of
/// the whiteness test for the longest record.
fn lags_of(tracks: &[TrackPair<'_>]) -> Vec<f64> {
    let Some(longest) = longest(tracks) else { return Vec::new() };
    let last = lag_count(longest.residual.len());
    (0..=last).step_by(last.div_ceil(MAX_LAGS).max(1)).map(|lag| lag as f64 * longest.interval).collect()
}

/// The correlation that chance exceeds in at most 5 % of the cases, at any lag, with the quantity or its magnitude.
///
/// It is that of Student's t with Bonferroni's correction for the number of independent lags. Lags nearer to each other
/// than the autocorrelation time are not independent, and neither are samples.
fn chance_limit(tracks: &[TrackPair<'_>]) -> f64 {
    let (lags, autocorrelation_time) = (lags_of(tracks), autocorrelation_time(tracks));
    let Some((longest, last)) = longest(tracks).zip(lags.last()) else { return 1.0 };
    let tests = 2.0 * (lags.len() as f64).min(1.0 + last / (longest.interval * autocorrelation_time));
    let samples: usize = tracks.iter().map(|pair| pair.lagged(*last).count()).sum();
    let degrees_of_freedom = (samples as f64 / autocorrelation_time - 2.0).max(0.0);
    let deviations = normal_quantile(SIGNIFICANCE / tests);
    deviations / (deviations * deviations + degrees_of_freedom).sqrt()
}

/// The autocorrelation time of the product of residual and quantity, in samples; the mean over all records.
///
/// It is 1 + 2 * (sum of the products of both autocorrelations), after M. S. Bartlett, Some aspects of the
/// time-correlation problem, Journal of the Royal Statistical Society 98 (1935) 536. Insignificant products are left
/// out.
fn autocorrelation_time(tracks: &[TrackPair<'_>]) -> f64 {
    let (mut sum, mut samples) = (0.0, 0.0);
    for pair in tracks {
        let (residual, quantity): (Vec<f64>, Vec<f64>) = pair.lagged(0.0).unzip();
        let (count, max_lag) = (residual.len() as f64, residual.len() / 4);
        let products = autocorrelations(&residual, max_lag).zip(autocorrelations(&quantity, max_lag));
        let significant = products
            .map(|(residual, quantity)| residual * quantity)
            .filter(|product| product.abs() > INSIGNIFICANT_PRODUCT / count);
        sum += count * (1.0 + 2.0 * significant.sum::<f64>()).max(1.0);
        samples += count;
    }
    if samples > 0.0 { sum / samples } else { 1.0 }
}

/// A product of two autocorrelations is insignificant below this number divided by the number of samples. Each
/// autocorrelation has the standard error 1 / sqrt(samples); the number is the square of two standard errors.
const INSIGNIFICANT_PRODUCT: f64 = 4.0;

/// The probability that chance exceeds the limit at any lag: the usual level of 5 %.
const SIGNIFICANCE: f64 = 0.05;

/// The number of standard deviations that a normal number exceeds, to either side, with this probability. By bisection.
fn normal_quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let is_too_low = libm::erfc(middle / std::f64::consts::SQRT_2) > probability;
        *(if is_too_low { &mut low } else { &mut high }) = middle;
    }
    high
}

/// The correlation with the largest magnitude over all lags.
fn strongest(tracks: &[TrackPair<'_>]) -> LaggedCorrelation {
    let at_lag = |lag: f64| LaggedCorrelation { value: correlation(tracks, lag), lag };
    let stronger = |best: LaggedCorrelation, next: LaggedCorrelation| {
        if next.value.abs() > best.value.abs() { next } else { best }
    };
    lags_of(tracks)
        .into_iter()
        .map(at_lag)
        .reduce(stronger)
        .unwrap_or(LaggedCorrelation { value: 0.0, lag: 0.0 })
}

/// The correlation coefficient over all records at one lag. 0 if the residual or the quantity is constant.
fn correlation(tracks: &[TrackPair<'_>], lag: f64) -> f64 {
    let pairs = || tracks.iter().flat_map(move |pair| pair.lagged(lag));
    let (count, sums) = pairs().fold((0.0, [0.0; 2]), |(count, [residual, quantity]), (a, b)| {
        (count + 1.0, [residual + a, quantity + b])
    });
    let means = sums.map(|sum: f64| sum / f64::max(count, 1.0));
    let [product, residual, quantity] = pairs().fold([0.0; 3], |[product, residual, quantity], (a, b)| {
        let (a, b) = (a - means[0], b - means[1]);
        [product + a * b, residual + a * a, quantity + b * b]
    });
    let scale = (residual * quantity).sqrt();
    if scale > 0.0 { product / scale } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rng::standard_normal;

    #[test]
    fn a_delayed_copy_of_a_quantity_correlates_at_its_delay() {
        let quantity: Vec<f64> = (0..600).map(|k| (0.05 * f64::from(k * k % 997)).sin()).collect();
        let delayed = |lag: usize, gain: f64| -> Vec<f64> {
            (0..600).map(|k: usize| if k < lag { f64::NAN } else { 3.0 + gain * quantity[k - lag] }).collect()
        };
        for (lag, gain) in [(0, 2.0), (7, -0.1)] {
            let residual = delayed(lag, gain);
            let strongest_correlation =
                strongest(&[TrackPair { residual: &residual, quantity: quantity.clone(), interval: 0.1 }]);
            assert!(
                (strongest_correlation.value - gain.signum()).abs() < 1e-9
                    && (strongest_correlation.lag - 0.1 * lag as f64).abs() < 1e-12
            );
        }
        assert!((normal_quantile(0.05) - 1.959_964).abs() < 1e-6);
        // Two records with different intervals and the same delay in seconds.
        let (fast, slow) = (delayed(6, 1.0), delayed(3, 1.0));
        let tracks = [(&fast, 0.1), (&slow, 0.2)];
        let tracks =
            tracks.map(|(residual, interval)| TrackPair { residual, quantity: quantity.clone(), interval });
        let strongest_correlation = strongest(&tracks);
        assert!(
            (strongest_correlation.value - 1.0).abs() < 1e-9
                && (strongest_correlation.lag - 0.6).abs() < 1e-12,
            "{strongest_correlation:?}"
        );
        assert_eq!(strongest(&[]).value, 0.0);
        let constant = TrackPair { residual: &quantity, quantity: vec![1.0; 600], interval: 0.1 };
        assert_eq!(strongest(&[constant]).value, 0.0);
    }

    #[test]
    fn independent_white_noise_exceeds_the_chance_limit_in_one_of_twenty_cases() {
        for (samples, expected) in [(40, 0..=24), (100, 0..=24), (500, 8..=32)] {
            let exceeds_limit = |seed: &u64| {
                let residual = standard_normal(*seed, samples);
                let signed = [TrackPair {
                    residual: &residual,
                    quantity: standard_normal(1000 + seed, samples),
                    interval: 0.1,
                }];
                let magnitudes = [signed[0].map_quantity(f64::abs)];
                let limit = chance_limit(&signed).max(chance_limit(&magnitudes));
                strongest(&signed).value.abs().max(strongest(&magnitudes).value.abs()) > limit
            };
            let exceeding = (0..400).filter(exceeds_limit).count();
            assert!(expected.contains(&exceeding), "{samples} samples: {exceeding} of 400");
        }
    }

    #[test]
    #[ignore = "takes several seconds"]
    fn the_chance_limit_does_not_depend_on_the_order_of_records() {
        let limit_of = |records: [(u64, usize, f64); 2]| {
            let noise = records.map(|(seed, samples, _)| {
                [standard_normal(seed, samples), standard_normal(1000 + seed, samples)]
            });
            let tracks = noise.iter().zip(records).map(|([residual, quantity], (_, _, interval))| {
                TrackPair { residual, quantity: quantity.clone(), interval }
            });
            chance_limit(&tracks.collect::<Vec<_>>())
        };
        let (few, many) = ((1, 400, 1.0), (2, 40_000, 0.01));
        let [few_first, many_first] = [limit_of([few, many]), limit_of([many, few])];
        assert!((few_first - many_first).abs() < 1e-12, "{few_first} {many_first}");
    }

    /// First-order autoregressive noise with a correlation time in samples.
    fn slow_noise(seed: u64, samples: usize, time: f64) -> Vec<f64> {
        let coefficient = libm::exp(-1.0 / time);
        let next = |state: &mut f64, input: f64| {
            *state = coefficient * *state + input;
            Some(*state)
        };
        standard_normal(seed, samples + 1000).into_iter().scan(0.0, next).skip(1000).collect()
    }

    #[test]
    #[ignore = "takes several seconds"]
    fn slow_noise_seldom_exceeds_the_chance_limit_and_a_dependence_does() {
        for (residual_time, quantity_time) in [(30.0, 30.0), (100.0, 3.0), (3.0, 100.0)] {
            let (mut false_alarms, mut detections) = (0, 0);
            for seed in 0..200 {
                let [residual, quantity] = [(seed, residual_time), (1000 + seed, quantity_time)]
                    .map(|(seed, time)| slow_noise(seed, 2000, time));
                let rms =
                    |track: &[f64]| (track.iter().map(|value| value * value).sum::<f64>() / 2000.0).sqrt();
                let scale = rms(&residual) / rms(&quantity);
                let dependent: Vec<f64> = residual
                    .iter()
                    .zip(&quantity)
                    .map(|(residual, quantity)| residual + 2.0 * scale * quantity)
                    .collect();
                let exceeds_limit = |residual: &[f64]| {
                    let signed = [TrackPair { residual, quantity: quantity.clone(), interval: 0.1 }];
                    let magnitudes = [signed[0].map_quantity(f64::abs)];
                    let limit = chance_limit(&signed).max(chance_limit(&magnitudes));
                    strongest(&signed).value.abs().max(strongest(&magnitudes).value.abs()) > limit
                };
                false_alarms += usize::from(exceeds_limit(&residual));
                detections += usize::from(exceeds_limit(&dependent));
            }
            assert!(
                false_alarms <= 20 && detections >= 190,
                "{residual_time} and {quantity_time}: {false_alarms} false alarms, {detections} detections"
            );
        }
    }

    #[test]
    fn a_magnitude_correlates_only_with_the_magnitude() {
        let quantity: Vec<f64> = (0..900).map(|k| (0.0698131700797732 * f64::from(k)).sin()).collect();
        let residual: Vec<f64> = quantity.iter().map(|value| value.abs()).collect();
        let pair = TrackPair { residual: &residual, quantity, interval: 0.1 };
        assert!(correlation(&[pair.map_quantity(f64::abs)], 0.0) > 0.999_999);
        assert!(correlation(&[pair], 0.0).abs() < 0.01);
    }
}
