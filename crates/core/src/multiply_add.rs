//! Products with a sum that are rounded once, also on processors without an instruction for them.
//!
//! WebAssembly has no such instruction, and its library computes with integers, which takes ten times longer. The functions
//! here use error-free transformations instead: a product or a sum of two numbers is the rounded result and an error,
//! and both are numbers of the same format (Dekker 1971, Knuth 1969). The bits are those of the instruction.

#[cfg(test)]
mod tests;

/// a b + c, rounded once.
#[inline(always)]
pub(crate) fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_family = "wasm") { emulated(a, b, c) } else { a.mul_add(b, c) }
}

/// Least size of a product whose error is a number of the format: the error of a larger one is a multiple of 2^-1006.
const LEAST: f64 = f64::from_bits((1023 - 900) << 52);
/// Greatest size of a product or a summand. No sum of such numbers overflows.
const GREATEST: f64 = f64::from_bits((1023 + 1000) << 52);

/// A bound of the relative error of a rounded sum, with a margin for the rounding of the product with it.
const SUM_ERROR: f64 = 2.0 * f64::EPSILON;

/// a b + c, rounded once, by operations that are rounded separately.
///
/// The sum of the rounded product and c has an error, and so has the product. Both errors together are the rest, which is
/// rounded. If the sum and the least possible rest give the same number as the sum and the greatest possible rest, this
/// number is the result, because rounding is monotonic.
#[inline(always)]
fn emulated(a: f64, b: f64, c: f64) -> f64 {
    let product = a * b;
    if is_in_range(product, c) {
        let (sum, sum_error) = exact_sum(product, c);
        let rest = sum_error + product_error(a, b, product);
        let result = sum + rest * (1.0 + SUM_ERROR);
        if result == sum + rest * (1.0 - SUM_ERROR) {
            return result;
        }
    } else if a == 0.0 || b == 0.0 {
        return product + c;
    }
    emulated_to_odd(a, b, c)
}

/// a b + c, rounded once, if the simple test does not decide: the result is near the middle between two numbers, or the
/// product and c cancel (Boldo and Melquiond, Emulation of FMA and correctly rounded sums, 2008).
///
/// The sum of the two least significant parts is rounded to odd. So the last addition sees whether it was inexact, and
/// rounding twice gives the same as rounding once. Numbers outside the range are computed by the library.
#[cold]
#[inline(never)]
fn emulated_to_odd(a: f64, b: f64, c: f64) -> f64 {
    let product = a * b;
    if !is_in_range(product, c) {
        return a.mul_add(b, c);
    }
    let (low, low_error) = exact_sum(c, product_error(a, b, product));
    let (high, high_error) = exact_sum(product, low);
    let result = high + sum_to_odd(low_error, high_error);
    // Halves of the greatest numbers overflow.
    if result.is_nan() { a.mul_add(b, c) } else { result }
}

/// Whether the error of a product is a number of the format and its sum with c cannot overflow. False for NaN.
#[inline(always)]
fn is_in_range(product: f64, c: f64) -> bool {
    (product.abs() >= LEAST) & (product.abs() <= GREATEST) & (c.abs() <= GREATEST)
}

/// a + b as the rounded sum and its error.
#[inline(always)]
fn exact_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let second = sum - a;
    (sum, (a - (sum - second)) + (b - second))
}

/// The error of a rounded product: a b = product + error.
#[inline(always)]
fn product_error(a: f64, b: f64, product: f64) -> f64 {
    let (a_high, b_high) = (upper_half(a), upper_half(b));
    let (a_low, b_low) = (a - a_high, b - b_high);
    (((a_high * b_high - product) + a_high * b_low) + a_low * b_high) + a_low * b_low
}

/// A number rounded to 26 of its 53 bits. What remains also has at most 26 bits, so products of halves are exact.
#[inline(always)]
fn upper_half(value: f64) -> f64 {
    f64::from_bits((value.to_bits() + (1 << 26)) & !((1 << 27) - 1))
}

/// a + b; if that is inexact, the neighbouring number whose last bit is 1.
fn sum_to_odd(a: f64, b: f64) -> f64 {
    let (sum, error) = exact_sum(a, b);
    let bits = sum.to_bits();
    if error == 0.0 || bits & 1 == 1 {
        sum
    } else if (error > 0.0) == (sum > 0.0) {
        f64::from_bits(bits + 1)
    } else {
        f64::from_bits(bits - 1)
    }
}
