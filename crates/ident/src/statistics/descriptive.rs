//! Means, medians, extremes and quantiles.

/// Returns the mean; 0 without values.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Returns the median: the middle value in order, or the upper one of two middle values. NaN without values.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Returns the minimum and the maximum. NaN is ignored. Without values they are +infinity and -infinity.
pub(crate) fn extremes(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[minimum, maximum], value| {
        [minimum.min(value), maximum.max(value)]
    })
}

/// The upper quartile of the standard normal distribution. Half of all normal numbers are within this many standard
/// deviations of the mean, so the median of the absolute values divided by it estimates the standard deviation.
pub(crate) const NORMAL_QUARTILE: f64 = 0.674_489_75;
/// The two-sided 95 % limit of the standard normal distribution, in standard deviations.
pub(crate) const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The two-sided 95 % limits of Student's t for one to four degrees of freedom, from tables. Fisher's expansion is not
/// accurate for these.
const STUDENT_95_TABLE: [f64; 4] = [12.706_204_7, 4.302_652_7, 3.182_446_3, 2.776_445_1];

/// Returns the two-sided 95 % limit of Student's t, in standard errors, with a relative error of at most 0.13 %. For at
/// most four degrees of freedom a table is used, otherwise R. A. Fisher's expansion. Zero degrees count as one.
pub(crate) fn student_95(degrees_of_freedom: usize) -> f64 {
    let z = NORMAL_95;
    let z2 = z * z;
    if let Some(limit) = STUDENT_95_TABLE.get(degrees_of_freedom.saturating_sub(1)) {
        return *limit;
    }
    let n = degrees_of_freedom as f64;
    let first = (z2 + 1.0) / 4.0;
    let second = ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
    let third = (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
    z * (1.0 + (first + (second + third / n) / n) / n)
}

/// Returns the samples that are not missing (NaN).
pub(crate) fn present(samples: &[f64]) -> Vec<f64> {
    samples.iter().copied().filter(|value| !value.is_nan()).collect()
}

/// Returns the samples that are not missing (NaN), minus their mean.
pub(crate) fn about_mean(samples: &[f64]) -> Vec<f64> {
    let present = present(samples);
    let mean = mean(&present);
    present.into_iter().map(|value| value - mean).collect()
}

/// Returns the rms of several signals, each about its own mean. Missing samples (NaN) are ignored.
pub(crate) fn rms_about_means<'t>(signals: impl Iterator<Item = &'t [f64]>) -> f64 {
    let squares = signals.flat_map(about_mean).map(|deviation| deviation * deviation);
    mean(&squares.collect::<Vec<f64>>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn students_t_agrees_with_tables() {
        for (freedom, table) in
            [(1, 12.706), (3, 3.182), (4, 2.776), (5, 2.571), (9, 2.262), (19, 2.093), (120, 1.980)]
        {
            let limit = student_95(freedom);
            assert!((limit / table - 1.0).abs() < 1.3e-3, "{freedom}: {limit}");
        }
        assert!((student_95(usize::MAX) - NORMAL_95).abs() < 1e-12);
    }

    #[test]
    fn without_values_the_mean_is_zero_and_the_median_nan() {
        assert_eq!((mean(&[]), median(&[]).is_nan()), (0.0, true));
        assert_eq!(extremes([f64::NAN, 2.0, -1.0].into_iter()), [-1.0, 2.0]);
    }
}
