//! Names of units in full, and units that are not known, for hints.
//!
//! A similar name is often another quantity: "rps" is not "rpm", and "mph" is not "mPa". So these tables are asked
//! before similar names.

/// Unit names in full and their symbols. A plural `s` is ignored.
const FULL_NAMES: [(&str, &str); 38] = [
    ("sec", "s"),
    ("second", "s"),
    ("msec", "ms"),
    ("usec", "us"),
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
    ("tonne", "t"),
    ("pound", "lb"),
    ("newton", "N"),
    ("joule", "J"),
    ("watt", "W"),
    ("pascal", "Pa"),
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
];

/// Units that are not known, and what to write instead.
const UNKNOWN_UNITS: [(&[&str], &str); 12] = [
    (
        &["rps", "cps", "rev", "revs", "revolution", "revolutions", "turn", "turns", "cycle", "cycles"],
        "revolutions per second are Hz, and per minute rpm",
    ),
    (&["kph", "kmh"], "write km/h"),
    (&["mph"], "a mile per hour is 0.44704 m/s"),
    (&["mps"], "write m/s"),
    (&["day", "days"], "a day is 24 h"),
    (&["ppm"], "1 ppm is 1e-4 %"),
    (&["mil", "mils", "thou"], "a thousandth of an inch is 0.0254 mm"),
    (&["atm"], "1 atm is 101325 Pa"),
    (&["mmhg", "torr"], "1 mmHg is 133.322 Pa"),
    (&["cst", "stokes"], "1 cSt is 1 mm2/s"),
    (&["gal", "gallon", "gallons"], "a gallon is 3.78541 l in the USA, and 4.54609 l in Britain"),
    (&["pi"], "pi is a number: write 3.14159"),
];

/// Returns the symbol for a unit that is written in full; `None` if the word is not in the list.
pub(super) fn symbol_of(full_name: &str) -> Option<&'static str> {
    let lower = full_name.to_lowercase();
    let singular = lower.strip_suffix('s').unwrap_or(&lower);
    FULL_NAMES.iter().find(|(word, _)| *word == lower || *word == singular).map(|(_, symbol)| *symbol)
}

/// Returns what to write instead of a unit that is not known; `None` if the table does not have the name.
pub(super) fn advice(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let found = UNKNOWN_UNITS.iter().find(|(names, _)| names.contains(&name.as_str()));
    found.map(|(_, advice)| *advice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Unit;

    #[test]
    fn full_names_have_known_symbols() {
        for (name, symbol) in FULL_NAMES {
            assert!(Unit::parse(symbol).is_ok(), "{name}");
            assert_eq!(symbol_of(&format!("{name}s").to_uppercase()), Some(symbol), "{name}");
        }
    }

    #[test]
    fn units_with_advice_are_not_known() {
        for name in UNKNOWN_UNITS.iter().flat_map(|(names, _)| *names) {
            assert!(Unit::parse(name).is_err() && symbol_of(name).is_none(), "{name}");
        }
        assert_eq!(advice("MPH"), Some("a mile per hour is 0.44704 m/s"));
        assert_eq!(advice("furlong"), None);
    }
}
