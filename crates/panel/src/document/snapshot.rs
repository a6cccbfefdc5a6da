//! The document as data, with its history.
//!
//! Steps of the history share most of their texts, so each text is saved once and steps refer to it by its index.

use std::collections::HashSet;
use std::sync::Arc;

use patchcord_core::document::json_value;
use patchcord_core::patch::TableAccess;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::history::{History, MAX_STEPS, State, Step, StepKind};
use super::{Document, Loose, Refusal, parsed};
use crate::limits::{MAX_LOOSE_CORDS, MAX_NAME_CHARACTERS};

/// Largest number of characters of the name of a step. It contains at most five names.
const MAX_LABEL_CHARACTERS: usize = 6 * MAX_NAME_CHARACTERS;
/// Largest number of a loose cord: the largest integer that the page can represent with all smaller ones.
const MAX_LOOSE_ID: u64 = (1 << 53) - 1;

/// A saved document.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct SavedDocument {
    /// Name of the file.
    file: String,
    /// The texts of all states, each once.
    texts: Vec<String>,
    /// The present state.
    present: SavedState,
    /// Steps that can be reverted, the oldest first.
    done: Vec<SavedStep>,
    /// Steps that can be repeated, the next one last.
    undone: Vec<SavedStep>,
}

/// A saved state.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct SavedState {
    /// Index of its text.
    text: usize,
    /// The cords with a loose end.
    loose: Vec<Loose>,
}

/// A saved step.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct SavedStep {
    /// Its name.
    label: String,
    /// Its kind.
    kind: StepKind,
    /// The state to which it leads.
    state: SavedState,
}

/// Saves a document.
pub(super) fn save(document: &Document) -> Value {
    let mut texts = Vec::new();
    let present = saved_state(&document.state(), &mut texts);
    let History { done, undone, .. } = &document.history;
    let [done, undone] = [done, undone].map(|steps| saved_steps(steps, &mut texts));
    let file = document.patch.file().to_owned();
    json_value(&SavedDocument { file, texts, present, done, undone })
}

/// Saves steps. New texts are added to `texts`.
fn saved_steps(steps: &[Step], texts: &mut Vec<String>) -> Vec<SavedStep> {
    let saved = |step: &Step| SavedStep {
        label: step.label.clone(),
        kind: step.kind.clone(),
        state: saved_state(&step.state, texts),
    };
    steps.iter().map(saved).collect()
}

/// Saves a state. A new text is added to `texts`.
fn saved_state(state: &State, texts: &mut Vec<String>) -> SavedState {
    let known = texts.iter().position(|text| **text == *state.text);
    let text = known.unwrap_or_else(|| {
        texts.push(state.text.to_string());
        texts.len() - 1
    });
    SavedState { text, loose: state.loose.clone() }
}

/// Makes the document of a snapshot.
///
/// # Errors
/// If the data are not a snapshot or above the limits, or its text is not a patch.
pub(super) fn restore(snapshot: &Value, table_access: &TableAccess) -> Result<Document, Refusal> {
    let saved = SavedDocument::deserialize(snapshot).map_err(|error| broken(&error.to_string()))?;
    if saved.done.len() + saved.undone.len() > MAX_STEPS {
        return Err(broken("it has too many steps"));
    }
    let texts: Vec<Arc<str>> = saved.texts.iter().map(|text| Arc::from(text.as_str())).collect();
    let present = state(saved.present, &texts)?;
    let history = History::with_steps(steps(saved.done, &texts)?, steps(saved.undone, &texts)?);
    let mut document = Document::of(parsed(&saved.file, &present.text, table_access)?);
    let loose_cords = history.done.iter().chain(&history.undone).flat_map(|step| &step.state.loose);
    let last = loose_cords.chain(&present.loose).map(|cord| cord.id).max();
    document.next_loose = last.map_or(1, |last| last.saturating_add(1));
    (document.loose, document.history) = (present.loose, history);
    Ok(document)
}

/// The steps of a history.
fn steps(saved: Vec<SavedStep>, texts: &[Arc<str>]) -> Result<Vec<Step>, Refusal> {
    let step = |SavedStep { label, kind, state: saved }| match label.chars().nth(MAX_LABEL_CHARACTERS) {
        Some(_) => Err(broken("the name of a step is too long")),
        None => state(saved, texts).map(|state| Step { label, kind, state }),
    };
    saved.into_iter().map(step).collect()
}

/// A state with its text.
///
/// # Errors
/// If its text is missing, or its loose cords are not valid.
fn state(saved: SavedState, texts: &[Arc<str>]) -> Result<State, Refusal> {
    let text = texts.get(saved.text).ok_or_else(|| broken("a text is missing"))?;
    let ids: HashSet<u64> = saved.loose.iter().map(|cord| cord.id).collect();
    let is_valid =
        |cord: &Loose| cord.id <= MAX_LOOSE_ID && cord.at.iter().all(|coordinate| coordinate.is_finite());
    if saved.loose.len() > MAX_LOOSE_CORDS
        || ids.len() < saved.loose.len()
        || !saved.loose.iter().all(is_valid)
    {
        return Err(broken("its loose cords are not valid"));
    }
    Ok(State { text: Arc::clone(text), loose: saved.loose })
}

/// The refusal of data that are not a snapshot.
fn broken(reason: &str) -> Refusal {
    Refusal::new(format!("the saved session cannot be read: {reason}; open its patch instead"))
}
