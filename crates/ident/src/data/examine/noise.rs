//! Noise estimated without a model.
//!
//! Differences of high order leave of a smooth curve next to nothing, and of white noise all: the difference of order d, divided by
//! the square root of (2d choose d), has the standard deviation of the noise. Where orders agree there is white noise of that
//! size; where they go on falling, the curve is not smooth from sample to sample or the noise is mostly slow; where they rise, it is mostly fast.

use crate::statistics::descriptive::{HALF_WITHIN, ends, median};

/// The orders that are compared.
const ORDERS: std::ops::RangeInclusive<usize> = 2..=6;
/// Differences that are at least needed of an order.
const LEAST: usize = 8;

/// The noise of a column.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// Standard deviation, in the unit of the column. Of samples rounded to a step it is no less than that of rounding, step / sqrt(12).
    pub sigma: f64,
    /// What can be said of it.
    pub kind: NoiseKind,
    /// The estimates from differences of order 2, 3, ... 6, as far as there are samples for them.
    pub by_order: Vec<f64>,
}

/// What can be said of noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseKind {
    /// White: all orders from some one on agree.
    White,
    /// Less with every order: it is mostly slow, or the curve moves too fast for its samples, and what is told is too much.
    Slow,
    /// More with every order: it is mostly fast, as of a reading that was differentiated, and what is told is too much.
    Fast,
    /// Less than rounding to the recorder's step.
    Rounding,
    /// None to be seen.
    None,
}

impl NoiseKind {
    /// The word for it.
    pub fn as_str(self) -> &'static str {
        match self {
            NoiseKind::White => "white",
            NoiseKind::Slow => "slow",
            NoiseKind::Fast => "fast",
            NoiseKind::Rounding => "rounding",
            NoiseKind::None => "none",
        }
    }
}

/// Noise on evenly spaced samples, NaN where one is missing, that are multiples of `quantum` if there is one. `None` where there
/// are too few.
pub(super) fn noise(samples: &[f64], quantum: Option<f64>) -> Option<Noise> {
    let estimates: Vec<Estimate> = ORDERS.map_while(|order| Estimate::of(samples, order)).collect();
    let [.., before, last] = estimates.as_slice() else { return None };
    let largest = samples.iter().copied().fold(0.0, |largest: f64, sample| largest.max(sample.abs()));
    let is_rounding = last.sigma <= DIGITS * largest;
    let is_curve = last.sigma <= SEEN * span(samples) && last.sigma <= FALLING * before.sigma;
    let (sigma, kind) = match white(&estimates) {
        _ if is_rounding || is_curve => (0.0, NoiseKind::None),
        Some(sigma) => (sigma, NoiseKind::White),
        None if last.sigma > before.sigma => (last.sigma, NoiseKind::Fast),
        None => (last.sigma, NoiseKind::Slow),
    };
    let rounding = quantum.map_or(0.0, |quantum| quantum / 12f64.sqrt());
    let (sigma, kind) = if sigma < rounding { (rounding, NoiseKind::Rounding) } else { (sigma, kind) };
    Some(Noise { sigma, kind, by_order: estimates.iter().map(|estimate| estimate.sigma).collect() })
}

/// Noise below this share of the largest sample is that of the digits of numbers.
const DIGITS: f64 = 1e-13;
/// Differences of the highest order below this share of the range are what is left of the curve, if they still fall.
const SEEN: f64 = 1e-5;
/// What falls like this from order to order still falls.
const FALLING: f64 = 0.7;
/// What differences of an order have of a curve with six samples a period, in variance, is less by this with the next. Of noise that is
/// not white it falls more slowly.
const OF_CURVE: f64 = 3.0;

/// The deviation of white noise, if all orders agree with the highest, or all from some one on and those before have too much as a
/// curve leaves it. Of those that agree the second is told: it has less of the curve than the first.
fn white(estimates: &[Estimate]) -> Option<f64> {
    let (last, before) = estimates.split_last()?;
    let disagrees = |estimate: &Estimate| !estimate.agrees_with(last);
    let first = before.iter().rposition(disagrees).map_or(0, |place| place + 1);
    let excess = |estimate: &Estimate| estimate.sigma * estimate.sigma - last.sigma * last.sigma;
    let of_curve = first == 0 || excess(&estimates[first - 1]) >= OF_CURVE * excess(&estimates[first]).abs();
    (first < before.len() && of_curve).then(|| estimates[first + 1].sigma)
}

