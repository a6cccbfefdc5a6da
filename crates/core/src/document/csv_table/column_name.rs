//! Column names with a unit at their end, such as "t (ms)" or "x [mm]".

use std::path::Path;

use super::{CsvFault, excerpt};
use patchcord_expr::Unit;

/// Splits a column name into the name and the unit in parentheses or brackets at its end. `None` if it has no unit.
///
/// A text that is not a unit belongs to the name, as in "force (filtered)". So do numbers, and the letter t: "f(t)" is
/// a function of time.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::csv_table::split_unit;
///
/// assert_eq!(split_unit("t (ms)"), Some(("t", "ms")));
/// assert_eq!(split_unit("c [N/(m s)]"), Some(("c", "N/(m s)")));
/// assert_eq!(split_unit("force (filtered)"), None);
/// ```
pub fn split_unit(column: &str) -> Option<(&str, &str)> {
    split_label(column).filter(|(_, label)| Unit::parse(label).is_ok())
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

/// Splits off the text in the last parentheses or brackets. `None` if it is missing, is a number or the letter t, or is
/// the whole name.
fn split_label(column: &str) -> Option<(&str, &str)> {
    let inner = column.strip_suffix(')').or_else(|| column.strip_suffix(']'))?;
    let mut depth = 1;
    let (open, _) = inner.char_indices().rev().find(|(_, letter)| {
        match letter {
            ')' | ']' => depth += 1,
            '(' | '[' => depth -= 1,
            _ => {}
        }
        depth == 0
    })?;
    let (name, label) = (column[..open].trim_end(), inner[open + 1..].trim());
    (!name.is_empty() && has_letter(label) && label != "t").then_some((name, label))
}

/// Whether a text has a letter or a percent sign. All other texts are numbers and signs, and no units.
fn has_letter(text: &str) -> bool {
    text.contains(|letter: char| letter.is_alphabetic() || letter == '%')
}

/// The characters between a name and a unit at its end.
const SEPARATORS: [char; 5] = ['_', ' ', '.', '-', '/'];

/// A unit that is also a common word at the end of a name, as in "x_in" for an input.
const AMBIGUOUS_UNIT: &str = "in";

/// The end of a column name that is another unit of the required dimension: "ms" of "t_ms", "mm/s" of "v/mm/s".
fn unit_at_end<'c>(column: &'c str, required: &Unit) -> Option<&'c str> {
    // A unit in parentheses is understood.
    let column = if split_label(column).is_some() { "" } else { column };
    let mut ends = column.match_indices(SEPARATORS).map(|(at, _)| &column[at + 1..]);
    ends.find(|end| *end != AMBIGUOUS_UNIT && is_other_unit(end, required))
}

/// Whether a text is a unit of the required dimension, and another one than the required unit.
fn is_other_unit(text: &str, required: &Unit) -> bool {
    let is_other = |unit: Unit| unit.dimension() == required.dimension() && !unit.is_same_as(required);
    has_letter(text) && Unit::parse(text).is_ok_and(is_other)
}

/// The part of the name of a column of times that is probably a unit, but is not understood: "sec" of "t (sec)", "ms"
/// of "t_ms", "t/ms" and "ms". `None` if the name does not indicate another unit than the second.
fn unclear_unit(column: &str) -> Option<&str> {
    if let Some((_, label)) = split_label(column) {
        return Unit::parse(label).is_err().then_some(label);
    }
    let second = Unit::parse("s").ok()?;
    unit_at_end(column, &second).or_else(|| is_other_unit(column, &second).then_some(column))
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
    let (column, unit) = (excerpt(column), excerpt(unclear_unit(column)?));
    let message = format!(
        "the times in the column {column} of {} are read as seconds, but its name has \"{unit}\"",
        path.as_ref().display()
    );
    // A text that is not understood is no example.
    let example = if Unit::parse(&unit).is_ok() { unit.as_str() } else { "ms" };
    let hint = format!(
        "write a unit above the names, as in \"# {column}: {example}\", or in the name, as in \"t ({example})\""
    );
    Some(CsvFault::new(message, hint))
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
    let (column, unit) = (excerpt(column), excerpt(unit_at_end(column, required)?));
    let message = format!(
        "the column {column} of {} is read in {}, but its name has \"{unit}\"",
        path.as_ref().display(),
        required.text()
    );
    let hint = format!(
        "write its unit above the names, as in \"# {column}: {unit}\", or in the name, as in \"x ({unit})\""
    );
    Some(CsvFault::new(message, hint))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_in_parentheses_or_brackets_is_split_off() {
        let cases = [
            ("t (ms)", Some(("t", "ms"))),
            ("time[ms]", Some(("time", "ms"))),
            ("x ( mm )", Some(("x", "mm"))),
            ("c (N/(m s))", Some(("c", "N/(m s)"))),
            ("slip (left) [%]", Some(("slip (left)", "%"))),
            ("n (rpm)", Some(("n", "rpm"))),
            ("x", None),
            ("force (filtered)", None),
            ("x (1)", None),
            ("x (2)", None),
            ("f(t)", None),
            ("(ms)", None),
            ("t ()", None),
            ("t ms)", None),
            (")", None),
            ("µ (µm)", Some(("µ", "µm"))),
        ];
        for (column, expected) in cases {
            assert_eq!(split_unit(column), expected, "{column}");
        }
    }

    #[test]
    fn a_name_that_may_contain_a_unit_of_time_is_doubtful() {
        let doubtful = [
            ("t (sec)", "sec"),
            ("t_ms", "ms"),
            ("time us", "us"),
            ("t-min", "min"),
            ("T [ticks]", "ticks"),
            ("t/ms", "ms"),
            ("ms", "ms"),
        ];
        for (column, unit) in doubtful {
            assert_eq!(unclear_unit(column), Some(unit), "{column}");
        }
        for column in ["t", "time", "s", "t (ms)", "t (2)", "x(t)", "t (m)"] {
            assert_eq!(unclear_unit(column), None, "{column}");
        }
        for column in ["t_s", "t/s", "t_rel", "t_2", "t_"] {
            assert_eq!(unclear_unit(column), None, "{column}");
        }
    }

    #[test]
    fn the_hint_about_a_time_has_its_unit() {
        for (column, example) in [("t_min", "min"), ("t (ticks)", "ms"), ("h", "h")] {
            let hint = unclear_time(column, "a.csv").unwrap().hint;
            assert!(hint.ends_with(&format!(", as in \"t ({example})\"")), "{hint}");
        }
    }

    #[test]
    fn the_end_of_a_name_that_is_a_common_word_is_no_unit() {
        let metre = Unit::parse("m").unwrap();
        assert_eq!(unit_at_end("x_in", &metre), None);
        assert_eq!(unit_at_end("x_in_mm", &metre), Some("mm"));
    }

    #[test]
    fn a_name_that_may_contain_another_unit_of_the_value_is_doubtful() {
        let speed = Unit::parse("m/s").unwrap();
        let cases = [
            ("v_mm/s", Some("mm/s")),
            ("v/mm/s", Some("mm/s")),
            ("v left km/h", Some("km/h")),
            ("v_m/s", None),
            ("v_mm", None),
            ("v_rel", None),
            ("v (mm/s)", None),
            ("mm/s", None),
        ];
        for (column, expected) in cases {
            assert_eq!(unit_at_end(column, &speed), expected, "{column}");
        }
    }
}
