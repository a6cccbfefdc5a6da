//! A symbol as it is being drawn.

use std::f64::consts::PI;

use super::hull;
use crate::plot::{Align, Area, Ink, Label, Stroke, text_width};

/// Em sizes of names, of settings and readings, and of what stands at jacks.
pub(in crate::schematic) const NAME: f64 = 12.5;
pub(in crate::schematic) const PRINT: f64 = 10.5;
pub(in crate::schematic) const SMALL: f64 = 9.5;

/// Distance of neighbouring jacks.
pub(super) const JACKS: f64 = 16.0;

/// Thickness of edges, of fine lines within symbols, and of cords.
pub(super) const EDGE: f64 = 1.5;
const FINE: f64 = 1.1;
pub(in crate::schematic) const CORD: f64 = 1.3;

/// How much lower than a middle line the baseline of a text stands that it runs through, in ems.
pub(super) const HALF_LETTER: f64 = 0.36;

/// Lines, areas and texts around an anchor, and where cords arrive and leave.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::schematic) struct Art {
    pub marks: Vec<Stroke>,
    pub inputs: Vec<(f64, f64)>,
    pub outputs: Vec<(f64, f64)>,
    /// Room kept free for what is not drawn.
    pub kept: Option<Area>,
}

impl Art {
    /// A closed outline, filled.
    pub fn body(&mut self, corners: &[(f64, f64)]) {
        self.marks.push(Stroke::Area { corners: corners.to_vec(), ink: Ink::Body });
        let closed = corners.iter().chain(corners.first()).copied().collect();
        self.marks.push(Stroke::Line { points: closed, width: EDGE, ink: Ink::Line });
    }

    pub fn rectangle(&mut self, (left, top): (f64, f64), (right, bottom): (f64, f64)) {
        self.body(&[(left, top), (right, top), (right, bottom), (left, bottom)]);
    }

    /// A circle, filled.
    pub fn circle(&mut self, centre: (f64, f64), radius: f64) {
        self.marks.push(Stroke::Disc { centre, radius, ink: Ink::Body });
        self.marks.push(Stroke::Ring { centre, radius, width: EDGE, ink: Ink::Line });
    }

    pub fn disc(&mut self, centre: (f64, f64), radius: f64) {
        self.marks.push(Stroke::Disc { centre, radius, ink: Ink::Line });
    }

    pub fn line(&mut self, points: &[(f64, f64)]) {
        self.marks.push(Stroke::Line { points: points.to_vec(), width: FINE, ink: Ink::Line });
    }

    /// A heavier line, for curves and arms of switches.
    pub fn bold(&mut self, points: &[(f64, f64)]) {
        self.marks.push(Stroke::Line { points: points.to_vec(), width: 1.8, ink: Ink::Line });
    }

    /// Rules within a symbol.
    pub fn rule(&mut self, points: &[(f64, f64)]) {
        self.marks.push(Stroke::Line { points: points.to_vec(), width: 1.0, ink: Ink::Soft });
    }

    /// A piece of cord.
    pub fn cord(&mut self, points: &[(f64, f64)]) {
        self.marks.push(Stroke::Line { points: points.to_vec(), width: CORD, ink: Ink::Wire });
    }

    /// A filled area in the colour of lines.
    pub fn solid(&mut self, corners: &[(f64, f64)]) {
        self.marks.push(Stroke::Area { corners: corners.to_vec(), ink: Ink::Line });
    }

    pub fn text(&mut self, text: &str, at: (f64, f64), size: f64, align: Align, ink: Ink) {
        self.marks.push(Stroke::Text(Label { text: text.to_owned(), at, size, align, ink }));
    }

    /// A name in the middle of a place if there is room for it, else above the symbol.
    pub fn name(&mut self, name: &str, centre: (f64, f64), room: f64) {
        if text_width(name, NAME) <= room {
            self.text(name, (centre.0, centre.1 + HALF_LETTER * NAME), NAME, Align::Middle, Ink::Line);
        } else {
            self.above(name, NAME, Ink::Line);
        }
    }

