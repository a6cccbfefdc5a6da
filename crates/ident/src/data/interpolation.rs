//! Interpolation of samples: in gaps of a column, and between the samples of a drive.
//!
//! [`fill_gaps`] replaces missing samples. [`table_points`] gives the points of the drive table that represents the
//! samples of a drive. A table connects its points by straight lines or by steps. That is exact for linear and
//! previous-sample holds. For a smooth hold, extra points between the samples follow an interpolating polynomial.

use crate::data::experiment_document::Hold;
use crate::statistics::projection::dot;

/// Replaces NaN between two samples by an interpolated value: a linear one, or the previous sample if the hold is
/// `Previous`. NaN before the first or after the last sample remains.
pub(crate) fn fill_gaps(samples: &mut [f64], hold: Hold) {
    let present: Vec<usize> = (0..samples.len()).filter(|index| !samples[*index].is_nan()).collect();
    for pair in present.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (previous, next) = (samples[from], samples[to]);
        for (steps, sample) in samples[from..to].iter_mut().enumerate().skip(1) {
            let fraction = steps as f64 / (to - from) as f64;
            *sample = match hold {
                Hold::Linear | Hold::Smooth => previous + fraction * (next - previous),
                Hold::Previous => previous,
            };
        }
    }
}

/// Table points per sample of a smooth drive. A chosen number: the straight lines between the points must follow the
/// interpolating polynomial closely.
const POINTS_PER_SAMPLE: usize = 8;
/// Samples through which the interpolating polynomial passes. Six samples give degree 5.
const STENCIL_SAMPLES: usize = 6;

/// Returns the table points (time in seconds, value) of a drive sampled every `interval` seconds, beginning at time 0.
/// Values keep their unit. With fewer than six samples a smooth drive gets one point per sample, like a linear one.
pub(crate) fn table_points(values: &[f64], interval: f64, hold: Hold) -> Vec<[f64; 2]> {
    match hold == Hold::Smooth && values.len() >= STENCIL_SAMPLES {
        true => smooth_points(values, interval),
        false => {
            values.iter().enumerate().map(|(sample, value)| [sample as f64 * interval, *value]).collect()
        }
    }
}

/// Interpolates with the Lagrange polynomial of degree 5 through the three samples on either side. At the ends, it is
/// the polynomial through the first or last six samples.
///
/// The relative error for a sine of angular frequency w with interval h is at most 5/1024 (w h)^6.
fn smooth_points(values: &[f64], interval: f64) -> Vec<[f64; 2]> {
    let weights: Vec<_> = (0..=(STENCIL_SAMPLES - 1) * POINTS_PER_SAMPLE)
        .map(|point| lagrange_weights(point as f64 / POINTS_PER_SAMPLE as f64))
        .collect();
    let point_at = |point: usize| {
        let first = (point / POINTS_PER_SAMPLE)
            .saturating_sub(STENCIL_SAMPLES / 2 - 1)
            .min(values.len() - STENCIL_SAMPLES);
        let value = dot(&weights[point - first * POINTS_PER_SAMPLE], &values[first..first + STENCIL_SAMPLES]);
        [point as f64 / POINTS_PER_SAMPLE as f64 * interval, value]
    };
    (0..=(values.len() - 1) * POINTS_PER_SAMPLE).map(point_at).collect()
}

/// Returns the Lagrange weights of six samples at a position, counted in samples from the first of them.
fn lagrange_weights(position: f64) -> [f64; STENCIL_SAMPLES] {
    std::array::from_fn(|node| {
        let other_nodes = (0..STENCIL_SAMPLES).filter(|other| *other != node);
        other_nodes.map(|other| (position - other as f64) / (node as f64 - other as f64)).product()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_tables_pass_through_the_samples_and_follow_the_curvature() {
        let quintic = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t - 0.1 * t.powi(5);
        let values: Vec<f64> = (0..7).map(|k| quintic(0.5 * f64::from(k))).collect();
        let smooth = table_points(&values, 0.5, Hold::Smooth);
        assert_eq!((smooth.len(), smooth[0], smooth[48][0]), (49, [0.0, 1.0], 3.0));
        assert!(smooth.iter().all(|[t, value]| (value - quintic(*t)).abs() < 1e-11));
        let sine_sample = |k: u32| (0.5 * f64::from(k)).sin();
        let sine = table_points(&(0..40).map(sine_sample).collect::<Vec<_>>(), 1.0, Hold::Smooth);
        let largest_error =
            sine[16..296].iter().map(|[t, value]| (value - (0.5 * t).sin()).abs()).fold(0.0, f64::max);
        let error_bound = 5.0 / 1024.0 * 0.5_f64.powi(6);
        assert!((0.5..1.0).contains(&(largest_error / error_bound)), "{largest_error}");
        let linear = table_points(&values, 0.5, Hold::Linear);
        let is_sample = |([_, point], value): (&[f64; 2], &f64)| point == value;
        assert!(linear.iter().zip(&values).all(is_sample) && linear.len() == 7);
        assert_eq!(table_points(&[1.0, 2.0, 4.0], 1.0, Hold::Smooth), [[0.0, 1.0], [1.0, 2.0], [2.0, 4.0]]);
        assert!(table_points(&[], 1.0, Hold::Smooth).is_empty());
    }
}
