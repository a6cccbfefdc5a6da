//! The drawing of one symbol, built from primitives.

use std::f64::consts::PI;

use super::hull;
use crate::plot::{Align, Area, Ink, Label, Primitive, text_width};

/// The em size of names.
pub(in crate::schematic) const NAME: f64 = 12.5;
/// The em size of settings, signal names and voltages.
pub(in crate::schematic) const PRINT: f64 = 10.5;
/// The em size of texts at jacks.
pub(in crate::schematic) const SMALL: f64 = 9.5;

/// The distance of neighbouring input jacks.
const JACK_PITCH: f64 = 16.0;

/// The thickness of edges.
pub(super) const EDGE: f64 = 1.5;
/// The thickness of fine lines within symbols.
const FINE: f64 = 1.1;
/// The thickness of cords in a schematic.
pub(in crate::schematic) const CORD: f64 = 1.3;

/// The distance from the middle of a text down to its baseline, in ems.
pub(super) const HALF_LETTER: f64 = 0.36;

/// The primitives of a symbol around its anchor, and the positions of its jacks.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::schematic) struct Art {
    /// The primitives from back to front.
    pub primitives: Vec<Primitive>,
    /// The positions of the input jacks.
    pub inputs: Vec<(f64, f64)>,
    /// The positions of the outputs.
    pub outputs: Vec<(f64, f64)>,
    /// An area that is reserved although nothing is drawn there.
    pub reserved: Option<Area>,
}

impl Art {
    /// Adds a filled polygon with an outline.
    pub(crate) fn body(&mut self, corners: &[(f64, f64)]) {
        self.primitives.push(Primitive::Area { corners: corners.to_vec(), ink: Ink::Body });
        let closed = corners.iter().chain(corners.first()).copied().collect();
        self.primitives.push(Primitive::Line { points: closed, width: EDGE, ink: Ink::Line });
    }

    /// Adds a filled rectangle with an outline.
    pub(crate) fn rectangle(&mut self, (left, top): (f64, f64), (right, bottom): (f64, f64)) {
        self.body(&[(left, top), (right, top), (right, bottom), (left, bottom)]);
    }

    /// Adds a filled circle with an outline.
    pub(crate) fn circle(&mut self, centre: (f64, f64), radius: f64) {
        self.primitives.push(Primitive::Disc { centre, radius, ink: Ink::Body });
        self.primitives.push(Primitive::Ring { centre, radius, width: EDGE, ink: Ink::Line });
    }

    /// Adds a filled circle in the colour of lines.
    pub(crate) fn disc(&mut self, centre: (f64, f64), radius: f64) {
        self.primitives.push(Primitive::Disc { centre, radius, ink: Ink::Line });
    }

    /// Adds a fine line.
    pub(crate) fn line(&mut self, points: &[(f64, f64)]) {
        self.primitives.push(Primitive::Line { points: points.to_vec(), width: FINE, ink: Ink::Line });
    }

    /// Adds a thick line, for curves and switch arms.
    pub(crate) fn bold(&mut self, points: &[(f64, f64)]) {
        self.primitives.push(Primitive::Line { points: points.to_vec(), width: 1.8, ink: Ink::Line });
    }

    /// Adds a rule in the secondary colour.
    pub(crate) fn rule(&mut self, points: &[(f64, f64)]) {
        self.primitives.push(Primitive::Line { points: points.to_vec(), width: 1.0, ink: Ink::Soft });
    }

    /// Adds a piece of cord.
    pub(crate) fn cord(&mut self, points: &[(f64, f64)]) {
        self.primitives.push(Primitive::Line { points: points.to_vec(), width: CORD, ink: Ink::Wire });
    }

    /// Adds a filled polygon in the colour of lines.
    pub(crate) fn solid(&mut self, corners: &[(f64, f64)]) {
        self.primitives.push(Primitive::Area { corners: corners.to_vec(), ink: Ink::Line });
    }

    /// Adds a text.
    pub(crate) fn text(&mut self, text: &str, at: (f64, f64), size: f64, align: Align, ink: Ink) {
        self.primitives.push(Primitive::Text(Label::new(text, at, size, align, ink)));
    }

    /// Adds a name at a centre if it is not wider than `max_width`, else above the symbol.
    pub(crate) fn name(&mut self, name: &str, centre: (f64, f64), max_width: f64) {
        if text_width(name, NAME) <= max_width {
            self.text(name, (centre.0, centre.1 + HALF_LETTER * NAME), NAME, Align::Middle, Ink::Line);
        } else {
            self.above(name, NAME, Ink::Line);
        }
    }

    /// Adds a centred line of text above everything drawn so far.
    pub(crate) fn above(&mut self, text: &str, size: f64, ink: Ink) {
        let area = self.area();
        self.text(text, (self.middle(), (area.top - 2.0 - 0.24 * size).floor()), size, Align::Middle, ink);
    }

