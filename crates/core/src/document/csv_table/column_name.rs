//! Column names with a unit at their end, such as "t (ms)" or "x [mm]".

use std::path::Path;

use super::{CsvFault, excerpt};
use patchcord_expr::{Unit, UnitLabel};

/// Splits a column name into the name and the unit in parentheses, brackets, braces or angle brackets at its end.
/// `None` if it has no unit.
///
/// A text that is not a unit belongs to the name, as in "force (filtered)". So do numbers, and the letter t: "f(t)" is
/// a function of time. Units in full, the degree sign and products such as "kNm" are understood, see [`UnitLabel`].
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table::split_unit;
/// use patchcord_expr::Unit;
///
/// assert_eq!(split_unit("t (ms)"), Some(("t", Unit::parse("ms")?)));
/// assert_eq!(split_unit("c [N/(m s)]"), Some(("c", Unit::parse("N/(m s)")?)));
/// assert_eq!(split_unit("t {seconds}"), Some(("t", Unit::parse("s")?)));
/// assert_eq!(split_unit("force (filtered)"), None);
/// # Ok::<(), patchcord_expr::UnitError>(())
/// ```
pub fn split_unit(column: &str) -> Option<(&str, Unit)> {
    let (name, label) = split_label(column)?;
    match UnitLabel::read(label) {
        UnitLabel::Unit(unit) => Some((name, unit)),
        _ => None,
    }
}

/// Splits a column name as [`split_unit`] does, into the name and the text of the unit as it is written.
pub(super) fn split_unit_text(column: &str) -> Option<(&str, &str)> {
    split_label(column).filter(|(_, label)| matches!(UnitLabel::read(label), UnitLabel::Unit(_)))
}

/// A column name without the unit at its end.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table::without_unit;
///
/// assert_eq!(without_unit("k (N/m)"), "k");
/// assert_eq!(without_unit("k"), "k");
/// ```
pub fn without_unit(column: &str) -> &str {
    split_unit(column).map_or(column, |(name, _)| name)
}

/// Splits off the text in the last parentheses, brackets, braces or angle brackets. `None` if it is missing, is a
/// number or the letter t, or is the whole name.
fn split_label(column: &str) -> Option<(&str, &str)> {
    let inner = column.strip_suffix([')', ']', '}', '>'])?;
    // Angle brackets inside other brackets are comparisons.
    let (opening, closing) = if column.ends_with('>') { ("<", ">") } else { ("([{", ")]}") };
    let mut depth = 1;
    let (open, _) = inner.char_indices().rev().find(|(_, letter)| {
        if closing.contains(*letter) {
            depth += 1;
        } else if opening.contains(*letter) {
            depth -= 1;
        }
        depth == 0
    })?;
    let (name, label) = (column[..open].trim_end(), inner[open + 1..].trim());
    (!name.is_empty() && has_letter(label) && label != "t").then_some((name, label))
}

/// Whether a text has a letter, a percent sign or a degree sign. All other texts are numbers and signs, and no units.
fn has_letter(text: &str) -> bool {
    text.contains(|letter: char| letter.is_alphabetic() || "%°˚℃℉".contains(letter))
}

/// The characters between a name and a unit at its end.
const SEPARATORS: [char; 5] = ['_', ' ', '.', '-', '/'];

/// The characters between a unit and other words in parentheses, as in "V rms".
const WORD_SEPARATORS: [char; 4] = [' ', ',', ';', '_'];

/// A unit that is also a common word at the end of a name, as in "x_in" for an input.
const AMBIGUOUS_UNIT: &str = "in";

/// Units that end a word after its first letter, as in "aft".
const ENDS_OF_WORDS: [&str; 2] = [AMBIGUOUS_UNIT, "ft"];

/// A text in the name of a column that is probably meant as a unit, but is not read as one.
struct Doubt<'c> {
    /// The text.
    text: &'c str,
    /// What it probably means.
    meaning: UnitLabel,
}

impl<'c> Doubt<'c> {
    /// The doubt about a text that is another unit than the required one, but of the same dimension. `None` if the text
    /// is no such unit.
    fn about(text: &'c str, required: &Unit) -> Option<Self> {
        if !has_letter(text) || text.eq_ignore_ascii_case(AMBIGUOUS_UNIT) {
            return None;
        }
        let is_other = |unit: &Unit| unit.dimension() == required.dimension() && !unit.is_same_as(required);
        let meaning = UnitLabel::read(text);
        let is_doubtful = match &meaning {
            UnitLabel::Unit(unit) => is_other(unit),
            // A long word, such as the "foot" of "left_foot", is rarely a unit.
            UnitLabel::Similar(unit) => is_other(unit) && (text.len() <= 3 || is_spelt_as_unit(text)),
            UnitLabel::Unknown { dimension, .. } => *dimension == Some(required.dimension()),
            UnitLabel::Text => false,
        };
        is_doubtful.then_some(Doubt { text, meaning })
    }

