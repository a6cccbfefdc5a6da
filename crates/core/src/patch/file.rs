//! Reads patches from files, readers and texts, and writes them to files.
//!
//! Reading has three steps: the text is parsed to a tree, `decode` fills the fields of the patch, and `table_file`
//! reads the tables that the patch refers to. Only a text that is not a JSON object with the key "patchcord" is an
//! error here. All other faults are findings of the patch.

use std::io::Read;
use std::path::Path;
use std::str::FromStr;

use serde_json::Value;

use super::document::Patch;
use super::table_access::{TableAccess, folder_of};
use super::{decode, table_file};
use crate::document::file::{
    DocumentError, MAX_DOCUMENT_BYTES, document_too_large, read_text, read_text_from,
};
use crate::document::{Report, tree};
use crate::output::write_atomic;

impl Patch {
    /// Reads a patch from a file.
    ///
    /// # Errors
    /// If the file cannot be read, is larger than 16 MB, or is not a JSON object with the key "patchcord". Faults
    /// inside the object are reported by [`Circuit::new`](crate::circuit::Circuit::new), all at once.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    ///
    /// let patch = Patch::read("../../patches/lessons/bouncing-ball.json")?;
    /// assert_eq!(patch.title, "A ball in a box");
    /// let error = Patch::read("no-such-patch.json").unwrap_err();
    /// assert!(error.to_string().starts_with("cannot read no-such-patch.json"));
    /// # Ok::<(), patchcord_core::document::DocumentError>(())
    /// ```
    pub fn read(path: impl AsRef<Path>) -> Result<Patch, DocumentError> {
        let path = path.as_ref();
        let text = read_text(path)?;
        let file = path.display().to_string();
        Ok(Patch::parse_in(path.parent().unwrap_or(Path::new("")), &file, &text)?)
    }

    /// Reads a patch from a reader that need not be a file, such as standard input.
    ///
    /// Reports name the patch as `file`. Paths of tables in files are relative to the folder of `file`.
    ///
    /// # Errors
    /// If the reader reports an error, has more than 16 MB, or its text is not a JSON object with the key "patchcord".
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    ///
    /// let patch = Patch::read_from(&b"{\"patchcord\": 1, \"title\": \"short\"}"[..], "<stdin>")?;
    /// assert_eq!((patch.file(), patch.title.as_str()), ("<stdin>", "short"));
    /// let error = Patch::read_from(std::io::repeat(b' '), "<stdin>").unwrap_err();
    /// assert!(error.to_string().contains("the document has more than 16 MB"));
    /// # Ok::<(), patchcord_core::document::DocumentError>(())
    /// ```
    pub fn read_from(reader: impl Read, file: &str) -> Result<Patch, DocumentError> {
        Ok(Patch::parse(file, &read_text_from(reader, file)?)?)
    }

    /// Reads a patch from a text.
    ///
    /// Reports name the patch as `file`. Paths of tables in files are relative to the folder of `file`.
    ///
    /// # Errors
    /// If the text is not a JSON object with the key "patchcord", or is longer than 16 MB.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    ///
    /// let text = r#"{
    ///     "patchcord": 1,
    ///     "title": "decay",
    ///     "elements": {"A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50}}
    /// }"#;
    /// let patch = Patch::parse("decay.json", text)?;
    /// assert_eq!((patch.file(), patch.title.as_str()), ("decay.json", "decay"));
    ///
    /// let report = Patch::parse("list.json", "[]").unwrap_err();
    /// assert_eq!(report.findings[0].message, "the patch must be an object, not a list");
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn parse(file: &str, text: &str) -> Result<Patch, Box<Report>> {
        Patch::parse_in(folder_of(file), file, text)
    }

    /// Reads a patch from a text, with paths of tables relative to `folder`. An empty path is the working directory.
    ///
    /// A byte order mark at the beginning of the text is ignored.
    ///
    /// # Errors
    /// If the text is not a JSON object with the key "patchcord", or is longer than 16 MB.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    ///
    /// let patch = Patch::parse_in("patches", "p.json", "\u{feff}{\"patchcord\": 1}")?;
    /// assert_eq!(patch.text(), "{\"patchcord\": 1}");
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn parse_in(folder: impl AsRef<Path>, file: &str, text: &str) -> Result<Patch, Box<Report>> {
        Patch::parse_with(TableAccess::Anywhere(folder.as_ref().to_owned()), file, text)
    }

