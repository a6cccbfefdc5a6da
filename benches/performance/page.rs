//! Writes the tables of docs/performance.md. Each table is between two markers.

use std::fs;
use std::path::Path;

use crate::Outcome;
use patchcord::output;

/// Replaces the text between `<!-- NAME -->` and `<!-- end of NAME -->` by a table.
///
/// # Errors
///
/// If the page has no such markers, or cannot be read or written.
pub(crate) fn replace(name: &str, table: &str) -> Outcome<()> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/performance.md");
    let text = fs::read_to_string(&path)?;
    let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->"));
    let (before, rest) = text.split_once(&begin).ok_or(format!("docs/performance.md has no {begin}"))?;
    let (_, after) = rest.split_once(&end).ok_or(format!("docs/performance.md has no {end}"))?;
    output::write_atomic(&path, format!("{before}{begin}{table}{end}{after}").as_bytes())?;
    Ok(())
}

/// A table in Markdown.
pub(crate) fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|cell| (*cell).to_owned()).collect();
    let rule = vec!["---".to_owned(); head.len()];
    let rows: String = rows.iter().map(|row| line(row)).collect();
    format!("{}{}{rows}", line(&head), line(&rule))
}
