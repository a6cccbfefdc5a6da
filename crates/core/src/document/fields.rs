//! Reading values and keys off the tree of the text; what does not fit is noted, and reading goes on.

use std::collections::HashSet;

use super::Placed;
use super::code::Code;
use super::diagnostic::{Diagnostic, Span, suggestion};
use super::tree::{self, Content, Node};
use patchcord_expr::nearest;

/// What was found wrong so far.
pub type Findings = Vec<Diagnostic>;

/// A finite number; reports anything else.
pub fn number(node: &Node, key: &str, findings: &mut Findings) -> Option<f64> {
    let Content::Number(text) = &node.value else {
        findings.push(wrong_type(node, key, "a number", &node.value));
        return None;
    };
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
    if value.is_none() {
        let message = format!("{text} is too large to hold");
        let hint = "every number must be finite";
        findings.push(Diagnostic::at(Code::NotFinite, node.span, message).hint(hint));
    }
    value
}

/// true or false; reports anything else.
pub fn flag(node: &Node, key: &str, findings: &mut Findings) -> Option<bool> {
    let Content::Flag(flag) = node.value else {
        findings.push(wrong_type(node, key, "true or false", &node.value));
        return None;
    };
    Some(flag)
}

/// A text with its place; reports anything else.
pub fn word(node: &Node, key: &str, findings: &mut Findings) -> Option<Placed<String>> {
    let Content::Text(text) = &node.value else {
        findings.push(wrong_type(node, key, "a text", &node.value));
        return None;
    };
    Some(Placed { value: text.clone(), span: node.span })
}

/// A number above 0 under a key.
pub fn positive(fields: &mut Fields<'_>, key: &'static str, findings: &mut Findings) -> Option<Placed<f64>> {
    number_that(fields, key, findings, |value| value > 0.0, "above 0")
}

/// A number that is not below 0 under a key.
pub fn not_negative(
    fields: &mut Fields<'_>,
    key: &'static str,
    findings: &mut Findings,
) -> Option<Placed<f64>> {
    number_that(fields, key, findings, |value| value >= 0.0, "0 or above")
}

fn number_that(
    fields: &mut Fields<'_>,
    key: &'static str,
    findings: &mut Findings,
    is_so: impl Fn(f64) -> bool,
    told: &str,
) -> Option<Placed<f64>> {
    let node = fields.take(key)?;
    let value = number(node, key, findings)?;
    if !is_so(value) {
        let message = format!("\"{key}\" must be {told}, not {value}");
        findings.push(Diagnostic::at(Code::BadNumber, node.span, message));
        return None;
    }
    Some(Placed { value, span: node.span })
}

/// One text, or a list of texts.
pub fn words(node: &Node, key: &str, findings: &mut Findings) -> Vec<Placed<String>> {
    match &node.value {
        Content::List(items) => items.iter().filter_map(|item| word(item, key, findings)).collect(),
        _ => word(node, key, findings).into_iter().collect(),
    }
}

/// The items of a list; reports anything else.
pub fn list<'a>(node: &'a Node, key: &str, findings: &mut Findings) -> Option<&'a [Node]> {
    let Content::List(items) = &node.value else {
        findings.push(wrong_type(node, key, "a list", &node.value));
        return None;
    };
    Some(items)
}

/// The report of a value of the wrong type.
pub fn wrong_type(node: &Node, key: &str, wanted: &str, got: &Content) -> Diagnostic {
    let message = format!("\"{key}\" takes {wanted}, not {}", got.noun());
    let quoted_number = matches!(got, Content::Text(text) if text.parse::<f64>().is_ok_and(f64::is_finite));
    let hint = (quoted_number && wanted == "a number").then(|| "take the quotes away".to_owned());
    Diagnostic::at(Code::WrongType, node.span, message).maybe_hint(hint)
}