    /// Reads a patch from a text that may read only some files as tables. A byte order mark at the beginning of the text
    /// is ignored.
    ///
    /// # Errors
    /// If the text is not a JSON object with the key "patchcord", or is longer than 16 MB. A table that may not be read
    /// is a finding, as other faults inside the object are.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{Patch, TableAccess};
    ///
    /// let patch = Patch::parse_with(TableAccess::None, "p.json", "{\"patchcord\": 1}")?;
    /// assert_eq!(patch.table_access(), &TableAccess::None);
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn parse_with(table_access: TableAccess, file: &str, text: &str) -> Result<Patch, Box<Report>> {
        if text.len() > MAX_DOCUMENT_BYTES {
            return Err(document_too_large(file));
        }
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let fail = |finding| Box::new(Report::new(file, text, vec![finding]));
        let root = tree::parse(text).map_err(fail)?;
        let mut patch = Patch::empty(file, text, table_access);
        decode::document(&root, &mut patch).map_err(fail)?;
        table_file::read_tables(&mut patch);
        Ok(patch)
    }

    /// Makes a patch from a JSON value. The text of the patch is the value, printed with indentation.
    ///
    /// # Errors
    /// If the value is not an object with the key "patchcord", or its text is longer than 16 MB.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    /// use serde_json::json;
    ///
    /// let patch = Patch::from_value("p.json", &json!({"patchcord": 1, "title": "empty"}))?;
    /// assert_eq!(patch.title, "empty");
    /// assert_eq!(patch.text(), "{\n  \"patchcord\": 1,\n  \"title\": \"empty\"\n}\n");
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn from_value(file: &str, value: &Value) -> Result<Patch, Box<Report>> {
        Patch::parse(file, &format!("{value:#}\n"))
    }

    /// Writes the text of the patch to a file.
    ///
    /// The text is written to a temporary file in the same folder, which then replaces `path`. An interruption
    /// therefore leaves either the old or the new text.
    ///
    /// # Errors
    /// If the file cannot be written. An existing file is then unchanged.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::PatchBuilder;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("written").build()?;
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("written.json");
    /// patch.write(&path)?;
    /// assert_eq!(std::fs::read_to_string(&path)?, patch.text());
    /// # Ok(())
    /// # }
    /// ```
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), DocumentError> {
        let path = path.as_ref();
        write_atomic(path, self.text().as_bytes()).map_err(|source| DocumentError::File {
            verb: "write",
            file: path.display().to_string(),
            source,
        })
    }
}

/// Reads a patch from a text. Reports name it `patch.json`, and paths of tables are relative to the working directory.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::Patch;
///
/// let patch: Patch = "{\"patchcord\": 1, \"title\": \"short\"}".parse()?;
/// assert_eq!((patch.file(), patch.title.as_str()), ("patch.json", "short"));
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
impl FromStr for Patch {
    type Err = Box<Report>;

    fn from_str(text: &str) -> Result<Patch, Box<Report>> {
        Patch::parse("patch.json", text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_patch_made_from_a_json_value_keeps_number_texts_and_key_order() {
        let text = r#"{"patchcord": 1, "z": 1.50, "a": 45e6, "m": 0.1000000000000000055}"#;
        let patch = Patch::parse("p.json", text).unwrap();
        assert_eq!(
            patch.value().to_string(),
            r#"{"patchcord":1,"z":1.50,"a":45e6,"m":0.1000000000000000055}"#
        );
        let again = Patch::from_value("p.json", patch.value()).unwrap();
        assert_eq!(again.value(), patch.value());
    }

    #[test]
    fn a_document_above_16_mb_is_rejected_before_it_is_parsed() {
        let text = format!("[{}1]", "1,".repeat(MAX_DOCUMENT_BYTES / 2));
        let report = Patch::parse("p.json", &text).unwrap_err();
        assert!(report.to_string().contains("more than 16 MB"), "{report}");
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), &text).unwrap();
        assert!(matches!(Patch::read(file.path()), Err(DocumentError::Text(_))));
    }
}
