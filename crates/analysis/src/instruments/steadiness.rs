//! Detects where a velocity follows its command without oscillating.

use std::ops::Range;

use super::critical_velocity::{REST_WINDOWS, swings};

/// The windows of a run in which the velocity slides steadily.
///
/// In such a window velocity minus command varies by at most a threshold, peak to peak, and the mean velocity is within
/// a tenth of the mean command. Standstill under a moving command is not steady sliding.
pub(super) struct Steadiness {
    /// For each sample: whether the window that starts there is steady.
    steady: Vec<bool>,
    /// For each sample: the number of consecutive steady windows, one starting at each sample from here on.
    consecutive: Vec<usize>,
    /// Samples per window.
    span: usize,
}

/// The largest deviation of the mean velocity from the mean command in a steady window, as a fraction of the command.
const FOLLOWING_TOLERANCE: f64 = 0.1;

impl Steadiness {
    /// Evaluates every window of `span` samples. `threshold` is in the unit of the velocity.
    pub(super) fn new(command: &[f64], velocity: &[f64], span: usize, threshold: f64) -> Self {
        let deviation: Vec<f64> =
            velocity.iter().zip(command).map(|(actual, wanted)| actual - wanted).collect();
        let follows = sums(&deviation, span)
            .zip(sums(command, span))
            .map(|(off, wanted)| off.abs() < FOLLOWING_TOLERANCE * wanted.abs());
        let calm = swings(&deviation, span).map(|swing| swing <= threshold);
        let steady: Vec<bool> = follows.zip(calm).map(|(follows, calm)| follows && calm).collect();
        let mut consecutive = vec![0; steady.len() + 1];
        for index in (0..steady.len()).rev() {
            consecutive[index] = if steady[index] { consecutive[index + 1] + 1 } else { 0 };
        }
        Steadiness { steady, consecutive, span }
    }

    /// Whether the window that starts at a sample is steady; false if no whole window starts there.
    pub(super) fn is_steady(&self, sample: usize) -> bool {
        self.steady.get(sample) == Some(&true)
    }

    /// The first of these samples from which the velocity is steady for [`REST_WINDOWS`] windows.
    pub(super) fn first_rest(&self, samples: Range<usize>) -> Option<usize> {
        let rest = (REST_WINDOWS - 1) * self.span + 1;
        let end = (samples.end + 1).saturating_sub(REST_WINDOWS * self.span);
        (samples.start..end.min(self.steady.len())).find(|start| self.consecutive[*start] >= rest)
    }
}

/// The sum of every `span` consecutive values.
fn sums(values: &[f64], span: usize) -> impl Iterator<Item = f64> {
    let total = |sum: &mut f64, value: &f64| {
        *sum += value;
        Some(*sum)
    };
    let totals: Vec<f64> = [0.0].into_iter().chain(values.iter().scan(0.0, total)).collect();
    (span..totals.len()).map(move |end| totals[end] - totals[end - span])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn following_is_steady_and_standstill_is_not() {
        let command: Vec<f64> = (0..200).map(|index| 1.0 + 0.01 * f64::from(index)).collect();
        let steady = |actual: &dyn Fn(usize) -> f64| {
            let velocity: Vec<f64> = (0..200).map(|index| command[index] + actual(index)).collect();
            Steadiness::new(&command, &velocity, 10, 0.1)
        };
        let along = steady(&|_| 0.0);
        assert!(along.is_steady(0) && along.is_steady(190) && !along.is_steady(191));
        assert_eq!((along.first_rest(3..43), along.first_rest(3..42)), (Some(3), None));
        assert!(!steady(&|index| -command[index]).is_steady(50), "stands still");
        assert!(!steady(&|index| 0.06 * if index % 2 == 0 { 1.0 } else { -1.0 }).is_steady(50), "oscillates");
        let later = steady(&|index| if index < 60 { 1.0 } else { 0.0 });
        assert_eq!(later.first_rest(0..200), Some(60));
        assert_eq!(later.first_rest(0..99), None);
    }

    #[test]
    fn sums_match_their_windows() {
        let values = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(sums(&values, 2).collect::<Vec<_>>(), [3.0, 6.0, 12.0]);
        assert_eq!(sums(&values, 5).count(), 0);
    }
}
