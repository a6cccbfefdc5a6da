//! Hints for entries in a short form, such as `"k": 2` for a parameter. They give the full form with the same name and
//! value.

use serde_json::json;

use crate::document::TypedNumber;
use crate::document::tree::{Content, KeyValue};
use crate::elements::{Family, find};
use patchcord_expr::format_significant;

/// Digits of a number that is read from a text. They are enough for every number that people type.
const NUMBER_DIGITS: usize = 15;

/// The hint for a parameter that is only a number, such as 2 or "2 N/m". `None` for other values.
pub(super) fn parameter_hint(entry: &KeyValue) -> Option<String> {
    quantity_hint(entry, "value")
}

/// The hint for a scale that is only a number, such as 2 or "2 N". `None` for other values.
pub(super) fn scale_hint(entry: &KeyValue) -> Option<String> {
    quantity_hint(entry, "per_volt")
}

/// The hint for a number in place of an object with `number_key` and "unit".
fn quantity_hint(entry: &KeyValue, number_key: &str) -> Option<String> {
    let (number, unit) = match &entry.value.value {
        Content::Number(number) => (number.clone(), None),
        Content::Text(text) => {
            let typed = TypedNumber::parse(text).ok()?;
            (format_significant(typed.number, NUMBER_DIGITS), typed.unit)
        }
        _ => return None,
    };
    let full_form = |unit: &str| {
        let (name, unit) = (json!(entry.key), json!(unit));
        format!("write {name}: {{\"{number_key}\": {number}, \"unit\": {unit}}}")
    };
    Some(match unit {
        Some(unit) => full_form(unit.text()),
        None => format!("{}, with its unit in place of \"1\"", full_form("1")),
    })
}

/// The hint for a signal that is only the name of an output. `None` for other values.
pub(super) fn signal_hint(entry: &KeyValue) -> Option<String> {
    let Content::Text(output) = &entry.value.value else { return None };
    let (name, output) = (json!(entry.key), json!(output));
    Some(format!("write {name}: {{\"at\": {output}}}, with a \"scale\" for another unit than V"))
}

/// The hint for an element or a drive that is only the name of its kind. `None` for other values.
pub(super) fn entry_hint(entry: &KeyValue, family: Family) -> Option<String> {
    let Content::Text(kind) = &entry.value.value else { return None };
    let (name, kind) = (json!(entry.key), find(family, kind)?.name);
    Some(format!("write {name}: {{\"kind\": \"{kind}\", ...}}; `patchcord elements {kind}` lists its keys"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::tree::parse;

    /// The only entry of an object.
    fn entry(text: &str) -> KeyValue {
        match parse(text).unwrap().value {
            Content::Object(mut entries) => entries.remove(0),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_full_form_of_a_quantity_has_its_name_number_and_unit() {
        let cases = [
            (r#"{"k": 2}"#, r#"write "k": {"value": 2, "unit": "1"}, with its unit in place of "1""#),
            (
                r#"{"k": 1.50e3}"#,
                r#"write "k": {"value": 1.50e3, "unit": "1"}, with its unit in place of "1""#,
            ),
            (r#"{"k": "2"}"#, r#"write "k": {"value": 2, "unit": "1"}, with its unit in place of "1""#),
            (r#"{"k": "4.5e7 N/m"}"#, r#"write "k": {"value": 4.5e7, "unit": "N/m"}"#),
        ];
        for (text, expected) in cases {
            assert_eq!(parameter_hint(&entry(text)).as_deref(), Some(expected), "{text}");
        }
        let scale = r#"write "force": {"per_volt": 45.36, "unit": "N"}"#;
        assert_eq!(scale_hint(&entry(r#"{"force": "45.36 N"}"#)).as_deref(), Some(scale));
        for text in [r#"{"k": "2 * m"}"#, r#"{"k": [1, 2]}"#, r#"{"k": {"value": 2}}"#, r#"{"k": null}"#] {
            assert_eq!(parameter_hint(&entry(text)), None, "{text}");
        }
    }

    #[test]
    fn the_full_form_of_a_signal_or_an_element_has_its_name_and_text() {
        let signal = r#"write "x": {"at": "A1"}, with a "scale" for another unit than V"#;
        assert_eq!(signal_hint(&entry(r#"{"x": "A1"}"#)).as_deref(), Some(signal));
        assert_eq!(signal_hint(&entry(r#"{"x": 1}"#)), None);
        let hint = |text: &str, family| entry_hint(&entry(text), family);
        let pot = r#"write "P": {"kind": "pot", ...}; `patchcord elements pot` lists its keys"#;
        assert_eq!(hint(r#"{"P": "pot"}"#, Family::Computing).as_deref(), Some(pot));
        let ramp = r#"write "u": {"kind": "ramp", ...}; `patchcord elements ramp` lists its keys"#;
        assert_eq!(hint(r#"{"u": "ramp"}"#, Family::Drive).as_deref(), Some(ramp));
        assert_eq!(hint(r#"{"u": "ramp"}"#, Family::Computing), None);
    }
}
