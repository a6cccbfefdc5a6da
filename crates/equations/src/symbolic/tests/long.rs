//! Long expressions: they keep their values, although they are not multiplied out.

use super::assert_equal;
use crate::symbolic::{Fraction, partial_derivative, value};
use crate::testing::reading::read;
use crate::testing::{Point, symbol};

/// The values of x, y, z, p and q.
const POINT: Point = Point([0.7, -0.4, 2.0, 1.3, 0.9]);

/// Asserts that a value is near another one.
fn assert_near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-11, "{found}, not {expected}");
}

#[test]
fn long_products_are_not_multiplied_out() {
    let sum = read("x + y + z + p + q + 1");
    let cube = sum.power(3);
    assert_eq!(cube.numerator().terms().len(), 56);
    let product = cube.times(&cube);
    assert_eq!(product.numerator().terms().len(), 1);
    assert_near(value(&product, &POINT), 5.5_f64.powi(6));
    let slope = partial_derivative(&product, symbol("x"));
    assert_near(value(&slope, &POINT), 6.0 * 5.5_f64.powi(5));
    assert!(product.contains(&mut |own| own == symbol("q")));
    assert!(product.minus(&product).is_zero());
    // With numbers in place of symbols it is short, and is multiplied out.
    let short = product.mapped(&mut |own| {
        if own == symbol("x") { Fraction::symbol(own) } else { Fraction::whole(1) }
    });
    assert_eq!(short, read("(x + 5)^6"));
}

#[test]
fn a_long_sum_without_negative_terms_has_a_known_sign() {
    let long = read("(p + q + F + Fs + T + 1)^3 * (p + q + F + Fs + T + 2)^3");
    assert_eq!(long.numerator().terms().len(), 1);
    assert!(long.is_positive() && long.is_constant());
    let unknown = read("(x + q + F + Fs + T + 1)^3 * (p + q + F + Fs + T + 2)^3");
    assert!(!unknown.is_nonnegative() && !unknown.is_constant());
}

#[test]
fn many_quotients_have_a_sum() {
    let text: Vec<String> = (1..=12).map(|index| format!("{index}/(x + {index} z + {index})")).collect();
    let sum = read(&text.join(" + "));
    let expected: f64 = (1..=12).map(f64::from).map(|index| index / (0.7 + 3.0 * index)).sum();
    assert_near(value(&sum, &POINT), expected);
}

#[test]
fn products_of_maxima_and_quotients_of_quotients_have_values() {
    let maxima = "max(x, y) max(x, p) max(y, q) max(x, q) max(x, z) max(y, p) max(z, q) max(z, p) max(x, 3)";
    assert_near(value(&read(maxima), &POINT), 0.7 * 1.3 * 0.9 * 0.9 * 2.0 * 1.3 * 2.0 * 2.0 * 3.0);
    let quotients =
        "1/(1 + 1/(x + p + 1/(z + q + 1/(x + p^2 + 1/(z + q^2 + 1/(x + p^3 + 1/(z + q^3 + 1/z)))))))";
    let (x, z, p, q) = (0.7_f64, 2.0_f64, 1.3_f64, 0.9_f64);
    let divisors = [z, z + q.powi(3), x + p.powi(3), z + q * q, x + p * p, z + q, x + p, 1.0];
    let expected = divisors.into_iter().fold(0.0, |inner, own| (own + inner).recip());
    assert_near(value(&read(quotients), &POINT), expected);
}

#[test]
fn quotients_of_short_sums_still_cancel() {
    assert_equal(&[
        "(x + y)^5 * (x - y)/(x + y)^4 = x^2 - y^2",
        "(x^6 - 1)/(x^2 + x + 1)/(x - 1) = x^3 + 1",
        "(p x + q)^3 * (p x - q)/(p^2 x^2 - q^2) = (p x + q)^2",
    ]);
}
