//! Patches read from files and texts, and written to files.

use std::path::Path;

use serde_json::Value;

use super::document::Patch;
use super::{decode, table_file};
use crate::document::file::{DocumentError, LARGEST, text_of, too_large};
use crate::document::{Report, tree};
use crate::output::write_whole;

impl Patch {
    /// Reads a patch from a file.
    ///
    /// # Errors
    /// When the file cannot be read, is larger than 16 MB or no JSON object. What is wrong inside the object is found by
    /// [`Circuit::new`](crate::circuit::Circuit::new), all of it at once.
    pub fn read(path: &Path) -> Result<Patch, DocumentError> {
        let text = text_of(path)?;
        let file = path.display().to_string();
        Ok(Patch::parse_in(path.parent().unwrap_or(Path::new("")), &file, &text)?)
    }

    /// Reads a patch from a text; `file` is the name that reports give it, and tables in files are looked for from
    /// its folder.
    ///
    /// # Errors
    /// When the text is not a JSON object, or is longer than 16 MB.
    pub fn parse(file: &str, text: &str) -> Result<Patch, Box<Report>> {
        Patch::parse_in(Path::new(file).parent().unwrap_or(Path::new("")), file, text)
    }

    /// The same, with tables in files looked for from another folder; an empty one is the working directory.
    ///
    /// # Errors
    /// Those of [`Patch::parse`].
    pub fn parse_in(folder: &Path, file: &str, text: &str) -> Result<Patch, Box<Report>> {
        if text.len() > LARGEST {
            return Err(too_large(file));
        }
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let fail = |finding| Box::new(Report::new(file, text, vec![finding]));
        let root = tree::parse(text).map_err(fail)?;
        let mut patch = Patch::empty(file, text);
        decode::document(&root, &mut patch).map_err(fail)?;
        table_file::read_all(&mut patch, folder);
        Ok(patch)
    }

    /// Makes a patch from a JSON value; its text is the value printed.
    ///
    /// # Errors
    /// When the value is not an object.
    pub fn from_value(file: &str, value: &Value) -> Result<Patch, Box<Report>> {
        Patch::parse(file, &format!("{value:#}\n"))
    }

    /// Writes the text to a file: beside it first, then renamed.
    ///
    /// # Errors
    /// When the file system refuses; the file is then as it was.
    pub fn write(&self, path: &Path) -> Result<(), DocumentError> {
        write_whole(path, self.text().as_bytes()).map_err(|source| DocumentError::File {
            verb: "write",
            file: path.display().to_string(),
            source,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn numbers_and_key_order_survive_the_value() {
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
    fn a_document_beyond_reason_is_refused_unread() {
        let text = format!("[{}1]", "1,".repeat(LARGEST / 2));
        let report = Patch::parse("p.json", &text).unwrap_err();
        assert!(report.to_string().contains("more than 16 MB"), "{report}");
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), &text).unwrap();
        assert!(matches!(Patch::read(file.path()), Err(DocumentError::Text(_))));
    }
}