    /// The doubt about the end of a column name: "ms" of "t_ms", "mm/s" of "v/mm/s".
    fn about_end(column: &'c str, required: &Unit) -> Option<Self> {
        let mut ends = column.match_indices(SEPARATORS).map(|(at, _)| &column[at + 1..]);
        ends.find_map(|end| Doubt::about(end, required))
    }

    /// The doubt about a unit directly after the letter of a quantity or after "time": "ms" of "tms".
    fn about_joined(column: &'c str, required: &Unit) -> Option<Self> {
        if Unit::parse(column).is_ok() {
            return None;
        }
        let after_word = column.strip_prefix("time").or_else(|| column.strip_prefix("Time"));
        let after_letter = column.chars().next().map(|letter| &column[letter.len_utf8()..]);
        let mut ends = after_word.into_iter().chain(after_letter);
        let is_unit = |end: &&str| end.chars().count() > 1 && !ENDS_OF_WORDS.contains(end);
        let unit = ends.find(|end| is_unit(end) && matches!(UnitLabel::read(end), UnitLabel::Unit(_)))?;
        Doubt::about(unit, required)
    }

    /// The doubt about a text in parentheses that is probably meant as a unit, but is not understood.
    fn about_label(label: &'c str, required: &Unit) -> Option<Self> {
        if label.eq_ignore_ascii_case(AMBIGUOUS_UNIT) {
            return None;
        }
        let meaning = UnitLabel::read(label);
        let dimension = match &meaning {
            UnitLabel::Similar(unit) if !unit.is_same_as(required) => Some(unit.dimension()),
            UnitLabel::Unknown { dimension, .. } => *dimension,
            UnitLabel::Text => {
                return label.split(WORD_SEPARATORS).find_map(|word| Doubt::about(word, required));
            }
            _ => return None,
        };
        // A unit of another dimension may be an ordinary word, such as "day" in "T (day)".
        let is_doubtful = dimension == Some(required.dimension()) || is_spelt_as_unit(label);
        is_doubtful.then_some(Doubt { text: label, meaning })
    }

    /// The doubt about the name of a column of times.
    fn about_times(column: &'c str, second: &Unit) -> Option<Self> {
        let Some((_, label)) = split_label(column) else {
            return Doubt::about_end(column, second)
                .or_else(|| Doubt::about(column, second))
                .or_else(|| Doubt::about_joined(column, second));
        };
        let meaning = UnitLabel::read(label);
        let is_clear = match &meaning {
            UnitLabel::Unit(_) => true,
            UnitLabel::Similar(unit) => unit.is_same_as(second),
            _ => false,
        };
        (!is_clear).then_some(Doubt { text: label, meaning })
    }

    /// The doubt about the name of a column of other values.
    fn about_values(column: &'c str, required: &Unit) -> Option<Self> {
        match split_label(column) {
            Some((name, label)) => {
                Doubt::about_label(label, required).or_else(|| Doubt::about_end(name, required))
            }
            None => Doubt::about_end(column, required).or_else(|| Doubt::about_joined(column, required)),
        }
    }

    /// What to write. `example` is the name of a column for an example, and the values are read in the unit `required`.
    fn hint(&self, column: &str, example: &str, required: &Unit) -> String {
        let column = excerpt(column);
        let fits = |unit: &&Unit| unit.dimension() == required.dimension();
        let unit = match &self.meaning {
            UnitLabel::Unit(unit) | UnitLabel::Similar(unit) => Some(unit).filter(fits),
            _ => None,
        };
        if let Some(unit) = unit {
            let unit = excerpt(unit.text());
            return format!(
                "write its unit above the names, as in \"# {column}: {unit}\", or in the name, as in \
                 \"{example} ({unit})\""
            );
        }
        let required = if required.text().is_empty() { "1" } else { required.text() };
        let advice = match &self.meaning {
            UnitLabel::Unknown { advice, .. } => format!("{advice}; "),
            _ => String::new(),
        };
        format!(
            "{advice}write the unit of the values above the names, as in \"# {column}: {required}\" for values in \
             {required}, or in the name, as in \"{example} ({required})\""
        )
    }
}

