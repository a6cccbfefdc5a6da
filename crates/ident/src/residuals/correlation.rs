//! What residuals go with: how far they correlate with what drives the patch and with what it does.

use crate::fit::fitted_model::Stage;
use crate::fit::model::{Course, ModelError};
use crate::fit::problem::Problem;
use crate::fit::trajectories::all_trajectories;
use crate::statistics::whiteness::{autocorrelations, lags};
use patchcord_analysis::spare;

/// How a residual goes with a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// The output whose residual it is.
    pub output: String,
    /// The drive or signal, as the patch has it.
    pub with: String,
    /// The correlation with it, -1 ... 1, where it is strongest.
    pub own: Lagged,
    /// The same with its size, whatever its sign.
    pub size: Lagged,
    /// What chance brings at most in 95 of 100 cases, at whichever lag.
    pub chance: f64,
}

/// A correlation with what was so many seconds before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lagged {
    /// -1 ... 1.
    pub value: f64,
    /// In seconds, not negative.
    pub lag: f64,
}

impl Correlation {
    /// The stronger of both, whatever its sign.
    pub fn strongest(&self) -> f64 {
        self.own.value.abs().max(self.size.value.abs())
    }
}

/// How what a stage leaves in training goes with every drive and signal, for every output the strongest first; records
/// beside which not all of these can be followed are left out.
///
/// # Errors
/// When the patch cannot be run beside the records.
pub fn correlations_of(problem: &Problem, stage: &Stage) -> Result<Vec<Correlation>, ModelError> {
    let (names, courses) = all_trajectories(problem, stage)?;
    let pairs: Vec<(usize, usize)> = (0..problem.outputs.len())
        .flat_map(|output| (0..names.len()).map(move |quantity| (output, quantity)))
        .collect();
    let mut all = spare::each(pairs.len(), |place| {
        let (output, quantity) = pairs[place];
        let tracks = tracks_of(problem, stage, &courses, output, quantity);
        let sizes: Vec<Tracks<'_>> = tracks.iter().map(|own| own.of(f64::abs)).collect();
        let correlation = Correlation {
            output: problem.outputs[output].clone(),
            with: names[quantity].clone(),
            own: strongest(&tracks),
            size: strongest(&sizes),
            chance: chance(&tracks).max(chance(&sizes)),
        };
        (output, correlation)
    });
    all.sort_by(|(one, a), (other, b)| one.cmp(other).then(b.strongest().total_cmp(&a.strongest())));
    Ok(all.into_iter().map(|(_, own)| own).collect())
}

/// What is left of an output beside a quantity, by record.
fn tracks_of<'s>(
    problem: &Problem,
    stage: &'s Stage,
    courses: &[Course],
    output: usize,
    quantity: usize,
) -> Vec<Tracks<'s>> {
    let pairs = stage.train.residuals.iter().zip(courses).zip(&problem.train);
    let tracks = pairs.filter_map(|((left, course), record)| {
        let with = course.get(quantity)?.clone();
        Some(Tracks { left: &left[output], with, interval: record.interval })
    });
    tracks.collect()
}

/// What is left of a record, and a quantity beside it.
struct Tracks<'r> {
    left: &'r [f64],
    with: Vec<f64>,
    interval: f64,
}

impl Tracks<'_> {
    fn of(&self, what: impl Fn(f64) -> f64) -> Self {
        Tracks { with: self.with.iter().map(|value| what(*value)).collect(), ..*self }
    }

    /// What is left beside the quantity so many seconds before.
    fn pairs(&self, lag: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let pairs = self.left.iter().skip((lag / self.interval).round() as usize).zip(&self.with);
        pairs.map(|(left, with)| (*left, *with)).filter(|(left, with)| left.is_finite() && with.is_finite())
    }
}

/// So many lags are looked at beside none, at most.
const MOST_LAGS: usize = 64;

/// The record with the most samples, whatever the order; of several the slowest.
fn longest<'t, 'r>(tracks: &'t [Tracks<'r>]) -> Option<&'t Tracks<'r>> {
    tracks
        .iter()
        .max_by(|a, b| a.left.len().cmp(&b.left.len()).then_with(|| a.interval.total_cmp(&b.interval)))
}

