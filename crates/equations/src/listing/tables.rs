//! Tables: their points.

use serde::Serialize;

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
        let shown = self.points.iter().take(MOST_POINTS).map(|[x, y]| format!("({x}, {y})"));
        let rest = self.points.len().saturating_sub(MOST_POINTS);
        let rest = if rest == 0 { String::new() } else { format!(" and {rest} more") };
        let unit = self.unit.as_deref().map_or_else(|| "V, V".to_owned(), |unit| format!("s, {unit}"));
        format!("{} in ({unit}): {}{rest}\n", self.name, shown.collect::<Vec<_>>().join(" "))
    }
}

/// Points of a table that the text shows.
const MOST_POINTS: usize = 12;
