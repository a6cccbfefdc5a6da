//! Cords in the JSON document of a patch, and differences between two documents.

use patchcord_core::patch::{Edit, Patch};
use serde_json::{Map, Value, json};

/// A cord as the document has it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct WrittenCord {
    /// Name of the element or instance that it drives.
    pub element: String,
    /// Name of the jack.
    pub jack: String,
    /// Its index among the cords of the jack.
    pub index: usize,
    /// Name of the output from which it comes.
    pub source: String,
}

/// All cords in the section "elements" of a patch, in the order of the document.
pub(crate) fn cords(patch: &Patch) -> Vec<WrittenCord> {
    written_elements(patch).flat_map(|element| cords_of(patch, element)).collect()
}

/// The names in the section "elements" of a patch.
pub(crate) fn written_elements(patch: &Patch) -> impl Iterator<Item = &String> {
    patch.value()["elements"].as_object().into_iter().flat_map(|elements| elements.keys())
}

/// The cords of one element.
fn cords_of(patch: &Patch, element: &str) -> Vec<WrittenCord> {
    let mut found: Vec<WrittenCord> = Vec::new();
    for (jack, source) in patch.written_cords(element) {
        let index = found.iter().filter(|cord| cord.jack == jack).count();
        let (element, jack, source) = (element.to_owned(), jack.to_owned(), source.to_owned());
        found.push(WrittenCord { element, jack, index, source });
    }
    found
}

/// The value at the jack of a cord: a name or a list of names. The document has the cord.
fn jack_of<'d>(document: &'d mut Value, cord: &WrittenCord) -> &'d mut Value {
    let element = &mut document["elements"][&cord.element];
    if element["in"].is_object() { &mut element["in"][&cord.jack] } else { &mut element[&cord.jack] }
}

/// Connects a cord to another output.
pub(crate) fn replug(document: &mut Value, cord: &WrittenCord, source: &str) {
    match jack_of(document, cord) {
        Value::Array(sources) => sources[cord.index] = json!(source),
        only => *only = json!(source),
    }
}

/// Removes a cord from a jack with a gain.
pub(crate) fn unplug(document: &mut Value, cord: &WrittenCord) {
    let is_empty = match jack_of(document, cord) {
        Value::Array(sources) => {
            sources.remove(cord.index);
            sources.is_empty()
        }
        _ => true,
    };
    if is_empty && let Some(jacks) = document["elements"][&cord.element]["in"].as_object_mut() {
        jacks.shift_remove(&cord.jack);
    }
}

/// Adds a cord at a jack with a gain.
pub(crate) fn plug(document: &mut Value, element: &str, jack: &str, source: &str) {
    let value = &mut document["elements"][element]["in"][jack];
    let mut sources = match value.take() {
        Value::Array(sources) => sources,
        Value::Null => Vec::new(),
        only => vec![only],
    };
    sources.push(json!(source));
    *value = Value::Array(sources);
}

/// The edits that change elements and scales of one document to those of another. No key is missing in the other one.
pub(crate) fn edits(from: &Value, to: &Value) -> Vec<Edit> {
    let mut edits = Vec::new();
    for section in ["elements", "scales"] {
        for (name, entry) in to[section].as_object().into_iter().flatten() {
            for (key, value) in entry.as_object().into_iter().flatten() {
                if from[section][name][key] != *value {
                    edits.push(Edit::at([section, name.as_str(), key.as_str()], value.clone()));
                }
            }
        }
    }
    edits
}

/// A value that is equal for documents with the same meaning. Numbers do not depend on their spelling. Lists of texts,
/// such as the cords of a jack, do not depend on their order.
pub(crate) fn meaning(value: &Value) -> Value {
    match value {
        Value::Number(number) => number.as_f64().map_or_else(|| value.clone(), |number| json!(number)),
        Value::Array(items) => {
            let mut items: Vec<Value> = items.iter().map(meaning).collect();
            if items.iter().all(Value::is_string) {
                items.sort_by(|one, other| one.as_str().cmp(&other.as_str()));
            }
            Value::Array(items)
        }
        Value::Object(entries) => {
            let meanings = entries.iter().map(|(key, value)| {
                let jacks = value.as_object().filter(|_| key == "in");
                (key.clone(), jacks.map_or_else(|| meaning(value), jacks_meaning))
            });
            Value::Object(meanings.collect())
        }
        other => other.clone(),
    }
}

/// The meaning of jacks with gains. A jack with one cord may have a name or a list.
fn jacks_meaning(jacks: &Map<String, Value>) -> Value {
    let lists = jacks.iter().map(|(jack, sources)| {
        let sources = if sources.is_string() { json!([sources]) } else { meaning(sources) };
        (jack.clone(), sources)
    });
    Value::Object(lists.collect())
}
