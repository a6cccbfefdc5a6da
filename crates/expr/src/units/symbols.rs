use std::f64::consts::PI;

use super::dimension::Dimension;
use super::nearest::nearest;

/// A unit that has a symbol of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Symbol {
    pub name: &'static str,
    pub factor: f64,
    pub dimension: Dimension,
    /// `None` for a unit without SI prefixes; else the largest power of ten that is customary
    /// when a prefix has to be chosen (any prefix may be read).
    pub customary: Option<i32>,
}

/// An SI prefix and its power of ten.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Prefix {
    pub name: &'static str,
    pub exponent: i32,
}

/// Up to this power, ten to a whole power is a number without rounding.
pub(super) const LARGEST_EXACT_TEN: i32 = 22;
pub(super) const NO_PREFIX: Prefix = prefix("", 0);
pub(super) const SECOND: Symbol = prefixed("s", 1.0, Dimension::TIME, 0);

// The first spelling of a power of ten is the one that is written; both signs for micro are read.
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

const fn prefix(name: &'static str, exponent: i32) -> Prefix {
    Prefix { name, exponent }
}

const fn plain(name: &'static str, factor: f64, dimension: Dimension) -> Symbol {
    Symbol { name, factor, dimension, customary: None }
}

const fn prefixed(name: &'static str, factor: f64, dimension: Dimension, customary: i32) -> Symbol {
    Symbol { name, factor, dimension, customary: Some(customary) }
}

/// The unit of this name, with its prefix. A whole symbol goes before a prefixed one: `min` is
/// the minute, `kg` a unit of its own.
pub(super) fn known(name: &str) -> Option<(Prefix, Symbol)> {
    if let Some(symbol) = SYMBOLS.iter().find(|symbol| symbol.name == name) {
        return Some((NO_PREFIX, *symbol));
    }
    PREFIXES.iter().find_map(|prefix| {
        let bare = name.strip_prefix(prefix.name)?;
        let mut takers = SYMBOLS.iter().filter(|symbol| symbol.customary.is_some());
        let symbol = takers.find(|symbol| symbol.name == bare)?;
        Some((*prefix, *symbol))
    })
}

/// The prefix that is written for a power of ten.
pub(super) fn prefix_for(exponent: i32) -> Option<Prefix> {
    let mut every = std::iter::once(&NO_PREFIX).chain(&PREFIXES);
    every.find(|prefix| prefix.exponent == exponent).copied()
}

/// What people write out in full, and the symbol for it.
const WRITTEN_OUT: [(&str, &str); 18] = [
    ("sec", "s"),
    ("second", "s"),
    ("minute", "min"),
    ("hour", "h"),
    ("hr", "h"),
    ("metre", "m"),
    ("meter", "m"),
    ("gram", "g"),
    ("kilogram", "kg"),
    ("newton", "N"),
    ("joule", "J"),
    ("watt", "W"),
    ("pascal", "Pa"),
    ("volt", "V"),
    ("ampere", "A"),
    ("hertz", "Hz"),
    ("percent", "%"),
    ("radian", "rad"),
];

fn symbol_of(written_out: &str) -> Option<&'static str> {
    let lower = written_out.to_lowercase();
    let singular = lower.strip_suffix('s').unwrap_or(&lower);
    WRITTEN_OUT.iter().find(|(word, _)| *word == lower || *word == singular).map(|(_, symbol)| *symbol)
}

/// What an unknown name was probably meant to be: one or two unit texts, or none.
pub(super) fn suggestions(unknown: &str) -> Vec<String> {
    if let Some(symbol) = symbol_of(unknown) {
        return vec![symbol.to_owned()];
    }
    let names = all_names();
    let near = nearest(unknown, names.iter().map(String::as_str)).map(str::to_owned);
    match two_units_run_together(unknown) {
        Some(product) => {
            near.filter(|name| differs_only_in_case(name, unknown)).into_iter().chain([product]).collect()
        }
        None => near.into_iter().collect(),
    }
}

fn differs_only_in_case(name: &str, unknown: &str) -> bool {
    name.to_lowercase() == unknown.to_lowercase()
}

fn two_units_run_together(unknown: &str) -> Option<String> {
    unknown.char_indices().skip(1).find_map(|(at, _)| {
        let (left, right) = unknown.split_at(at);
        let (own, other) = (known(left)?.1, known(right)?.1);
        // Nobody multiplies a unit by itself so: a letter was typed twice.
        (own.name != other.name).then(|| format!("{left} {right}"))
    })
}

fn all_names() -> Vec<String> {
    let bare = SYMBOLS.iter().map(|symbol| symbol.name.to_owned());
    let takers = SYMBOLS.iter().filter(|symbol| symbol.customary.is_some());
    let combined = takers.flat_map(|symbol| {
        let join = move |prefix: &Prefix| format!("{}{}", prefix.name, symbol.name);
        PREFIXES.iter().map(join)
    });
    bare.chain(combined).collect()
}

/// Ten to a whole power, correctly rounded up to `LARGEST_EXACT_TEN`.
pub(super) fn ten_to(exponent: i32) -> f64 {
    let magnitude = (0..exponent.unsigned_abs()).fold(1.0, |product, _| product * 10.0);
    if exponent < 0 { 1.0 / magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn only_the_kilogram_is_known_twice() {
        let mut seen = HashSet::new();
        let twice: Vec<String> = all_names().into_iter().filter(|name| !seen.insert(name.clone())).collect();
        assert_eq!(twice, ["kg"]);
    }

    #[test]
    fn whole_symbols_go_before_prefixed_ones() {
        let name = |text| known(text).map(|(prefix, symbol)| (prefix.name, symbol.name));
        assert_eq!(name("min"), Some(("", "min")));
        assert_eq!(name("mm"), Some(("m", "m")));
        assert_eq!(name("Pa"), Some(("", "Pa")));
        assert_eq!(name("cP"), Some(("c", "P")));
        assert_eq!(name("kgf"), Some(("", "kgf")));
        assert_eq!(name("mmin"), None);
    }

    #[test]
    fn powers_of_ten_are_exact() {
        assert_eq!(ten_to(9), 1e9);
        assert_eq!(ten_to(-9), 1e-9);
        assert_eq!(ten_to(0), 1.0);
    }

    #[test]
    fn suggests_what_was_meant() {
        assert_eq!(suggestions("Nm"), ["nm", "N m"]);
        assert_eq!(suggestions("KN"), ["kN", "K N"]);
        assert_eq!(suggestions("pa"), ["Pa"]);
        assert_eq!(suggestions("Ns"), ["ns", "N s"]);
        assert_eq!(suggestions("kgm"), ["kg m"]);
        assert_eq!(suggestions("mmm"), ["mm"]);
        assert!(suggestions("furlong").is_empty());
    }
}
