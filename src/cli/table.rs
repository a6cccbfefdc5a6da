//! Text tables for the terminal.

/// Rows of cells under headings. Each column is as wide as necessary; columns of numbers are aligned right.
pub(super) struct Table {
    /// The headings, then the rows.
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table with constant headings.
    pub(super) fn new<const N: usize>(headings: [&str; N]) -> Self {
        Table::with(headings.map(str::to_owned))
    }

    /// An empty table with computed headings.
    pub(super) fn with(headings: impl Into<Vec<String>>) -> Self {
        Table { rows: vec![headings.into()] }
    }

    /// The text of a table with these rows.
    pub(super) fn from_rows<const N: usize>(headings: [&str; N], rows: &[[String; N]]) -> String {
        let mut table = Table::new(headings);
        rows.iter().for_each(|row| table.row(row.clone()));
        table.text()
    }

    /// Appends a row with one cell per heading.
    pub(super) fn row(&mut self, cells: impl Into<Vec<String>>) {
        self.rows.push(cells.into());
    }

    /// Removes the column with this index, which is 0 for the first one.
    pub(super) fn drop_column(&mut self, index: usize) {
        self.rows.iter_mut().for_each(|row| drop(row.remove(index)));
    }

    /// The table as text; empty if it has no rows.
    pub(super) fn text(&self) -> String {
        if self.rows.len() < 2 {
            return String::new();
        }
        let columns = self.rows[0].len();
        let widths: Vec<_> = (0..columns).map(|column| self.width(column)).collect();
        let numeric: Vec<_> = (0..columns).map(|column| self.is_numeric(column)).collect();
        self.rows.iter().map(|row| line(row, &widths, &numeric)).collect()
    }

    /// Width of a column in characters.
    fn width(&self, column: usize) -> usize {
        self.rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0)
    }

    /// Whether all cells of a column below the heading are numbers or empty.
    fn is_numeric(&self, column: usize) -> bool {
        self.rows[1..].iter().all(|row| row[column].is_empty() || row[column].parse::<f64>().is_ok())
    }
}

/// A number with this many decimals. A number that is rounded to 0 has no sign.
pub(super) fn decimals(number: f64, count: usize) -> String {
    let text = format!("{number:.count$}");
    match text.strip_prefix('-') {
        Some(size) if size.bytes().all(|digit| matches!(digit, b'0' | b'.')) => size.to_owned(),
        _ => text,
    }
}

/// Pads the cells to the widths. Two spaces separate columns, and spaces at the end are removed.
fn line(row: &[String], widths: &[usize], numeric: &[bool]) -> String {
    let cells = row.iter().zip(widths).zip(numeric).map(|((cell, width), numeric)| {
        // The width of a format is limited to 65535, and names inside macros can be longer.
        let padding = " ".repeat(width - cell.chars().count());
        if *numeric { padding + cell } else { cell.clone() + &padding }
    });
    let line = cells.collect::<Vec<_>>().join("  ");
    format!("{}\n", line.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(["name", "volts"]);
        table.row(["A1".into(), "100".into()]);
        table.row(["long".into(), "-5".into()]);
        assert_eq!(table.text(), "name  volts\nA1      100\nlong     -5\n");
    }

    #[test]
    fn a_number_that_is_rounded_to_0_has_no_sign() {
        let texts = [-0.00004, -0.0, 0.00004, -0.00006, -12.5].map(|number| decimals(number, 4));
        assert_eq!(texts, ["0.0000", "0.0000", "0.0000", "-0.0001", "-12.5000"]);
        assert_eq!(decimals(-0.4, 0), "0");
        assert_eq!(decimals(f64::NEG_INFINITY, 2), "-inf");
    }

    #[test]
    fn a_cell_can_have_more_than_65535_characters() {
        let mut table = Table::new(["name", "volts"]);
        table.row(["a".repeat(70_000), "1".into()]);
        assert!(table.text().ends_with("a      1\n"));
    }
}
