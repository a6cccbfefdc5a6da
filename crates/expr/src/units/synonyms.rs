//! Names of units in full, and units that are not known, for hints and for the names of columns.
//!
//! A similar name is often another quantity: "rps" is not "rpm", and "mph" is not "mPa". So these tables are asked
//! before similar names.

use super::dimension::Dimension;
use super::symbols::with_prefix;

/// What to write instead of a text for a pure number.
pub(super) const PURE_NUMBER: &str = "write \"1\" for a pure number";

/// What to write instead of a unit of revolutions.
const REVOLUTIONS: &str = "revolutions per second are Hz, and per minute rpm";

/// Unit names in full and their symbols. A plural `s` is ignored.
const FULL_NAMES: [(&str, &str); 44] = [
    ("sec", "s"),
    ("second", "s"),
    ("msec", "ms"),
    ("milli", "ms"),
    ("usec", "us"),
    ("nsec", "ns"),
    ("min", "min"),
    ("minute", "min"),
    ("hour", "h"),
    ("hr", "h"),
    ("metre", "m"),
    ("meter", "m"),
    ("micron", "µm"),
    ("inch", "in"),
    ("inches", "in"),
    ("foot", "ft"),
    ("feet", "ft"),
    ("gram", "g"),
    ("kilogram", "kg"),
    ("kg", "kg"),
    ("tonne", "t"),
    ("pound", "lb"),
    ("lb", "lb"),
    ("newton", "N"),
    ("joule", "J"),
    ("watt", "W"),
    ("pascal", "Pa"),
    ("bar", "bar"),
    ("volt", "V"),
    ("amp", "A"),
    ("ampere", "A"),
    ("ohm", "ohm"),
    ("coulomb", "C"),
    ("farad", "F"),
    ("tesla", "T"),
    ("kelvin", "K"),
    ("hertz", "Hz"),
    ("percent", "%"),
    ("rad", "rad"),
    ("radian", "rad"),
    ("degree", "deg"),
    ("litre", "l"),
    ("liter", "l"),
    ("henry", "H"),
];

/// Full names that are also other words: "max" and "min", the second of two, the left foot, the output of an amp.
const WORDS: [&str; 4] = ["min", "second", "foot", "amp"];

/// The prefixes of full names.
const FULL_PREFIXES: [(&str, &str); 8] = [
    ("pico", "p"),
    ("nano", "n"),
    ("micro", "µ"),
    ("milli", "m"),
    ("centi", "c"),
    ("kilo", "k"),
    ("mega", "M"),
    ("giga", "G"),
];

