//! Edits of a document: new values at paths of keys, and the errors of all edits.
//!
//! [`Patch::with_edits`] puts values at arbitrary paths, and reads the edited text again. [`Patch::edit`] begins typed
//! edits, which are faster: see `editor`.

use serde_json::Value;

use super::document::Patch;
use super::render::{root_of, splice};
use crate::document::Report;

/// A new value at a path of keys in a document.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::Edit;
///
/// let edit = Edit::new("parameters/k/value", 3);
/// assert_eq!(edit.path(), ["parameters", "k", "value"]);
/// assert_eq!(edit.value(), &serde_json::json!(3));
/// let edit = Edit::at(["parameters", "k", "note"], "a/b");
/// assert_eq!(edit.path().len(), 3);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Edit {
    /// The keys from the root of the document. All except the last must exist in the document.
    pub(super) path: Vec<String>,
    /// The new value.
    pub(super) value: Value,
}

impl Edit {
    /// A new value at a path such as `"parameters/VcL/value"`. The separator is a slash.
    pub fn new(path: &str, value: impl Into<Value>) -> Edit {
        Edit { path: path.split('/').map(str::to_owned).collect(), value: value.into() }
    }

    /// A new value at a path of keys. Unlike [`Edit::new`], it permits keys with a slash.
    pub fn at(keys: impl IntoIterator<Item = impl Into<String>>, value: impl Into<Value>) -> Edit {
        Edit { path: keys.into_iter().map(Into::into).collect(), value: value.into() }
    }

    /// The keys from the root of the document to the value.
    pub fn path(&self) -> &[String] {
        &self.path
    }

    /// The new value.
    pub fn value(&self) -> &Value {
        &self.value
    }
}

/// The reason why a document cannot be edited.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{EditError, PatchBuilder};
///
/// let patch = PatchBuilder::new("spring").parameter("k", 2.0, "N/m", [0.0, 10.0]).build()?;
/// let error = patch.edit().set_parameter("m", 1.0).unwrap_err();
/// assert_eq!(error.to_string(), "there is no parameter m in the patch");
/// let error = patch.edit().set_parameter("k", f64::NAN).unwrap_err();
/// assert!(matches!(error, EditError::NotFinite(name) if name == "k"));
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A key of a path before the last is missing, or its value is not an object. The field is the path.
    #[error("there is no {0} in the document")]
    MissingPath(String),
    /// Two edits have the same path, or one path is within the other. The field is the path of the inner edit.
    #[error("{0} is edited twice")]
    OverlappingEdits(String),
    /// The patch does not have a parameter, element, setting, drive or cord.
    #[error("there is no {noun} {name} in the patch")]
    Unknown {
        /// The kind of object: "parameter", "element", "setting", "drive", "cord".
        noun: &'static str,
        /// The name that does not exist. For a cord, its two ends: "from P1 into x10 of A1".
        name: String,
    },
    /// The element belongs to an instance of a macro, so it is not in the document. The field is its name.
    #[error("{0} is inside an instance: edit its macro")]
    InsideInstance(String),
    /// A value is infinite or not a number. The field is the name of the parameter.
    #[error("{0} must be a finite number")]
    NotFinite(String),
    /// The edited text cannot be decoded, for example because it is longer than 16 MB.
    #[error(transparent)]
    InvalidDocument(#[from] Box<Report>),
}

impl Patch {
    /// Returns a patch with new values at some paths of the document. `file` is its name.
    ///
    /// Only these places of the text change. If the last key of a path does not exist, it is added at the end of its
    /// object.
    ///
    /// # Errors
    /// If a path does not exist, if two edits overlap, or if the new text cannot be decoded.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{Edit, Patch};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = Patch::parse("old.json", r#"{"patchcord": 1, "run":  {"for": 8}}"#)?;
    /// let longer = patch.with_edits("new.json", &[Edit::new("run/for", 10), Edit::new("run/every", 0.5)])?;
    /// assert_eq!(longer.text(), r#"{"patchcord": 1, "run":  {"for": 10, "every": 0.5}}"#);
    /// # Ok(())
    /// # }
    /// ```
    pub fn with_edits(&self, file: &str, edits: &[Edit]) -> Result<Patch, EditError> {
        check_no_overlap(edits)?;
        let text = splice(self.text(), &root_of(self.text()), edits)?;
        let table_access = self.table_access.renamed(&self.file, file);
        Ok(Patch::parse_with(table_access, file, &text)?)
    }
}

