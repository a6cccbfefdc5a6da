//! The log of a search in words and as a document.

use serde::Serialize;

use crate::report::ranges::LeftOverDocument;
use crate::search::search_log::{Action, Change};

/// An entry of the log as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchLogDocument {
    /// What was done, in words.
    pub did: String,
    /// The effects in the patch after that, each with its place.
    pub effects: Vec<String>,
    /// What the patch with them leaves.
    pub left: LeftOverDocument,
}

impl From<&Change> for SearchLogDocument {
    fn from(change: &Change) -> Self {
        let [train, test] = change.left;
        SearchLogDocument {
            did: action_text(&change.did),
            effects: change.effects.clone(),
            left: LeftOverDocument { train, test },
        }
    }
}

/// What the search did, in words.
pub fn action_text(action: &Action) -> String {
    match action {
        Action::FitPatch => "the patch as it was".to_owned(),
        Action::Take(effect) => format!("{effect} is taken"),
        Action::ContinueUnconfirmed(effect) => format!("{effect} is gone on from, not confirmed by itself"),
        Action::TryInPair(effect) => {
            format!("{effect} is gone on from, as of two effects one may hide the other")
        }
        Action::BacktrackFromMore => "back, as more effects do not hold together".to_owned(),
        Action::BacktrackFromPair => "back, as no two hold together and leave but noise".to_owned(),
        Action::RefitFromTrial => "the same, fitted better from where a trial had come to".to_owned(),
        Action::RestoreFit => "the same, as it was before that".to_owned(),
        Action::Drop(effect) => format!("{effect} is dropped"),
        Action::Keep(effect) => format!("{effect} is looked at again beside the others, and stays"),
        Action::Replace { by, replaced } => format!("{by} takes the place of {replaced}"),
    }
}
