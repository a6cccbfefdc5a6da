//! Sketches: what the study draws without axes, and what needs axes in more than one direction.

use super::{Drawn, Sheet};
use patchcord_draw::plot::{Align, Drawing, Ink, Label, Stroke, text_width};

/// A place in pixels from the upper left corner.
pub(super) type Place = (f64, f64);

/// As wide as a picture.
pub(super) const WIDTH: f64 = 900.0;

/// Left edge of what stands by itself.
const MARGIN: f64 = 16.0;

/// Em sizes of the heading, and of what is written beside lines.
const HEADING: f64 = 18.0;
const TEXT: f64 = 14.0;

/// Thicknesses of curves and edges, and of lines that only measure or lead.
const BOLD: f64 = 1.8;
const FINE: f64 = 1.0;

/// Lengths of dashes and of the gaps between them.
const DASH: f64 = 6.0;
const GAP: f64 = 4.0;

/// How much lower than a middle line the baseline of a text stands that it runs through, in ems.
const HALF_LETTER: f64 = 0.36;

/// A sketch that is being drawn.
pub(super) struct Sketch {
    drawing: Drawing,
}

impl Sketch {
    /// An empty one of a height, under a heading.
    pub fn new(heading: &str, height: f64) -> Sketch {
        let mut sketch = Sketch { drawing: Drawing { width: WIDTH, height, marks: Vec::new() } };
        sketch.write(heading, (MARGIN, 34.0), HEADING, Align::Start, Ink::Line);
        sketch
    }

    /// A curve or an edge.
    pub fn line(&mut self, points: &[Place], ink: Ink) {
        self.push(points, BOLD, ink);
    }

    /// A line that measures or leads.
    pub fn fine(&mut self, points: &[Place]) {
        self.push(points, FINE, Ink::Soft);
    }

    fn push(&mut self, points: &[Place], width: f64, ink: Ink) {
        self.drawing.marks.push(Stroke::Line { points: points.to_vec(), width, ink });
    }