/// Checks that no edit has the same path as another one, or a path within that of another.
fn check_no_overlap(edits: &[Edit]) -> Result<(), EditError> {
    let overlaps = |(index, edit): &(usize, &Edit)| {
        let is_repeated = edits[..*index].iter().any(|earlier| earlier.path == edit.path);
        let contains_edit =
            |outer: &Edit| outer.path.len() < edit.path.len() && edit.path.starts_with(&outer.path);
        is_repeated || edits.iter().any(contains_edit)
    };
    match edits.iter().enumerate().find(overlaps) {
        Some((_, edit)) => Err(EditError::OverlappingEdits(edit.path.join("/"))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// A document with an irregular layout, which edits must keep.
    const TEXT: &str = r#"{
  "patchcord": 1,
  "parameters": {"K":  {"value": 45e6, "unit": "N/m"}},
  "run": {"for": 8},
  "empty": {}
}
"#;

    /// The patch of `TEXT` with edits.
    fn edited(edits: &[Edit]) -> Result<Patch, EditError> {
        Patch::parse("old.json", TEXT).unwrap().with_edits("new.json", edits)
    }

    #[test]
    fn edits_change_only_their_places_in_the_text() {
        let edits = [
            Edit::new("run/every", 0.5),
            Edit::new("parameters/K/value", 1e3),
            Edit::new("pictures", json!([{"x": "t", "y": ["x", "v"]}])),
            Edit::new("empty/key", "text"),
        ];
        let patch = edited(&edits).unwrap();
        let text = r#"{
  "patchcord": 1,
  "parameters": {"K":  {"value": 1000.0, "unit": "N/m"}},
  "run": {"for": 8, "every": 0.5},
  "empty": {"key": "text"}, "pictures": [
    {"x": "t", "y": ["x", "v"]}
  ]
}
"#;
        assert_eq!((patch.text(), patch.file()), (text, "new.json"));
    }

    #[test]
    fn several_new_keys_are_added_to_one_object_in_the_order_of_the_edits() {
        let text = |empty: &str| {
            let old = TEXT.replace("{}", empty);
            let keys = ["empty/b", "run/every", "empty/a", "run/step", "empty/c"];
            let edits: Vec<_> = keys.iter().map(|key| Edit::new(key, 1)).collect();
            Patch::parse("old.json", &old).unwrap().with_edits("new.json", &edits).unwrap().text().to_owned()
        };
        for empty in ["{}", "{ }"] {
            assert!(text(empty).contains(r#""run": {"for": 8, "every": 1, "step": 1},"#), "{}", text(empty));
            assert!(text(empty).contains(r#""empty": {"b": 1, "a": 1, "c": 1}"#), "{}", text(empty));
        }
    }

    #[test]
    fn a_missing_path_and_overlapping_edits_are_rejected() {
        let message = |edits: &[Edit]| edited(edits).unwrap_err().to_string();
        assert_eq!(
            message(&[Edit::new("parameters/M/value", 1)]),
            "there is no parameters/M/value in the document"
        );
        assert_eq!(message(&[Edit::new("patchcord/x", 1)]), "there is no patchcord/x in the document");
        let within = [Edit::new("parameters/K", json!({})), Edit::new("parameters/K/value", 1)];
        assert_eq!(message(&within), "parameters/K/value is edited twice");
        assert_eq!(message(&[Edit::new("run/for", 1), Edit::new("run/for", 2)]), "run/for is edited twice");
        for missing in ["run/every", "empty/key"] {
            let twice = [Edit::new(missing, 1), Edit::new("patchcord", 1), Edit::new(missing, 1)];
            assert_eq!(message(&twice), format!("{missing} is edited twice"));
        }
    }
}