/// Units that are not known: their names, the dimension of all of them if it is clear, and what to write instead.
///
/// Names are in lower case, or in the only case in which they have this meaning.
const UNKNOWN_UNITS: [(&[&str], Option<Dimension>, &str); 44] = [
    (
        &["degc", "degf", "degk", "celsius", "centigrade", "fahrenheit"],
        Some(Dimension::TEMPERATURE),
        "temperatures are in K, and 0 °C is 273.15 K",
    ),
    (&["rps", "cps"], Some(Dimension::FREQUENCY), REVOLUTIONS),
    (&["rev", "revs", "revolution", "revolutions", "turn", "turns", "cycle", "cycles"], None, REVOLUTIONS),
    (&["grad", "gon"], Some(Dimension::NONE), "1 gon is 0.9 deg"),
    (&["arcmin"], Some(Dimension::NONE), "60 arcmin are 1 deg"),
    (&["arcsec"], Some(Dimension::NONE), "3600 arcsec are 1 deg"),
    (&["kph", "kmh"], Some(VELOCITY), "write km/h"),
    (&["mph"], Some(VELOCITY), "a mile per hour is 0.44704 m/s"),
    (&["mps"], Some(VELOCITY), "write m/s"),
    (&["fps"], Some(VELOCITY), "write ft/s"),
    (&["knot", "knots", "kt", "kts"], Some(VELOCITY), "a knot is 1.852 km/h"),
    (&["d", "day", "days"], Some(Dimension::TIME), "a day is 24 h"),
    (&["week", "weeks"], Some(Dimension::TIME), "a week is 168 h"),
    (&["year", "years"], Some(Dimension::TIME), "a year of 365 days is 8760 h"),
    (&["ppm"], Some(Dimension::NONE), "1 ppm is 1e-4 %"),
    (&["db"], Some(Dimension::NONE), "20 dB are a factor of 10 of an amplitude: write the factor, in 1"),
    (&["dimensionless", "unitless", "none"], Some(Dimension::NONE), PURE_NUMBER),
    (&["mil", "mils", "thou"], Some(Dimension::LENGTH), "a thousandth of an inch is 0.0254 mm"),
    (&["dm"], Some(Dimension::LENGTH), "1 dm is 10 cm"),
    (&["yd", "yard", "yards"], Some(Dimension::LENGTH), "a yard is 3 ft"),
    (&["mi", "mile", "miles"], Some(Dimension::LENGTH), "a mile is 1.609344 km"),
    (&["oz", "ounce", "ounces"], Some(Dimension::MASS), "an ounce is 28.349523125 g"),
    (&["slug", "slugs"], Some(Dimension::MASS), "a slug is 14.5939 kg"),
    (
        &["ton", "tons"],
        Some(Dimension::MASS),
        "a metric ton is t, a ton of 2000 lb is 907.18474 kg, and one of 2240 lb is 1016.0469088 kg",
    ),
    (&["dan"], Some(Dimension::FORCE), "1 daN is 10 N"),
    (&["dyn", "dyne"], Some(Dimension::FORCE), "1 dyn is 1e-5 N"),
    (&["kip", "kips"], Some(Dimension::FORCE), "1 kip is 1000 lbf"),
    (&["atm"], Some(Dimension::PRESSURE), "1 atm is 101325 Pa"),
    (&["mmhg", "torr"], Some(Dimension::PRESSURE), "1 mmHg is 133.322 Pa"),
    (&["hpa"], Some(Dimension::PRESSURE), "1 hPa is 100 Pa, or 1 mbar"),
    (&["ksi"], Some(Dimension::PRESSURE), "1 ksi is 1000 psi"),
    (&["cst", "stokes"], Some(Dimension::new(0, 2, -1, 0, 0)), "1 cSt is 1 mm2/s"),
    (&["cal", "kcal", "calorie", "calories"], Some(Dimension::ENERGY), "1 cal is 4.184 J"),
    (&["ev", "kev", "mev", "gev"], Some(Dimension::ENERGY), "1 eV is 1.602176634e-19 J"),
    (&["erg"], Some(Dimension::ENERGY), "1 erg is 1e-7 J"),
    (&["btu"], Some(Dimension::ENERGY), "1 BTU is 1055.06 J"),
    (&["Nms", "mNms", "kNms"], Some(Dimension::new(1, 2, -1, 0, 0)), "write N m s"),
    (
        &["S", "mS", "uS", "µS", "nS", "kS", "siemens"],
        Some(Dimension::new(-1, -2, 3, 2, 0)),
        "1 S (siemens) is 1/ohm; a second is s",
    ),
    (&["wb", "mwb", "weber"], Some(Dimension::new(1, 2, -2, -1, 0)), "1 Wb is 1 V s"),
    (&["G", "mG", "gauss"], Some(Dimension::FLUX_DENSITY), "1 G (gauss) is 1e-4 T; a gram is g"),
    (
        &["gal", "gallon", "gallons"],
        Some(Dimension::VOLUME),
        "a gallon is 3.78541 l in the USA, and 4.54609 l in Britain",
    ),
    (
        &["mol", "mole", "moles", "mmol", "umol", "µmol", "nmol", "kmol", "mM", "uM", "µM", "nM"],
        None,
        "no unit counts molecules: write a mass, such as g/l",
    ),
    (&["M"], None, "M is the prefix mega, as in MN; a metre is m, and no unit counts molecules"),
    (&["pi"], None, "pi is a number: write 3.14159"),
];