    /// A line of text above everything drawn so far, about the middle of the symbol.
    pub fn above(&mut self, text: &str, size: f64, ink: Ink) {
        let area = self.area();
        self.text(text, (self.middle(), (area.top - 2.0 - 0.24 * size).floor()), size, Align::Middle, ink);
    }

    /// A line of text below everything drawn so far.
    pub fn below(&mut self, text: &str, size: f64, ink: Ink) {
        let area = self.area();
        self.text(text, (self.middle(), (area.bottom + 2.0 + 0.8 * size).ceil()), size, Align::Middle, ink);
    }

    /// The middle of what is no text.
    fn middle(&self) -> f64 {
        let drawn = hull(self.marks.iter().filter(|mark| !matches!(mark, Stroke::Text(_))).map(area));
        (drawn.left + drawn.right) / 2.0
    }

    /// A diode at a place, that conducts in a direction (a vector of length 1).
    pub fn diode(&mut self, at: (f64, f64), way: (f64, f64)) {
        let place = |along: f64, across: f64| {
            (at.0 + way.0 * along - way.1 * across, at.1 + way.1 * along + way.0 * across)
        };
        self.solid(&[place(-4.0, -4.0), place(4.0, 0.0), place(-4.0, 4.0)]);
        self.bold(&[place(4.0, -4.5), place(4.0, 4.5)]);
    }

    /// A resistor as a narrow box between two places of one height.
    pub fn resistor(&mut self, left: f64, right: f64, y: f64) {
        self.rectangle((left, y - 3.0), (right, y + 3.0));
    }

    /// The head of an arrow.
    pub fn head(&mut self, tip: (f64, f64), way: (f64, f64)) {
        let place = |along: f64, across: f64| {
            (tip.0 - way.0 * along - way.1 * across, tip.1 - way.1 * along + way.0 * across)
        };
        self.solid(&[tip, place(6.0, -2.6), place(6.0, 2.6)]);
    }

    /// A curve `y(x)` over -1 ... 1 in a square of that half width around a place; up is positive.
    pub fn curve(&mut self, centre: (f64, f64), half: f64, curve: impl Fn(f64) -> f64) {
        let point = |step: u32| {
            let x = f64::from(step) / 20.0 - 1.0;
            (centre.0 + half * x, centre.1 - half * curve(x).clamp(-1.0, 1.0))
        };
        let points: Vec<_> = (0..=40).map(point).collect();
        self.bold(&points);
    }

    /// The texts.
    pub fn labels(&self) -> impl Iterator<Item = &Label> {
        self.marks.iter().filter_map(|mark| match mark {
            Stroke::Text(label) => Some(label),
            _ => None,
        })
    }

    /// The room of everything drawn.
    pub fn area(&self) -> Area {
        hull(self.marks.iter().map(area).chain(self.kept))
    }
}

/// Heights of so many jacks about a middle.
pub(super) fn jack_heights(count: usize) -> impl Iterator<Item = f64> {
    let first = -JACKS * (count.max(1) - 1) as f64 / 2.0;
    (0..count).map(move |jack| first + JACKS * jack as f64)
}

/// Points brought into the square from -1 to 1.
pub(super) fn fitted(points: &[[f64; 2]]) -> Vec<(f64, f64)> {
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

/// A wave over -1 ... 1.
pub(super) fn wave(x: f64) -> f64 {
    (PI * x).sin()
}

fn area(mark: &Stroke) -> Area {
    let hull_of = |points: &[(f64, f64)], more: f64| {
        hull(points.iter().map(|at| Area {
            left: at.0 - more,
            top: at.1 - more,
            right: at.0 + more,
            bottom: at.1 + more,
        }))
    };
    match mark {
        Stroke::Line { points, .. } => hull_of(points, 0.0),
        Stroke::Area { corners, .. } => hull_of(corners, 0.0),
        Stroke::Ring { centre, radius, .. } | Stroke::Disc { centre, radius, .. } => {
            hull_of(&[*centre], *radius)
        }
        Stroke::Text(label) => label.area(),
    }
}
