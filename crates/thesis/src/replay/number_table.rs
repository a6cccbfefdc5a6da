//! Tables of numbers behind a figure, which the gallery and the page of differences print.

/// A table of numbers, all as formatted texts.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::replay::NumberTable;
///
/// let mut table = NumberTable::new("two numbers", ["a", "b"]);
/// table.rows.push(vec!["1".to_owned(), "2".to_owned()]);
/// assert_eq!(table.markdown(), "| a | b |\n|---|---|\n| 1 | 2 |\n");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NumberTable {
    /// An explanation of the numbers, in a few sentences.
    pub reason: &'static str,
    /// The column headings, with units.
    pub head: Vec<String>,
    /// The rows. Each row has one text per column.
    pub rows: Vec<Vec<String>>,
}

impl NumberTable {
    /// Makes a table with column headings and no rows.
    pub fn new<'a>(reason: &'static str, head: impl IntoIterator<Item = &'a str>) -> NumberTable {
        NumberTable { reason, head: head.into_iter().map(str::to_owned).collect(), rows: Vec::new() }
    }

    /// Formats headings and rows as a Markdown table, without the reason.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let rule = format!("|{}\n", "---|".repeat(self.head.len()));
        line(&self.head) + &rule + &self.rows.iter().map(|row| line(row)).collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markdown_has_one_line_per_row() {
        let mut table = NumberTable::new("", ["a", "b"]);
        table.rows.push(vec!["1".to_owned(), "2".to_owned()]);
        assert_eq!(table.markdown(), "| a | b |\n|---|---|\n| 1 | 2 |\n");
    }
}
