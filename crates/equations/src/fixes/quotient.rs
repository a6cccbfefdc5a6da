//! Short quotients of whole numbers, in place of numbers with many digits.

/// The largest divisor that is tried.
const MOST_DIVISOR: u32 = 999;
/// The largest dividend, without trailing zeros.
const MOST_DIVIDEND: f64 = 9999.0;
/// A quotient that differs from a number by at most this share is that number, which has 14 digits.
const ROUNDING: f64 = 2e-13;
/// Decades of the numbers that are tried.
const DECADES: std::ops::RangeInclusive<i32> = -9..=9;

/// The shortest quotient of whole numbers that is a positive number. `None` if there is no short one.
pub(super) fn short_quotient(value: f64) -> Option<[f64; 2]> {
    let decade = value.log10().floor();
    if !(value > 0.0 && DECADES.contains(&(decade as i32))) {
        return None;
    }
    let mantissa = value / 10f64.powf(decade);
    let quotient = |divisor: u32| {
        let product = mantissa * f64::from(divisor);
        let dividend = product.round();
        let is_equal = (product - dividend).abs() <= ROUNDING * product;
        (is_equal && dividend <= MOST_DIVIDEND).then_some([dividend, f64::from(divisor)])
    };
    let [dividend, divisor] = (1..=MOST_DIVISOR).find_map(quotient)?;
    let shifted = 10f64.powf(decade.abs());
    let [dividend, divisor] =
        if decade < 0.0 { [dividend, divisor * shifted] } else { [dividend * shifted, divisor] };
    let common = common_divisor(dividend, divisor);
    Some([dividend / common, divisor / common])
}

/// The greatest common divisor of two whole numbers.
fn common_divisor(one: f64, other: f64) -> f64 {
    if other == 0.0 { one } else { common_divisor(other, one % other) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_many_digits_are_short_quotients() {
        let cases = [
            (83.333_333_333_333, [250.0, 3.0]),
            (0.071_428_571_428_571, [1.0, 14.0]),
            (5.0 / 4.536, [625.0, 567.0]),
            (0.833_333_333_333_33, [5.0, 6.0]),
            (588_235.294_117_65, [10_000_000.0, 17.0]),
            (0.009_090_909_090_909_1, [1.0, 110.0]),
            (2.5, [5.0, 2.0]),
            (1000.0, [1000.0, 1.0]),
        ];
        for (value, expected) in cases {
            assert_eq!(short_quotient(value), Some(expected), "{value}");
        }
    }

    #[test]
    fn other_numbers_are_no_short_quotients() {
        for value in [std::f64::consts::PI, 2f64.sqrt(), 0.333_333, 0.0, -0.5, 1e-12, f64::NAN, f64::INFINITY]
        {
            assert_eq!(short_quotient(value), None, "{value}");
        }
    }
}