/// The lags that are looked at, in seconds: evenly over those of the longest record that are looked at for colour.
fn lags_of(tracks: &[Tracks<'_>]) -> Vec<f64> {
    let Some(longest) = longest(tracks) else { return Vec::new() };
    let last = lags(longest.left.len());
    (0..=last).step_by(last.div_ceil(MOST_LAGS).max(1)).map(|lag| lag as f64 * longest.interval).collect()
}

/// The largest correlation that chance brings in 95 of 100 cases, or more of them where a record is short, with a quantity or its
/// size at any lag. Lags within what the pairs remember are one, and so are samples.
fn chance(tracks: &[Tracks<'_>]) -> f64 {
    let (lags, memory) = (lags_of(tracks), memory(tracks));
    let Some((longest, last)) = longest(tracks).zip(lags.last()) else { return 1.0 };
    let tried = 2.0 * (lags.len() as f64).min(1.0 + last / (longest.interval * memory));
    let pairs: usize = tracks.iter().map(|own| own.pairs(*last).count()).sum();
    let freedom = (pairs as f64 / memory - 2.0).max(0.0);
    let deviations = deviations(MISSED / tried);
    deviations / (deviations * deviations + freedom).sqrt()
}

/// Over how many samples pairs remember: 1 + 2 (sum of the products of the autocorrelations of both), as by M. S. Bartlett, Some
/// aspects of the time-correlation problem, Journal of the Royal Statistical Society 98 (1935) 536. What is lost in chance is left
/// out.
fn memory(tracks: &[Tracks<'_>]) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for own in tracks {
        let (left, with): (Vec<f64>, Vec<f64>) = own.pairs(0.0).unzip();
        let (count, most) = (left.len() as f64, left.len() / 4);
        let products = autocorrelations(&left, most).zip(autocorrelations(&with, most));
        let told = products.map(|(left, with)| left * with).filter(|product| product.abs() > LOST / count);
        sum += count * (1.0 + 2.0 * told.sum::<f64>()).max(1.0);
        all += count;
    }
    if all > 0.0 { sum / all } else { 1.0 }
}

/// Two autocorrelations are lost in chance where either lies within two of its standard errors, so many samples' inverse root:
/// where their product is less than this over the number of samples.
const LOST: f64 = 4.0;

/// So often chance brings more.
const MISSED: f64 = 0.05;

/// Beyond how many standard deviations, to either side, so small a share of normal numbers lies.
fn deviations(share: f64) -> f64 {
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let is_beyond = libm::erfc(middle / std::f64::consts::SQRT_2) > share;
        *(if is_beyond { &mut low } else { &mut high }) = middle;
    }
    high
}

/// The strongest correlation over all lags.
fn strongest(tracks: &[Tracks<'_>]) -> Lagged {
    let at = |lag: f64| Lagged { value: correlation(tracks, lag), lag };
    let stronger = |best: Lagged, own: Lagged| if own.value.abs() > best.value.abs() { own } else { best };
    lags_of(tracks).into_iter().map(at).reduce(stronger).unwrap_or(Lagged { value: 0.0, lag: 0.0 })
}

/// The correlation over all records, 0 where either stands still.
fn correlation(tracks: &[Tracks<'_>], lag: f64) -> f64 {
    let pairs = || tracks.iter().flat_map(move |own| own.pairs(lag));
    let (count, sums) =
        pairs().fold((0.0, [0.0; 2]), |(count, [left, with]), (a, b)| (count + 1.0, [left + a, with + b]));
    let means = sums.map(|sum: f64| sum / f64::max(count, 1.0));
    let [both, left, with] = pairs().fold([0.0; 3], |[both, left, with], (a, b)| {
        let (a, b) = (a - means[0], b - means[1]);
        [both + a * b, left + a * a, with + b * b]
    });
    let size = (left * with).sqrt();
    if size > 0.0 { both / size } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rng::normal;

    #[test]
    fn what_follows_a_quantity_is_found_at_its_lag() {
        let with: Vec<f64> = (0..600).map(|k| (0.05 * f64::from(k * k % 997)).sin()).collect();
        let late = |lag: usize, gain: f64| -> Vec<f64> {
            (0..600).map(|k: usize| if k < lag { f64::NAN } else { 3.0 + gain * with[k - lag] }).collect()
        };
        for (lag, gain) in [(0, 2.0), (7, -0.1)] {
            let left = late(lag, gain);
            let found = strongest(&[Tracks { left: &left, with: with.clone(), interval: 0.1 }]);
            assert!(
                (found.value - gain.signum()).abs() < 1e-9 && (found.lag - 0.1 * lag as f64).abs() < 1e-12
            );
        }
        assert!((deviations(0.05) - 1.959_964).abs() < 1e-6);
        // Records with other intervals have their own lags.
        let (left, slow) = (late(6, 1.0), late(3, 1.0));
        let tracks = [(&left, 0.1), (&slow, 0.2)];
        let tracks = tracks.map(|(left, interval)| Tracks { left, with: with.clone(), interval });
        let found = strongest(&tracks);
        assert!((found.value - 1.0).abs() < 1e-9 && (found.lag - 0.6).abs() < 1e-12, "{found:?}");
        assert_eq!(strongest(&[]).value, 0.0);
        let still = Tracks { left: &with, with: vec![1.0; 600], interval: 0.1 };
        assert_eq!(strongest(&[still]).value, 0.0);
    }

    #[test]
    fn white_noise_goes_with_another_by_more_than_chance_in_one_of_twenty_cases() {
        for (samples, expected) in [(40, 0..=24), (100, 0..=24), (500, 8..=32)] {
            let is_beyond = |seed: &u64| {
                let left = normal(*seed, samples);
                let own = [Tracks { left: &left, with: normal(1000 + seed, samples), interval: 0.1 }];
                let size = [own[0].of(f64::abs)];
                let most = chance(&own).max(chance(&size));
                strongest(&own).value.abs().max(strongest(&size).value.abs()) > most
            };
            let beyond = (0..400).filter(is_beyond).count();
            assert!(expected.contains(&beyond), "{samples} samples: {beyond} of 400");
        }
    }

    #[test]
    #[ignore = "takes several seconds"]
    fn what_chance_brings_does_not_go_by_the_order_of_records() {
        let told = |records: [(u64, usize, f64); 2]| {
            let noise =
                records.map(|(seed, samples, _)| [normal(seed, samples), normal(1000 + seed, samples)]);
            let tracks = noise.iter().zip(records).map(|([left, with], (_, _, interval))| Tracks {
                left,
                with: with.clone(),
                interval,
            });
            chance(&tracks.collect::<Vec<_>>())
        };
        let (few, many) = ((1, 400, 1.0), (2, 40_000, 0.01));
        let [one, other] = [told([few, many]), told([many, few])];
        assert!((one - other).abs() < 1e-12, "{one} {other}");
    }

    /// Noise that remembers for so many samples.
    fn slow(seed: u64, samples: usize, time: f64) -> Vec<f64> {
        let keeps = libm::exp(-1.0 / time);
        let next = |now: &mut f64, own: f64| {
            *now = keeps * *now + own;
            Some(*now)
        };
        normal(seed, samples + 1000).into_iter().scan(0.0, next).skip(1000).collect()
    }

    #[test]
    #[ignore = "takes several seconds"]
    fn slow_noise_goes_with_another_by_no_more_than_chance_and_shows_what_it_follows() {
        for (one, other) in [(30.0, 30.0), (100.0, 3.0), (3.0, 100.0)] {
            let (mut beyond, mut found) = (0, 0);
            for seed in 0..200 {
                let [left, with] =
                    [(seed, one), (1000 + seed, other)].map(|(seed, time)| slow(seed, 2000, time));
                let sigma = |own: &[f64]| (own.iter().map(|own| own * own).sum::<f64>() / 2000.0).sqrt();
                let share = sigma(&left) / sigma(&with);
                let follows: Vec<f64> =
                    left.iter().zip(&with).map(|(own, with)| own + 2.0 * share * with).collect();
                let is_beyond = |left: &[f64]| {
                    let tracks = [Tracks { left, with: with.clone(), interval: 0.1 }];
                    let sizes = [tracks[0].of(f64::abs)];
                    let most = chance(&tracks).max(chance(&sizes));
                    strongest(&tracks).value.abs().max(strongest(&sizes).value.abs()) > most
                };
                beyond += usize::from(is_beyond(&left));
                found += usize::from(is_beyond(&follows));
            }
            assert!(beyond <= 20 && found >= 190, "{one} and {other}: {beyond} beyond, {found} found");
        }
    }

    #[test]
    fn what_follows_only_the_size_shows_there() {
        let with: Vec<f64> = (0..900).map(|k| (0.0698131700797732 * f64::from(k)).sin()).collect();
        let left: Vec<f64> = with.iter().map(|value| value.abs()).collect();
        let tracks = Tracks { left: &left, with, interval: 0.1 };
        assert!(correlation(&[tracks.of(f64::abs)], 0.0) > 0.999_999);
        assert!(correlation(&[tracks], 0.0).abs() < 0.01);
    }
}
