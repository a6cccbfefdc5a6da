//! Renders edits of a document into its text. Only the edited places of the text change.
//!
//! A batch may edit one place several times, for example add two cords to one jack. [`merge_edits`] therefore first
//! merges a batch into [`Edit`]s of different places, which hold complete values. [`splice`] then replaces the text of
//! these places, from the end of the text to its beginning. A removal is rendered alone: it needs the places in the text
//! after all edits before it.

use serde_json::{Map, Value};

use super::cut::cut;
use super::edit::{Edit, EditError};
use super::prune::Removal;
use crate::document::tree::{self, Content, Node};

/// An edit of a document.
///
/// `PatchEditor` checks beforehand that the document has the element or object to change. Only the path of `Put` is not
/// checked, so only `Put` can fail to render.
#[derive(Debug, Clone)]
pub(super) enum DocumentEdit {
    /// Puts a value at a path of keys. If the last key does not exist, it is added at the end of its object.
    Put {
        /// The keys from the root of the document. All except the last must exist.
        path: Vec<String>,
        /// The new value.
        value: Value,
    },
    /// Puts a value at a path of keys, and adds an object for every key that does not exist. A missing section is added
    /// at the end of the document.
    PutWithin {
        /// The keys from the root of the document.
        path: Vec<String>,
        /// The new value.
        value: Value,
    },
    /// Adds a cord to a jack, after the cords that the jack has.
    AddCord {
        /// The keys from the root of the document to the element or the macro instance.
        element: Vec<String>,
        /// The keys from the element to the jack: ["in", "x10"] or ["bias_plus"].
        jack: Vec<String>,
        /// Name of the output that is plugged in.
        from: String,
    },
    /// Replaces a name in all cords into an element.
    Replug {
        /// The keys from the root of the document to the element or the macro instance.
        element: Vec<String>,
        /// The keys of the element whose values contain cords.
        jacks: Vec<String>,
        /// The name that is replaced.
        from: String,
        /// The new name.
        to: String,
    },
    /// Removes parts of the document.
    Remove(Removal),
}

/// Parses a text that has been parsed before, or that was rendered from such a text. It is therefore valid JSON.
pub(super) fn root_of(text: &str) -> Node {
    tree::parse(text).expect("the text of a patch is JSON")
}

/// Returns the text with the edits of a batch.
///
/// # Errors
/// If the path of a `Put` does not exist.
pub(super) fn render(text: &str, batch: &[DocumentEdit]) -> Result<String, EditError> {
    let puts_values = |edit: &DocumentEdit| !matches!(edit, DocumentEdit::Remove(_));
    let mut text = text.to_owned();
    for edits in batch.chunk_by(|edit, next| puts_values(edit) && puts_values(next)) {
        let root = root_of(&text);
        text = match edits {
            [DocumentEdit::Remove(removal)] => cut(&text, &root, &removal.pruned(&root)),
            _ => splice(&text, &root, &merge_edits(&root, edits)?)?,
        };
    }
    Ok(text)
}

/// Merges a batch into edits of which none is at the same place as another or within it.
///
/// An added cord needs the cords that are there, so the whole value of the element is taken from the document and
/// edited.
///
/// # Errors
/// If the path of a `Put` does not exist.
fn merge_edits(root: &Node, batch: &[DocumentEdit]) -> Result<Vec<Edit>, EditError> {
    let mut merged = Vec::new();
    for edit in batch {
        match edit {
            DocumentEdit::Put { path, value } => merge_put(&mut merged, root, path, value, false)?,
            DocumentEdit::PutWithin { path, value } => merge_put(&mut merged, root, path, value, true)?,
            DocumentEdit::AddCord { element, jack, from } => {
                let entry = element_value(&mut merged, root, element)?;
                if let Some(cords) = value_at(entry, jack, true) {
                    *cords = match cords.take() {
                        Value::Array(mut cords) => {
                            cords.push(Value::from(from.as_str()));
                            Value::Array(cords)
                        }
                        Value::String(only_cord) => Value::from(vec![only_cord, from.clone()]),
                        _ => Value::from(vec![from.clone()]),
                    };
                }
            }
            DocumentEdit::Replug { element, jacks, from, to } => {
                let entry = element_value(&mut merged, root, element)?;
                for jack in jacks {
                    if let Some(cords) = entry.get_mut(jack.as_str()) {
                        replace_cords(cords, from, to);
                    }
                }
            }
            // A removal is rendered alone, so it is not among the edits to merge.
            DocumentEdit::Remove(_) => {}
        }
    }
    Ok(merged)
}

