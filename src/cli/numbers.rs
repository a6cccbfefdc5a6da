//! Parsers for numbers on the command line.
//!
//! An option takes a number in one unit. A number with another unit of the same dimension is converted. `TypedNumber`
//! is the only reader of such numbers.

use super::failure::Failure;
use patchcord::document::{TypedNumber, TypedNumberError};
use patchcord::expr::Unit;
use patchcord::patch::Patch;

/// Parses a finite number in `unit`, or with a unit of the same dimension.
pub(super) fn number_in(unit: &str, text: &str) -> Result<f64, String> {
    let expected = Unit::parse(unit).map_err(|error| error.to_string())?;
    let number = TypedNumber::parse(text).and_then(|typed| typed.in_unit(&expected));
    number.map_err(|error| match error {
        TypedNumberError::NotANumber(_) => format!("{error}: give the value in {unit}"),
        other => other.to_string(),
    })
}

/// A parser for positive numbers in `unit`.
pub(super) fn positive_in(
    unit: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text: &str| {
        let number = number_in(unit, text)?;
        if number > 0.0 { Ok(number) } else { Err("must be a positive number".to_owned()) }
    }
}

/// Parses a positive number in the unit of the signals, which depends on the patch.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    let TypedNumber { number, unit, .. } = TypedNumber::parse(text).map_err(|error| error.to_string())?;
    match unit {
        Some(unit) => Err(format!("give the number in the unit of the signals, without the unit {unit}")),
        None if number > 0.0 => Ok(number),
        None => Err("must be a positive number".to_owned()),
    }
}

/// Parses a positive time in seconds.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let seconds = number_in("s", text)?;
    if seconds > 0.0 { Ok(seconds) } else { Err("must be a positive time in seconds".to_owned()) }
}

/// Parses NAME=VALUE. The declared unit of the parameter is not known here, see [`in_declared_units`].
pub(super) fn setting(text: &str) -> Result<(String, TypedNumber), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, such as VcL=2.54e-3")?;
    let value = TypedNumber::parse(value).map_err(|error| error.to_string())?;
    Ok((name.trim().to_owned(), value))
}

/// The settings of `--set` with their values in the units that the patch declares.
///
/// A name that the patch does not have keeps its number. The check of the circuit reports the name.
pub(super) fn in_declared_units(
    settings: &[(String, TypedNumber)],
    patch: &Patch,
) -> Result<Vec<(String, f64)>, Failure> {
    let in_declared_unit = |(name, typed): &(String, TypedNumber)| {
        let value = match patch.parameters.get(name) {
            Some(parameter) => typed.in_unit(&parameter.unit),
            None => Ok(typed.number),
        };
        value
            .map(|value| (name.clone(), value))
            .map_err(|error| Failure::usage(format!("--set {name}: {error}")))
    };
    settings.iter().map(in_declared_unit).collect()
}

/// The largest number of threads. More only slow each other down.
const MAX_THREADS: usize = 1024;

/// Parses a number of threads.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    let number = text.trim().parse().ok().filter(|number| (1..=MAX_THREADS).contains(number));
    number.ok_or_else(|| format!("must be an integer from 1 to {MAX_THREADS}"))
}

/// Parses a number of repetitions.
pub(super) fn repetitions(text: &str) -> Result<u32, String> {
    let number = text.parse().ok().filter(|number| *number > 0);
    number.ok_or_else(|| format!("must be an integer from 1 to {}", u32::MAX))
}

/// Parses the seed of a random number generator.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("must be an integer from 0 to {}", u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_with_a_unit_is_converted() {
        let cases =
            [("s", "1ms", 0.001), ("s", "2.5e-1 s", 0.25), ("µm", "3um", 3.0), ("Hz", "1kHz", 1000.0)];
        for (unit, text, number) in cases {
            assert_eq!(number_in(unit, text), Ok(number), "{text}");
        }
        let message = |unit: &str, text: &str| number_in(unit, text).unwrap_err();
        assert_eq!(message("cm2", "700 kg"), "\"700 kg\" is in kg, but cm2 is expected");
        assert_eq!(message("s", "soon"), "\"soon\" is not a number: give the value in s");
        assert_eq!(message("s", "0,5"), "\"0,5\" is not a number: write 0.5");
        assert_eq!(message("s", "inf"), "inf is not a finite number");
        assert_eq!(positive("0.25"), Ok(0.25));
        let without_unit = "give the number in the unit of the signals, without the unit mm/s";
        assert_eq!(positive("0.25 mm/s"), Err(without_unit.to_owned()));
    }

    #[test]
    fn the_unit_of_every_option_is_a_unit() {
        for unit in ["s", "Hz", "P", "kgf", "kN/mm", "cm2", "µm", "mm/s", "%"] {
            assert_eq!(number_in(unit, "2"), Ok(2.0), "{unit}");
        }
    }

    #[test]
    fn a_setting_has_a_name_and_a_number() {
        let parsed = |text: &str| setting(text).map(|(name, typed)| (name, typed.number));
        assert_eq!(parsed(" m = 4 "), Ok(("m".to_owned(), 4.0)));
        assert_eq!(parsed("m=4kg"), Ok(("m".to_owned(), 4.0)));
        assert_eq!(parsed("m=4,5"), Err("\"4,5\" is not a number: write 4.5".to_owned()));
        assert_eq!(parsed("m=four"), Err("\"four\" is not a number".to_owned()));
        assert_eq!(parsed("m=inf"), Err("inf is not a finite number".to_owned()));
    }
}
