//! Unit tests of `unit`.

use proptest::prelude::*;

use super::*;

fn unit(text: &str) -> Unit {
    Unit::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn error(text: &str) -> UnitError {
    Unit::parse(text).expect_err(text)
}

#[test]
fn parses_sizes() {
    let sizes = [
        ("", 1.0),
        ("1", 1.0),
        ("%", 0.01),
        ("mm", 1e-3),
        ("cm/s", 1e-2),
        ("kg", 1.0),
        ("mg", 1e-6),
        ("µm", 1e-6),
        ("um", 1e-6),
        ("kN", 1e3),
        ("min", 60.0),
        ("P", 0.1),
        ("cP", 1e-3),
        ("mm²", 1e-6),
        ("1/min", 1.0 / 60.0),
        ("kgf", 9.80665),
        ("km/h", 1e3 / 3600.0),
        ("N/mm2", 1e6),
        ("1/mm3", 1e9),
        ("ml", 1e-6),
        ("m/s^0.5", 1.0),
        ("km^0.5", 1000f64.sqrt()),
    ];
    for (text, size) in sizes {
        assert_eq!(unit(text).factor(), size, "{text}");
    }
}

#[test]
fn spellings_of_the_same_unit_agree() {
    let groups: [&[&str]; 4] = [
        &["N s/m", "N*s/m", "N·s/m", "N s m-1", "kg/s", " N  s / m ", "(N s)/m"],
        &["m/s2", "m/s^2", "m s-2", "m s^-2", "m/s²", "m s⁻²", "m/s/s", "m/(s s)"],
        &["Pa", "N/m2", "kg/(m s2)", "kg/m/s2"],
        &["1/s", "s-1", "Hz", "rad/s", "1 / s"],
    ];
    for group in groups {
        for text in group {
            assert_eq!(unit(text).dimension(), unit(group[0]).dimension(), "{text}");
            assert_eq!(unit(text).factor(), 1.0, "{text}");
        }
    }
}

#[test]
fn units_with_the_same_values_are_the_same() {
    for (one, other) in [("rad/s", "1/s"), ("1/s", "Hz"), ("rpm", "1/min"), ("N s/m", "kg/s")] {
        assert!(unit(one).is_same_as(&unit(other)), "{one} {other}");
    }
    for (one, other) in [("rad/s", "Hz"), ("rpm", "1/s"), ("deg/s", "1/s"), ("mm", "m"), ("m", "s")] {
        assert!(!unit(one).is_same_as(&unit(other)), "{one} {other}");
    }
    assert!(unit("kHz").counts_cycles() && !unit("1/s").counts_cycles() && !unit("mm Hz").counts_cycles());
}

#[test]
fn rejects_a_product_after_a_slash() {
    let found = error("kg/m s2");
    assert_eq!(found.range, 3..7);
    let hint = found.hint.unwrap();
    assert_eq!(hint, "write /(m s2) if it does, else put s2 before the /");
}

#[test]
fn reports_the_bytes_at_fault() {
    let faults = [
        ("N sec/m", 2..5),
        ("100 N", 0..3),
        ("m 2", 2..3),
        ("N/", 2..2),
        ("N//m", 2..3),
        ("(m", 0..1),
        ("m)", 1..2),
        ("m^", 1..2),
        ("m--1", 1..4),
        ("m99", 1..3),
        ("m!", 1..2),
        ("((((((((((m))))))))))", 8..9),
    ];
    for (text, range) in faults {
        assert_eq!(error(text).range, range, "{text}: {}", error(text));
    }
    for degrees in ["degC", "celsius", "Fahrenheit", "°C"] {
        assert!(error(degrees).hint.unwrap().starts_with("temperatures are in K"), "{degrees}");
    }
    assert_eq!(error("KN").hint.as_deref(), Some("did you mean kN or K N?"));
    assert_eq!(error("Nm").hint.as_deref(), Some("did you mean nm or N m?"));
    let hints = [
        ("rps", "revolutions per second are Hz, and per minute rpm"),
        ("kmh", "write km/h"),
        ("rads/s", "did you mean rad?"),
        ("mins", "did you mean min?"),
        ("degrees", "did you mean deg?"),
    ];
    for (text, hint) in hints {
        assert_eq!(error(text).hint.as_deref(), Some(hint), "{text}");
    }
}

#[test]
fn hints_have_the_right_quantity() {
    let hints = [
        ("mol/l", "no unit counts molecules: write a mass, such as g/l"),
        ("M", "M is the prefix mega, as in MN; a metre is m, and no unit counts molecules"),
        ("cal", "1 cal is 4.184 J"),
        ("kcal", "1 cal is 4.184 J"),
        ("eV", "1 eV is 1.602176634e-19 J"),
        ("MeV", "1 eV is 1.602176634e-19 J"),
        ("dB", "20 dB are a factor of 10 of an amplitude: write the factor, in 1"),
        ("G", "1 G (gauss) is 1e-4 T; a gram is g"),
        ("mS", "1 S (siemens) is 1/ohm; a second is s"),
        ("lbs", "did you mean lb?"),
        ("kgs", "did you mean kg?"),
        ("hPa", "1 hPa is 100 Pa, or 1 mbar"),
        ("Nms/rad", "write N m s"),
        ("dimensionless", "write \"1\" for a pure number"),
        ("-", "write \"1\" for a pure number"),
        ("\u{2013}", "write \"1\" for a pure number"),
        ("mVolts", "did you mean mV?"),
        ("milliseconds", "did you mean ms?"),
        ("rmp", "did you mean rpm?"),
        ("mmm", "did you mean mm?"),
    ];
    for (text, hint) in hints {
        assert_eq!(error(text).hint.as_deref(), Some(hint), "{text}");
    }
    // A short name with other letters is another quantity.
    for text in ["foo", "xl", "kq"] {
        assert_eq!(error(text).hint, None, "{text}");
    }
}

#[test]
fn rejects_sizes_that_overflow() {
    assert!(Unit::parse("Gm12 Gm12 Gm12").is_err());
    assert!(Unit::parse("1/(Gm12 Gm12 Gm12)").is_err());
    assert!(Unit::parse(&"m ".repeat(200)).is_err());
}

#[test]
fn rates_are_per_second() {
    let rates = [
        ("m", "m/s"),
        ("m/s", "m/s2"),
        ("mm", "mm/s"),
        ("N s", "N"),
        ("N s/m", "N/m"),
        ("N/m", "N/(m s)"),
        ("s", "1"),
        ("1", "1/s"),
        ("", "1/s"),
        ("%", "%/s"),
        ("1/s", "1/s2"),
    ];
    for (text, rate) in rates {
        let found = unit(text).per_second();
        assert_eq!(found.text(), rate);
        assert_eq!(found, unit(rate), "{text}");
    }
}

#[test]
fn products_have_the_units_of_their_factors() {
    let drag = Unit::of_product([(&unit("N"), 1.0), (&unit("mm/s"), -2.0)]);
    assert_eq!((drag.text(), drag.factor()), ("N s2/mm2", 1e6));
    assert_eq!(Unit::of_product([(&unit("m/s"), 1.0), (&unit("s"), 1.0)]).text(), "m");
    assert_eq!(Unit::of_product([(&unit("N"), 1.0), (&unit("N"), -1.0)]), unit("1"));
}

proptest! {
    #[test]
    fn parsing_never_panics(text in "\\PC*") {
        let _ = Unit::parse(&text);
    }

    #[test]
    fn parsing_unit_like_text_never_panics(text in "[mNs1%²⁻µ() */^.2-]{0,40}") {
        if let Err(error) = Unit::parse(&text) {
            prop_assert!(text.get(error.range).is_some());
        }
    }

    #[test]
    fn dimensions_survive_formatting_and_parsing(powers in prop::array::uniform5(-9i8..=9)) {
        let [kilogram, metre, second, ampere, kelvin] = powers;
        let dimension = Dimension::new(kilogram, metre, second, ampere, kelvin);
        if !dimension.is_dimensionless() {
            let unit = Unit::parse(&dimension.to_string()).unwrap();
            prop_assert_eq!(unit.dimension(), dimension);
            prop_assert_eq!(unit.factor(), 1.0);
        }
    }

    #[test]
    fn conversion_to_si_and_back_keeps_the_value(value in -1e6..1e6f64, text in "(mm|kN|min|ft)/(s|h|kg)2") {
        let unit = unit(&text);
        let back = unit.out_of_si(unit.to_si(value));
        prop_assert!((back - value).abs() <= 1e-15 * value.abs());
    }
}
