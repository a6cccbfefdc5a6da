//! Reads typed values and the keys of objects from a JSON tree.
//!
//! Every reader returns `None` for a wrong value and adds a diagnostic to the findings, so reading can continue. An
//! object is read with [`Fields`]: the decoder takes the keys that it knows, and [`Fields::finish`] reports missing and
//! unknown keys.

use std::collections::HashSet;

use super::Placed;
use super::code::Code;
use super::diagnostic::{Diagnostic, Span};
use super::quantity::{Quantity, fixed_unit, unit_rule};
use super::tree::{Content, KeyValue, Node};
use super::typed_number::without_separators;
use super::wording::suggestion;
use patchcord_expr::nearest;

/// The diagnostics that were found so far.
pub type Findings = Vec<Diagnostic>;

/// Reads a finite number. `key` is named in the diagnostic for another value.
pub fn number(node: &Node, key: &str, findings: &mut Findings) -> Option<f64> {
    let Content::Number(text) = &node.value else {
        findings.push(wrong_type(node, key, "a number", &node.value));
        return None;
    };
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
    if value.is_none() {
        let message = format!("{text} is too large to hold");
        let hint = "every number must be finite";
        findings.push(Diagnostic::at(Code::NOT_FINITE, node.span, message).hint(hint));
    }
    value
}

/// Reads `true` or `false`.
pub fn flag(node: &Node, key: &str, findings: &mut Findings) -> Option<bool> {
    let Content::Flag(flag) = node.value else {
        findings.push(wrong_type(node, key, "true or false", &node.value));
        return None;
    };
    Some(flag)
}

/// Reads a text with its position.
pub fn string(node: &Node, key: &str, findings: &mut Findings) -> Option<Placed<String>> {
    let Content::Text(text) = &node.value else {
        findings.push(wrong_type(node, key, "a text", &node.value));
        return None;
    };
    Some(Placed { value: text.clone(), span: node.span })
}

/// Reads the optional number of a key, which must be above 0.
pub fn positive(fields: &mut Fields<'_>, key: &'static str, findings: &mut Findings) -> Option<Placed<f64>> {
    number_if(fields, key, findings, |value| value > 0.0, "above 0")
}

/// Reads the optional number of a key, which must be 0 or above.
pub fn non_negative(
    fields: &mut Fields<'_>,
    key: &'static str,
    findings: &mut Findings,
) -> Option<Placed<f64>> {
    number_if(fields, key, findings, |value| value >= 0.0, "0 or above")
}

/// Reads the optional number of a key. `condition` describes the allowed values in the message.
fn number_if(
    fields: &mut Fields<'_>,
    key: &'static str,
    findings: &mut Findings,
    is_allowed: impl Fn(f64) -> bool,
    condition: &str,
) -> Option<Placed<f64>> {
    let node = fields.take(key)?;
    let value = number(node, key, findings)?;
    if !is_allowed(value) {
        let message = format!("\"{key}\" must be {condition}, not {value}");
        findings.push(Diagnostic::at(Code::BAD_NUMBER, node.span, message));
        return None;
    }
    Some(Placed { value, span: node.span })
}

/// Reads one text or a list of texts. Values that are not texts are reported and left out.
pub fn strings(node: &Node, key: &str, findings: &mut Findings) -> Vec<Placed<String>> {
    match &node.value {
        Content::List(items) => items.iter().filter_map(|item| string(item, key, findings)).collect(),
        _ => string(node, key, findings).into_iter().collect(),
    }
}

/// Reads the items of a list.
pub fn list<'a>(node: &'a Node, key: &str, findings: &mut Findings) -> Option<&'a [Node]> {
    let Content::List(items) = &node.value else {
        findings.push(wrong_type(node, key, "a list", &node.value));
        return None;
    };
    Some(items)
}

/// The diagnostic for a value of the wrong type. `expected` describes the right type, with its article.
pub fn wrong_type(node: &Node, key: &str, expected: &str, got: &Content) -> Diagnostic {
    let message = format!("\"{key}\" must be {expected}, not {}", got.noun());
    let hint = match got {
        Content::Text(text) if expected == "a number" => quoted_number_hint(text, key),
        _ => None,
    };
    Diagnostic::at(Code::WRONG_TYPE, node.span, message).maybe_hint(hint)
}