/// The keys of an object, each taken once; what is left at the end is not known.
pub struct Fields<'a> {
    /// The entries, and whether they were taken.
    pub entries: Vec<(&'a tree::Entry, bool)>,
    span: Span,
    asked: Vec<&'static str>,
    /// Keys that were needed and are not there, and what they mean.
    missing: Vec<(&'static str, String)>,
    noun: String,
}

impl<'a> Fields<'a> {
    /// The fields of an object; anything else is noted as wrong.
    pub fn of(node: &'a Node, noun: impl Into<String>, findings: &mut Findings) -> Option<Self> {
        let noun = noun.into();
        let Content::Object(entries) = &node.value else {
            let message = format!("{noun} must be an object, not {}", node.value.noun());
            findings.push(Diagnostic::at(Code::WrongType, node.span, message));
            return None;
        };
        note_duplicates(entries, findings);
        let entries = entries.iter().map(|entry| (entry, false)).collect();
        Some(Fields { entries, span: node.span, asked: Vec::new(), missing: Vec::new(), noun })
    }

    /// The value of an optional key.
    pub fn take(&mut self, key: &'static str) -> Option<&'a Node> {
        self.take_with_key(key).map(|(_, node)| node)
    }

    /// The value of an optional key, and the place of the key.
    pub fn take_with_key(&mut self, key: &'static str) -> Option<(Span, &'a Node)> {
        self.asked.push(key);
        let mut found = None;
        for (entry, taken) in self.entries.iter_mut().filter(|(entry, _)| entry.key == key) {
            *taken = true;
            found = found.or(Some((entry.key_span, &entry.value)));
        }
        found
    }

    /// What must be there; if it is not, [`Fields::finish`] says so.
    pub fn need(&mut self, key: &'static str, meaning: &str) -> Option<&'a Node> {
        let node = self.take(key);
        if node.is_none() {
            self.missing.push((key, meaning.to_owned()));
        }
        node
    }

    /// The text under a key; empty where there is none.
    pub fn text(&mut self, key: &'static str, findings: &mut Findings) -> String {
        let node = self.take(key);
        node.and_then(|node| word(node, key, findings)).map_or_else(String::new, |text| text.value)
    }

    /// Calls `each` for every named thing of a section.
    pub fn each(
        &mut self,
        section: &'static str,
        findings: &mut Findings,
        mut each: impl FnMut(&'a tree::Entry, &mut Findings),
    ) {
        let Some(node) = self.take(section) else { return };
        let Some(named) = Fields::of(node, format!("\"{section}\""), findings) else { return };
        for entry in named.rest() {
            each(entry, findings);
        }
    }

    /// Every entry that was not taken, the first of each key.
    pub fn rest(&self) -> impl Iterator<Item = &'a tree::Entry> + use<'a> {
        let left: Vec<_> = self.entries.iter().filter(|(_, taken)| !taken).map(|(entry, _)| *entry).collect();
        let mut seen = HashSet::new();
        left.into_iter().filter(move |entry| seen.insert(entry.key.as_str()))
    }

    /// Reports the keys that are missing and those that are not known.
    pub fn finish(&mut self, findings: &mut Findings) {
        self.report_missing(findings);
        for entry in self.rest() {
            findings.push(self.unknown(entry).maybe_hint(suggestion(&entry.key, &self.asked)));
        }
    }

    /// Reports the keys that are missing. One that stands there misspelled is not missing but unknown.
    pub fn report_missing(&mut self, findings: &mut Findings) {
        for (key, meaning) in std::mem::take(&mut self.missing) {
            findings.push(match self.take_near(key) {
                Some(entry) => self.unknown(entry).hint(format!("did you mean \"{key}\"?")),
                None => {
                    let opening = Span { start: self.span.start, end: self.span.start + 1 };
                    let message = format!("{} needs \"{key}\"", self.noun);
                    Diagnostic::at(Code::MissingKey, opening, message).hint(meaning)
                }
            });
        }
    }

    fn take_near(&mut self, key: &str) -> Option<&'a tree::Entry> {
        let near = nearest(key, self.rest().map(|entry| entry.key.as_str()))?;
        let (entry, taken) = self.entries.iter_mut().find(|(entry, _)| entry.key == near)?;
        *taken = true;
        Some(entry)
    }

    fn unknown(&self, entry: &tree::Entry) -> Diagnostic {
        let message = format!("\"{}\" is not a key of {}", entry.key, self.noun);
        Diagnostic::at(Code::UnknownKey, entry.key_span, message)
    }
}

fn note_duplicates(entries: &[tree::Entry], findings: &mut Findings) {
    let mut seen = HashSet::new();
    for entry in entries.iter().filter(|entry| !seen.insert(entry.key.as_str())) {
        let message = format!("\"{}\" stands here more than once", entry.key);
        let hint = "keep one of them: JSON readers would silently drop the others";
        findings.push(Diagnostic::at(Code::DuplicateKey, entry.key_span, message).hint(hint));
    }
}
