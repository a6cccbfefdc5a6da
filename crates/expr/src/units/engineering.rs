//! The choice of a readable unit prefix.

use super::parse::Factor;
use super::symbols::{Prefix, power_of_ten, prefix_for};
use super::unit::{Unit, text_of};

/// Values from 1 up to this keep their prefix, because 1500 N is easier to read than 1.5 kN.
const MAX_UNCHANGED: f64 = 1e4;

/// The powers of ten of the prefixes that may be chosen, in ascending order.
const PREFIX_EXPONENTS: [i32; 7] = [-9, -6, -3, 0, 3, 6, 9];

/// Returns the factor and the unit text with which values in `unit` are most readable.
///
/// `largest` is the largest absolute value, in `unit`. The caller multiplies its values by the
/// factor and labels them with the text. Example: for 0.0101 m/s the result is 1000 and `mm/s`. The
/// prefix of the first factor is chosen so that the largest value is at least 1 and below 1000. The
/// unit is unchanged, with factor 1, if
///
/// * the largest value is at least 1 and below 10 000, is zero, or is not finite,
/// * the first factor has a power (`m2`) or takes no prefix (`kg`, `deg`, `%`),
/// * the unit is a pure number,
/// * no customary prefix gives such a value; kiloseconds, for example, are not customary.
///
/// # Examples
///
/// ```
/// use patchcord_expr::{Unit, engineering};
///
/// let (factor, unit) = engineering(&Unit::parse("m/s")?, 0.0101);
/// assert_eq!((factor, unit.as_str()), (1000.0, "mm/s"));
/// let (factor, unit) = engineering(&Unit::parse("N")?, 1500.0);
/// assert_eq!((factor, unit.as_str()), (1.0, "N"));
/// # Ok::<(), patchcord_expr::UnitError>(())
/// ```
pub fn engineering(unit: &Unit, largest: f64) -> (f64, String) {
    match better_prefix(unit, largest.abs()) {
        Some((first, prefix)) => {
            let factor = power_of_ten(first.prefix.exponent - prefix.exponent);
            (factor, with_first_prefix(unit, prefix))
        }
        None => (1.0, unit.text().to_owned()),
    }
}

/// Returns the first factor and the prefix that makes values readable; `None` if the unit must stay.
fn better_prefix(unit: &Unit, largest: f64) -> Option<(&Factor, Prefix)> {
    let first = unit.factors().first().filter(|first| first.power == 1.0)?;
    let max_exponent = first.symbol.max_prefix?;
    if (1.0..MAX_UNCHANGED).contains(&largest) {
        return None;
    }
    let fits = |exponent: &&i32| {
        let shown = largest * power_of_ten(first.prefix.exponent - **exponent);
        **exponent <= max_exponent && (1.0..1000.0).contains(&shown)
    };
    let exponent = PREFIX_EXPONENTS.iter().find(fits)?;
    Some((first, prefix_for(*exponent)?))
}

/// Returns the text of the unit with another prefix of its first factor.
fn with_first_prefix(unit: &Unit, prefix: Prefix) -> String {
    let mut factors = unit.factors().to_vec();
    if let Some(first) = factors.first_mut() {
        first.prefix = prefix;
    }
    text_of(&factors)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn shown(text: &str, largest: f64) -> (f64, String) {
        engineering(&Unit::parse(text).unwrap(), largest)
    }

    #[test]
    fn chooses_readable_prefixes() {
        let cases = [
            ("m/s", 0.0101, 1e3, "mm/s"),
            ("m/s", -0.0101, 1e3, "mm/s"),
            ("m", 3e-6, 1e6, "µm"),
            ("m", 3e-9, 1e9, "nm"),
            ("mm/s", 12345.0, 1e-3, "m/s"),
            ("mm/s", 0.05, 1e3, "µm/s"),
            ("N", 25_000.0, 1e-3, "kN"),
            ("N s/m", 0.25, 1e3, "mN s/m"),
            ("cm", 0.05, 1e4, "µm"),
        ];
        for (text, largest, factor, better) in cases {
            assert_eq!(shown(text, largest), (factor, better.to_owned()), "{text}");
        }
    }

    #[test]
    fn keeps_units_without_a_better_prefix() {
        let cases = [
            ("N", 771.0),
            ("N", 1500.0),
            ("s", 8.4),
            ("s", 86_400.0),
            ("1", 1e-6),
            ("", 1e-6),
            ("%", 0.001),
            ("1/s", 1e6),
            ("kg", 1e-3),
            ("m2", 1e-6),
            ("m", 0.0),
            ("m", f64::INFINITY),
            ("m", f64::NAN),
            ("m", 1e-20),
            ("N*s", 3.0),
        ];
        for (text, largest) in cases {
            assert_eq!(shown(text, largest), (1.0, text.to_owned()), "{largest}");
        }
    }

    proptest! {
        #[test]
        fn the_shown_value_is_the_same_quantity(exponent in -12i32..12, text in "(k|m|µ|)(N|m|V) s/kg") {
            let unit = Unit::parse(&text).unwrap();
            let largest = 3.0 * power_of_ten(exponent);
            let (factor, better) = engineering(&unit, largest);
            let after = Unit::parse(&better).unwrap();
            prop_assert_eq!(after.dimension(), unit.dimension());
            let ratio = after.to_si(largest * factor) / unit.to_si(largest);
            prop_assert!((ratio - 1.0).abs() < 1e-14);
        }
    }
}
