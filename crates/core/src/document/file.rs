//! Reads the text of a document from its file or from standard input, with a limit on the size.

use std::io::{self, ErrorKind, Read};
use std::path::Path;

use super::code::Code;
use super::diagnostic::{Diagnostic, Span};
use super::input_file::{InputFile, LimitedReader};
use super::printable::escape_controls;
use super::report::Report;
use crate::output::io_reason;

/// The reason why a document could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// The file system reported an error.
    #[error("cannot {verb} {}: {}", escape_controls(file), io_reason(source))]
    File {
        /// The operation that failed, as a verb: "read" or "write".
        verb: &'static str,
        /// Path of the file, as the user wrote it.
        file: String,
        /// The error of the system.
        source: io::Error,
    },
    /// The text is not a valid document.
    #[error(transparent)]
    Text(#[from] Box<Report>),
}

/// Size of the largest document that is read, in bytes. The tree of a text takes about a hundred times the memory of
/// the text.
pub(crate) const MAX_DOCUMENT_BYTES: usize = 16_000_000;

/// Reads the text of a document.
///
/// # Errors
/// If the file cannot be read, is not a regular file, has more than 16 MB, or is not UTF-8 text.
///
/// # Examples
///
/// ```
/// use patchcord_core::document::read_text;
///
/// let error = read_text("no-such-patch.json").unwrap_err();
/// assert!(error.to_string().starts_with("cannot read no-such-patch.json"));
/// ```
pub fn read_text(path: impl AsRef<Path>) -> Result<String, DocumentError> {
    let path = path.as_ref();
    let opened = InputFile::open(path, MAX_DOCUMENT_BYTES as u64);
    text_of(opened.and_then(all_bytes), &path.display().to_string())
}

/// Reads the text of a document from a reader that need not be a file, such as standard input. Reports name it `file`.
///
/// # Errors
/// If the reader reports an error, or has more than 16 MB or no UTF-8 text.
pub fn read_text_from(reader: impl Read, file: &str) -> Result<String, DocumentError> {
    text_of(all_bytes(LimitedReader::new(reader, MAX_DOCUMENT_BYTES as u64)), file)
}

/// All bytes of a reader.
fn all_bytes(mut reader: impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text of the bytes that were read from `file`.
///
/// # Errors
/// If the bytes could not be read, are too many, or are not UTF-8 text.
fn text_of(bytes: io::Result<Vec<u8>>, file: &str) -> Result<String, DocumentError> {
    let bytes = bytes.map_err(|source| match source.kind() {
        ErrorKind::FileTooLarge => DocumentError::Text(document_too_large(file)),
        _ => DocumentError::File { verb: "read", file: file.to_owned(), source },
    })?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let readable = String::from_utf8_lossy(error.as_bytes()).into_owned();
        let span = Span { start: valid, end: valid };
        let finding = Diagnostic::at(Code::SYNTAX, span, "the file is not UTF-8 text")
            .hint("save it with the encoding UTF-8");
        Box::new(Report::new(file, &readable, vec![finding]))
    })?;
    Ok(text)
}

/// The report on a document above [`MAX_DOCUMENT_BYTES`].
pub(crate) fn document_too_large(file: &str) -> Box<Report> {
    let message = format!("the document has more than {} MB", MAX_DOCUMENT_BYTES / 1_000_000);
    let finding = Diagnostic::at(Code::SYNTAX, Span::default(), message)
        .hint("no document needs that much: is it the right file?");
    Box::new(Report::new(file, "", vec![finding]))
}
