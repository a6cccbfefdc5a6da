//! Every case has the bits of [`f64::mul_add`], which the standard library rounds once on every target.

use proptest::prelude::*;

use super::*;

/// Special numbers: zeros, ends of the range of normal and of denormal numbers, limits of the emulation.
const SPECIAL: [f64; 17] = [
    0.0,
    f64::from_bits(1),
    f64::from_bits((1 << 52) - 1),
    f64::MIN_POSITIVE,
    LEAST,
    f64::EPSILON,
    0.1,
    0.5,
    1.0 - f64::EPSILON / 2.0,
    1.0,
    1.0 + f64::EPSILON,
    3.0,
    134_217_729.0,
    GREATEST,
    f64::MAX,
    f64::INFINITY,
    f64::NAN,
];

/// Checks both emulations. The bits of a result that is not a number are not specified.
fn check(a: f64, b: f64, c: f64) {
    let expected = a.mul_add(b, c);
    for result in [emulated(a, b, c), emulated_to_odd(a, b, c)] {
        let is_equal = result.to_bits() == expected.to_bits() || (result.is_nan() && expected.is_nan());
        assert!(is_equal, "{a:e} x {b:e} + {c:e} = {result:e} instead of {expected:e}");
    }
}

/// A number with this exponent; sign and digits are those of `bits`.
fn with_exponent(bits: u64, exponent: i64) -> f64 {
    let biased = (1023 + exponent).clamp(0, 2046) as u64;
    f64::from_bits(bits & !(0x7ff << 52) | biased << 52)
}

/// The number that is `steps` representable numbers away.
fn stepped(value: f64, steps: i64) -> f64 {
    f64::from_bits(value.to_bits().wrapping_add_signed(steps))
}

/// A number with few digits: its product with another number often lies in the middle between two numbers.
fn with_few_digits(bits: u64, digits: u32, exponent: i64) -> f64 {
    with_exponent(bits & (u64::MAX << (52 - digits)), exponent)
}

#[test]
fn special_numbers_are_multiplied_and_added_as_by_the_library() {
    let signed: Vec<f64> = SPECIAL.iter().flat_map(|value| [*value, -value]).collect();
    for a in &signed {
        for b in &signed {
            signed.iter().for_each(|c| check(*a, *b, *c));
            [-2, -1, 0, 1, 2].into_iter().for_each(|steps| check(*a, *b, stepped(-a * b, steps)));
        }
    }
}

#[test]
fn results_in_the_middle_between_two_numbers_are_rounded_to_even() {
    let half = f64::EPSILON / 2.0;
    // An exact tie, a tie that the error of the product decides, and a tie that a much smaller number decides.
    assert_eq!(emulated(1.0, half, 1.0), 1.0);
    assert_eq!(emulated(half, 1.0 + f64::EPSILON, 1.0), 1.0 + f64::EPSILON);
    assert_eq!(emulated(1.0 + half * 2.0, 1.0 + half * 2.0, half), 1.0 + 3.0 * f64::EPSILON);
    assert_eq!(emulated(1.0, 1.0, half + half * f64::EPSILON), 1.0 + f64::EPSILON);
    for digits in 0..60 {
        for shift in 45..60 {
            let (a, b) = (1.0 + f64::EPSILON * f64::from(digits), 2.0_f64.powi(-shift));
            [1.0, -1.0, 1.0 + f64::EPSILON, 2.0, -2.0].into_iter().for_each(|c| check(a, b, c));
        }
    }
}

#[test]
fn on_this_target_a_product_with_a_sum_has_the_same_bits() {
    let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
    assert_eq!(multiply_add(a, b, -1.0), -f64::EPSILON * f64::EPSILON);
    assert_eq!(a * b - 1.0, 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn any_bits(a: u64, b: u64, c: u64) {
        check(f64::from_bits(a), f64::from_bits(b), f64::from_bits(c));
    }

    #[test]
    fn ordinary_numbers(bits: [u64; 3], exponents in prop::array::uniform3(-60_i64..=60)) {
        check(
            with_exponent(bits[0], exponents[0]),
            with_exponent(bits[1], exponents[1]),
            with_exponent(bits[2], exponents[2]),
        );
    }

    #[test]
    fn extreme_exponents(bits: [u64; 3], one in -1100_i64..=1100, sum in -1100_i64..=1100, gap in -120_i64..=120) {
        let product = sum - one;
        check(with_exponent(bits[0], one), with_exponent(bits[1], product), with_exponent(bits[2], sum + gap));
    }

    #[test]
    fn products_and_sums_that_nearly_cancel(bits: [u64; 2], exponents in prop::array::uniform2(-60_i64..=60), steps in -5_i64..=5) {
        let (a, b) = (with_exponent(bits[0], exponents[0]), with_exponent(bits[1], exponents[1]));
        check(a, b, stepped(-a * b, steps));
    }

    #[test]
    fn results_near_the_middle(
        bits: [u64; 3], digits in prop::array::uniform3(0_u32..=30), exponents in prop::array::uniform2(-30_i64..=30), gap in -110_i64..=110,
    ) {
        let a = with_few_digits(bits[0], digits[0], exponents[0]);
        let b = with_few_digits(bits[1], digits[1], exponents[1]);
        check(a, b, with_few_digits(bits[2], digits[2], exponents[0] + exponents[1] + gap));
        check(a, f64::from_bits(b.to_bits() | 1), with_exponent(bits[2], exponents[0] + exponents[1] + gap));
    }
}
