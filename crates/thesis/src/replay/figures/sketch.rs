//! Sketches: figures without axes, and figures that need axes in more than one direction.
//!
//! A [`Sketch`] collects strokes and texts in pixels. It offers the symbols of the thesis: blocks, sums, arrows,
//! springs, dampers, ground and dimension lines.

use super::{DrawnFigure, Sheet};
use patchcord_draw::plot::{Align, Drawing, Ink, Label, Primitive, text_width};

/// A point in pixels from the upper left corner: right, down.
pub(super) type PixelPoint = (f64, f64);

/// The width of a sketch in pixels, the same as that of a picture.
pub(super) const WIDTH: f64 = 900.0;

/// The left edge of texts and tables, in pixels.
const MARGIN: f64 = 16.0;

/// Text size of the heading, in pixels per em.
const HEADING: f64 = 18.0;
/// Text size of all other texts, in pixels per em.
const TEXT: f64 = 14.0;

/// Line width of curves and edges, in pixels.
const BOLD: f64 = 1.8;
/// Line width of dimension lines and guides, in pixels.
const FINE: f64 = 1.0;

/// Length of a dash, in pixels.
const DASH: f64 = 6.0;
/// Length of the gap between two dashes, in pixels.
const GAP: f64 = 4.0;

/// Distance from the middle of a line of text down to its baseline, in ems.
const HALF_LETTER: f64 = 0.36;

/// A sketch under construction.
pub(super) struct Sketch {
    /// The strokes, areas and texts so far. Later ones cover earlier ones.
    drawing: Drawing,
}

impl Sketch {
    /// Makes an empty sketch with a heading. `height` is in pixels.
    pub(super) fn new(heading: &str, height: f64) -> Sketch {
        let mut sketch = Sketch { drawing: Drawing { width: WIDTH, height, primitives: Vec::new() } };
        sketch.write(heading, (MARGIN, 34.0), HEADING, Align::Start, Ink::Line);
        sketch
    }

    /// Draws a curve or an edge.
    pub(super) fn line(&mut self, points: &[PixelPoint], ink: Ink) {
        self.push(points, BOLD, ink);
    }

    /// Draws a dimension line or a guide.
    pub(super) fn fine(&mut self, points: &[PixelPoint]) {
        self.push(points, FINE, Ink::Soft);
    }

    /// Adds a polyline with a width in pixels.
    fn push(&mut self, points: &[PixelPoint], width: f64, ink: Ink) {
        self.drawing.primitives.push(Primitive::Line { points: points.to_vec(), width, ink });
    }