    /// A line in dashes.
    pub fn dashed(&mut self, from: Place, to: Place) {
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let at = |way: f64| {
            let part = (way / length).min(1.0);
            (from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1))
        };
        let mut way = 0.0;
        while way < length {
            self.fine(&[at(way), at(way + DASH)]);
            way += DASH + GAP;
        }
    }

    /// An area without an edge.
    pub fn area(&mut self, corners: &[Place], ink: Ink) {
        self.drawing.marks.push(Stroke::Area { corners: corners.to_vec(), ink });
    }

    /// An area in the colour of bodies, with an edge.
    pub fn body(&mut self, corners: &[Place]) {
        self.area(corners, Ink::Body);
        let closed: Vec<_> = corners.iter().chain(corners.first()).copied().collect();
        self.line(&closed, Ink::Line);
    }

    /// A box about a middle, with its name.
    pub fn block(&mut self, middle: Place, (width, height): (f64, f64), name: &str) {
        let (x, y) = (width / 2.0, height / 2.0);
        let corner = |right: f64, down: f64| (middle.0 + right * x, middle.1 + down * y);
        self.body(&[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
        self.middle(name, middle);
    }

    /// A place where signals add up.
    pub fn sum(&mut self, centre: Place) {
        let radius = 13.0;
        self.drawing.marks.push(Stroke::Disc { centre, radius, ink: Ink::Body });
        self.drawing.marks.push(Stroke::Ring { centre, radius, width: BOLD, ink: Ink::Line });
        self.middle("Σ", centre);
    }

    /// A dot.
    pub fn dot(&mut self, centre: Place, ink: Ink) {
        self.drawing.marks.push(Stroke::Disc { centre, radius: 7.0, ink });
    }

    /// An arrow along points, its head at the last.
    pub fn arrow(&mut self, points: &[Place], ink: Ink) {
        self.push(points, BOLD, ink);
        if let [.., from, tip] = points {
            self.head(*from, *tip, ink);
        }
    }

    fn head(&mut self, from: Place, tip: Place, ink: Ink) {
        let length = (tip.0 - from.0).hypot(tip.1 - from.1);
        let way = ((tip.0 - from.0) / length, (tip.1 - from.1) / length);
        let side = |across: f64| (tip.0 - 9.0 * way.0 - across * way.1, tip.1 - 9.0 * way.1 + across * way.0);
        self.area(&[tip, side(-3.6), side(3.6)], ink);
    }

    /// A length between two places, with its name beside the middle: above a level line, to the right of others.
    pub fn span(&mut self, from: Place, to: Place, name: &str) {
        self.fine(&[from, to]);
        self.head(from, to, Ink::Soft);
        self.head(to, from, Ink::Soft);
        let middle = ((from.0 + to.0) / 2.0, (from.1 + to.1) / 2.0);
        let is_level = (to.1 - from.1).abs() < (to.0 - from.0).abs();
        match is_level {
            true => self.centred(name, (middle.0, middle.1 - 7.0)),
            false => self.text(name, (middle.0 + 8.0, middle.1 + HALF_LETTER * TEXT)),
        }
    }

    /// A spring between two places of one height or one above the other, with its name beside it.
    pub fn spring(&mut self, from: Place, to: Place, name: &str) {
        const TURNS: usize = 12;
        let turn = |index: usize| match index {
            0 | 1 => 0.0,
            index if index >= TURNS - 1 => 0.0,
            index if index % 2 == 0 => 9.0,
            _ => -9.0,
        };
        let points: Vec<_> =
            (0..=TURNS).map(|index| beside(from, to, index as f64 / TURNS as f64, turn(index))).collect();
        self.line(&points, Ink::Line);
        self.named(from, to, name);
    }

    /// A damper between two places, with its name beside it.
    pub fn damper(&mut self, from: Place, to: Place, name: &str) {
        let at = |along: f64, across: f64| beside(from, to, along, across);
        self.line(&[at(0.0, 0.0), at(0.35, 0.0)], Ink::Line);
        self.line(&[at(0.65, -11.0), at(0.35, -11.0), at(0.35, 11.0), at(0.65, 11.0)], Ink::Line);
        self.line(&[at(0.52, -8.0), at(0.52, 8.0)], Ink::Line);
        self.line(&[at(0.52, 0.0), at(1.0, 0.0)], Ink::Line);
        self.named(from, to, name);
    }

    fn named(&mut self, from: Place, to: Place, name: &str) {
        match (to.1 - from.1).abs() < (to.0 - from.0).abs() {
            true => self.centred(name, ((from.0 + to.0) / 2.0, from.1 - 18.0)),
            false => self.text(name, (from.0 + 18.0, (from.1 + to.1) / 2.0 + HALF_LETTER * TEXT)),
        }
    }

    /// Firm ground along a line, hatched to the right of its way.
    pub fn ground(&mut self, from: Place, to: Place) {
        self.line(&[from, to], Ink::Line);
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let count = (length / 12.0) as usize;
        for index in 0..count {
            let along = (index as f64 + 0.9) / count as f64;
            let back = (index as f64 + 0.2) / count as f64;
            self.fine(&[beside(from, to, along, 0.0), beside(from, to, back, 10.0)]);
        }
    }

    /// A text that begins at a place.
    pub fn text(&mut self, text: &str, at: Place) {
        self.write(text, at, TEXT, Align::Start, Ink::Line);
    }

    /// A text that ends at a place.
    pub fn text_before(&mut self, text: &str, at: Place) {
        self.write(text, at, TEXT, Align::End, Ink::Line);
    }

    /// A text with a place below its middle.
    pub fn centred(&mut self, text: &str, at: Place) {
        self.write(text, at, TEXT, Align::Middle, Ink::Line);
    }

    /// A text about a place.
    pub fn middle(&mut self, text: &str, at: Place) {
        self.centred(text, (at.0, at.1 + HALF_LETTER * TEXT));
    }

    /// A text in a colour, that begins at a place.
    pub fn coloured(&mut self, text: &str, at: Place, ink: Ink) {
        self.write(text, at, TEXT, Align::Start, ink);
    }

    fn write(&mut self, text: &str, at: Place, size: f64, align: Align, ink: Ink) {
        self.drawing.marks.push(Stroke::Text(Label { text: text.to_owned(), at, size, align, ink }));
    }

    /// Columns of text from a place down, each row over a rule but the first, which goes with the second.
    pub fn table(&mut self, (left, top): Place, rows: &[Vec<String>]) {
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

    /// What was drawn, with the settings behind it and what is read off it.
    pub fn drawn(self, settings: impl Into<String>, reading: impl Into<String>) -> Drawn {
        Drawn {
            sheet: Sheet::Drawing(Box::new(self.drawing)),
            settings: settings.into(),
            reading: reading.into(),
            patches: Vec::new(),
            commands: Vec::new(),
            table: None,
        }
    }
}

/// A place so far along the way from one place to another (0 ... 1), and so many pixels to its right.
fn beside(from: Place, to: Place, along: f64, across: f64) -> Place {
    let (x, y) = (to.0 - from.0, to.1 - from.1);
    let length = x.hypot(y);
    (from.0 + along * x - across * y / length, from.1 + along * y + across * x / length)
}

/// Coordinates of its own within a sketch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// Where 0, 0 lies.
    pub origin: Place,
    /// Pixels for a unit to the right, and for a unit up.
    pub scale: (f64, f64),
}

impl Grid {
    /// Where a point lies.
    pub fn at(&self, x: f64, y: f64) -> Place {
        (self.origin.0 + x * self.scale.0, self.origin.1 - y * self.scale.1)
    }

    /// Where points lie.
    pub fn all(&self, points: impl IntoIterator<Item = (f64, f64)>) -> Vec<Place> {
        points.into_iter().map(|(x, y)| self.at(x, y)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_beside_a_way_is_to_its_right() {
        // Down is positive: to the right of the way to the right is below it.
        assert_eq!(beside((0.0, 0.0), (10.0, 0.0), 0.5, 3.0), (5.0, 3.0));
        assert_eq!(beside((0.0, 0.0), (0.0, 10.0), 1.0, 3.0), (-3.0, 10.0));
    }

    #[test]
    fn a_grid_counts_upward() {
        let grid = Grid { origin: (100.0, 200.0), scale: (10.0, 5.0) };
        assert_eq!(grid.at(2.0, 4.0), (120.0, 180.0));
    }
}