/// The dimension of a velocity, m/s.
const VELOCITY: Dimension = Dimension::new(0, 1, -1, 0, 0);

/// Returns the symbol for a unit that is written in full, also with a prefix in full; `None` if the word is not in the
/// list.
pub(super) fn symbol_of(full_name: &str) -> Option<String> {
    let lower = full_name.to_lowercase();
    let with_full_prefix = |(word, prefix): &(&str, &str)| {
        let symbol = symbol_without_prefix(lower.strip_prefix(*word)?)?;
        with_prefix(prefix, symbol)
    };
    let symbol = symbol_without_prefix(&lower).map(str::to_owned);
    symbol.or_else(|| FULL_PREFIXES.iter().find_map(with_full_prefix))
}

/// Returns the symbol for a name in lower case that is written in full without a prefix.
fn symbol_without_prefix(lower: &str) -> Option<&'static str> {
    let singular = lower.strip_suffix('s').unwrap_or(lower);
    FULL_NAMES.iter().find(|(word, _)| *word == lower || *word == singular).map(|(_, symbol)| *symbol)
}

/// Whether a name that is written in full cannot be another word, such as "Sec" for a section or "min" for a minimum.
pub(super) fn is_clear_full_name(name: &str) -> bool {
    let lower = name.to_lowercase();
    let is_abbreviation = name.chars().count() <= 3;
    !WORDS.contains(&lower.as_str()) && (!is_abbreviation || lower == name)
}

/// Returns what to write instead of a unit that is not known, and the dimension of that unit if it is clear. `None` if
/// the table does not have the name.
pub(super) fn advice(name: &str) -> Option<(&'static str, Option<Dimension>)> {
    let lower = name.to_lowercase();
    let found =
        UNKNOWN_UNITS.iter().find(|(names, _, _)| names.contains(&name) || names.contains(&lower.as_str()));
    found.map(|(_, dimension, advice)| (*advice, *dimension))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Unit;

    #[test]
    fn full_names_have_known_symbols() {
        for (name, symbol) in FULL_NAMES {
            assert!(Unit::parse(symbol).is_ok(), "{name}");
            let plural = format!("{name}s").to_uppercase();
            assert_eq!(symbol_of(&plural).as_deref(), Some(symbol), "{name}");
        }
    }

    #[test]
    fn full_names_may_have_a_prefix_in_full() {
        let cases = [
            ("milliseconds", Some("ms")),
            ("Micrometer", Some("µm")),
            ("kilonewtons", Some("kN")),
            ("megapascal", Some("MPa")),
            ("kilopound", None),
            ("centigrade", None),
        ];
        for (name, symbol) in cases {
            assert_eq!(symbol_of(name).as_deref(), symbol, "{name}");
        }
    }

    #[test]
    fn full_names_that_are_other_words_are_not_clear() {
        for name in ["sec", "secs", "seconds", "Seconds", "hrs", "mins", "Volt", "microns"] {
            assert!(is_clear_full_name(name), "{name}");
        }
        for name in ["Sec", "HR", "min", "MIN", "second", "foot", "Amp"] {
            assert!(!is_clear_full_name(name), "{name}");
        }
    }

    #[test]
    fn units_with_advice_are_not_known() {
        for name in UNKNOWN_UNITS.iter().flat_map(|(names, _, _)| *names) {
            assert!(Unit::parse(name).is_err() && symbol_of(name).is_none(), "{name}");
        }
        assert_eq!(advice("MPH"), Some(("a mile per hour is 0.44704 m/s", Some(VELOCITY))));
        assert_eq!(advice("furlong"), None);
        // The gram and the millimetre are known.
        assert!(advice("G").is_some() && advice("g").is_none());
        assert!(advice("mM").is_some() && advice("mm").is_none());
    }
}
