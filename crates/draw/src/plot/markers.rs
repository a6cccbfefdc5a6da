//! The dashed vertical lines at events, and their labels.
//!
//! The labels are in two rows at the upper edge of the screen. A label that a trace would cross there is in one of two
//! rows at the lower edge, if it is free of traces there.

use super::clip::{Area, Line, clip};
use super::surface::{Align, Surface, TextStyle};
use super::{Picture, PlotError, font, palette};

/// The em size of the labels.
const TEXT_SIZE: f64 = 11.5;

/// The distance from a line to its label.
const LABEL_OFFSET: f64 = 4.0;
/// The distance from the upper edge of a row to the baseline of its labels.
const BASELINE: f64 = 14.0;
/// The minimum gap between labels in a row.
const LABEL_GAP: f64 = 6.0;

/// The length of a dash.
const DASH: f64 = 5.0;
/// The gap between dashes.
const DASH_GAP: f64 = 4.0;

/// Half the thickness of a line.
const HALF_WIDTH: f64 = 0.5;

/// The number of rows of labels at each edge. A label is in the first row in which it fits.
const ROWS: usize = 2;
/// The height of a row of labels.
const ROW_HEIGHT: f64 = 14.0;
/// The distance from the lower edge of the screen to the lowest baseline.
const LOWER_MARGIN: f64 = 5.0;

/// The minimum distance of lines; of closer lines only the first is drawn.
const MIN_LINE_GAP: f64 = 2.0;

/// Draws the dashed lines and the labels that fit, and returns the areas of these labels. `lines` are the visible lines
/// of all traces.
pub(super) fn draw(
    picture: &Picture,
    lines: &[Line],
    screen: Area,
    surface: &mut dyn Surface,
) -> Result<Vec<Area>, PlotError> {
    let fractions = picture.markers.iter().map(|marker| picture.horizontal.fraction(marker.at));
    let mut markers: Vec<_> =
        fractions.zip(&picture.markers).filter(|(fraction, _)| (0.0..=1.0).contains(fraction)).collect();
    markers.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut labels: Vec<Area> = Vec::new();
    let mut rows = Rows { screen, free_from: [screen.left; 2 * ROWS] };
    let mut next_line_from = screen.left;
    for (fraction, marker) in markers {
        let x = (screen.left + fraction * screen.width()).floor() + HALF_WIDTH;
        if x >= next_line_from {
            draw_dashes(x, screen, surface)?;
            next_line_from = x + MIN_LINE_GAP;
        }
        let label = font::truncated(&marker.label, TEXT_SIZE, screen.width());
        let (from, to) = label_extent(x, font::width(&label, TEXT_SIZE), screen);
        if let Some(area) = rows.place(from, to, lines) {
            let style = TextStyle { size: TEXT_SIZE, colour: palette::NOTE, align: Align::Start };
            surface.text(&label, (area.left, area.bottom), style)?;
            labels.push(area);
        }
    }
    Ok(labels)
}

/// The rows of labels: those at the upper edge from above, then those at the lower edge from below.
struct Rows {
    /// The screen.
    screen: Area,
    /// The position in each row from which on it is free.
    free_from: [f64; 2 * ROWS],
}

impl Rows {
    /// Places a label between two positions, and returns its area. `None` if it fits in no row at the upper edge.
    ///
    /// If traces cross the label in every row, it is in the first row in which it fits.
    fn place(&mut self, from: f64, to: f64, lines: &[Line]) -> Option<Area> {
        let fits = |row: &usize| from >= self.free_from[*row];
        let first = (0..ROWS).find(fits)?;
        let is_clear = |row: &usize| {
            let area = self.area(*row, from, to);
            lines.iter().all(|line| clip(line, area).is_empty())
        };
        let row = (0..2 * ROWS).filter(fits).find(is_clear).unwrap_or(first);
        self.free_from[row] = to + LABEL_GAP;
        Some(self.area(row, from, to))
    }

    /// Returns the area of a label in a row. Its lower edge is the baseline.
    fn area(&self, row: usize, left: f64, right: f64) -> Area {
        let top = match row.checked_sub(ROWS) {
            None => self.screen.top + ROW_HEIGHT * row as f64,
            Some(above) => self.screen.bottom - LOWER_MARGIN - BASELINE - ROW_HEIGHT * above as f64,
        };
        Area { left, top, right, bottom: top + BASELINE }
    }
}

/// Returns the left and right end of a label of this width: right of its line, or left of it near the right edge.
fn label_extent(x: f64, width: f64, screen: Area) -> (f64, f64) {
    let right = x + LABEL_OFFSET;
    let from = if right + width <= screen.right { right } else { x - LABEL_OFFSET - width };
    (from, from + width)
}

/// Draws a dashed vertical line at `x` from the upper to the lower edge of the screen.
fn draw_dashes(x: f64, screen: Area, surface: &mut dyn Surface) -> Result<(), PlotError> {
    let mut top = screen.top;
    while top < screen.bottom {
        let bottom = (top + DASH).min(screen.bottom);
        surface.rectangle((x - HALF_WIDTH, top), (x + HALF_WIDTH, bottom), palette::MARKER)?;
        top = bottom + DASH_GAP;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: Area = Area { left: 0.0, top: 0.0, right: 400.0, bottom: 300.0 };

    /// The upper edges of labels between these positions, with these traces.
    fn tops(labels: &[(f64, f64)], lines: &[Line]) -> Vec<Option<f64>> {
        let mut rows = Rows { screen: SCREEN, free_from: [SCREEN.left; 2 * ROWS] };
        labels.iter().map(|(from, to)| rows.place(*from, *to, lines).map(|area| area.top)).collect()
    }

    #[test]
    fn a_label_is_in_the_first_row_that_no_trace_crosses() {
        let lowest = SCREEN.bottom - LOWER_MARGIN - BASELINE;
        let along = |y: f64| -> Line { vec![(0.0, y), (400.0, y)] };
        let falling = vec![(10.0, 0.0), (30.0, 60.0), (300.0, 290.0)];
        let label = [(5.0, 120.0)];
        assert_eq!(tops(&label, &[]), [Some(0.0)]);
        assert_eq!(tops(&label, &[along(5.0)]), [Some(ROW_HEIGHT)]);
        assert_eq!(tops(&label, std::slice::from_ref(&falling)), [Some(lowest)]);
        assert_eq!(tops(&label, &[falling.clone(), along(290.0)]), [Some(lowest - ROW_HEIGHT)]);
        assert_eq!(tops(&label, &[falling, along(290.0), along(270.0)]), [Some(0.0)]);
    }

    #[test]
    fn a_label_without_space_at_the_upper_edge_is_omitted() {
        let close = [(5.0, 120.0), (10.0, 130.0), (15.0, 140.0)];
        assert_eq!(tops(&close, &[]), [Some(0.0), Some(ROW_HEIGHT), None]);
    }
}