/// The hint for a text in place of a number. `None` if the text is neither a number, perhaps with a decimal comma, nor a
/// number with a unit.
fn quoted_number_hint(text: &str, key: &str) -> Option<String> {
    if text.parse::<f64>().is_ok_and(f64::is_finite) {
        return Some("remove the quotes".to_owned());
    }
    if let Some(advised) = without_separators(text).filter(|_| !text.contains(char::is_alphabetic)) {
        return Some(format!("write {advised} without quotes"));
    }
    let quantity = Quantity::parse(text)?;
    let advised = fixed_unit(key).and_then(|unit| quantity.number_in(unit));
    let number = advised.as_deref().unwrap_or("the number alone");
    Some(format!("write {number} without quotes: {}", unit_rule(key)))
}

/// A hint about a key that the format does not have.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyAdvice {
    /// The key of the format that was meant.
    pub key: &'static str,
    /// What to write instead.
    pub hint: String,
}

/// The keys of an object while a decoder takes them. Keys that remain at the end are unknown.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::fields::{Fields, number};
/// use patchcord_core::document::tree;
///
/// let root = tree::parse(r#"{"mass": 2, "wight": 3}"#)?;
/// let mut findings = Vec::new();
/// let mut fields = Fields::of(&root, "the body", &mut findings).expect("the root is an object");
/// let mass = fields.require("mass", "in kg").and_then(|node| number(node, "mass", &mut findings));
/// fields.finish(&mut findings);
/// assert_eq!(mass, Some(2.0));
/// assert_eq!(findings[0].message, "\"wight\" is not a key of the body");
/// # Ok::<(), patchcord_core::document::Diagnostic>(())
/// ```
pub struct Fields<'a> {
    /// The entries of the object, and whether they were taken.
    pub entries: Vec<(&'a KeyValue, bool)>,
    /// Position of the object.
    span: Span,
    /// The keys that the decoder knows, present or not. Hints for unknown keys suggest them.
    known_keys: Vec<&'static str>,
    /// Required keys that are missing, with their meaning.
    missing: Vec<(&'static str, String)>,
    /// What the object is, for messages: "the patch" or "element A1".
    noun: String,
}

impl<'a> Fields<'a> {
    /// The keys of an object. Reports keys that occur twice. `None` if the value is not an object.
    ///
    /// `noun` is what messages call the object.
    pub fn of(node: &'a Node, noun: impl Into<String>, findings: &mut Findings) -> Option<Self> {
        Fields::of_with_hint(node, noun, None, findings)
    }

    /// Like [`Fields::of`]. `hint` says what to write in place of a value that is not an object.
    pub fn of_with_hint(
        node: &'a Node,
        noun: impl Into<String>,
        hint: Option<String>,
        findings: &mut Findings,
    ) -> Option<Self> {
        let noun = noun.into();
        let Content::Object(entries) = &node.value else {
            let message = format!("{noun} must be an object, not {}", node.value.noun());
            findings.push(Diagnostic::at(Code::WRONG_TYPE, node.span, message).maybe_hint(hint));
            return None;
        };
        report_duplicates(entries, findings);
        let entries = entries.iter().map(|entry| (entry, false)).collect();
        Some(Fields { entries, span: node.span, known_keys: Vec::new(), missing: Vec::new(), noun })
    }

    /// Takes the value of an optional key.
    pub fn take(&mut self, key: &'static str) -> Option<&'a Node> {
        self.take_with_key(key).map(|(_, node)| node)
    }

    /// Takes the value of an optional key, with the position of the key. If the key occurs twice, the first value
    /// counts.
    pub fn take_with_key(&mut self, key: &'static str) -> Option<(Span, &'a Node)> {
        self.known_keys.push(key);
        let mut first = None;
        for (entry, taken) in self.entries.iter_mut().filter(|(entry, _)| entry.key == key) {
            *taken = true;
            first = first.or(Some((entry.key_span, &entry.value)));
        }
        first
    }

    /// Takes the value of a required key. If the key is missing, [`Fields::finish`] reports it.
    ///
    /// `meaning` describes the key. It becomes the hint of the diagnostic.
    pub fn require(&mut self, key: &'static str, meaning: &str) -> Option<&'a Node> {
        let node = self.take(key);
        if node.is_none() {
            self.missing.push((key, meaning.to_owned()));
        }
        node
    }

    /// Takes the text of an optional key. Empty if the key is missing or its value is not a text.
    pub fn text(&mut self, key: &'static str, findings: &mut Findings) -> String {
        let node = self.take(key);
        node.and_then(|node| string(node, key, findings)).map_or_else(String::new, |text| text.value)
    }

    /// Takes an optional section, an object, and calls `each` for each of its keys. Of equal keys only the first
    /// counts.
    pub fn each(
        &mut self,
        section: &'static str,
        findings: &mut Findings,
        mut each: impl FnMut(&'a KeyValue, &mut Findings),
    ) {
        let Some(node) = self.take(section) else { return };
        let Some(named) = Fields::of(node, format!("\"{section}\""), findings) else { return };
        for entry in named.remaining() {
            each(entry, findings);
        }
    }

    /// The entries that were not taken. Of equal keys only the first counts.
    pub fn remaining(&self) -> impl Iterator<Item = &'a KeyValue> + use<'a> {
        let remaining: Vec<_> =
            self.entries.iter().filter(|(_, taken)| !taken).map(|(entry, _)| *entry).collect();
        let mut seen = HashSet::new();
        remaining.into_iter().filter(move |entry| seen.insert(entry.key.as_str()))
    }

    /// Reports the required keys that are missing and the keys that are unknown.
    pub fn finish(&mut self, findings: &mut Findings) {
        self.finish_with_advice(&|_| None, findings);
    }

    /// Like [`Fields::finish`]. `advice` knows keys that people write for keys of this object.
    pub fn finish_with_advice(
        &mut self,
        advice: &dyn Fn(&str) -> Option<KeyAdvice>,
        findings: &mut Findings,
    ) {
        self.report_missing_with_advice(advice, findings);
        for entry in self.remaining() {
            let hint = match advice(&entry.key) {
                Some(advice) => Some(advice.hint),
                None => suggestion(&entry.key, &self.known_keys),
            };
            findings.push(self.unknown_key(entry).maybe_hint(hint));
        }
    }

    /// Reports the required keys that are missing. A misspelled key is reported as unknown, with the right spelling.
    pub fn report_missing(&mut self, findings: &mut Findings) {
        self.report_missing_with_advice(&|_| None, findings);
    }

    /// Like [`Fields::report_missing`]. A key that is written for the missing one is reported in its place.
    fn report_missing_with_advice(
        &mut self,
        advice: &dyn Fn(&str) -> Option<KeyAdvice>,
        findings: &mut Findings,
    ) {
        for (key, meaning) in std::mem::take(&mut self.missing) {
            let is_for_key = |entry: &KeyValue| advice(&entry.key).is_some_and(|advice| advice.key == key);
            if let Some(entry) = self.take_first(is_for_key) {
                let hint = advice(&entry.key).map(|advice| advice.hint);
                findings.push(self.unknown_key(entry).maybe_hint(hint));
                continue;
            }
            findings.push(match self.take_similar(key) {
                Some(entry) => self.unknown_key(entry).hint(format!("did you mean \"{key}\"?")),
                None => {
                    let opening = Span { start: self.span.start, end: self.span.start + 1 };
                    let message = format!("{} needs \"{key}\"", self.noun);
                    Diagnostic::at(Code::MISSING_KEY, opening, message).hint(meaning)
                }
            });
        }
    }

    /// Takes the entry with the most similar key, if a key is similar enough to be a misspelling.
    fn take_similar(&mut self, key: &str) -> Option<&'a KeyValue> {
        let near = nearest(key, self.remaining().map(|entry| entry.key.as_str()))?;
        self.take_first(|entry| entry.key == near)
    }

    /// Takes the first entry that was not taken and meets a condition.
    fn take_first(&mut self, is_meant: impl Fn(&KeyValue) -> bool) -> Option<&'a KeyValue> {
        let (entry, taken) = self.entries.iter_mut().find(|(entry, taken)| !*taken && is_meant(entry))?;
        *taken = true;
        Some(entry)
    }

    /// The diagnostic for a key that the object must not have.
    fn unknown_key(&self, entry: &KeyValue) -> Diagnostic {
        let message = format!("\"{}\" is not a key of {}", entry.key, self.noun);
        Diagnostic::at(Code::UNKNOWN_KEY, entry.key_span, message)
    }
}

/// Reports every key that occurs more than once.
fn report_duplicates(entries: &[KeyValue], findings: &mut Findings) {
    let mut seen = HashSet::new();
    for entry in entries.iter().filter(|entry| !seen.insert(entry.key.as_str())) {
        let message = format!("the key \"{}\" occurs more than once", entry.key);
        let hint = "keep one of them: other JSON readers silently drop the others";
        findings.push(Diagnostic::at(Code::DUPLICATE_KEY, entry.key_span, message).hint(hint));
    }
}
