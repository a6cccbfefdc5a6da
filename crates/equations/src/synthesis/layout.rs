//! The layout of a patch as people write it: a line for each element, scale and so on.

use serde_json::Value;

/// The longest line before a list is written with a line for each item.
const WIDTH: usize = 100;

/// The sections that begin after an empty line.
const SEPARATE: [&str; 6] = ["parameters", "drives", "equations", "elements", "signals", "run"];

/// The text of a document.
pub(super) fn layout(document: &Value) -> String {
    let Some(sections) = document.as_object() else { return inline(document) };
    let mut lines = Vec::new();
    for (key, value) in sections {
        let space = if SEPARATE.contains(&key.as_str()) { "\n" } else { "" };
        lines.push(format!("{space}  {}: {}", Value::from(key.as_str()), section(key, value)));
    }
    format!("{{\n{}\n}}\n", lines.join(",\n"))
}

/// The text of a section. A section of named objects has a line for each, and so has a list that is too long for a line.
fn section(key: &str, value: &Value) -> String {
    let written = inline(value);
    let entries: Vec<String> = match value {
        Value::Object(entries) if entries.values().any(Value::is_object) => {
            entries.iter().map(entry).collect()
        }
        Value::Array(items) if key.len() + written.len() > WIDTH => items.iter().map(inline).collect(),
        _ => return written,
    };
    let [open, close] = if value.is_object() { ["{", "}"] } else { ["[", "]"] };
    format!("{open}\n    {}\n  {close}", entries.join(",\n    "))
}

/// The text of an entry of an object on one line.
fn entry((name, value): (&String, &Value)) -> String {
    format!("{}: {}", Value::from(name.as_str()), inline(value))
}

/// The text of a value on one line, with spaces after commas and colons.
fn inline(value: &Value) -> String {
    match value {
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(inline).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Object(entries) => {
            let entries: Vec<String> = entries.iter().map(entry).collect();
            format!("{{{}}}", entries.join(", "))
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn elements_have_a_line_each() {
        let document = json!({
            "patchcord": 1,
            "title": "a \"decay\"",
            "elements": {"A1": {"kind": "integrator", "in": {"x1": ["P1"]}}, "P1": {"kind": "pot", "setting": 0.5}},
            "run": {"for": 2, "step": 0.001},
            "record": ["x", "y"]
        });
        let text = layout(&document);
        let expected = r#"{
  "patchcord": 1,
  "title": "a \"decay\"",

  "elements": {
    "A1": {"kind": "integrator", "in": {"x1": ["P1"]}},
    "P1": {"kind": "pot", "setting": 0.5}
  },

  "run": {"for": 2, "step": 0.001},
  "record": ["x", "y"]
}
"#;
        assert_eq!(text, expected);
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), document);
    }

    #[test]
    fn a_long_list_has_a_line_for_each_item() {
        let names: Vec<String> = (0..30).map(|index| format!("T{index}")).collect();
        let text = layout(&json!({"record": names}));
        assert_eq!(text.lines().count(), 34);
        assert_eq!(text.lines().nth(2), Some("    \"T0\","));
    }
}