/// Merges an edit that puts a value at a path.
///
/// If an earlier edit contains the path, the value is put into that edit. Earlier edits below the path are removed.
/// `creates_objects` says whether an object is added for every missing key of the path.
fn merge_put(
    merged: &mut Vec<Edit>,
    root: &Node,
    path: &[String],
    value: &Value,
    creates_objects: bool,
) -> Result<(), EditError> {
    if let Some(outer) = merged.iter_mut().find(|edit| path.starts_with(&edit.path)) {
        let inner_path = &path[outer.path.len()..];
        let target = value_at(&mut outer.value, inner_path, creates_objects);
        *target.ok_or_else(|| EditError::MissingPath(path.join("/")))? = value.clone();
        return Ok(());
    }
    merged.retain(|edit| !edit.path.starts_with(path));
    // The edit ends at the first missing key. The keys after it become objects of its value.
    let mut end = path.len();
    if creates_objects {
        let mut node = root;
        for (index, key) in path.iter().enumerate() {
            match node.child(key) {
                Some(child) => node = child,
                None => {
                    end = index + 1;
                    break;
                }
            }
        }
    }
    let mut nested_value = Value::Object(Map::new());
    if let Some(target) = value_at(&mut nested_value, &path[end..], true) {
        *target = value.clone();
    }
    merged.push(Edit { path: path[..end].to_vec(), value: nested_value });
    Ok(())
}

/// The value of an element with the edits merged so far, for further changes. `path` has the keys to the element.
///
/// If no edit contains the element, its value is copied from the document and becomes an edit. Edits below the element
/// are merged into it.
fn element_value<'f>(
    merged: &'f mut Vec<Edit>,
    root: &Node,
    path: &[String],
) -> Result<&'f mut Value, EditError> {
    let missing_path = || EditError::MissingPath(path.join("/"));
    if let Some(index) = merged.iter().position(|edit| path.starts_with(&edit.path)) {
        let outer = &mut merged[index];
        let inner_path = &path[outer.path.len()..];
        return value_at(&mut outer.value, inner_path, false).ok_or_else(missing_path);
    }
    let node = path.iter().try_fold(root, |node, key| node.child(key)).ok_or_else(missing_path)?;
    let mut value = node.to_value();
    let (inner_edits, other_edits): (Vec<Edit>, Vec<Edit>) =
        std::mem::take(merged).into_iter().partition(|edit| edit.path.starts_with(path));
    for edit in inner_edits {
        if let Some(target) = value_at(&mut value, &edit.path[path.len()..], true) {
            *target = edit.value;
        }
    }
    *merged = other_edits;
    let index = merged.len();
    merged.push(Edit { path: path.to_vec(), value });
    Ok(&mut merged[index].value)
}

/// The value at a path of keys inside a value. If the last key does not exist, it is added with an empty object.
///
/// Keys before the last are added only if `creates_objects`. `None` if such a key is missing, or if a value on the path
/// is not an object.
fn value_at<'v>(value: &'v mut Value, keys: &[String], creates_objects: bool) -> Option<&'v mut Value> {
    let mut target = value;
    for (index, key) in keys.iter().enumerate() {
        let Value::Object(entries) = target else { return None };
        let is_last = index + 1 == keys.len();
        if !is_last && !creates_objects && !entries.contains_key(key) {
            return None;
        }
        target = entries.entry(key.clone()).or_insert_with(|| Value::Object(Map::new()));
    }
    Some(target)
}

