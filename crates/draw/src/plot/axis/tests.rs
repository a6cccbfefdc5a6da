//! Axes cover their values in round divisions.

use super::*;

fn range(values: &[f64], divisions: usize) -> (f64, f64) {
    let axis = Axis::fit("x", "", values.iter().copied(), divisions);
    assert_eq!(axis.divisions, divisions);
    (axis.low, axis.high)
}

fn tight(values: &[f64]) -> (f64, f64, usize) {
    let axis = Axis::fit_tight("x", "", values.iter().copied(), 10);
    (axis.low, axis.high, axis.divisions)
}

#[test]
fn ranges_are_those_of_a_scope() {
    assert_eq!(range(&[0.0, 10.0], 10), (0.0, 10.0));
    assert_eq!(range(&[-4.0, 4.0], 8), (-4.0, 4.0));
    assert_eq!(range(&[0.0, 0.8], 8), (0.0, 0.8));
    assert_eq!(range(&[-1.0, 1.0], 8), (-2.0, 2.0));
    assert_eq!(range(&[0.0, 30.0], 10), (0.0, 50.0));
    assert_eq!(range(&[-7.5, -0.5], 8), (-8.0, 0.0));
    assert_eq!(range(&[101.0, 107.0], 8), (100.0, 108.0));
    assert_eq!(range(&[-0.01, 10.0], 8), (-4.0, 12.0));
}

#[test]
fn the_range_includes_zero_only_if_near() {
    assert_eq!(range(&[1.0, 7.0], 8).0, 0.0);
    assert!(range(&[990.0, 1000.0], 8).0 > 900.0);
}

#[test]
fn rounding_in_the_last_sample_adds_no_division() {
    assert_eq!(range(&[0.0, 10.000000001], 10), (0.0, 10.0));
    assert_eq!(range(&[0.0, 0.1 + 0.2], 3), (0.0, 0.3));
}

#[test]
fn tight_axes_have_no_empty_divisions() {
    assert_eq!(tight(&[0.0, 30.0]), (0.0, 30.0, 6));
    assert_eq!(tight(&[-1.0, 1.0]), (-1.0, 1.0, 10));
    assert_eq!(tight(&[0.0, 0.0]), (-1.0, 1.0, 10));
}

#[test]
fn equal_axes_have_divisions_of_one_size() {
    let axes = |across: &[f64], up: &[f64]| {
        let axes = Axis::fit_equal("mm", [("x".to_owned(), across.to_vec()), ("y".to_owned(), up.to_vec())]);
        axes.map(|axis| (axis.low, axis.high, axis.divisions))
    };
    assert_eq!(axes(&[0.0, 30.0], &[0.0, 3.0]), [(0.0, 30.0, 6), (-5.0, 15.0, 4)]);
    assert_eq!(axes(&[-1.0, 1.0], &[-8.0, 8.0]), [(-4.0, 4.0, 4), (-8.0, 8.0, 8)]);
    assert_eq!(axes(&[], &[2.0, 2.0])[1], (0.0, 2.0, 4));
}

#[test]
fn zero_is_found_between_the_ends_only() {
    let zero = |low: f64, high: f64, divisions: usize| {
        Axis { low, high, divisions, ..Axis::fit("x", "", [0.0, 1.0], 10) }.zero_fraction()
    };
    assert_eq!(zero(-2.0, 6.0, 8), Some(0.25));
    assert_eq!(zero(-1.0, 3.0, 3), Some(0.25), "zero between two division lines");
    assert_eq!([zero(0.0, 5.0, 5), zero(-5.0, 0.0, 5), zero(2.0, 4.0, 2)], [None; 3]);
}

#[test]
fn constant_values_have_a_sensible_range() {
    assert_eq!(range(&[], 10), (-1.0, 1.0));
    assert_eq!(range(&[0.0, 0.0], 10), (-1.0, 1.0));
    assert_eq!(range(&[f64::NAN, f64::INFINITY], 10), (-1.0, 1.0));
    assert_eq!(range(&[5.0, 5.0], 8), (0.0, 8.0));
    assert_eq!(range(&[-3.0], 10), (-5.0, 0.0));
    assert_eq!(range(&[1e-320], 10), (-1.0, 1.0));
}

#[test]
fn infinities_and_gaps_are_ignored() {
    let values = [1.0, f64::NAN, f64::NEG_INFINITY, 10.0, f64::INFINITY];
    assert_eq!(range(&values, 10), (0.0, 10.0));
}

#[test]
fn extreme_values_give_a_drawable_axis() {
    let axis = Axis::fit("x", "", [f64::MAX, f64::MIN], 0);
    assert!(axis.is_drawable(), "{axis:?}");
}

#[test]
fn logarithmic_axes_have_the_given_ends() {
    let axis = |low, high| Axis::logarithmic("f", "Hz", low, high);
    let ends = |axis: Axis| (axis.low, axis.high, axis.divisions);
    assert_eq!(ends(axis(0.1, 1000.0)), (0.1, 1000.0, 4));
    assert_eq!(ends(axis(25.0, 40.0)), (25.0, 40.0, 1));
    assert_eq!(ends(axis(5.0, 5.0)), (5.0, 50.0, 1));
    let four = axis(0.1, 1000.0);
    assert_eq!([0.1, 1.0, 10.0, 1000.0].map(|value| four.fraction(value)), [0.0, 0.25, 0.5, 1.0]);
    assert!(four.is_drawable() && four.fraction(-1.0) < -10.0 && four.zero_fraction().is_none());
    assert!(
        four.has_decade_divisions()
            && !axis(25.0, 40.0).has_decade_divisions()
            && !axis(1e-99, 1e99).has_decade_divisions()
    );
    assert_eq!(four.multiples(1..2).collect::<Vec<_>>(), [1.0, 10.0, 100.0]);
    assert_eq!(axis(0.25, 4.0).multiples(2..4).collect::<Vec<_>>(), [0.3, 2.0, 3.0]);
    for (low, high) in [(0.0, 1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY), (-1.0, -2.0)] {
        assert!(axis(low, high).is_drawable(), "{low} {high}");
    }
    assert!(!Axis { low: -1.0, ..four }.is_drawable());
}

/// A deterministic stream of numbers of widely varying size and sign.
fn numbers() -> impl Iterator<Item = f64> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let size = 10f64.powi((state >> 20) as i32 % 12);
        ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * size
    })
}

#[test]
fn every_fit_covers_its_values_in_round_steps() {
    let mut stream = numbers();
    for round in 0..5000 {
        let values: Vec<f64> = stream.by_ref().take(1 + round % 4).collect();
        let divisions = 2 + round % 12;
        check(&Axis::fit("x", "", values.iter().copied(), divisions), &values);
        check(&Axis::fit_tight("x", "", values.iter().copied(), divisions), &values);
    }
}

fn check(axis: &Axis, values: &[f64]) {
    assert!(axis.is_drawable() && axis.high > axis.low, "{axis:?}");
    let step = (axis.high - axis.low) / axis.divisions as f64;
    for value in values {
        assert!(*value >= axis.low - 2.0 * OVERSHOOT * step, "{value} in {axis:?}");
        assert!(*value <= axis.high + 2.0 * OVERSHOOT * step, "{value} in {axis:?}");
    }
    let mantissa = step / 10f64.powf((step.log10() + 1e-9).floor());
    assert!([1.0, 2.0, 5.0].iter().any(|m| (mantissa - m).abs() < 1e-6), "{axis:?}");
    let lines_below = axis.low / step;
    assert!((lines_below - lines_below.round()).abs() < 1e-3, "{axis:?}");
}