/// Whether a text is spelt as a unit and not as a word: it has a sign such as "/", begins with degrees as in "deg C",
/// or has a capital letter after a small one as in "mVolts".
fn is_spelt_as_unit(text: &str) -> bool {
    let mut pairs = text.chars().zip(text.chars().skip(1));
    text.contains(['/', '^', '*', '·', '°', '²', '³', '⁻'])
        || text.starts_with("deg ")
        || pairs.any(|(first, second)| first.is_lowercase() && second.is_uppercase())
}

/// The doubt about a column of times without a unit, if its name seems to indicate one. `path` is the file.
///
/// The caller reports it as a warning: the times are read as seconds.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table::unclear_time;
///
/// let doubt = unclear_time("t_ms", "a.csv").expect("a doubt");
/// assert_eq!(doubt.message, "the times in the column t_ms of a.csv are read as seconds, but its name has \"ms\"");
/// assert_eq!(unclear_time("time", "a.csv"), None);
/// ```
pub fn unclear_time(column: &str, path: impl AsRef<Path>) -> Option<CsvFault> {
    let second = Unit::parse("s").ok()?;
    let doubt = Doubt::about_times(column, &second)?;
    let message = format!(
        "the times in the column {} of {} are read as seconds, but its name has \"{}\"",
        excerpt(column),
        path.as_ref().display(),
        excerpt(doubt.text)
    );
    Some(CsvFault::new(message, doubt.hint(column, "t", &second)))
}