/// Replaces a name in cords: a name, a list of names, or an object of jacks.
fn replace_cords(cords: &mut Value, from: &str, to: &str) {
    match cords {
        Value::String(text) if text == from => *text = to.to_owned(),
        Value::Array(items) => items.iter_mut().for_each(|item| replace_cords(item, from, to)),
        Value::Object(jacks) => jacks.values_mut().for_each(|item| replace_cords(item, from, to)),
        _ => (),
    }
}

/// A replacement of the bytes from `start` to `end` of a text. If both are equal, the new text is inserted.
struct TextReplacement {
    start: usize,
    end: usize,
    text: String,
}

/// Returns the text with new values at the places of the edits. No place may be equal to another or within it.
///
/// # Errors
/// If a path does not exist.
pub(super) fn splice(text: &str, root: &Node, edits: &[Edit]) -> Result<String, EditError> {
    let mut filled_objects = Vec::new();
    let replacements = edits.iter().map(|edit| text_replacement(root, edit, &mut filled_objects));
    let mut replacements = replacements.collect::<Result<Vec<_>, _>>()?;
    replacements.sort_by_key(|replacement| replacement.start);
    let mut text = text.to_owned();
    // Replacing from the end keeps the positions of the replacements before it.
    for replacement in replacements.iter().rev() {
        text.replace_range(replacement.start..replacement.end, &replacement.text);
    }
    Ok(text)
}

/// The change of the text for an edit.
///
/// `filled_objects` contains the positions, after the opening brace, of the empty objects to which an earlier edit
/// added a key. The next key needs a comma.
fn text_replacement(
    root: &Node,
    edit: &Edit,
    filled_objects: &mut Vec<usize>,
) -> Result<TextReplacement, EditError> {
    let missing_path = || EditError::MissingPath(edit.path.join("/"));
    let (key, parents) = edit.path.split_last().ok_or_else(missing_path)?;
    let object = parents.iter().try_fold(root, |node, key| node.child(key)).ok_or_else(missing_path)?;
    let Content::Object(entries) = &object.value else { return Err(missing_path()) };
    let text = format_value(&edit.value);
    if let Some(node) = object.child(key) {
        return Ok(TextReplacement { start: node.span.start, end: node.span.end, text });
    }
    let text = format!("{}: {text}", Value::from(key.as_str()));
    if let Some(last_entry) = entries.last() {
        let position = last_entry.value.span.end;
        return Ok(TextReplacement { start: position, end: position, text: format!(", {text}") });
    }
    let [start, end] = [object.span.start + 1, object.span.end - 1];
    if filled_objects.contains(&start) {
        return Ok(TextReplacement { start: end, end, text: format!(", {text}") });
    }
    filled_objects.push(start);
    Ok(TextReplacement { start, end, text })
}

/// Formats a value in the layout of the shipped patches: on one line, but each object of a list on its own line.
fn format_value(value: &Value) -> String {
    match value {
        Value::Array(items) if items.iter().any(Value::is_object) => {
            let lines: Vec<_> =
                items.iter().map(|item| format!("    {}", format_on_one_line(item))).collect();
            format!("[\n{}\n  ]", lines.join(",\n"))
        }
        _ => format_on_one_line(value),
    }
}

/// Formats a value on one line, with a space after every comma and colon.
fn format_on_one_line(value: &Value) -> String {
    match value {
        Value::Array(items) => {
            let items: Vec<_> = items.iter().map(format_on_one_line).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Object(entries) => {
            let format_entry = |(key, value): (&String, &Value)| {
                format!("{}: {}", Value::from(key.as_str()), format_on_one_line(value))
            };
            let entries: Vec<_> = entries.iter().map(format_entry).collect();
            format!("{{{}}}", entries.join(", "))
        }
        _ => value.to_string(),
    }
}
