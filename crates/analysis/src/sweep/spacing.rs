//! The values of a spaced axis. Ends with few digits give values with few digits: 3.2, not 3.1999999999999997.
//!
//! Equal differences are computed with decimal numbers of any length and rounded once. Equal ratios are computed with
//! powers. A power that differs from a short decimal number by rounding only becomes that number.

use patchcord_expr::{Function, round_significant};

/// The value number `index` of `count` values with equal differences from `first` to `last`. `count` is at least 2.
pub(super) fn value_by_difference([first, last]: [f64; 2], index: u64, count: u64) -> f64 {
    match end(first, last, index, count) {
        Some(end) => end,
        None => decimal_value(first, last, index, count)
            .unwrap_or_else(|| interpolate_linearly(first, last, share(index, count))),
    }
}

/// The value number `index` of `count` values with equal ratios from `first` to `last`, which are positive. `count` is
/// at least 2.
pub(super) fn value_by_ratio([first, last]: [f64; 2], index: u64, count: u64) -> f64 {
    match end(first, last, index, count) {
        Some(end) => end,
        None => without_rounding_error(interpolate_by_ratio(first, last, share(index, count))),
    }
}

/// The first or the last value, which are exact. `None` for a value between them.
fn end(first: f64, last: f64, index: u64, count: u64) -> Option<f64> {
    match index {
        0 => Some(first),
        _ if index + 1 == count => Some(last),
        _ => None,
    }
}

/// The position of a value between the ends, from 0 to 1.
fn share(index: u64, count: u64) -> f64 {
    index as f64 / (count - 1) as f64
}

/// Linear interpolation. If the difference of the ends overflows, the ends are weighted separately.
fn interpolate_linearly(first: f64, last: f64, share: f64) -> f64 {
    let difference = last - first;
    if difference.is_finite() { first + share * difference } else { first * (1.0 - share) + last * share }
}

/// Interpolation with equal ratios. If the ratio of the ends overflows, the powers are computed separately.
fn interpolate_by_ratio(first: f64, last: f64, share: f64) -> f64 {
    let (ratio, power) = (last / first, |base, exponent| Function::Power.apply(base, exponent));
    if ratio.is_normal() {
        first * power(ratio, share)
    } else {
        power(first, 1.0 - share) * power(last, share)
    }
}

/// Number of significant digits of a short decimal number.
const SHORT_DIGITS: usize = 10;
/// The largest rounding error of a power, as a share of the power.
const POWER_ERROR: f64 = 1e-14;

/// The nearest decimal number of [`SHORT_DIGITS`] if the difference is at most a rounding error, else the value itself.
fn without_rounding_error(value: f64) -> f64 {
    let short = round_significant(value, SHORT_DIGITS);
    if (short - value).abs() <= POWER_ERROR * value { short } else { value }
}

/// A decimal number: `digits` times ten to the power of `exponent`.
struct Decimal {
    /// The digits with the sign.
    digits: i128,
    /// The power of ten of the last digit.
    exponent: i32,
}

impl Decimal {
    /// The shortest decimal number that reads back to a finite value. `None` for other values.
    fn of(value: f64) -> Option<Decimal> {
        let text = format!("{value:e}");
        let (mantissa, exponent) = text.split_once('e')?;
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = format!("{whole}{fraction}").parse().ok()?;
        let exponent: i32 = exponent.parse().ok()?;
        Some(Decimal { digits, exponent: exponent - fraction.len() as i32 })
    }

    /// The digits of the same number with a lower exponent. `None` if there are too many.
    fn digits_at(&self, exponent: i32) -> Option<i128> {
        let power = u32::try_from(self.exponent - exponent).ok()?;
        if self.digits == 0 { Some(0) } else { self.digits.checked_mul(10i128.checked_pow(power)?) }
    }
}

