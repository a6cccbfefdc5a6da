//! Which kind of document a file is, so that one given in place of another is told as that.

use super::code::Code;
use super::diagnostic::Diagnostic;
use super::tree::{Content, Node};

/// What documents there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DocumentKind {
    /// A patch.
    Patch,
    /// An experiment: a patch and measured data.
    Experiment,
    /// An effect that a patch may lack.
    Effect,
}

const ALL: [DocumentKind; 3] = [DocumentKind::Patch, DocumentKind::Experiment, DocumentKind::Effect];

impl DocumentKind {
    /// That a document is of another kind than this; nothing where it is of this, or of none that is known.
    pub fn instead(self, root: &Node) -> Option<Diagnostic> {
        let Content::Object(entries) = &root.value else { return None };
        let at = |key: &str| entries.iter().find(|entry| entry.key == key);
        if at(self.keys()[0]).is_some() {
            return None;
        }
        let given = ALL.into_iter().find(|kind| kind.keys().iter().all(|key| at(key).is_some()))?;
        let message = format!("this is {}, where {} is needed", given.noun(), self.noun());
        let hint = if self == DocumentKind::Effect { FOLDER_HINT } else { given.hint() };
        Some(Diagnostic::at(Code::UnknownKey, at(given.keys()[0])?.key_span, message).hint(hint))
    }

    /// The keys that tell it.
    fn keys(self) -> &'static [&'static str] {
        match self {
            DocumentKind::Patch => &["patchcord"],
            DocumentKind::Experiment => &["patch", "outputs"],
            DocumentKind::Effect => &["effect", "forms"],
        }
    }

    fn noun(self) -> &'static str {
        match self {
            DocumentKind::Patch => "a patch",
            DocumentKind::Experiment => "an experiment",
            DocumentKind::Effect => "an effect",
        }
    }

    /// What to do with one that was given in place of another.
    fn hint(self) -> &'static str {
        match self {
            DocumentKind::Patch => {
                "an experiment is a file of its own that names the patch and what was measured: docs/gap.md shows one"
            }
            DocumentKind::Experiment => "`patchcord gap` takes it; the patch is the file that it names",
            DocumentKind::Effect => {
                "`patchcord gap EXPERIMENT.json --effects DIR` tries the effects of a folder; docs/effect-format.md tells more"
            }
        }
    }
}

/// What to do with anything else in a folder of effects.
const FOLDER_HINT: &str =
    "every .json file in a folder of effects is taken for one: put them where nothing else is";
