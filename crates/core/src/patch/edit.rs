//! Documents with other values in some places, and everything else as it was written.

use serde_json::Value;

use super::document::Patch;
use crate::document::Report;
use crate::document::tree::{self, Content, Node};

/// What is put where.
#[derive(Debug, Clone, PartialEq)]
pub struct Edit {
    /// The keys that lead there from the document's beginning. All but the last stand in the document.
    pub path: Vec<String>,
    /// What stands there afterwards.
    pub value: Value,
}

impl Edit {
    /// A value at the end of a path such as `"parameters/VcL/value"`.
    pub fn new(path: &str, value: impl Into<Value>) -> Edit {
        Edit { path: path.split('/').map(str::to_owned).collect(), value: value.into() }
    }
}

/// Why a document cannot be edited.
#[derive(Debug, thiserror::Error)]
pub enum EditError {
    /// A path on which something other than the last key is missing, or is no object.
    #[error("there is no {0} in the document")]
    NoPlace(String),
    /// Two edits of one place, there or not, or of which one lies within the other.
    #[error("{0} is edited twice")]
    Twice(String),
    /// What comes out is no document.
    #[error(transparent)]
    Text(#[from] Box<Report>),
}

/// A piece of the text that gives way to another.
struct Patchwork {
    start: usize,
    end: usize,
    text: String,
}

impl Patch {
    /// The same document with other values in some places: of the text only these change. A last key that does not stand there
    /// is added at the end of its object. `file` is the name of what comes out.
    ///
    /// # Errors
    /// When a path leads nowhere, or two edits overlap.
    pub fn edited(&self, file: &str, edits: &[Edit]) -> Result<Patch, EditError> {
        let root = tree::parse(self.text());
        let root = root.map_err(|finding| Box::new(Report::new(self.file(), self.text(), vec![finding])))?;
        check_apart(edits)?;
        let mut opened = Vec::new();
        let pieces = edits.iter().map(|edit| piece(&root, edit, &mut opened));
        let mut pieces = pieces.collect::<Result<Vec<_>, _>>()?;
        pieces.sort_by_key(|piece| piece.start);
        let mut text = self.text().to_owned();
        // From the end, so that what stands before keeps its place.
        for piece in pieces.iter().rev() {
            text.replace_range(piece.start..piece.end, &piece.text);
        }
        Ok(Patch::parse(file, &text)?)
    }
}

/// Refuses two edits of one place, and one within another.
fn check_apart(edits: &[Edit]) -> Result<(), EditError> {
    let is_twice = |(index, edit): &(usize, &Edit)| {
        let stood_before = edits[..*index].iter().any(|other| other.path == edit.path);
        let holds = |other: &Edit| other.path.len() < edit.path.len() && edit.path.starts_with(&other.path);
        stood_before || edits.iter().any(holds)
    };
    match edits.iter().enumerate().find(is_twice) {
        Some((_, edit)) => Err(EditError::Twice(edit.path.join("/"))),
        None => Ok(()),
    }
}

/// What an edit does to the text. `opened` holds where the empty objects begin into which something was put before.
fn piece(root: &Node, edit: &Edit, opened: &mut Vec<usize>) -> Result<Patchwork, EditError> {
    let nowhere = || EditError::NoPlace(edit.path.join("/"));
    let (last, before) = edit.path.split_last().ok_or_else(nowhere)?;
    let object = before.iter().try_fold(root, |node, key| node.child(key)).ok_or_else(nowhere)?;
    let Content::Object(entries) = &object.value else { return Err(nowhere()) };
    let text = written(&edit.value);
    if let Some(node) = object.child(last) {
        return Ok(Patchwork { start: node.span.start, end: node.span.end, text });
    }
    let text = format!("{}: {text}", Value::from(last.as_str()));
    if let Some(before) = entries.last() {
        let at = before.value.span.end;
        return Ok(Patchwork { start: at, end: at, text: format!(", {text}") });
    }
    let [start, end] = [object.span.start + 1, object.span.end - 1];
    if opened.contains(&start) {
        return Ok(Patchwork { start: end, end, text: format!(", {text}") });
    }
    opened.push(start);
    Ok(Patchwork { start, end, text })
}

/// A value as a person writes it: on one line, a list of objects on a line each.
fn written(value: &Value) -> String {
    match value {
        Value::Array(items) if items.iter().any(Value::is_object) => {
            let lines: Vec<_> = items.iter().map(|item| format!("    {}", on_one_line(item))).collect();
            format!("[\n{}\n  ]", lines.join(",\n"))
        }
        _ => on_one_line(value),
    }
}

fn on_one_line(value: &Value) -> String {
    match value {
        Value::Array(items) => {
            let items: Vec<_> = items.iter().map(on_one_line).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Object(entries) => {
            let told = |(key, value): (&String, &Value)| {
                format!("{}: {}", Value::from(key.as_str()), on_one_line(value))
            };
            let entries: Vec<_> = entries.iter().map(told).collect();
            format!("{{{}}}", entries.join(", "))
        }
        _ => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    const TEXT: &str = r#"{
  "patchcord": 1,
  "parameters": {"K":  {"value": 45e6, "unit": "N/m"}},
  "run": {"for": 8},
  "empty": {}
}
"#;

    fn edited(edits: &[Edit]) -> Result<Patch, EditError> {
        Patch::parse("old.json", TEXT).unwrap().edited("new.json", edits)
    }

    #[test]
    fn nothing_but_the_places_named_changes() {
        let edits = [
            Edit::new("run/every", 0.5),
            Edit::new("parameters/K/value", 1e3),
            Edit::new("pictures", json!([{"x": "t", "y": ["x", "v"]}])),
            Edit::new("empty/key", "text"),
        ];
        let patch = edited(&edits).unwrap();
        let text = r#"{
  "patchcord": 1,
  "parameters": {"K":  {"value": 1000.0, "unit": "N/m"}},
  "run": {"for": 8, "every": 0.5},
  "empty": {"key": "text"}, "pictures": [
    {"x": "t", "y": ["x", "v"]}
  ]
}
"#;
        assert_eq!((patch.text(), patch.file()), (text, "new.json"));
    }

    #[test]
    fn several_keys_come_into_one_object_in_their_order() {
        let text = |empty: &str| {
            let old = TEXT.replace("{}", empty);
            let keys = ["empty/b", "run/every", "empty/a", "run/step", "empty/c"];
            let edits: Vec<_> = keys.iter().map(|key| Edit::new(key, 1)).collect();
            Patch::parse("old.json", &old).unwrap().edited("new.json", &edits).unwrap().text().to_owned()
        };
        for empty in ["{}", "{ }"] {
            assert!(text(empty).contains(r#""run": {"for": 8, "every": 1, "step": 1},"#), "{}", text(empty));
            assert!(text(empty).contains(r#""empty": {"b": 1, "a": 1, "c": 1}"#), "{}", text(empty));
        }
    }

    #[test]
    fn what_leads_nowhere_or_meets_another_edit_is_refused() {
        let told = |edits: &[Edit]| edited(edits).unwrap_err().to_string();
        assert_eq!(
            told(&[Edit::new("parameters/M/value", 1)]),
            "there is no parameters/M/value in the document"
        );
        assert_eq!(told(&[Edit::new("patchcord/x", 1)]), "there is no patchcord/x in the document");
        let within = [Edit::new("parameters/K", json!({})), Edit::new("parameters/K/value", 1)];
        assert_eq!(told(&within), "parameters/K/value is edited twice");
        assert_eq!(told(&[Edit::new("run/for", 1), Edit::new("run/for", 2)]), "run/for is edited twice");
        for missing in ["run/every", "empty/key"] {
            let twice = [Edit::new(missing, 1), Edit::new("patchcord", 1), Edit::new(missing, 1)];
            assert_eq!(told(&twice), format!("{missing} is edited twice"));
        }
    }
}
