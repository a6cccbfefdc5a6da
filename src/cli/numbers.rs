//! Parsers for numbers on the command line.
//!
//! An option takes a number in one unit. A number with a unit is an error, and the message says what to write instead.

use patchcord::expr::{Unit, leading_number, round_significant};

/// The number of digits of a suggested value. More digits would show the rounding errors of a conversion.
const SUGGESTED_DIGITS: usize = 12;

/// Parses a finite number in `unit`.
pub(super) fn number_in(unit: &str, text: &str) -> Result<f64, String> {
    let text = text.trim();
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("{text} is not a finite number")),
        Err(_) => Err(format!("\"{text}\" is not a number: {}", advice(text, unit))),
    }
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

/// Parses a positive number in a unit that depends on the patch.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    let number: f64 =
        text.trim().parse().map_err(|_| format!("\"{text}\" is not a number: leave out its unit"))?;
    match number {
        infinite if !infinite.is_finite() => Err(format!("{text} is not a finite number")),
        positive if positive > 0.0 => Ok(positive),
        _ => Err("must be a positive number".to_owned()),
    }
}

/// Parses a positive time in seconds.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let seconds = number_in("s", text)?;
    if seconds > 0.0 { Ok(seconds) } else { Err("must be a positive time in seconds".to_owned()) }
}

/// Parses NAME=VALUE. The value is in the unit that the patch declares, which is not known here.
pub(super) fn setting(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, such as VcL=2.54e-3")?;
    let (name, value) = (name.trim(), value.trim());
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok((name.to_owned(), number)),
        Ok(_) => Err(format!("{value} is not a finite number")),
        Err(_) => Err(format!("\"{value}\" is not a number{}", setting_advice(name, value))),
    }
}

/// What to write instead of a value that is not a number. Empty if the text has no number.
fn setting_advice(name: &str, value: &str) -> String {
    let decimal_point = value.replacen(',', ".", 1);
    match leading_number(value) {
        Some((number, unit)) if Unit::parse(unit).is_ok() => {
            format!(": write {name}={number} if the patch declares {name} in {unit}")
        }
        _ if decimal_point.parse::<f64>().is_ok() => {
            format!(": write a decimal point: {name}={decimal_point}")
        }
        _ => String::new(),
    }
}

/// What to write instead of a text that is not a number: "leave out its unit and give the value in s: 0.001".
fn advice(text: &str, unit: &str) -> String {
    let Some((number, given)) = leading_number(text) else { return format!("give the value in {unit}") };
    let number: Option<f64> = number.parse().ok();
    let value = if given == unit { number } else { number.and_then(|number| converted(number, given, unit)) };
    let value = value.map_or_else(String::new, |value| format!(": {value}"));
    format!("leave out its unit and give the value in {unit}{value}")
}

/// Converts a number from one unit to another. None if a unit is unknown or they have different dimensions.
fn converted(number: f64, from: &str, to: &str) -> Option<f64> {
    let [from, to] = [Unit::parse(from).ok()?, Unit::parse(to).ok()?];
    let is_possible = from.dimension() == to.dimension();
    is_possible.then(|| round_significant(from.convert(number, &to), SUGGESTED_DIGITS))
}

/// The largest number of threads. More only slow each other down.
const MAX_THREADS: usize = 1024;

/// Parses a number of threads.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    let number = text.trim().parse().ok().filter(|number| (1..=MAX_THREADS).contains(number));
    number.ok_or_else(|| format!("must be an integer from 1 to {MAX_THREADS}"))
}

/// Parses the seed of a random number generator.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("must be an integer from 0 to {}", u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_with_a_unit_is_converted_in_the_message() {
        let message = |unit: &str, text: &str| number_in(unit, text).unwrap_err();
        let stem =
            |text: &str| format!("\"{text}\" is not a number: leave out its unit and give the value in");
        assert_eq!(message("s", "1ms"), format!("{} s: 0.001", stem("1ms")));
        assert_eq!(message("s", "2.5e-1 s"), format!("{} s: 0.25", stem("2.5e-1 s")));
        assert_eq!(message("µm", "3um"), format!("{} µm: 3", stem("3um")));
        assert_eq!(message("cm2", "700 kg"), format!("{} cm2", stem("700 kg")));
        assert_eq!(message("Hz", "120 rpm"), format!("{} Hz: 2", stem("120 rpm")));
        assert_eq!(message("s", "soon"), "\"soon\" is not a number: give the value in s");
        assert_eq!(message("s", "inf"), "inf is not a finite number");
    }

    #[test]
    fn a_setting_has_a_name_and_a_number() {
        assert_eq!(setting(" m = 4 "), Ok(("m".to_owned(), 4.0)));
        let wanted = "\"4kg\" is not a number: write m=4 if the patch declares m in kg";
        assert_eq!(setting("m=4kg"), Err(wanted.to_owned()));
        let wanted = "\"4,5\" is not a number: write a decimal point: m=4.5";
        assert_eq!(setting("m=4,5"), Err(wanted.to_owned()));
        assert_eq!(setting("m=four"), Err("\"four\" is not a number".to_owned()));
        assert_eq!(setting("m=inf"), Err("inf is not a finite number".to_owned()));
    }
}
