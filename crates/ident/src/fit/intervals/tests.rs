//! Unit tests of `intervals`.

use std::f64::consts::PI;

use super::*;
use crate::fit::base_fit::fit_base;
use crate::fit::step_size::tests::{AMPLITUDE, RATE, decay, measured};
use patchcord_core::patch::Patch;

/// The rise of the sum of squares at a rate, with the amplitude fitted again, for noise of 1 V.
fn rise(rate: f64) -> f64 {
    let decay = |rate: f64| (0..20).map(move |sample| (-rate * f64::from(sample)).exp());
    let dot = |left: f64, right: f64| decay(left).zip(decay(right)).map(|(a, b)| a * b).sum::<f64>();
    AMPLITUDE.powi(2) * (dot(RATE, RATE) - dot(rate, RATE).powi(2) / dot(rate, rate))
}

/// The uncertainty of the rate of a decay, and the rise of the sum of squares at the ends of its interval, relative
/// to the expected rise.
fn rate_uncertainty(sigma: f64) -> (Uncertainty, [f64; 2]) {
    let (patch, fit, problem) = decay(sigma, 32);
    let base = fit_base(&problem, &patch, &fit, 1).unwrap().unwrap();
    let uncertainty = with_profile_intervals(&problem, base, 0).unwrap().uncertainty(0);
    (uncertainty, uncertainty.interval.map(|rate| rise(rate) / (student_95(19) * sigma).powi(2)))
}

#[test]
fn an_interval_is_proportional_to_a_small_noise() {
    let (uncertainty, rises) = rate_uncertainty(0.01);
    assert!(rises.iter().all(|rise| (rise - 1.0).abs() < 0.05), "{uncertainty:?} {rises:?}");
    let half_width = student_95(19) * uncertainty.error;
    assert!(
        uncertainty.interval.iter().all(|end| ((end - RATE).abs() / half_width - 1.0).abs() < 0.01),
        "{uncertainty:?}"
    );
}

/// At high rates only the first sample is large, so that the data depend little on the rate.
#[test]
fn an_interval_is_longer_on_the_side_where_the_parameter_has_less_effect() {
    let (uncertainty, rises) = rate_uncertainty(3.5);
    assert!((0.5..1.5).contains(&rises[1]), "{uncertainty:?} {rises:?}");
    assert!(uncertainty.interval[1] - RATE > 1.5 * student_95(19) * uncertainty.error, "{uncertainty:?}");
    assert_eq!(rate_uncertainty(10.0).0.interval[1], 10.0);
}

/// At the end of the record, a fiftieth of the range of the frequency is eight periods.
#[test]
fn standard_error_of_a_frequency_is_that_of_the_linearised_sine() {
    let patch = r#"{
  "patchcord": 1,
  "parameters": {"f": {"value": 3.3, "unit": "1/s", "range": [0.1, 20]}},
  "scales": {"volts": {"per_volt": 1, "unit": "V"}},
  "drives": {"D1": {"kind": "sine", "scale": "volts", "amplitude": 5, "frequency": "f"}},
  "elements": {"A1": {"kind": "summer", "in": {"x1": ["D1"]}}}
}"#;
    let patch = Patch::parse("sine.json", patch).unwrap_or_else(|report| panic!("{report}"));
    let (count, sigma) = (200, 10.0);
    let times = (0..count).map(|sample| 0.1 * f64::from(sample));
    let volts = times.clone().map(|time| -5.0 * (2.0 * PI * 3.3 * time).sin()).collect();
    let problem = measured("A1", volts, sigma, 32);
    let base = fit_base(&problem, &patch, &["f".to_owned()], 1).unwrap().unwrap();
    let uncertainty = with_standard_errors(&problem, base).unwrap().uncertainty(0);
    let squared_slopes = times.map(|time| (5.0 * 2.0 * PI * time * (2.0 * PI * 3.3 * time).cos()).powi(2));
    let error = sigma / squared_slopes.sum::<f64>().sqrt();
    assert!((uncertainty.error / error - 1.0).abs() < 0.05, "{uncertainty:?} {error}");
}