    /// Draws a dashed line.
    pub(super) fn dashed(&mut self, from: PixelPoint, to: PixelPoint) {
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let at = |distance: f64| {
            let part = (distance / length).min(1.0);
            (from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1))
        };
        let mut distance = 0.0;
        while distance < length {
            self.fine(&[at(distance), at(distance + DASH)]);
            distance += DASH + GAP;
        }
    }

    /// Fills an area without an edge.
    pub(super) fn area(&mut self, corners: &[PixelPoint], ink: Ink) {
        self.drawing.primitives.push(Primitive::Area { corners: corners.to_vec(), ink });
    }

    /// Fills an area in the colour of solid bodies and draws its edge.
    pub(super) fn body(&mut self, corners: &[PixelPoint]) {
        self.area(corners, Ink::Body);
        let closed: Vec<_> = corners.iter().chain(corners.first()).copied().collect();
        self.line(&closed, Ink::Line);
    }

    /// Draws a box around its centre, with its name inside.
    pub(super) fn block(&mut self, middle: PixelPoint, (width, height): (f64, f64), name: &str) {
        let (x, y) = (width / 2.0, height / 2.0);
        let corner = |right: f64, down: f64| (middle.0 + right * x, middle.1 + down * y);
        self.body(&[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
        self.centred_on(name, middle);
    }

    /// Draws a summing point.
    pub(super) fn sum(&mut self, centre: PixelPoint) {
        let radius = 13.0;
        self.drawing.primitives.push(Primitive::Disc { centre, radius, ink: Ink::Body });
        self.drawing.primitives.push(Primitive::Ring { centre, radius, width: BOLD, ink: Ink::Line });
        self.centred_on("Σ", centre);
    }

    /// Draws a dot.
    pub(super) fn dot(&mut self, centre: PixelPoint, ink: Ink) {
        self.drawing.primitives.push(Primitive::Disc { centre, radius: 7.0, ink });
    }

    /// Draws an arrow along points, with its head at the last one.
    pub(super) fn arrow(&mut self, points: &[PixelPoint], ink: Ink) {
        self.push(points, BOLD, ink);
        if let [.., from, tip] = points {
            self.arrow_head(*from, *tip, ink);
        }
    }

    /// Draws the head of an arrow.
    fn arrow_head(&mut self, from: PixelPoint, tip: PixelPoint, ink: Ink) {
        let length = (tip.0 - from.0).hypot(tip.1 - from.1);
        let direction = ((tip.0 - from.0) / length, (tip.1 - from.1) / length);
        let side = |across: f64| {
            (
                tip.0 - 9.0 * direction.0 - across * direction.1,
                tip.1 - 9.0 * direction.1 + across * direction.0,
            )
        };
        self.area(&[tip, side(-3.6), side(3.6)], ink);
    }

    /// Draws a dimension line between two points. Its name is above a level line, and to the right of any other.
    pub(super) fn span(&mut self, from: PixelPoint, to: PixelPoint, name: &str) {
        self.fine(&[from, to]);
        self.arrow_head(from, to, Ink::Soft);
        self.arrow_head(to, from, Ink::Soft);
        let middle = ((from.0 + to.0) / 2.0, (from.1 + to.1) / 2.0);
        let is_level = (to.1 - from.1).abs() < (to.0 - from.0).abs();
        match is_level {
            true => self.centred(name, (middle.0, middle.1 - 7.0)),
            false => self.text(name, (middle.0 + 8.0, middle.1 + HALF_LETTER * TEXT)),
        }
    }

    /// Draws a spring between two points, level or upright, with its name next to it.
    pub(super) fn spring(&mut self, from: PixelPoint, to: PixelPoint, name: &str) {
        /// Number of segments of the zigzag.
        const TURNS: usize = 12;
        let turn = |index: usize| match index {
            0 | 1 => 0.0,
            index if index >= TURNS - 1 => 0.0,
            index if index % 2 == 0 => 9.0,
            _ => -9.0,
        };
        let points: Vec<_> = (0..=TURNS)
            .map(|index| offset_point(from, to, index as f64 / TURNS as f64, turn(index)))
            .collect();
        self.line(&points, Ink::Line);
        self.name_symbol(from, to, name);
    }

    /// Draws a damper between two points, level or upright, with its name next to it.
    pub(super) fn damper(&mut self, from: PixelPoint, to: PixelPoint, name: &str) {
        let at = |along: f64, across: f64| offset_point(from, to, along, across);
        self.line(&[at(0.0, 0.0), at(0.35, 0.0)], Ink::Line);
        self.line(&[at(0.65, -11.0), at(0.35, -11.0), at(0.35, 11.0), at(0.65, 11.0)], Ink::Line);
        self.line(&[at(0.52, -8.0), at(0.52, 8.0)], Ink::Line);
        self.line(&[at(0.52, 0.0), at(1.0, 0.0)], Ink::Line);
        self.name_symbol(from, to, name);
    }

    /// Writes a name next to the middle of a symbol: above a level one, to the right of an upright one.
    fn name_symbol(&mut self, from: PixelPoint, to: PixelPoint, name: &str) {
        match (to.1 - from.1).abs() < (to.0 - from.0).abs() {
            true => self.centred(name, ((from.0 + to.0) / 2.0, from.1 - 18.0)),
            false => self.text(name, (from.0 + 18.0, (from.1 + to.1) / 2.0 + HALF_LETTER * TEXT)),
        }
    }

    /// Draws fixed ground along a line. It is hatched on the right side, seen from `from` to `to`.
    pub(super) fn ground(&mut self, from: PixelPoint, to: PixelPoint) {
        self.line(&[from, to], Ink::Line);
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let count = (length / 12.0) as usize;
        for index in 0..count {
            let along = (index as f64 + 0.9) / count as f64;
            let back = (index as f64 + 0.2) / count as f64;
            self.fine(&[offset_point(from, to, along, 0.0), offset_point(from, to, back, 10.0)]);
        }
    }

    /// Writes a text that begins at a point.
    pub(super) fn text(&mut self, text: &str, at: PixelPoint) {
        self.write(text, at, TEXT, Align::Start, Ink::Line);
    }

    /// Writes a text that ends at a point.
    pub(super) fn text_before(&mut self, text: &str, at: PixelPoint) {
        self.write(text, at, TEXT, Align::End, Ink::Line);
    }

    /// Writes a text that is centred horizontally on a point. The point is on its baseline.
    pub(super) fn centred(&mut self, text: &str, at: PixelPoint) {
        self.write(text, at, TEXT, Align::Middle, Ink::Line);
    }

    /// Writes a text that is centred on a point in both directions.
    pub(super) fn centred_on(&mut self, text: &str, at: PixelPoint) {
        self.centred(text, (at.0, at.1 + HALF_LETTER * TEXT));
    }

    /// Writes a text in a colour. It begins at a point.
    pub(super) fn coloured(&mut self, text: &str, at: PixelPoint, ink: Ink) {
        self.write(text, at, TEXT, Align::Start, ink);
    }

    /// Adds a text. `size` is in pixels per em, and `at` is on its baseline.
    fn write(&mut self, text: &str, at: PixelPoint, size: f64, align: Align, ink: Ink) {
        self.drawing.primitives.push(Primitive::Text(Label::new(text, at, size, align, ink)));
    }

    /// Writes a table. `(left, top)` is the start of the baseline of its first row, and rows are 34 pixels apart.
    /// There is a rule below each row except the first; the first two rows together are the heading.
    pub(super) fn table(&mut self, (left, top): PixelPoint, rows: &[Vec<String>]) {
        let columns = rows.first().map_or(0, Vec::len);
        let widest = |column: usize| {
            let cells = rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| text_width(cell, TEXT)).fold(0.0, f64::max) + 30.0
        };
        let edges: Vec<f64> = (0..=columns).map(|count| left + (0..count).map(widest).sum::<f64>()).collect();
        for (index, row) in rows.iter().enumerate() {
            let y = top + 34.0 * index as f64;
            row.iter().zip(&edges).for_each(|(cell, x)| self.text(cell, (*x, y)));
            if index > 0 {
                self.fine(&[(left, y + 12.0), (edges[columns] - 30.0, y + 12.0)]);
            }
        }
    }

    /// Returns the finished figure, with its settings and its reading.
    pub(super) fn finish(self, settings: impl Into<String>, reading: impl Into<String>) -> DrawnFigure {
        DrawnFigure {
            sheet: Sheet::Drawing(Box::new(self.drawing)),
            settings: settings.into(),
            reading: reading.into(),
            patches: Vec::new(),
            commands: Vec::new(),
            table: None,
        }
    }
}