/// The doubt about a column without a unit that is read in the required unit, if its name seems to indicate another
/// one.
///
/// The caller reports it as a warning. Columns of times have a doubt of their own, [`unclear_time`].
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table::unclear_value;
/// use patchcord_expr::Unit;
///
/// let metre = Unit::parse("m")?;
/// let doubt = unclear_value("x_mm", &metre, "a.csv").expect("a doubt");
/// assert_eq!(doubt.message, "the column x_mm of a.csv is read in m, but its name has \"mm\"");
/// assert_eq!(unclear_value("x_m", &metre, "a.csv"), None);
/// # Ok::<(), patchcord_expr::UnitError>(())
/// ```
pub fn unclear_value(column: &str, required: &Unit, path: impl AsRef<Path>) -> Option<CsvFault> {
    let doubt = Doubt::about_values(column, required)?;
    let message = format!(
        "the column {} of {} is read in {}, but its name has \"{}\"",
        excerpt(column),
        path.as_ref().display(),
        required.text(),
        excerpt(doubt.text)
    );
    Some(CsvFault::new(message, doubt.hint(column, "x", required)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(text: &str) -> Unit {
        Unit::parse(text).unwrap()
    }

    #[test]
    fn a_unit_in_parentheses_or_brackets_is_split_off() {
        let cases = [
            ("t (ms)", Some(("t", "ms"))),
            ("time[ms]", Some(("time", "ms"))),
            ("t {ms}", Some(("t", "ms"))),
            ("t<ms>", Some(("t", "ms"))),
            ("x ( mm )", Some(("x", "mm"))),
            ("c (N/(m s))", Some(("c", "N/(m s)"))),
            ("slip (left) [%]", Some(("slip (left)", "%"))),
            ("n (rpm)", Some(("n", "rpm"))),
            ("t (sec)", Some(("t", "s"))),
            ("t (hrs)", Some(("t", "h"))),
            ("t (usec)", Some(("t", "us"))),
            ("M (kNm)", Some(("M", "kN m"))),
            ("x (micron)", Some(("x", "µm"))),
            ("phi (°)", Some(("phi", "deg"))),
            ("x", None),
            ("force (filtered)", None),
            ("x (1)", None),
            ("x (2)", None),
            ("x (t<s)", None),
            ("x>s", None),
            ("f(t)", None),
            ("(ms)", None),
            ("t ()", None),
            ("t ms)", None),
            (")", None),
            (">", None),
            ("T (°C)", None),
            ("T (deg C)", None),
            ("T [deg F]", None),
            ("u (mVolts)", None),
            ("µ (µm)", Some(("µ", "µm"))),
        ];
        for (column, expected) in cases {
            let found = split_unit(column).map(|(name, unit)| (name, unit.text().to_owned()));
            let expected = expected.map(|(name, unit)| (name, unit.to_owned()));
            assert_eq!(found, expected, "{column}");
        }
    }

    #[test]
    fn a_name_that_may_contain_a_unit_of_time_is_doubtful() {
        let in_doubt = |column| Doubt::about_times(column, &unit("s")).map(|doubt| doubt.text);
        let doubtful = [
            ("t (days)", "days"),
            ("t (MIN)", "MIN"),
            ("t_ms", "ms"),
            ("time us", "us"),
            ("time_usec", "usec"),
            ("t-min", "min"),
            ("t_days", "days"),
            ("T [ticks]", "ticks"),
            ("t/ms", "ms"),
            ("ms", "ms"),
            ("hours", "hours"),
            ("tms", "ms"),
            ("timems", "ms"),
            ("tmin", "min"),
        ];
        for (column, text) in doubtful {
            assert_eq!(in_doubt(column), Some(text), "{column}");
        }
        for column in ["t", "time", "s", "t (ms)", "t (2)", "x(t)", "t (m)", "seconds", "times", "th"] {
            assert_eq!(in_doubt(column), None, "{column}");
        }
        for column in ["t_s", "t/s", "t_sec", "t_rel", "t_2", "t_", "t (second)", "t (Sec)", "t (secs)"] {
            assert_eq!(in_doubt(column), None, "{column}");
        }
    }

    #[test]
    fn the_hint_about_a_time_has_its_unit() {
        for (column, example) in
            [("t_min", "min"), ("time_usec", "us"), ("tms", "ms"), ("h", "h"), ("t (ticks)", "s")]
        {
            let hint = unclear_time(column, "a.csv").unwrap().hint;
            assert!(hint.ends_with(&format!(", as in \"t ({example})\"")), "{hint}");
        }
        assert_eq!(
            unclear_time("t (days)", "a.csv").unwrap().hint,
            "a day is 24 h; write the unit of the values above the names, as in \"# t (days): s\" for values in s, or \
             in the name, as in \"t (s)\""
        );
    }

    #[test]
    fn the_end_of_a_name_that_is_a_common_word_is_no_unit() {
        let in_doubt = |column| Doubt::about_values(column, &unit("m")).map(|doubt| doubt.text);
        assert_eq!(in_doubt("x_in_mm"), Some("mm"));
        for column in ["x_in", "x_IN", "x (IN)", "aft", "left_foot", "xm"] {
            assert_eq!(in_doubt(column), None, "{column}");
        }
    }

    #[test]
    fn a_name_that_may_contain_another_unit_of_the_value_is_doubtful() {
        let cases = [
            ("v_mm/s", "m/s", Some("mm/s")),
            ("v/mm/s", "m/s", Some("mm/s")),
            ("v left km/h", "m/s", Some("km/h")),
            ("v_kmh", "m/s", Some("kmh")),
            ("v_m/s", "m/s", None),
            ("v_mm", "m/s", None),
            ("v_rel", "m/s", None),
            ("v (mm/s)", "m/s", None),
            ("mm/s", "m/s", None),
            ("xmm", "m", Some("mm")),
            ("MPa", "kPa", None),
            ("u (mVolts)", "V", Some("mVolts")),
            ("u (mVolts)", "mV", None),
            ("u (mVolts)", "A", Some("mVolts")),
            ("u (mV rms)", "V", Some("mV")),
            ("u (mV rms)", "mV", None),
            ("F_kN (raw)", "N", Some("kN")),
            ("F (KN)", "N", Some("KN")),
            ("T (°C)", "K", Some("°C")),
            ("T (°C)", "V", Some("°C")),
            ("T (deg C)", "K", Some("deg C")),
            ("T (deg F)", "V", Some("deg F")),
            ("T (°  C)", "K", Some("°  C")),
            ("T deg C", "K", Some("deg C")),
            ("T_degC", "K", Some("degC")),
            ("T (day)", "K", None),
            ("F (second)", "N", None),
            ("F (left foot)", "N", None),
            ("F (Ch1)", "N", None),
            ("duty_cycle", "1", None),
        ];
        for (column, required, expected) in cases {
            let found = Doubt::about_values(column, &unit(required)).map(|doubt| doubt.text);
            assert_eq!(found, expected, "{column} {required}");
        }
    }

    #[test]
    fn the_hint_about_a_value_has_its_unit() {
        let hint = |column, required| unclear_value(column, &unit(required), "a.csv").unwrap().hint;
        assert_eq!(
            hint("u (mVolts)", "V"),
            "write its unit above the names, as in \"# u (mVolts): mV\", or in the name, as in \"x (mV)\""
        );
        assert_eq!(
            hint("T (°C)", "K"),
            "temperatures are in K, and 0 °C is 273.15 K; write the unit of the values above the names, as in \
             \"# T (°C): K\" for values in K, or in the name, as in \"x (K)\""
        );
        // Millivolts are no current.
        assert!(hint("u (mVolts)", "A").ends_with("as in \"x (A)\""));
    }
}