fn span(samples: &[f64]) -> f64 {
    let [least, most] = ends(samples.iter().copied());
    most - least
}

/// What differences of one order say.
struct Estimate {
    order: usize,
    sigma: f64,
    /// How many it is made of.
    count: f64,
}

impl Estimate {
    fn of(samples: &[f64], order: usize) -> Option<Estimate> {
        let weights = weights(order);
        let difference =
            |window: &[f64]| window.iter().zip(&weights).map(|(sample, weight)| sample * weight).sum::<f64>();
        let differences: Vec<f64> = samples.windows(order + 1).map(difference).collect();
        let count = differences.iter().filter(|value| !value.is_nan()).count();
        let estimate = || {
            let (sigma, count) = deviation(&differences, order);
            Estimate { order, sigma, count }
        };
        (count >= LEAST).then(estimate)
    }

    /// Whether both may see the same white noise. They are made of the same samples: of white noise their ratio has a deviation that
    /// follows from the products of their correlations, summed up.
    fn agrees_with(&self, other: &Estimate) -> bool {
        let products = |a: usize, b: usize| middle(a + b) / (middle(a) * middle(b));
        let (a, b) = (self.order, other.order);
        let variance = products(a, a) + products(b, b) - 2.0 * products(a, b);
        let allowed = TRIMMED + DEVIATIONS * (0.5 * variance / other.count).sqrt();
        (self.sigma - other.sigma).abs() <= allowed * other.sigma
    }
}

/// Estimates that lie further apart than so many deviations disagree.
const DEVIATIONS: f64 = 5.0;
/// By so much they may disagree for what is left out beyond four deviations.
const TRIMMED: f64 = 0.005;

/// 2 n choose n.
fn middle(n: usize) -> f64 {
    (1..=n).map(|step| (n + step) as f64 / step as f64).product()
}

/// The weights of a difference, so that white noise keeps its deviation.
fn weights(order: usize) -> Vec<f64> {
    let mut weights = vec![1.0];
    for step in 0..order {
        let last = weights[step];
        weights.push(-last * (order - step) as f64 / (step + 1) as f64);
    }
    let size = weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
    weights.iter().map(|weight| weight / size).collect()
}

/// Standard deviation about 0 of differences that are normal but for some that lie on a step or a kink of the curve: the root mean
/// square of those that do not overlap one beyond four deviations by the median, and how many these are. NaN stands for one that is
/// missing.
fn deviation(differences: &[f64], order: usize) -> (f64, f64) {
    let sizes: Vec<f64> = differences.iter().map(|value| value.abs()).filter(|size| !size.is_nan()).collect();
    let rough = median(&sizes) / HALF_WITHIN;
    let limit = if rough > 0.0 { BEYOND * rough } else { f64::INFINITY };
    let mut left = without_neighbours(differences, limit, order);
    if left.len() < sizes.len() / 2 {
        left = sizes.into_iter().filter(|size| *size <= limit).collect();
    }
    let squares: f64 = left.iter().map(|value| value * value).sum();
    let count = left.len() as f64;
    ((squares / count).sqrt() / OF_CUT, count)
}

/// What lies beyond so many deviations is no noise.
const BEYOND: f64 = 4.0;
/// Of normal numbers cut there this is the root mean square.
const OF_CUT: f64 = 0.999_465;

