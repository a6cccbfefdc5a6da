//! The step to which a recorder rounds.

/// Numbers nearer to each other than this share of their size are the same, but for the last digits of a sum.
const SAME: f64 = 1e-12;
/// A step below this share of the range is nothing but the digits with which numbers are written.
const LEAST: f64 = 1e-8;
/// Multiples up to this one are looked at: larger ones of a step that is known to few digits tell nothing.
const MULTIPLES: f64 = 50.0;
/// So far a gap between values may be off a multiple of the step, in steps.
const OFF: f64 = 0.02;
/// Where fewer gaps than this are looked at, these have to be all there are, and exact multiples.
const MANY: usize = 8;
/// The step may be this part of the least gap.
const PARTS: [f64; 4] = [1.0, 2.0, 3.0, 5.0];

/// The step of which all samples are multiples, apart from an offset; `None` where there is none to be seen.
pub(super) fn quantum(samples: &[f64]) -> Option<f64> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    let same = SAME * first.abs().max(last.abs());
    let gaps = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > same);
    let gaps: Vec<f64> = gaps.collect();
    let least = gaps.iter().copied().reduce(f64::min)?;
    let found = PARTS.iter().find_map(|part| step(&gaps, least / part))?;
    (gaps.len() > 1 && found > LEAST * (last - first)).then(|| in_short(found))
}

/// The number to nine digits: more are not known of differences.
fn in_short(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}

/// A step near this one of which all gaps are multiples.
fn step(gaps: &[f64], near: f64) -> Option<f64> {
    let small: Vec<(f64, f64)> = gaps
        .iter()
        .map(|gap| (*gap, (gap / near).round()))
        .filter(|(_, multiple)| *multiple <= MULTIPLES)
        .collect();
    let sum = small.iter().fold((0.0, 0.0), |sum, (gap, multiple)| (sum.0 + gap, sum.1 + multiple));
    let step = sum.0 / sum.1;
    let (enough, off) = if small.len() < MANY { (small.len() == gaps.len(), 1e-6) } else { (true, OFF) };
    let fits = |(gap, multiple): &(f64, f64)| (gap / step - multiple).abs() <= off;
    (enough && small.iter().all(fits)).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rng::normal;

    #[test]
    fn rounded_samples_show_their_step() {
        for step in [5e-8, 1e-3, 0.25, 3.0] {
            for offset in [0.0, 0.37] {
                let samples: Vec<f64> =
                    normal(2, 3000).iter().map(|value| step * ((300.0 * value).round() + offset)).collect();
                let found = quantum(&samples).unwrap();
                assert!((found / step - 1.0).abs() < 1e-6, "{step} {offset}: {found}");
            }
        }
    }

    #[test]
    fn a_step_that_no_two_samples_lie_apart_is_found() {
        let samples: Vec<f64> = (0..40).map(|place| f64::from(place / 2 * 5 + place % 2 * 2)).collect();
        assert_eq!(quantum(&samples), Some(1.0), "gaps of 2 and 3");
        assert_eq!(quantum(&[0.0, 5.0, 10.0, 5.0, 0.0]), Some(5.0));
        let tenths: Vec<f64> = (0..40).map(|place| f64::from(place * place % 17) / 10.0).collect();
        assert_eq!(quantum(&tenths), Some(0.1), "which no difference of tenths is to the last digit");
    }

    #[test]
    fn numbers_as_they_come_have_no_step() {
        for seed in 0..20 {
            assert_eq!(quantum(&normal(seed, 500)), None);
        }
        assert_eq!(quantum(&[1.0, 1.0]), None);
        assert_eq!(quantum(&[1.0, 2.0]), None, "two values are no row of steps");
    }
}
