//! The table of unit symbols and SI prefixes.
//!
//! The sizes of non-SI units are exact by definition (in, ft, lb, lbf, kgf, h) or rounded to the nearest
//! 64-bit number (deg, rpm, psi, hp). The horsepower is the mechanical one, 550 ft lbf/s.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use super::dimension::Dimension;
use super::nearest::nearest;
use super::synonyms::symbol_of;

/// A unit symbol without prefix, such as `N` or `min`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Symbol {
    /// The text of the symbol.
    pub name: &'static str,
    /// The size of the unit in SI units.
    pub factor: f64,
    /// The dimension of the quantities that are measured in this unit.
    pub dimension: Dimension,
    /// The power of ten of the largest prefix that is customary in output; every prefix is accepted
    /// in input. `None` if the symbol takes no prefix.
    pub max_prefix: Option<i32>,
}

impl Symbol {
    /// Whether the symbol contains an angle: `rad`, `deg`, and `rpm`, which is an angle per time.
    pub(super) fn is_angle(self) -> bool {
        matches!(self.name, "rad" | "deg" | "rpm")
    }

    /// The size of the unit if angles are measured in turns. Other symbols have their usual size.
    pub(super) fn size_in_turns(self) -> f64 {
        match self.name {
            "rad" => 1.0 / TAU,
            "deg" => 1.0 / 360.0,
            "rpm" => 1.0 / 60.0,
            _ => self.factor,
        }
    }

    /// Whether the symbol counts cycles.
    pub(super) fn is_cycle(self) -> bool {
        self.name == "Hz"
    }
}

/// An SI prefix and its power of ten.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Prefix {
    /// The text of the prefix; empty for no prefix.
    pub name: &'static str,
    /// The power of ten: 3 for `k`.
    pub exponent: i32,
}

/// The largest whole power of ten that is exact in a 64-bit number.
pub(super) const MAX_EXACT_POWER_OF_TEN: i32 = 22;
/// The empty prefix.
pub(super) const NO_PREFIX: Prefix = prefix("", 0);
/// The symbol of the second; [`super::Unit::per_second`] needs it.
pub(super) const SECOND: Symbol = prefixed("s", 1.0, Dimension::TIME, 0);

/// The largest number of letters of a short name. With an edit, a short name is often another unit: "cal" is not "cl".
const MAX_SHORT_NAME: usize = 3;

/// Pairs of units that are often written without a blank, such as `kNm`.
const UNSPACED_PRODUCTS: [(&str, &str); 6] =
    [("N", "m"), ("N", "mm"), ("N", "cm"), ("W", "h"), ("A", "h"), ("Pa", "s")];

/// Every prefix that is accepted.
///
/// Of several spellings of a power of ten, output uses the first. Both Unicode signs for micro and the
/// letter u are accepted.
const PREFIXES: [Prefix; 10] = [
    prefix("p", -12),
    prefix("n", -9),
    prefix("µ", -6),
    prefix("μ", -6),
    prefix("u", -6),
    prefix("m", -3),
    prefix("c", -2),
    prefix("k", 3),
    prefix("M", 6),
    prefix("G", 9),
];

/// Every symbol. The order decides only which of two equally similar names a hint suggests.
///
/// The kilogram has its own row, without prefixes, so that output keeps `kg`.
const SYMBOLS: [Symbol; 37] = [
    prefixed("m", 1.0, Dimension::LENGTH, 3),
    plain("kg", 1.0, Dimension::MASS),
    prefixed("g", 1e-3, Dimension::MASS, 3),
    SECOND,
    prefixed("A", 1.0, Dimension::CURRENT, 9),
    prefixed("K", 1.0, Dimension::TEMPERATURE, 0),
    prefixed("N", 1.0, Dimension::FORCE, 9),
    prefixed("Pa", 1.0, Dimension::PRESSURE, 9),
    prefixed("J", 1.0, Dimension::ENERGY, 9),
    prefixed("W", 1.0, Dimension::POWER, 9),
    prefixed("V", 1.0, Dimension::VOLTAGE, 9),
    prefixed("Hz", 1.0, Dimension::FREQUENCY, 9),
    prefixed("ohm", 1.0, Dimension::RESISTANCE, 9),
    prefixed("Ohm", 1.0, Dimension::RESISTANCE, 9),
    prefixed("Ω", 1.0, Dimension::RESISTANCE, 9),
    prefixed("F", 1.0, Dimension::CAPACITANCE, 0),
    prefixed("H", 1.0, Dimension::INDUCTANCE, 0),
    prefixed("C", 1.0, Dimension::CHARGE, 0),
    prefixed("T", 1.0, Dimension::FLUX_DENSITY, 0),
    prefixed("P", 0.1, Dimension::VISCOSITY, 0),
    prefixed("bar", 1e5, Dimension::PRESSURE, 0),
    prefixed("l", 1e-3, Dimension::VOLUME, 0),
    prefixed("L", 1e-3, Dimension::VOLUME, 0),
    prefixed("rad", 1.0, Dimension::NONE, 0),
    plain("deg", PI / 180.0, Dimension::NONE),
    plain("%", 0.01, Dimension::NONE),
    plain("min", 60.0, Dimension::TIME),
    plain("h", 3600.0, Dimension::TIME),
    plain("rpm", PI / 30.0, Dimension::FREQUENCY),
    plain("in", 0.0254, Dimension::LENGTH),
    plain("ft", 0.3048, Dimension::LENGTH),
    plain("lb", 0.45359237, Dimension::MASS),
    plain("lbf", 4.4482216152605, Dimension::FORCE),
    plain("kgf", 9.80665, Dimension::FORCE),
    plain("psi", 6894.757293168361, Dimension::PRESSURE),
    plain("hp", 745.6998715822702, Dimension::POWER),
    plain("t", 1e3, Dimension::MASS),
];

