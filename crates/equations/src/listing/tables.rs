//! Tables: their points.

use serde::Serialize;

use crate::notation::function_latex;

/// A table of points: straight lines between them, constant outside.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableDescription {
    /// Its name in the equations.
    pub name: String,
    /// The unit of the ordinates of a table of time, whose abscissas are seconds. `None` if both are volts.
    pub unit: Option<String>,
    /// The points, [abscissa, ordinate].
    pub points: Vec<[f64; 2]>,
}

impl TableDescription {
    /// The table as plain text.
    pub(super) fn text(&self) -> String {
        self.with_name(&self.name)
    }

    /// The table in LaTeX.
    pub(super) fn latex(&self) -> String {
        format!("\\noindent {}", self.with_name(&format!("${}$", function_latex(&self.name))))
    }

    /// The table under a name: its units and its first points.
    fn with_name(&self, name: &str) -> String {
        let shown = self.points.iter().take(MOST_POINTS).map(|[x, y]| format!("({x}, {y})"));
        let rest = self.points.len().saturating_sub(MOST_POINTS);
        let rest = if rest == 0 { String::new() } else { format!(" and {rest} more") };
        let unit = self.unit.as_deref().map_or_else(|| "V, V".to_owned(), |unit| format!("s, {unit}"));
        format!("{name} in ({unit}): {}{rest}\n", shown.collect::<Vec<_>>().join(" "))
    }
}

/// Points of a table that the text shows.
const MOST_POINTS: usize = 12;