/// Those of some differences within a limit that have no sample in common with one beyond it.
fn without_neighbours(differences: &[f64], limit: f64, order: usize) -> Vec<f64> {
    let mut is_near = vec![false; differences.len()];
    for place in (0..differences.len()).filter(|place| differences[*place].abs() > limit) {
        let end = (place + order + 1).min(differences.len());
        is_near[place.saturating_sub(order)..end].fill(true);
    }
    let left = differences.iter().zip(is_near).filter(|(value, is_near)| !is_near && !value.is_nan());
    left.map(|(value, _)| *value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rng::normal;

    /// A smooth curve with kinks and a step, 60 samples to its fastest period.
    fn curve(count: usize) -> Vec<f64> {
        let value = |place: usize| {
            let time = place as f64;
            let smooth = 3.0 * libm::sin(time / 31.0) + libm::sin(0.3 + time / 9.5);
            smooth + if place > count / 2 { 2.0 } else { 0.0 } + (time / 70.0 % 2.0 - 1.0).abs()
        };
        (0..count).map(value).collect()
    }

    fn noisy(sigma: f64, seed: u64, count: usize) -> Vec<f64> {
        curve(count).iter().zip(normal(seed, count)).map(|(value, dice)| value + sigma * dice).collect()
    }

    #[test]
    fn white_noise_on_a_curve_is_found_to_a_twentieth() {
        for (seed, sigma) in [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0].into_iter().enumerate() {
            let found = noise(&noisy(sigma, seed as u64, 4000), None).unwrap();
            assert_eq!(found.kind, NoiseKind::White, "{sigma} {found:?}");
            assert!((found.sigma / sigma - 1.0).abs() < 0.05, "{sigma} {found:?}");
        }
    }

    #[test]
    fn its_error_is_small_on_the_average_of_many_seeds() {
        let ratios: Vec<f64> =
            (0..40).map(|seed| noise(&noisy(0.01, seed, 1000), None).unwrap().sigma / 0.01).collect();
        let mean = ratios.iter().sum::<f64>() / 40.0;
        let most = ratios.iter().map(|ratio| (ratio - 1.0).abs()).fold(0.0, f64::max);
        assert!((mean - 1.0).abs() < 0.02 && most < 0.12, "{mean} {most}");
    }

    #[test]
    fn missing_samples_are_left_out() {
        let mut samples = noisy(0.01, 3, 4000);
        samples.iter_mut().skip(5).step_by(29).for_each(|sample| *sample = f64::NAN);
        let found = noise(&samples, None).unwrap();
        assert!((found.sigma / 0.01 - 1.0).abs() < 0.05, "{found:?}");
        assert_eq!(noise(&[1.0, f64::NAN, 2.0].repeat(20), None), None, "no three in a row");
    }

    #[test]
    fn of_rounded_samples_noise_and_rounding_are_told_together() {
        for (step, sigma) in [(0.01, 0.01), (0.01, 0.02), (0.02, 0.01)] {
            let rounded: Vec<f64> =
                noisy(sigma, 9, 4000).iter().map(|value| step * (value / step).round()).collect();
            let found = noise(&rounded, Some(step)).unwrap();
            let together = (sigma * sigma + step * step / 12.0_f64).sqrt();
            assert_eq!(found.kind, NoiseKind::White, "{found:?}");
            assert!((found.sigma / together - 1.0).abs() < 0.05, "{step} {sigma} {found:?}");
        }
    }

    #[test]
    fn where_nothing_but_rounding_is_seen_its_deviation_is_told() {
        let step = 1e-2;
        let slow: Vec<f64> = (0..4000)
            .map(|place| step * (2.0 * libm::sin(f64::from(place) / 900.0) / step).round())
            .collect();
        let found = noise(&slow, Some(step)).unwrap();
        assert_eq!((found.kind, found.sigma), (NoiseKind::Rounding, step / 12f64.sqrt()), "{found:?}");
    }

    #[test]
    fn without_noise_none_is_told() {
        let smooth: Vec<f64> = (0..4000).map(|place| 3.0 * libm::sin(f64::from(place) / 31.0)).collect();
        let found = noise(&smooth, None).unwrap();
        assert_eq!((found.sigma, found.kind), (0.0, NoiseKind::None), "{found:?}");
        let straight: Vec<f64> = (0..50).map(f64::from).collect();
        assert_eq!(noise(&straight, None).unwrap().sigma, 0.0);
    }

    #[test]
    fn noise_that_is_not_white_is_told_so() {
        let white = normal(4, 8001);
        let fast: Vec<f64> = white.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut slow = vec![0.0];
        white.iter().for_each(|dice| slow.push(0.9 * slow[slow.len() - 1] + dice));
        assert_eq!(noise(&fast, None).unwrap().kind, NoiseKind::Fast);
        assert_eq!(noise(&slow, None).unwrap().kind, NoiseKind::Slow);
    }

    #[test]
    fn too_few_samples_say_nothing() {
        assert_eq!(noise(&[1.0, 2.0, 1.0, 3.0], None), None);
        assert_eq!(noise(&normal(1, 10), None), None);
        assert_eq!(noise(&normal(1, 11), None).unwrap().by_order.len(), 2);
    }
}