/// Returns the point at a share `along` (0 ... 1) of the line from one point to another, moved by `across` pixels to
/// its right.
fn offset_point(from: PixelPoint, to: PixelPoint, along: f64, across: f64) -> PixelPoint {
    let (x, y) = (to.0 - from.0, to.1 - from.1);
    let length = x.hypot(y);
    (from.0 + along * x - across * y / length, from.1 + along * y + across * x / length)
}

/// A coordinate system within a sketch. Its vertical axis points up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// The pixel of the origin.
    pub origin: PixelPoint,
    /// Pixels per unit to the right, and per unit up.
    pub scale: (f64, f64),
}

impl Grid {
    /// Returns the pixel of a point.
    pub(super) fn at(&self, x: f64, y: f64) -> PixelPoint {
        (self.origin.0 + x * self.scale.0, self.origin.1 - y * self.scale.1)
    }

    /// Returns the pixels of several points.
    pub(super) fn all(&self, points: impl IntoIterator<Item = (f64, f64)>) -> Vec<PixelPoint> {
        points.into_iter().map(|(x, y)| self.at(x, y)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_point_is_to_the_right_of_its_line() {
        // The vertical axis points down, so right of a line to the right is below it.
        assert_eq!(offset_point((0.0, 0.0), (10.0, 0.0), 0.5, 3.0), (5.0, 3.0));
        assert_eq!(offset_point((0.0, 0.0), (0.0, 10.0), 1.0, 3.0), (-3.0, 10.0));
    }

    #[test]
    fn a_grid_counts_upward() {
        let grid = Grid { origin: (100.0, 200.0), scale: (10.0, 5.0) };
        assert_eq!(grid.at(2.0, 4.0), (120.0, 180.0));
    }
}
