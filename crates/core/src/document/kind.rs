//! Recognises the kind of a document, so that a document of the wrong kind gets one clear diagnostic.
//!
//! Without this check, an experiment in place of a patch would give one "unknown key" for each of its keys. The results
//! that the program itself writes as JSON are recognised too.

use super::code::Code;
use super::diagnostic::{Diagnostic, Span};
use super::key_synonyms::{QUANTITIES, synonym_advice};
use super::tree::{Content, KeyValue, Node};
use patchcord_expr::nearest;

/// The kinds of documents.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::{DocumentKind, tree};
///
/// let root = tree::parse(r#"{"patch": "p.json", "outputs": {}}"#)?;
/// let finding = DocumentKind::Patch.wrong_kind(&root).expect("an experiment is not a patch");
/// assert_eq!(finding.message, "this is an experiment, where a patch is needed");
/// assert_eq!(DocumentKind::Experiment.wrong_kind(&root), None);
/// assert_eq!(DocumentKind::of(&root), Some(DocumentKind::Experiment));
///
/// let root = tree::parse(r#"{"type": "FeatureCollection"}"#)?;
/// let finding = DocumentKind::Patch.wrong_kind(&root).expect("a map is not a patch");
/// assert_eq!(finding.message, "this is not a patch: it has no key \"patchcord\"");
/// # Ok::<(), patchcord_core::document::Diagnostic>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DocumentKind {
    /// A problem: equations and their quantities, from which `patchcord scale` makes a patch.
    Problem,
    /// A patch.
    Patch,
    /// An experiment: the name of a patch, with measured data.
    Experiment,
    /// An effect that a patch may lack.
    Effect,
    /// The report of a search for missing effects: report.json.
    SearchReport,
    /// The result of another command with `--json`.
    CommandResult,
}

/// All kinds, in the order in which they are tried. A problem has the key of a patch as well, and some results of
/// commands have the keys of an experiment.
const ALL: [DocumentKind; 6] = [
    DocumentKind::Problem,
    DocumentKind::Patch,
    DocumentKind::SearchReport,
    DocumentKind::CommandResult,
    DocumentKind::Experiment,
    DocumentKind::Effect,
];

impl DocumentKind {
    /// The kind of a document. `None` if it is of no known kind.
    pub fn of(root: &Node) -> Option<DocumentKind> {
        let Content::Object(entries) = &root.value else { return None };
        identify(entries).map(|(kind, _)| kind)
    }

    /// The diagnostic for a document of another kind in place of this one.
    ///
    /// A document of no known kind is reported if a patch or a problem is expected. A misspelled main key is left to the
    /// decoder of these. `None` if there is nothing to report.
    pub fn wrong_kind(self, root: &Node) -> Option<Diagnostic> {
        let Content::Object(entries) = &root.value else { return None };
        let (given, identifying) = match identify(entries) {
            Some((given, _)) if given == self => return None,
            Some(identified) => identified,
            None if has_key(entries, self.main_key()) => return None,
            None => return self.unknown_kind(root, entries),
        };
        if self == DocumentKind::Problem && given == DocumentKind::Patch && !has_key(entries, ELEMENTS) {
            return self.unknown_kind(root, entries);
        }
        let message = format!("this is {}, where {} is needed", given.noun(), self.noun());
        let hint = given.hint_in_place_of(self);
        Some(Diagnostic::at(Code::UNKNOWN_KEY, identifying.key_span, message).hint(hint))
    }

    /// The main key of a document of this kind. `None` if the document is of another kind.
    fn identifying_key(self, entries: &[KeyValue]) -> Option<&KeyValue> {
        if self == DocumentKind::Problem {
            return quantities_key(entries);
        }
        let find = |key: &str| entries.iter().find(|entry| entry.key == key);
        let has_all = |keys: &&&[&str]| keys.iter().all(|key| find(key).is_some());
        self.key_sets().iter().find(has_all).and_then(|keys| find(keys[0]))
    }

    /// The diagnostic for a document of no known kind in place of a patch or a problem. `None` for other expected kinds,
    /// if a key is probably the misspelled main key, and for equations, which are a part of a problem.
    fn unknown_kind(self, root: &Node, entries: &[KeyValue]) -> Option<Diagnostic> {
        let hint = match self {
            DocumentKind::Patch => "is it the right file? A patch begins with {\"patchcord\": 1, ...",
            DocumentKind::Problem if !has_key(entries, EQUATIONS) => {
                "is it the right file? A problem has \"patchcord\", \"quantities\", \"equations\" and \"run\": see \
                 docs/problem-format.md"
            }
            _ => return None,
        };
        let main_key = self.main_key();
        if nearest(main_key, entries.iter().map(|entry| entry.key.as_str())).is_some() {
            return None;
        }
        let opening = Span { start: root.span.start, end: root.span.start + 1 };
        let message = format!("this is not {}: it has no key \"{main_key}\"", self.noun());
        Some(Diagnostic::at(Code::MISSING_KEY, opening, message).hint(hint))
    }

