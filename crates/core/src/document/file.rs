//! The text of a document's file.

use std::fs;
use std::io::Read as _;
use std::path::Path;

use super::code::Code;
use super::diagnostic::{Diagnostic, Report, Span};
use crate::output::refusal;

/// Why a document could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    /// The file system refused.
    #[error("cannot {verb} {file}: {}", refusal(source))]
    File {
        /// What was tried.
        verb: &'static str,
        /// The file.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The text is not a JSON object.
    #[error(transparent)]
    Text(#[from] Box<Report>),
}

/// Bytes of the largest document that is read: the tree of a text takes a hundred times its room.
pub(crate) const LARGEST: usize = 16_000_000;

/// The text of a document's file.
pub fn text_of(path: &Path) -> Result<String, DocumentError> {
    let file = path.display().to_string();
    let bytes =
        read(path).map_err(|source| DocumentError::File { verb: "read", file: file.clone(), source })?;
    if bytes.len() > LARGEST {
        return Err(too_large(&file).into());
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let readable = String::from_utf8_lossy(error.as_bytes()).into_owned();
        let finding = Diagnostic::at(Code::Syntax, Span { start: at, end: at }, "the file is not UTF-8 text")
            .hint("save it with the encoding UTF-8");
        Box::new(Report::new(&file, &readable, vec![finding]))
    })?;
    Ok(text)
}

/// The bytes of a file; of one that is too large, no more than shows it.
fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    fs::File::open(path)?.take(LARGEST as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

pub(crate) fn too_large(file: &str) -> Box<Report> {
    let message = format!("the document has more than {} MB", LARGEST / 1_000_000);
    let finding = Diagnostic::at(Code::Syntax, Span::default(), message)
        .hint("no document needs that much: is it the right file?");
    Box::new(Report::new(file, "", vec![finding]))
}