    /// Adds a centred line of text below everything drawn so far.
    pub(crate) fn below(&mut self, text: &str, size: f64, ink: Ink) {
        let area = self.area();
        self.text(text, (self.middle(), (area.bottom + 2.0 + 0.8 * size).ceil()), size, Align::Middle, ink);
    }

    /// Returns the horizontal middle of all primitives except texts.
    fn middle(&self) -> f64 {
        let drawn = hull(self.primitives.iter().filter(|primitive| primitive.label().is_none()).map(area));
        (drawn.left + drawn.right) / 2.0
    }

    /// Adds a diode at a position; `direction` is the unit vector of its forward current.
    pub(crate) fn diode(&mut self, at: (f64, f64), direction: (f64, f64)) {
        let point_at = |along: f64, across: f64| {
            (
                at.0 + direction.0 * along - direction.1 * across,
                at.1 + direction.1 * along + direction.0 * across,
            )
        };
        self.solid(&[point_at(-4.0, -4.0), point_at(4.0, 0.0), point_at(-4.0, 4.0)]);
        self.bold(&[point_at(4.0, -4.5), point_at(4.0, 4.5)]);
    }

    /// Adds a resistor as a narrow horizontal box.
    pub(crate) fn resistor(&mut self, left: f64, right: f64, y: f64) {
        self.rectangle((left, y - 3.0), (right, y + 3.0));
    }

    /// Adds the head of an arrow; `direction` is a unit vector.
    pub(crate) fn head(&mut self, tip: (f64, f64), direction: (f64, f64)) {
        let point_at = |along: f64, across: f64| {
            (
                tip.0 - direction.0 * along - direction.1 * across,
                tip.1 - direction.1 * along + direction.0 * across,
            )
        };
        self.solid(&[tip, point_at(6.0, -2.6), point_at(6.0, 2.6)]);
    }

    /// Adds a curve `y(x)` for x from -1 to 1 in a square around a centre; y points up.
    pub(crate) fn curve(&mut self, centre: (f64, f64), half: f64, curve: impl Fn(f64) -> f64) {
        let point = |step: u32| {
            let x = f64::from(step) / 20.0 - 1.0;
            (centre.0 + half * x, centre.1 - half * curve(x).clamp(-1.0, 1.0))
        };
        let points: Vec<_> = (0..=40).map(point).collect();
        self.bold(&points);
    }

    /// Returns the texts.
    pub(crate) fn labels(&self) -> impl Iterator<Item = &Label> {
        self.primitives.iter().filter_map(Primitive::label)
    }

    /// Returns the area of all primitives and the reserved area.
    pub(crate) fn area(&self) -> Area {
        hull(self.primitives.iter().map(area).chain(self.reserved))
    }
}

/// Returns the heights of this number of input jacks, centred on 0.
pub(super) fn jack_heights(count: usize) -> impl Iterator<Item = f64> {
    centred_heights(count, JACK_PITCH)
}

/// Returns this number of heights with a distance of `pitch`, centred on 0.
pub(super) fn centred_heights(count: usize, pitch: f64) -> impl Iterator<Item = f64> {
    let first = -pitch * (count.max(1) - 1) as f64 / 2.0;
    (0..count).map(move |index| first + pitch * index as f64)
}

/// Scales points to the range -1 to 1 in x and in y.
pub(super) fn normalised(points: &[[f64; 2]]) -> Vec<(f64, f64)> {
    let ends = |axis: usize| {
        let values = || points.iter().map(move |point| point[axis]);
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
    };
    let share = |value: f64, (low, high): (f64, f64)| {
        if high > low { 2.0 * (value - low) / (high - low) - 1.0 } else { 0.0 }
    };
    let (x, y) = (ends(0), ends(1));
    points.iter().map(|point| (share(point[0], x), share(point[1], y))).collect()
}

/// Returns one period of a sine for x from -1 to 1.
pub(super) fn wave(x: f64) -> f64 {
    (PI * x).sin()
}

/// Returns the area that a primitive covers. The thickness of lines is ignored.
fn area(primitive: &Primitive) -> Area {
    let hull_of =
        |points: &[(f64, f64)], margin: f64| hull(points.iter().map(|at| Area::around(*at, margin)));
    match primitive {
        Primitive::Line { points, .. } => hull_of(points, 0.0),
        Primitive::Area { corners, .. } => hull_of(corners, 0.0),
        Primitive::Ring { centre, radius, .. } | Primitive::Disc { centre, radius, .. } => {
            hull_of(&[*centre], *radius)
        }
        Primitive::Text(label) => label.area(),
    }
}
