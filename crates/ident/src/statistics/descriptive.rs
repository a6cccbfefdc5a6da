//! What several numbers come to.

/// Their mean; 0 of none.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The middle one; NaN of none.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The least and the largest, NaN left out; of none infinite, the wrong way round.
pub(crate) fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], own| [least.min(own), most.max(own)])
}

/// Of normal numbers half lie within so many standard deviations.
pub(crate) const HALF_WITHIN: f64 = 0.674_489_75;
/// Of normal numbers 95 of 100 lie within so many standard deviations.
pub(crate) const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The same of one to four degrees of freedom, for which the expansion is too short.
const STUDENT_95_OF_FEW: [f64; 4] = [12.706_204_7, 4.302_652_7, 3.182_446_3, 2.776_445_1];

/// Within how many standard errors 95 of 100 cases lie where these come from so many degrees of freedom: Student's t, by R. A. Fisher's
/// expansion, to 0.13 %.
pub(crate) fn student_95(freedom: usize) -> f64 {
    let z = NORMAL_95;
    let z2 = z * z;
    if let Some(table) = STUDENT_95_OF_FEW.get(freedom.saturating_sub(1)) {
        return *table;
    }
    let n = freedom as f64;
    let first = (z2 + 1.0) / 4.0;
    let second = ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
    let third = (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
    z * (1.0 + (first + (second + third / n) / n) / n)
}

/// The samples of a track that are not missing.
pub(crate) fn there(track: &[f64]) -> Vec<f64> {
    track.iter().copied().filter(|value| !value.is_nan()).collect()
}

/// The samples of a track that are not missing, less their mean.
pub(crate) fn about_mean(track: &[f64]) -> Vec<f64> {
    let there = there(track);
    let mean = mean(&there);
    there.into_iter().map(|value| value - mean).collect()
}

/// How far tracks go about their means, rms.
pub(crate) fn rms_about_means<'t>(tracks: impl Iterator<Item = &'t [f64]>) -> f64 {
    let moved = tracks.flat_map(about_mean).map(|own| own * own);
    mean(&moved.collect::<Vec<f64>>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn students_t_is_that_of_the_tables() {
        for (freedom, table) in
            [(1, 12.706), (3, 3.182), (4, 2.776), (5, 2.571), (9, 2.262), (19, 2.093), (120, 1.980)]
        {
            let found = student_95(freedom);
            assert!((found / table - 1.0).abs() < 1.3e-3, "{freedom}: {found}");
        }
        assert!((student_95(usize::MAX) - NORMAL_95).abs() < 1e-12);
    }

    #[test]
    fn of_no_numbers_there_is_nothing_to_tell() {
        assert_eq!((mean(&[]), median(&[]).is_nan()), (0.0, true));
        assert_eq!(ends([f64::NAN, 2.0, -1.0].into_iter()), [-1.0, 2.0]);
    }
}
