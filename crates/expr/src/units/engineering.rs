use super::read::Factor;
use super::symbols::{Prefix, prefix_for, ten_to};
use super::unit::{Unit, text_of};

/// Values from 1 up to this keep the prefix that was written: 1500 N is easier read than 1.5 kN.
const LARGEST_KEPT: f64 = 1e4;

/// The powers of ten among which a prefix is chosen, smallest first.
const CHOICES: [i32; 7] = [-9, -6, -3, 0, 3, 6, 9];

/// The factor and unit text with which values in `unit` are best shown.
///
/// `largest` is the largest absolute value, in `unit`. Values are multiplied by the returned
/// factor and labelled with the returned text: values up to 0.0101 m/s come out as up to 10.1
/// mm/s. The prefix of the first factor is chosen so that the largest value lies between 1 and
/// 1000. The unit stays as it is, with factor 1, when
///
/// * the largest value lies between 1 and 10 000 already, is zero, or is not finite,
/// * the first factor has a power (`m2`), takes no prefix (`kg`, `deg`, `%`), or there is none,
/// * no customary prefix would do: there are no kiloseconds.
pub fn engineering(unit: &Unit, largest: f64) -> (f64, String) {
    match better_prefix(unit, largest.abs()) {
        Some((first, prefix)) => {
            let factor = ten_to(first.prefix.exponent - prefix.exponent);
            (factor, with_first_prefix(unit, prefix))
        }
        None => (1.0, unit.text().to_owned()),
    }
}

fn better_prefix(unit: &Unit, largest: f64) -> Option<(&Factor, Prefix)> {
    let first = unit.factors().first().filter(|first| first.power == 1.0)?;
    let most = first.symbol.customary?;
    if (1.0..LARGEST_KEPT).contains(&largest) {
        return None;
    }
    let fits = |exponent: &&i32| {
        let shown = largest * ten_to(first.prefix.exponent - **exponent);
        **exponent <= most && (1.0..1000.0).contains(&shown)
    };
    let exponent = CHOICES.iter().find(fits)?;
    Some((first, prefix_for(*exponent)?))
}

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
    fn keeps_units_that_do_well_or_cannot_do_better() {
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
            let largest = 3.0 * ten_to(exponent);
            let (factor, better) = engineering(&unit, largest);
            let after = Unit::parse(&better).unwrap();
            prop_assert_eq!(after.dimension(), unit.dimension());
            let ratio = after.to_si(largest * factor) / unit.to_si(largest);
            prop_assert!((ratio - 1.0).abs() < 1e-14);
        }
    }
}
