//! What residuals go with: how far they correlate with what drives the patch and with what it does.

use serde_json::{Value, json};

use super::model::ModelError;
use super::score::lags;
use super::stage::{Problem, Stage};

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
    /// What chance brings at one lag in 95 of 100 cases: twice the root of the samples that the residual remembers over all samples.
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

    /// The same as a JSON document.
    pub fn document(&self) -> Value {
        let told = |own: Lagged| json!({"correlation": own.value, "lag": own.lag});
        json!({
            "output": self.output, "with": self.with, "itself": told(self.own), "size": told(self.size), "chance": self.chance,
        })
    }
}

impl Problem {
    /// How what a stage leaves in training goes with every drive and signal, for every output the strongest first.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub fn correlations(&self, stage: &Stage) -> Result<Vec<Correlation>, ModelError> {
        let (names, courses) = self.courses(stage)?;
        let of_pair = |output: usize, quantity: usize| {
            let pairs = stage.train.residuals.iter().zip(&courses);
            let tracks: Vec<Tracks<'_>> = pairs
                .zip(&self.train)
                .map(|((left, course), record)| Tracks {
                    left: &left[output],
                    with: course[quantity].clone(),
                    interval: record.interval,
                })
                .collect();
            let sizes = tracks.iter().map(|own| own.of(|value| value.abs())).collect::<Vec<_>>();
            let samples = tracks.iter().flat_map(|own| own.left).filter(|own| !own.is_nan()).count();
            Correlation {
                output: self.outputs[output].clone(),
                with: names[quantity].clone(),
                own: strongest(&tracks),
                size: strongest(&sizes),
                chance: 2.0 * (stage.memory / samples.max(1) as f64).sqrt(),
            }
        };
        let of_output = |output: usize| {
            let mut all: Vec<Correlation> =
                (0..names.len()).map(|quantity| of_pair(output, quantity)).collect();
            all.sort_by(|a, b| b.strongest().total_cmp(&a.strongest()));
            all
        };
        Ok((0..self.outputs.len()).flat_map(of_output).collect())
    }
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

    /// What is left beside the quantity so many samples before.
    fn pairs(&self, lag: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        let pairs = self.left.iter().skip(lag).zip(&self.with);
        pairs.map(|(left, with)| (*left, *with)).filter(|(left, with)| left.is_finite() && with.is_finite())
    }
}

/// The strongest correlation, over all lags up to those that are looked at for colour.
fn strongest(tracks: &[Tracks<'_>]) -> Lagged {
    let longest = tracks.iter().map(|own| own.left.len()).max().unwrap_or_default();
    let interval = tracks.first().map_or(0.0, |own| own.interval);
    let at = |lag: usize| Lagged { value: correlation(tracks, lag), lag: lag as f64 * interval };
    let stronger = |best: Lagged, own: Lagged| if own.value.abs() > best.value.abs() { own } else { best };
    (0..=lags(longest)).map(at).reduce(stronger).unwrap_or(Lagged { value: 0.0, lag: 0.0 })
}

/// The correlation over all records, 0 where either stands still.
fn correlation(tracks: &[Tracks<'_>], lag: usize) -> f64 {
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
        let still = Tracks { left: &with, with: vec![1.0; 600], interval: 0.1 };
        assert_eq!(strongest(&[still]).value, 0.0);
    }

    #[test]
    fn what_follows_only_the_size_shows_there() {
        let with: Vec<f64> = (0..900).map(|k| (0.0698131700797732 * f64::from(k)).sin()).collect();
        let left: Vec<f64> = with.iter().map(|value| value.abs()).collect();
        let tracks = Tracks { left: &left, with, interval: 0.1 };
        assert!(correlation(&[tracks.of(f64::abs)], 0) > 0.999_999);
        assert!(correlation(&[tracks], 0).abs() < 0.01);
    }
}
