//! Modes: their values and the conditions under which they change.

use serde::Serialize;

use super::lines;
use crate::notation::escaped;

/// A mode: a discrete value of an element, such as the position of a relay.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeDescription {
    /// Name of the element.
    pub element: String,
    /// A noun, such as "position".
    pub mode: String,
    /// Name of the value at the start, before the conditions are examined.
    pub initial: String,
    /// The changes; of several that are due, the first one happens.
    pub changes: Vec<ModeChange>,
}

/// A change of a mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeChange {
    /// Name of the value before the change.
    pub from: String,
    /// Name of the value after it.
    pub to: String,
    /// The condition.
    pub when: String,
    /// The condition in LaTeX, without the signs that begin a formula.
    pub when_latex: String,
    /// What else the change sets, such as "v = -e v"; empty if nothing.
    pub sets: String,
    /// The same in LaTeX.
    pub sets_latex: String,
}

impl ModeDescription {
    /// The mode as plain text, one change a line.
    pub(super) fn text(&self) -> String {
        let change = |change: &ModeChange| {
            let sets = if change.sets.is_empty() { String::new() } else { format!(", then {}", change.sets) };
            format!("  {} -> {} if {}{sets}", change.from, change.to, change.when)
        };
        let head = format!("{} of {}, at first {}:\n", self.mode, self.element, self.initial);
        head + &lines(self.changes.iter().map(change))
    }

    /// The mode in LaTeX: a heading and a list of its changes.
    pub(super) fn latex(&self) -> String {
        let change = |change: &ModeChange| {
            let sets = &change.sets_latex;
            let sets = if sets.is_empty() { String::new() } else { format!(", then ${sets}$") };
            format!("  \\item {} $\\to$ {} if ${}${sets}", change.from, change.to, change.when_latex)
        };
        let head =
            format!("\\noindent {} of {}, at first {}:\n", self.mode, escaped(&self.element), self.initial);
        let changes = lines(self.changes.iter().map(change));
        if changes.is_empty() {
            return head;
        }
        format!("{head}\\begin{{itemize}}\n{changes}\\end{{itemize}}\n")
    }
}

/// The changes in order, with those joined that differ in the first value only. Changes from different values do not
/// compete, so their order does not matter.
pub(super) fn joined(changes: impl Iterator<Item = ModeChange>) -> Vec<ModeChange> {
    let mut kept: Vec<ModeChange> = Vec::new();
    for change in changes {
        let is_equal = |other: &&mut ModeChange| {
            (&other.to, &other.when, &other.sets) == (&change.to, &change.when, &change.sets)
        };
        match kept.iter_mut().find(is_equal) {
            Some(other) if other.from.split(" or ").any(|name| name == change.from) => {}
            Some(other) => other.from += &format!(" or {}", change.from),
            None => kept.push(change),
        }
    }
    kept
}
