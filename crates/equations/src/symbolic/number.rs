//! Exact numbers: the rational number that a decimal means.

use num_bigint::BigInt;
use num_integer::Integer as _;
use num_rational::BigRational;
use num_traits::{One as _, Pow as _, ToPrimitive as _, Zero as _};

/// A rational number. Products of scales and gains cancel exactly in it, which they do not as f64.
pub(crate) type Rational = BigRational;

/// The rational number with the shortest decimal that reads as `value`: 1/10 for 0.1.
///
/// The value must be finite.
pub(crate) fn exact(value: f64) -> Rational {
    let text = format!("{value:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (whole, decimals) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{decimals}").parse::<BigInt>().unwrap_or_default();
    let power = exponent.parse::<i64>().unwrap_or_default() - decimals.len() as i64;
    let factor = Rational::from_integer(BigInt::from(10u8).pow(power.unsigned_abs()));
    let digits = Rational::from_integer(digits);
    if power < 0 { digits / factor } else { digits * factor }
}

/// The f64 nearest to a number.
pub(crate) fn nearest(number: &Rational) -> f64 {
    number.to_f64().unwrap_or(f64::NAN)
}

/// A whole number as a rational one.
pub(crate) fn whole(number: i64) -> Rational {
    Rational::from_integer(BigInt::from(number))
}

/// The square root of a positive number as `outside x sqrt(inside)`, with a whole number inside.
///
/// The number inside has no square factor of a prime below [`LARGEST_PRIME`], and is no square itself.
pub(crate) fn square_root(number: &Rational) -> (Rational, Rational) {
    let mut inside = number.numer() * number.denom();
    let mut outside = Rational::new(BigInt::one(), number.denom().clone());
    for prime in 2..LARGEST_PRIME {
        let square = BigInt::from(prime * prime);
        while let (quotient, rest) = inside.div_rem(&square)
            && rest.is_zero()
        {
            inside = quotient;
            outside *= whole(prime);
        }
    }
    let root = inside.sqrt();
    if &root * &root == inside {
        (outside * Rational::from_integer(root), Rational::one())
    } else {
        (outside, Rational::from_integer(inside))
    }
}

/// Square factors of primes below this number are found.
const LARGEST_PRIME: i64 = 100;

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(numerator: i64, denominator: i64) -> Rational {
        Rational::new(numerator.into(), denominator.into())
    }

    #[test]
    fn decimals_are_exact() {
        assert_eq!(exact(0.1), ratio(1, 10));
        assert_eq!(exact(-2.54e-3), ratio(-127, 50_000));
        assert_eq!(exact(45e6), whole(45_000_000));
        assert_eq!(exact(0.0), whole(0));
        for value in [1e300, -1.7e-300, 0.1 + 0.2, f64::MIN_POSITIVE, 1.0 / 3.0] {
            assert_eq!(nearest(&exact(value)), value);
        }
    }

    #[test]
    fn square_roots_have_no_square_inside() {
        assert_eq!(square_root(&ratio(1, 4)), (ratio(1, 2), whole(1)));
        assert_eq!(square_root(&ratio(5000, 9)), (ratio(50, 3), whole(2)));
        assert_eq!(square_root(&ratio(1, 2)), (ratio(1, 2), whole(2)));
        assert_eq!(square_root(&whole(101 * 101)), (whole(101), whole(1)));
    }
}
