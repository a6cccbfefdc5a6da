//! Recognises the kind of a document, so that a document of the wrong kind gets one clear diagnostic.
//!
//! Without this check, an experiment in place of a patch would give one "unknown key" for each of its keys.

use super::code::Code;
use super::diagnostic::Diagnostic;
use super::tree::{Content, Node};

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
/// # Ok::<(), patchcord_core::document::Diagnostic>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DocumentKind {
    /// A patch.
    Patch,
    /// An experiment: the name of a patch, with measured data.
    Experiment,
    /// An effect that a patch may lack.
    Effect,
}

/// All kinds, in the order in which they are tried.
const ALL: [DocumentKind; 3] = [DocumentKind::Patch, DocumentKind::Experiment, DocumentKind::Effect];

impl DocumentKind {
    /// The diagnostic for a document of another kind in place of this one.
    ///
    /// `None` if the document is of this kind, or of no known kind.
    pub fn wrong_kind(self, root: &Node) -> Option<Diagnostic> {
        let Content::Object(entries) = &root.value else { return None };
        let find = |key: &str| entries.iter().find(|entry| entry.key == key);
        if find(self.keys()[0]).is_some() {
            return None;
        }
        let given = ALL.into_iter().find(|kind| kind.keys().iter().all(|key| find(key).is_some()))?;
        let message = format!("this is {}, where {} is needed", given.noun(), self.noun());
        let hint = if self == DocumentKind::Effect { FOLDER_HINT } else { given.hint() };
        Some(Diagnostic::at(Code::UNKNOWN_KEY, find(given.keys()[0])?.key_span, message).hint(hint))
    }

    /// The keys that identify the kind: a document with all of them is of this kind. The first key alone is
    /// sufficient if this kind is expected.
    fn keys(self) -> &'static [&'static str] {
        match self {
            DocumentKind::Patch => &["patchcord"],
            DocumentKind::Experiment => &["patch", "outputs"],
            DocumentKind::Effect => &["effect", "forms"],
        }
    }

    /// The kind's name with its article, for messages.
    fn noun(self) -> &'static str {
        match self {
            DocumentKind::Patch => "a patch",
            DocumentKind::Experiment => "an experiment",
            DocumentKind::Effect => "an effect",
        }
    }

    /// What to do with a document of this kind that was given in place of a patch or an experiment.
    fn hint(self) -> &'static str {
        match self {
            DocumentKind::Patch => {
                "an experiment is another file, which names the patch and the measured data: see docs/gap.md"
            }
            DocumentKind::Experiment => "run `patchcord gap` with it, or use the patch that it names",
            DocumentKind::Effect => {
                "`patchcord gap EXPERIMENT.json --effects DIR` tries the effects of a folder: see docs/effect-format.md"
            }
        }
    }
}

/// What to do with a document that is not an effect in a folder of effects.
const FOLDER_HINT: &str =
    "every .json file in a folder of effects is read as an effect: keep other files elsewhere";