    /// The key that is sufficient if this kind is expected. Diagnostics refer to its position.
    fn main_key(self) -> &'static str {
        self.key_sets()[0][0]
    }

    /// The sets of keys that identify the kind: a document with all keys of one set is of this kind. Every set begins
    /// with the main key. A problem is also identified by other words, see [`quantities_key`].
    fn key_sets(self) -> &'static [&'static [&'static str]] {
        match self {
            DocumentKind::Problem => &[&["quantities", "patchcord"]],
            DocumentKind::Patch => &[&["patchcord"]],
            DocumentKind::Experiment => &[&["patch", "outputs"], &["patch", "data"]],
            DocumentKind::Effect => &[&["effect", "forms"]],
            DocumentKind::SearchReport => &[&["verdict", "sentence"]],
            DocumentKind::CommandResult => &[&["ok"]],
        }
    }

    /// The kind's name with its article, for messages.
    fn noun(self) -> &'static str {
        match self {
            DocumentKind::Problem => "a problem",
            DocumentKind::Patch => "a patch",
            DocumentKind::Experiment => "an experiment",
            DocumentKind::Effect => "an effect",
            DocumentKind::SearchReport => "a report of `patchcord gap`",
            DocumentKind::CommandResult => "the result of a command with --json",
        }
    }

    /// What to do with a document of this kind that was given in place of one of another kind.
    fn hint_in_place_of(self, needed: DocumentKind) -> &'static str {
        if needed == DocumentKind::Effect {
            return FOLDER_HINT;
        }
        match self {
            DocumentKind::Problem => {
                "`patchcord scale PROBLEM.json --out PATCH.json` makes a patch from it: see docs/problem-format.md"
            }
            DocumentKind::Patch if needed == DocumentKind::Problem => {
                "a problem has \"quantities\" and no \"elements\": see docs/problem-format.md"
            }
            DocumentKind::Patch => {
                "an experiment is another file, which names the patch and the measured data: see docs/gap.md"
            }
            DocumentKind::Experiment => "run `patchcord gap` with it, or use the patch that it names",
            DocumentKind::Effect => {
                "`patchcord gap EXPERIMENT.json --effects DIR` tries the effects of a folder: see docs/effect-format.md"
            }
            DocumentKind::SearchReport => {
                "`patchcord gap` reads experiments; the fitted patch is the file fitted.json next to the report"
            }
            DocumentKind::CommandResult => "give the command the file from which the result was made",
        }
    }
}

/// The kind of a document with these keys, and the key to which diagnostics refer. `None` if it is of no known kind.
fn identify(entries: &[KeyValue]) -> Option<(DocumentKind, &KeyValue)> {
    ALL.into_iter().find_map(|kind| Some((kind, kind.identifying_key(entries)?)))
}

/// The key of the elements of a patch.
const ELEMENTS: &str = "elements";
/// The key of the equations of a problem or a patch.
const EQUATIONS: &str = "equations";

/// The key of a problem that means its quantities: the right key, another word for it, or a misspelled one.
///
/// `None` if there is no such key, if the document is not one of patchcord, or if it has elements and so is a patch.
fn quantities_key(entries: &[KeyValue]) -> Option<&KeyValue> {
    let find = |is_meant: &dyn Fn(&str) -> bool| entries.iter().find(|entry| is_meant(&entry.key));
    if !has_key(entries, "patchcord") || has_key(entries, ELEMENTS) {
        return None;
    }
    find(&|key| key == QUANTITIES.key).or_else(|| find(&means_quantities))
}

/// Whether a document has a key.
fn has_key(entries: &[KeyValue], key: &str) -> bool {
    entries.iter().any(|entry| entry.key == key)
}

/// Whether a key is another word for "quantities", or a misspelling of it.
fn means_quantities(key: &str) -> bool {
    synonym_advice(&[QUANTITIES], key, |_| true).is_some() || nearest(QUANTITIES.key, [key]).is_some()
}

/// What to do with a document that is not an effect in a folder of effects.
const FOLDER_HINT: &str =
    "every .json file in a folder of effects is read as an effect: keep other files elsewhere";
