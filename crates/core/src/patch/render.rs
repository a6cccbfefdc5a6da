//! Edits of a document as its text: of the text only the edited places change.

use serde_json::{Map, Value, json};

use super::edit::{Edit, EditError};
use crate::document::tree::{self, Content, Node};

/// An edit of a document. `PatchEditor` checks the places of all but `Put`, so that rendering them cannot fail.
#[derive(Debug, Clone)]
pub(super) enum DocumentEdit {
    /// Puts a value at a path of keys, or adds the last key at the end of its object.
    Put {
        /// The keys from the beginning of the document. All but the last are there.
        path: Vec<String>,
        /// The value.
        value: Value,
    },
    /// The same, with objects for keys of the path that are not there yet: a missing section is added at the end of the
    /// document.
    PutWithin {
        /// The keys from the beginning of the document.
        path: Vec<String>,
        /// The value.
        value: Value,
    },
    /// Adds a cord behind those that a jack has.
    AddCord {
        /// The element, or the instance of a macro.
        element: String,
        /// The keys from the element to the jack: "in" and "x10", or "bias_plus" alone.
        jack: Vec<String>,
        /// The name that is plugged in.
        from: String,
    },
    /// Puts another name in place of one that is plugged into an element.
    Replug {
        /// The element, or the instance of a macro.
        element: String,
        /// The keys of the element below which cords are.
        jacks: Vec<String>,
        /// The name that is replaced.
        from: String,
        /// The name that replaces it.
        to: String,
    },
}

/// The root of a text that was read before, or rendered from one.
pub(super) fn root_of(text: &str) -> Node {
    tree::parse(text).expect("the text of a patch is JSON")
}

/// The text with the edits of a batch.
///
/// # Errors
/// When the path of a `Put` leads nowhere.
pub(super) fn render(text: &str, batch: &[DocumentEdit]) -> Result<String, EditError> {
    let root = root_of(text);
    splice(text, &root, &folded(&root, batch)?)
}

/// One edit for each place, so that no place is edited twice.
fn folded(root: &Node, batch: &[DocumentEdit]) -> Result<Vec<Edit>, EditError> {
    let mut folded = Vec::new();
    for edit in batch {
        match edit {
            DocumentEdit::Put { path, value } => put(&mut folded, root, path, value, false)?,
            DocumentEdit::PutWithin { path, value } => put(&mut folded, root, path, value, true)?,
            DocumentEdit::AddCord { element, jack, from } => {
                let entry = entry(&mut folded, root, element)?;
                if let Some(cords) = place_in(entry, jack, true) {
                    *cords = match cords.take() {
                        Value::Array(mut all) => {
                            all.push(json!(from));
                            Value::Array(all)
                        }
                        Value::String(only) => json!([only, from]),
                        _ => json!([from]),
                    };
                }
            }
            DocumentEdit::Replug { element, jacks, from, to } => {
                let entry = entry(&mut folded, root, element)?;
                for jack in jacks {
                    if let Some(cords) = entry.get_mut(jack.as_str()) {
                        replug(cords, from, to);
                    }
                }
            }
        }
    }
    Ok(folded)
}

/// Adds the edit that puts a value at a path.
fn put(
    folded: &mut Vec<Edit>,
    root: &Node,
    path: &[String],
    value: &Value,
    makes_objects: bool,
) -> Result<(), EditError> {
    if let Some(around) = folded.iter_mut().find(|edit| path.starts_with(&edit.path)) {
        let inside = &path[around.path.len()..];
        let place = place_in(&mut around.value, inside, makes_objects);
        *place.ok_or_else(|| EditError::NoPlace(path.join("/")))? = value.clone();
        return Ok(());
    }
    folded.retain(|edit| !edit.path.starts_with(path));
    let mut end = path.len();
    if makes_objects {
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
    let mut own = Value::Object(Map::new());
    if let Some(place) = place_in(&mut own, &path[end..], true) {
        *place = value.clone();
    }
    folded.push(Edit { path: path[..end].to_vec(), value: own });
    Ok(())
}

/// The value of an element with the edits so far, to be changed.
fn entry<'f>(folded: &'f mut Vec<Edit>, root: &Node, element: &str) -> Result<&'f mut Value, EditError> {
    let path = ["elements".to_owned(), element.to_owned()];
    let nowhere = || EditError::NoPlace(path.join("/"));
    if let Some(index) = folded.iter().position(|edit| path.starts_with(&edit.path)) {
        let around = &mut folded[index];
        let inside = &path[around.path.len()..];
        return place_in(&mut around.value, inside, false).ok_or_else(nowhere);
    }
    let node = path.iter().try_fold(root, |node, key| node.child(key)).ok_or_else(nowhere)?;
    let mut value = node.to_value();
    let (below, others): (Vec<Edit>, Vec<Edit>) =
        std::mem::take(folded).into_iter().partition(|edit| edit.path.starts_with(&path));
    for edit in below {
        if let Some(place) = place_in(&mut value, &edit.path[path.len()..], true) {
            *place = edit.value;
        }
    }
    *folded = others;
    let index = folded.len();
    folded.push(Edit { path: path.to_vec(), value });
    Ok(&mut folded[index].value)
}

/// The place at a path of keys in a value; a last key that is not there is added. `None` if a key before the last is not
/// there and no objects are to be made, or if something on the path is no object.
fn place_in<'v>(value: &'v mut Value, keys: &[String], makes_objects: bool) -> Option<&'v mut Value> {
    let mut place = value;
    for (index, key) in keys.iter().enumerate() {
        let Value::Object(entries) = place else { return None };
        let is_last = index + 1 == keys.len();
        if !is_last && !makes_objects && !entries.contains_key(key) {
            return None;
        }
        place = entries.entry(key.clone()).or_insert_with(|| Value::Object(Map::new()));
    }
    Some(place)
}

/// Puts another name in place of one that is plugged into jacks.
fn replug(jacks: &mut Value, from: &str, to: &str) {
    match jacks {
        Value::String(text) if text == from => *text = to.to_owned(),
        Value::Array(items) => items.iter_mut().for_each(|item| replug(item, from, to)),
        Value::Object(entries) => entries.values_mut().for_each(|item| replug(item, from, to)),
        _ => (),
    }
}

/// A piece of the text that gives way to another.
struct Patchwork {
    start: usize,
    end: usize,
    text: String,
}

/// The text with other values in some places, no two of which overlap.
///
/// # Errors
/// When a path leads nowhere.
pub(super) fn splice(text: &str, root: &Node, edits: &[Edit]) -> Result<String, EditError> {
    let mut opened = Vec::new();
    let pieces = edits.iter().map(|edit| piece(root, edit, &mut opened));
    let mut pieces = pieces.collect::<Result<Vec<_>, _>>()?;
    pieces.sort_by_key(|piece| piece.start);
    let mut text = text.to_owned();
    // From the end, so that what stands before keeps its place.
    for piece in pieces.iter().rev() {
        text.replace_range(piece.start..piece.end, &piece.text);
    }
    Ok(text)
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