/// Makes a prefix.
const fn prefix(name: &'static str, exponent: i32) -> Prefix {
    Prefix { name, exponent }
}

/// Makes a symbol that takes no prefix.
const fn plain(name: &'static str, factor: f64, dimension: Dimension) -> Symbol {
    Symbol { name, factor, dimension, max_prefix: None }
}

/// Makes a symbol that takes prefixes, up to `max_prefix` in output.
const fn prefixed(name: &'static str, factor: f64, dimension: Dimension, max_prefix: i32) -> Symbol {
    Symbol { name, factor, dimension, max_prefix: Some(max_prefix) }
}

/// Splits a name into prefix and symbol; `None` if it is not a unit.
///
/// A symbol without prefix takes precedence: `min` is the minute, not the milli-inch.
pub(super) fn from_name(name: &str) -> Option<(Prefix, Symbol)> {
    if let Some(symbol) = SYMBOLS.iter().find(|symbol| symbol.name == name) {
        return Some((NO_PREFIX, *symbol));
    }
    PREFIXES.iter().find_map(|prefix| {
        let bare = name.strip_prefix(prefix.name)?;
        let mut prefixable = SYMBOLS.iter().filter(|symbol| symbol.max_prefix.is_some());
        let symbol = prefixable.find(|symbol| symbol.name == bare)?;
        Some((*prefix, *symbol))
    })
}

/// Returns the prefix for a power of ten; `None` if there is none.
pub(super) fn prefix_for(exponent: i32) -> Option<Prefix> {
    let mut every = std::iter::once(&NO_PREFIX).chain(&PREFIXES);
    every.find(|prefix| prefix.exponent == exponent).copied()
}

/// Returns a prefix and a symbol as one name; `None` if the symbol does not take the prefix.
pub(super) fn with_prefix(prefix: &str, symbol: &str) -> Option<String> {
    let name = format!("{prefix}{symbol}");
    // A name such as "min" has another meaning.
    let (found_prefix, found_symbol) = from_name(&name)?;
    (found_prefix.name == prefix && found_symbol.name == symbol).then_some(name)
}

/// Returns at most two unit texts that the author of an unknown name probably meant.
///
/// A name written in full gives its symbol. Otherwise the nearest name is suggested, and a product of
/// two units if the name is one: `Nm` gives `nm` and `N m`. The nearest name of a short name has the same letters.
pub(super) fn suggestions(unknown: &str) -> Vec<String> {
    if let Some(symbol) = symbol_of(unknown).or_else(|| prefixed_full_name(unknown)) {
        return vec![symbol];
    }
    let mut names = all_names();
    if unknown.chars().count() <= MAX_SHORT_NAME {
        names.retain(|name| letters(name) == letters(unknown));
    }
    let near = nearest(unknown, names.iter().map(String::as_str)).map(str::to_owned);
    match as_product(unknown) {
        Some(product) => {
            near.filter(|name| is_equal_ignoring_case(name, unknown)).into_iter().chain([product]).collect()
        }
        None => near.into_iter().collect(),
    }
}

/// Returns the symbol with its prefix for a prefix in front of a full name: `mV` for `mVolts`.
pub(super) fn prefixed_full_name(name: &str) -> Option<String> {
    PREFIXES.iter().find_map(|prefix| {
        let full_name = name.strip_prefix(prefix.name)?;
        let is_long = full_name.chars().count() > MAX_SHORT_NAME;
        with_prefix(prefix.name, &symbol_of(full_name).filter(|_| is_long)?)
    })
}

/// Returns a product of two units that is usual without a blank, with the blank: `kN m` for `kNm`.
pub(super) fn unspaced_product(name: &str) -> Option<String> {
    UNSPACED_PRODUCTS.iter().find_map(|(first, second)| {
        let prefix = name.strip_suffix(*second)?.strip_suffix(*first)?;
        with_prefix(prefix, first).map(|first| format!("{first} {second}"))
    })
}