/// The exact value number `index` of `count` values with equal differences, rounded once. `None` if the ends have too
/// many digits.
fn decimal_value(first: f64, last: f64, index: u64, count: u64) -> Option<f64> {
    let [first, last] = [Decimal::of(first)?, Decimal::of(last)?];
    let exponent = first.exponent.min(last.exponent);
    let [first, last] = [first.digits_at(exponent)?, last.digits_at(exponent)?];
    let (index, intervals) = (i128::from(index), i128::from(count - 1));
    let sum = first.checked_mul(intervals - index)?.checked_add(last.checked_mul(index)?)?;
    quotient_text(sum, intervals, exponent).parse().ok()
}

/// Number of decimals of a quotient. At least 20 of them are significant, because a divisor is at most 1e9.
const QUOTIENT_DECIMALS: usize = 30;

/// The quotient of two integers, times ten to the power of `exponent`, as a text. The divisor is positive.
fn quotient_text(dividend: i128, divisor: i128, exponent: i32) -> String {
    let (size, divisor) = (dividend.unsigned_abs(), divisor.unsigned_abs());
    let sign = if dividend < 0 { "-" } else { "" };
    let mut text = format!("{sign}{}.", size / divisor);
    let mut remainder = size % divisor;
    for _ in 0..QUOTIENT_DECIMALS {
        remainder *= 10;
        text += &(remainder / divisor).to_string();
        remainder %= divisor;
    }
    format!("{text}e{exponent}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn differences(ends: [f64; 2], count: u64) -> Vec<f64> {
        (0..count).map(|index| value_by_difference(ends, index, count)).collect()
    }

    fn ratios(ends: [f64; 2], count: u64) -> Vec<f64> {
        (0..count).map(|index| value_by_ratio(ends, index, count)).collect()
    }

    #[test]
    fn decimal_ends_give_decimal_values() {
        assert_eq!(differences([0.1, 1.0], 10), [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]);
        assert_eq!(differences([3.0, 4.0], 11), [3.0, 3.1, 3.2, 3.3, 3.4, 3.5, 3.6, 3.7, 3.8, 3.9, 4.0]);
        assert_eq!(differences([-0.3, 0.6], 10), [-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
        assert_eq!(differences([4.0, 3.0], 6), [4.0, 3.8, 3.6, 3.4, 3.2, 3.0]);
        assert_eq!(differences([0.0, 2e-3], 5), [0.0, 5e-4, 1e-3, 1.5e-3, 2e-3]);
        assert_eq!(differences([5e6, 45e6], 3), [5e6, 25e6, 45e6]);
        let thousandths = differences([3.0, 4.0], 1001);
        let expected = (3000..=4000).map(|number| format!("{number}e-3").parse::<f64>().unwrap());
        assert!(thousandths.into_iter().eq(expected));
    }

    #[test]
    fn values_without_a_short_decimal_number_are_rounded_once() {
        assert_eq!(differences([0.0, 1.0], 4), [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]);
        assert_eq!(differences([-1.0, 0.0], 4), [-1.0, -2.0 / 3.0, -1.0 / 3.0, 0.0]);
        // The ends have too many digits for one exponent.
        assert_eq!(differences([1e-300, 1.0], 3), [1e-300, 0.5, 1.0]);
        // The difference of the ends is not a finite number.
        assert_eq!(differences([-1.7e308, 1.7e308], 5)[1], -8.5e307);
    }

    #[test]
    fn ratios_of_decimal_ends_give_decimal_values() {
        assert_eq!(ratios([0.001, 1000.0], 7), [0.001, 0.01, 0.1, 1.0, 10.0, 100.0, 1000.0]);
        assert_eq!(ratios([0.01, 0.16], 5), [0.01, 0.02, 0.04, 0.08, 0.16]);
        assert_eq!(ratios([5e6, 45e6], 3), [5e6, 15e6, 45e6]);
        let irrational = ratios([1.0, 2.0], 3)[1];
        assert!((irrational / 2f64.sqrt() - 1.0).abs() < 1e-15, "{irrational}");
    }
}
