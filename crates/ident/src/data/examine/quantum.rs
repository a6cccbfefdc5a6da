//! The quantum of a column: the step to which a recorder rounds its samples.
//!
//! The samples are sorted. If they are quantised, every gap between two different values is a multiple of the quantum.
//! The smallest gap, or a simple fraction of it, is the first guess, and the small gaps refine it.

use patchcord_expr::round_significant;

/// The ratio to the largest sample up to which two samples are equal. Such a difference is rounding of floating-point
/// numbers.
const EQUALITY_RATIO: f64 = 1e-12;
/// The least ratio of a quantum to the range of the samples. A smaller step is only the last digit of the numbers in
/// the file. A chosen limit.
const MIN_RANGE_RATIO: f64 = 1e-8;
/// The largest multiple of the quantum that is checked. The first guess is not accurate enough for larger multiples.
const MAX_MULTIPLE: f64 = 50.0;
/// The largest difference between a gap and a multiple of the quantum, in quanta. A chosen limit.
const GAP_TOLERANCE: f64 = 0.02;
/// The number of small gaps below which the gaps are weak evidence. Then all gaps must be small, and multiples of the
/// quantum within [`FEW_GAPS_TOLERANCE`]. A chosen limit.
const FEW_GAPS: usize = 8;
/// The largest difference between a gap and a multiple of the quantum, in quanta, if there are few gaps.
const FEW_GAPS_TOLERANCE: f64 = 1e-6;
/// The ratios of the smallest gap to the quantum that are tried. A chosen list: the smallest gap of a short column may
/// be several quanta.
const SMALLEST_GAP_MULTIPLES: [f64; 4] = [1.0, 2.0, 3.0, 5.0];

/// The significant digits of a quantum. A difference of samples is not more accurate.
const QUANTUM_DIGITS: usize = 9;

/// Returns the step of which all samples are multiples, apart from a common offset, to nine significant digits. None if
/// there is no such step, or if there are fewer than three different values. The samples must not be NaN.
pub(super) fn quantum(samples: &[f64]) -> Option<f64> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    let equality = EQUALITY_RATIO * first.abs().max(last.abs());
    let gaps = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > equality);
    let gaps: Vec<f64> = gaps.collect();
    let smallest_gap = gaps.iter().copied().reduce(f64::min)?;
    let step =
        SMALLEST_GAP_MULTIPLES.iter().find_map(|multiple| refined_step(&gaps, smallest_gap / multiple))?;
    (gaps.len() > 1 && step > MIN_RANGE_RATIO * (last - first))
        .then(|| round_significant(step, QUANTUM_DIGITS))
}

/// Returns a step close to `guess` of which all gaps are multiples. None if there is none. Gaps of more than
/// [`MAX_MULTIPLE`] steps are ignored. The step is the sum of the other gaps divided by the sum of their multiples.
fn refined_step(gaps: &[f64], guess: f64) -> Option<f64> {
    let small_gaps: Vec<(f64, f64)> = gaps
        .iter()
        .map(|gap| (*gap, (gap / guess).round()))
        .filter(|(_, multiple)| *multiple <= MAX_MULTIPLE)
        .collect();
    let sum = small_gaps.iter().fold((0.0, 0.0), |sum, (gap, multiple)| (sum.0 + gap, sum.1 + multiple));
    let step = sum.0 / sum.1;
    let (is_sufficient, tolerance) = match small_gaps.len() {
        count if count < FEW_GAPS => (count == gaps.len(), FEW_GAPS_TOLERANCE),
        _ => (true, GAP_TOLERANCE),
    };
    let is_multiple = |(gap, multiple): &(f64, f64)| (gap / step - multiple).abs() <= tolerance;
    (is_sufficient && small_gaps.iter().all(is_multiple)).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rng::standard_normal;

    #[test]
    fn the_quantum_of_rounded_samples_is_found() {
        for step in [5e-8, 1e-3, 0.25, 3.0] {
            for offset in [0.0, 0.37] {
                let rounded = |value: &f64| step * ((300.0 * value).round() + offset);
                let samples: Vec<f64> = standard_normal(2, 3000).iter().map(rounded).collect();
                let quantum = quantum(&samples).unwrap();
                assert!((quantum / step - 1.0).abs() < 1e-6, "{step} {offset}: {quantum}");
            }
        }
    }

    #[test]
    fn a_quantum_smaller_than_every_gap_is_found() {
        let samples: Vec<f64> = (0..40).map(|index| f64::from(index / 2 * 5 + index % 2 * 2)).collect();
        assert_eq!(quantum(&samples), Some(1.0), "gaps of 2 and 3");
        assert_eq!(quantum(&[0.0, 5.0, 10.0, 5.0, 0.0]), Some(5.0));
        let tenths: Vec<f64> = (0..40).map(|index| f64::from(index * index % 17) / 10.0).collect();
        assert_eq!(quantum(&tenths), Some(0.1), "although differences of tenths are not exact");
    }

    #[test]
    fn unrounded_samples_have_no_quantum() {
        for seed in 0..20 {
            assert_eq!(quantum(&standard_normal(seed, 500)), None);
        }
        assert_eq!(quantum(&[1.0, 1.0]), None);
        assert_eq!(quantum(&[1.0, 2.0]), None, "two values have only one gap");
    }
}
