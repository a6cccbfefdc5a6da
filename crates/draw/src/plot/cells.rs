//! The square cells of the part of the screen that a trace uses.

use std::ops::Range;

use super::clip::{Area, Line};

/// Number of positions along a trace in the width of a cell.
const POSITIONS_PER_CELL: f64 = 2.0;

/// Number of cells along a row or a column between a cell and the farthest ones that are near it.
const NEAR: usize = 2;
/// Number of the cells near a cell, itself included, unless it is at the border.
pub(super) const NEAR_CELLS: usize = (2 * NEAR + 1) * (2 * NEAR + 1);

/// Square cells as wide as a trace, in the rectangle around it. Their indices rise down each column, column by column.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells {
    /// The upper left corner.
    corner: (f64, f64),
    /// The length of the sides of a cell.
    pub(super) width: f64,
    /// The number of cells from left to right.
    pub(super) columns: usize,
    /// The number of cells from top to bottom.
    pub(super) rows: usize,
}

impl Cells {
    /// Returns the cells of the rectangle around a trace of this thickness; `None` if it has no points.
    pub(super) fn around(lines: &[Line], width: f64) -> Option<Cells> {
        let mut points = lines.iter().flatten();
        let first = *points.next()?;
        let (low, high) = points.fold((first, first), |(low, high), point| {
            ((low.0.min(point.0), low.1.min(point.1)), (high.0.max(point.0), high.1.max(point.1)))
        });
        let cells = |length: f64| (length / width) as usize + 1;
        Some(Cells { corner: low, width, columns: cells(high.0 - low.0), rows: cells(high.1 - low.1) })
    }

    /// Returns the number of cells.
    pub(super) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// Returns the area of all cells.
    pub(super) fn area(&self) -> Area {
        Area {
            left: self.corner.0,
            top: self.corner.1,
            right: self.corner.0 + self.columns as f64 * self.width,
            bottom: self.corner.1 + self.rows as f64 * self.width,
        }
    }

    /// Returns the distances of a position from the upper left corner, in cells.
    pub(super) fn within_area(&self, at: (f64, f64)) -> (f64, f64) {
        ((at.0 - self.corner.0) / self.width, (at.1 - self.corner.1) / self.width)
    }

    /// Returns the index of the cell at a position. A position outside is in the nearest cell.
    pub(super) fn at(&self, position: (f64, f64)) -> usize {
        let (across, down) = self.within_area(position);
        (across as usize).min(self.columns - 1) * self.rows + (down as usize).min(self.rows - 1)
    }

    /// Returns the indices of the cells near a cell, itself included.
    pub(super) fn near(&self, cell: usize) -> impl Iterator<Item = usize> {
        let rows = self.rows;
        let (near_columns, near_rows) = (near(cell / rows, self.columns), near(cell % rows, rows));
        near_columns.flat_map(move |column| near_rows.clone().map(move |row| column * rows + row))
    }
}

/// Returns the rows near a row, or the columns near a column, of which there are `count`.
fn near(index: usize, count: usize) -> Range<usize> {
    index.saturating_sub(NEAR)..(index + NEAR + 1).min(count)
}

/// Returns the positions from one point to another at which the cells of this width are looked up. The last one is `to`.
pub(super) fn positions(from: (f64, f64), to: (f64, f64), width: f64) -> impl Iterator<Item = (f64, f64)> {
    let (across, down) = (to.0 - from.0, to.1 - from.1);
    let count = (across.hypot(down) / width * POSITIONS_PER_CELL).ceil().max(1.0) as u32;
    (1..=count).map(move |index| {
        let share = f64::from(index) / f64::from(count);
        (from.0 + share * across, from.1 + share * down)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_in_cells() {
        let cells = Cells::around(&[vec![(10.0, 5.0), (14.0, 11.0)], vec![(12.0, 4.0)]], 2.0).unwrap();
        assert_eq!((cells.columns, cells.rows, cells.count()), (3, 4, 12));
        let indices = [(10.0, 4.0), (10.0, 6.5), (13.9, 4.0), (14.0, 11.0), (99.0, -9.0)];
        assert_eq!(indices.map(|at| cells.at(at)), [0, 1, 4, 11, 8]);
        assert_eq!(cells.area(), Area { left: 10.0, top: 4.0, right: 16.0, bottom: 12.0 });
        assert!(Cells::around(&[vec![]], 2.0).is_none());
    }

    #[test]
    fn cells_within_two_rows_and_columns_are_near() {
        let cells = Cells::around(&[vec![(0.0, 0.0), (9.5, 6.5)]], 1.0).unwrap();
        assert_eq!(cells.near(0).collect::<Vec<_>>(), [0, 1, 2, 7, 8, 9, 14, 15, 16]);
        assert_eq!(cells.near(cells.at((5.0, 3.0))).count(), NEAR_CELLS);
    }

    #[test]
    fn positions_are_half_a_cell_apart() {
        let found: Vec<_> = positions((0.0, 3.0), (4.0, 3.0), 2.0).collect();
        assert_eq!(found, [(1.0, 3.0), (2.0, 3.0), (3.0, 3.0), (4.0, 3.0)]);
        assert_eq!(positions((1.0, 1.0), (1.0, 1.0), 2.0).collect::<Vec<_>>(), [(1.0, 1.0)]);
    }
}
