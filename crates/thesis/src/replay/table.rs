//! Tables of numbers that stand behind a figure.

/// A table: what its columns hold, and its rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Why the numbers are what they are, in a few sentences.
    pub reason: &'static str,
    /// What the columns hold, with their units.
    pub head: Vec<String>,
    /// The rows, a text for each column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new<'a>(reason: &'static str, head: impl IntoIterator<Item = &'a str>) -> Table {
        Table { reason, head: head.into_iter().map(str::to_owned).collect(), rows: Vec::new() }
    }

    /// As Markdown has it.
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
    fn markdown_has_a_line_a_row() {
        let mut table = Table::new("", ["a", "b"]);
        table.rows.push(vec!["1".to_owned(), "2".to_owned()]);
        assert_eq!(table.markdown(), "| a | b |\n|---|---|\n| 1 | 2 |\n");
    }
}
