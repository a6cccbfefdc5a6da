//! Round numbers for scales and time scales.

use patchcord_expr::round_significant;

/// The mantissas of round numbers, the roundest first.
const MANTISSAS: [f64; 14] = [1.0, 2.0, 5.0, 1.5, 2.5, 3.0, 4.0, 6.0, 8.0, 1.2, 1.25, 1.6, 7.0, 9.0];

/// The largest number of significant digits of an f64.
const MOST_DIGITS: usize = 17;

/// The roundest number from `least` to `most`. Both must be positive and finite, and `least` must not exceed `most`.
pub(super) fn roundest(least: f64, most: f64) -> f64 {
    let is_within = |number: &f64| (least..=most).contains(number);
    if let Some(number) = MANTISSAS.iter().find_map(|mantissa| multiple(*mantissa, least, most)) {
        return number;
    }
    let middle = (least * most).sqrt();
    (2..=MOST_DIGITS).map(|digits| round_significant(middle, digits)).find(is_within).unwrap_or(middle)
}

/// The smallest mantissa x 10^n from `least` to `most`. `None` if there is none.
fn multiple(mantissa: f64, least: f64, most: f64) -> Option<f64> {
    let exponent = (least / mantissa).log10().floor() as i32;
    // The exponent of 0 is the least integer.
    let exponents = exponent.saturating_sub(1)..=exponent.saturating_add(2);
    exponents.map(|exponent| decimal(mantissa, exponent)).find(|number| (least..=most).contains(number))
}

/// The f64 nearest to mantissa x 10^exponent.
fn decimal(mantissa: f64, exponent: i32) -> f64 {
    format!("{mantissa}e{exponent}").parse().unwrap_or(f64::NAN)
}

/// The numbers 1, 2 and 5 x 10^n in the decade of a positive number, and 10 x 10^n.
fn steps(number: f64) -> [f64; 4] {
    let exponent = number.log10().floor() as i32;
    let next = decimal(1.0, exponent.saturating_add(1));
    [decimal(1.0, exponent), decimal(2.0, exponent), decimal(5.0, exponent), next]
}

/// The number 1, 2 or 5 x 10^n with the smallest ratio to a positive number.
pub(super) fn nearest_step(number: f64) -> f64 {
    let distance = |step: &f64| (step / number).ln().abs();
    let nearest = steps(number).into_iter().min_by(|one, other| distance(one).total_cmp(&distance(other)));
    nearest.unwrap_or(number)
}

/// The smallest number 1, 2 or 5 x 10^n that is not below a positive number, except for rounding.
pub(super) fn step_above(number: f64) -> f64 {
    let is_above = |step: &f64| *step >= number * (1.0 - 1e-9);
    steps(number).into_iter().find(is_above).unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_roundest_number_of_a_range_is_found() {
        let cases = [
            ((0.9, 1.7), 1.0),
            ((1.1, 2.0), 2.0),
            ((2.1, 4.0), 2.5),
            ((2.6, 4.9), 3.0),
            ((5.1, 9.6), 6.0),
            ((0.010_64, 0.0196), 0.015),
            ((4.2e-9, 7.8e-9), 5e-9),
            ((7.1e12, 1.3e13), 1e13),
            ((2.54e-5, 2.54e-5), 2.54e-5),
        ];
        for ((least, most), expected) in cases {
            assert_eq!(roundest(least, most), expected, "{least} ... {most}");
        }
    }

    #[test]
    fn a_range_with_the_ratio_of_94_to_51_always_has_a_round_number() {
        for step in 0..1000 {
            let least = 1.023_f64.powi(step) * 1e-5;
            let number = roundest(least, least * 94.0 / 51.0);
            let mantissa = round_significant(number / 10f64.powf(number.log10().floor()), 3);
            assert!(MANTISSAS[..9].contains(&mantissa) || mantissa == 10.0, "{least}: {number}");
        }
    }

    #[test]
    fn ranges_without_a_normal_number_do_not_panic() {
        assert_eq!(roundest(0.0, 0.0), 0.0);
        assert!(roundest(0.0, 5e-324) <= 5e-324);
        assert!(roundest(f64::MAX, f64::INFINITY) >= f64::MAX);
    }

    #[test]
    fn time_scales_are_1_2_or_5() {
        let cases = [(1.0, 1.0), (1.3, 1.0), (1.5, 2.0), (3.0, 2.0), (3.3, 5.0), (7.5, 10.0), (0.16, 0.2)];
        for (number, expected) in cases {
            assert_eq!(nearest_step(number), expected, "{number}");
        }
        let cases = [(1.0, 1.0), (1.1, 2.0), (2.5, 5.0), (5.1, 10.0), (0.02, 0.02), (3e-7, 5e-7)];
        for (number, expected) in cases {
            assert_eq!(step_above(number), expected, "{number}");
        }
    }
}
