//! Where a velocity slides along with its command, without oscillating.

use std::ops::Range;

use super::critical_velocity::{REST, swings};

/// The windows of a run in which the velocity slides steadily: less the command it swings by no more than a threshold,
/// peak to peak, and its mean is within a tenth of the mean command. Standing still is not sliding.
pub(super) struct Steadiness {
    /// Whether the window that begins at each sample is steady.
    steady: Vec<bool>,
    /// How many windows in a row are steady from each sample on, one beginning at each sample.
    lasting: Vec<usize>,
    /// Samples in a window.
    span: usize,
}

/// The mean velocity of a steady window is off the mean command by less than this share of it.
const FOLLOWS: f64 = 0.1;

impl Steadiness {
    pub fn new(command: &[f64], velocity: &[f64], span: usize, threshold: f64) -> Self {
        let off: Vec<f64> = velocity.iter().zip(command).map(|(actual, wanted)| actual - wanted).collect();
        let follows =
            sums(&off, span).zip(sums(command, span)).map(|(off, wanted)| off.abs() < FOLLOWS * wanted.abs());
        let calm = swings(&off, span).map(|swing| swing <= threshold);
        let steady: Vec<bool> = follows.zip(calm).map(|(follows, calm)| follows && calm).collect();
        let mut lasting = vec![0; steady.len() + 1];
        for index in (0..steady.len()).rev() {
            lasting[index] = if steady[index] { lasting[index + 1] + 1 } else { 0 };
        }
        Steadiness { steady, lasting, span }
    }

    /// Whether the window that begins at a sample is steady.
    pub fn is_steady(&self, sample: usize) -> bool {
        self.steady.get(sample) == Some(&true)
    }

    /// Where, among these samples, the velocity first is steady for four windows.
    pub fn first_rest(&self, samples: Range<usize>) -> Option<usize> {
        let rest = (REST - 1) * self.span + 1;
        let end = (samples.end + 1).saturating_sub(REST * self.span);
        (samples.start..end.min(self.steady.len())).find(|start| self.lasting[*start] >= rest)
    }
}

/// The sum of every so many values in a row.
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
    fn sliding_along_is_steady_and_standing_still_is_not() {
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
    fn sums_are_those_of_windows() {
        let values = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(sums(&values, 2).collect::<Vec<_>>(), [3.0, 6.0, 12.0]);
        assert_eq!(sums(&values, 5).count(), 0);
    }
}