/// Returns the names of units that differ from a name only in upper and lower case, in alphabetical order.
pub(super) fn in_other_case(name: &str) -> Vec<String> {
    let mut names = all_names();
    names.retain(|known| is_equal_ignoring_case(known, name));
    names.sort_unstable();
    names.dedup();
    names
}

/// Returns the letters of a name without regard to their order, number and case.
fn letters(name: &str) -> BTreeSet<char> {
    name.to_lowercase().chars().collect()
}

/// Whether two names are equal without regard to upper and lower case.
fn is_equal_ignoring_case(name: &str, unknown: &str) -> bool {
    name.to_lowercase() == unknown.to_lowercase()
}

/// Splits a name into two different units: `Nm` into `N m`.
fn as_product(unknown: &str) -> Option<String> {
    unknown.char_indices().skip(1).find_map(|(at, _)| {
        let (left, right) = unknown.split_at(at);
        let (own, other) = (from_name(left)?.1, from_name(right)?.1);
        // The same unit twice is a typing error, such as "mmm", not a product.
        (own.name != other.name).then(|| format!("{left} {right}"))
    })
}

/// Returns every symbol, and every symbol with every prefix.
fn all_names() -> Vec<String> {
    let bare = SYMBOLS.iter().map(|symbol| symbol.name.to_owned());
    let prefixable = SYMBOLS.iter().filter(|symbol| symbol.max_prefix.is_some());
    let combined = prefixable.flat_map(|symbol| {
        let join = move |prefix: &Prefix| format!("{}{}", prefix.name, symbol.name);
        PREFIXES.iter().map(join)
    });
    bare.chain(combined).collect()
}

/// Returns ten to a whole power, correctly rounded up to [`MAX_EXACT_POWER_OF_TEN`].
pub(super) fn power_of_ten(exponent: i32) -> f64 {
    let magnitude = (0..exponent.unsigned_abs()).fold(1.0, |product, _| product * 10.0);
    if exponent < 0 { 1.0 / magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn only_the_kilogram_has_two_readings() {
        let mut seen = HashSet::new();
        let twice: Vec<String> = all_names().into_iter().filter(|name| !seen.insert(name.clone())).collect();
        assert_eq!(twice, ["kg"]);
    }

    #[test]
    fn plain_symbols_take_precedence() {
        let name = |text| from_name(text).map(|(prefix, symbol)| (prefix.name, symbol.name));
        assert_eq!(name("min"), Some(("", "min")));
        assert_eq!(name("mm"), Some(("m", "m")));
        assert_eq!(name("Pa"), Some(("", "Pa")));
        assert_eq!(name("cP"), Some(("c", "P")));
        assert_eq!(name("kgf"), Some(("", "kgf")));
        assert_eq!(name("mmin"), None);
    }

    #[test]
    fn products_without_a_blank_are_split() {
        let cases = [
            ("Nm", Some("N m")),
            ("kNm", Some("kN m")),
            ("mNm", Some("mN m")),
            ("Nmm", Some("N mm")),
            ("kWh", Some("kW h")),
            ("mPas", Some("mPa s")),
            ("nm", None),
            ("Nms", None),
            ("xNm", None),
            ("N m", None),
        ];
        for (name, product) in cases {
            assert_eq!(unspaced_product(name).as_deref(), product, "{name}");
        }
    }

    #[test]
    fn prefixes_of_full_names_are_found() {
        let cases = [
            ("mVolts", Some("mV")),
            ("kNewton", Some("kN")),
            ("uSeconds", Some("us")),
            ("minches", None),
            ("camp", None),
            ("volts", None),
        ];
        for (name, symbol) in cases {
            assert_eq!(prefixed_full_name(name).as_deref(), symbol, "{name}");
        }
    }

    #[test]
    fn names_in_another_case_are_found() {
        assert_eq!(in_other_case("KN"), ["kN"]);
        assert_eq!(in_other_case("KG"), ["kg"]);
        assert_eq!(in_other_case("MPA"), ["MPa", "mPa"]);
        assert_eq!(in_other_case("left"), [""; 0]);
    }

    #[test]
    fn powers_of_ten_are_exact() {
        assert_eq!(power_of_ten(9), 1e9);
        assert_eq!(power_of_ten(-9), 1e-9);
        assert_eq!(power_of_ten(0), 1.0);
    }

    #[test]
    fn suggests_the_intended_unit() {
        assert_eq!(suggestions("Nm"), ["nm", "N m"]);
        assert_eq!(suggestions("KN"), ["kN", "K N"]);
        assert_eq!(suggestions("pa"), ["Pa"]);
        assert_eq!(suggestions("Ns"), ["ns", "N s"]);
        assert_eq!(suggestions("kgm"), ["kg m"]);
        assert_eq!(suggestions("mmm"), ["mm"]);
        assert!(suggestions("furlong").is_empty());
    }
}
