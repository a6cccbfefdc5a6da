//! Keys of other programs and of textbooks, for hints about unknown keys.
//!
//! The tables are in `elements` and in `patch`, except for the key that identifies a problem.

use super::fields::KeyAdvice;

/// A key of this format, with what people write for it.
pub(crate) struct KeySynonyms {
    /// The key of this format.
    pub key: &'static str,
    /// What it specifies; empty if the hint needs no explanation.
    pub meaning: &'static str,
    /// What people write, in lower case with underscores.
    pub words: &'static [&'static str],
}

impl KeySynonyms {
    /// A key without an explanation.
    pub(crate) const fn new(key: &'static str, words: &'static [&'static str]) -> KeySynonyms {
        KeySynonyms { key, meaning: "", words }
    }
}

/// Keys that people write for the quantities of a problem. They also identify a document as a problem.
pub(crate) const QUANTITIES: KeySynonyms = KeySynonyms {
    key: "quantities",
    meaning: "the quantities of the equations with their units",
    words: &[
        "quantity",
        "variables",
        "variable",
        "unknowns",
        "unknown",
        "states",
        "state",
        "state_variables",
    ],
};

/// The hint about an unknown key, from the first row of a table that has it and whose key is permitted. `None` if there
/// is no such row. Capitals, blanks and hyphens do not count.
pub(crate) fn synonym_advice(
    table: &[KeySynonyms],
    written: &str,
    is_permitted: impl Fn(&str) -> bool,
) -> Option<KeyAdvice> {
    let written = written.to_lowercase().replace([' ', '-'], "_");
    let mut rows = table.iter().filter(|row| row.words.contains(&written.as_str()));
    let &KeySynonyms { key, meaning, .. } = rows.find(|row| is_permitted(row.key))?;
    let meaning = if meaning.is_empty() { String::new() } else { format!(", {meaning}") };
    Some(KeyAdvice { key, hint: format!("did you mean \"{key}\"{meaning}?") })
}
