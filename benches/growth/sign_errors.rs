//! All sign errors of a patch.

use patchcord::patch::{Edit, Patch};
use serde_json::{Value, json};

use crate::document::{WrittenCord, cords, edits, replug};
use crate::inverters::inverses;

/// The name of an inverter that is added. No patch has it.
const NEW_NAME: &str = "sign_error";

/// A change that reverses the sign at a cord.
pub(crate) struct SignError {
    /// The change, as a clause.
    pub description: String,
    /// The edits of the document.
    edits: Vec<Edit>,
}

impl SignError {
    /// The patch with the error. `None` if it cannot be made.
    pub(crate) fn patch(&self, patch: &Patch) -> Option<Patch> {
        patch.with_edits(patch.file(), &self.edits).ok()
    }
}

/// All sign errors of a patch: each cord from the inverses of its output, and with an inverter in it.
pub(crate) fn sign_errors(patch: &Patch) -> Vec<SignError> {
    let mut errors = Vec::new();
    for cord in cords(patch) {
        for inverse in inverses(patch, &cord.source) {
            if inverse != cord.element {
                let description =
                    format!("{inverse} is plugged into {} in place of {}", cord.element, cord.source);
                errors.push(SignError { description, edits: replugged(patch, &cord, inverse) });
            }
        }
        let description = format!("an inverter is between {} and {}", cord.source, cord.element);
        let inverter = json!({"kind": "inverter", "in": cord.source});
        let mut edits = replugged(patch, &cord, NEW_NAME);
        edits.push(Edit::at(["elements", NEW_NAME], inverter));
        errors.push(SignError { description, edits });
    }
    errors
}

/// The edits after which a cord comes from another output.
fn replugged(patch: &Patch, cord: &WrittenCord, source: &str) -> Vec<Edit> {
    let mut document: Value = patch.value().clone();
    replug(&mut document, cord, source);
    edits(patch.value(), &document)
}
