//! Draws cords and links.

use super::Cord;
use super::face::JACK_RADIUS;
use crate::plot::{Ink, Primitive};
use crate::schematic::layout::Point;

/// The thickness of a cord.
const CORD_WIDTH: f64 = 2.4;
/// The thickness of the background line that separates a cord from those behind it.
const OUTLINE_WIDTH: f64 = 4.6;

/// The thickness of a link.
const LINK_WIDTH: f64 = 1.3;
/// The radius of the plugs of a link.
const PIN_RADIUS: f64 = 2.4;
/// The lengths of the dashes of a link and of the gaps between them.
const DASH: (f64, f64) = (9.0, 4.0);

/// Draws a cord.
pub(super) fn draw(cord: &Cord, primitives: &mut Vec<Primitive>) {
    primitives.push(Primitive::Line { points: cord.points.clone(), width: OUTLINE_WIDTH, ink: Ink::Page });
    primitives.push(Primitive::Line {
        points: cord.points.clone(),
        width: CORD_WIDTH,
        ink: Ink::Cord(cord.colour),
    });
}

/// Draws the plugs of a cord. They are in front of the jacks.
pub(super) fn draw_plugs(cord: &Cord, primitives: &mut Vec<Primitive>) {
    let ink = Ink::Cord(cord.colour);
    primitives.extend(cord.ends.map(|centre| Primitive::Disc { centre, radius: JACK_RADIUS, ink }));
}

/// Draws a link as a thin dashed line.
pub(super) fn draw_link(points: &[Point], primitives: &mut Vec<Primitive>) {
    let mut dash = vec![points[0]];
    let (mut remaining, mut is_drawn) = (DASH.0, true);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        loop {
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            if length <= remaining {
                remaining -= length;
                dash.push(to);
                break;
            }
            let share = remaining / length;
            from = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
            dash.push(from);
            end_dash(&mut dash, is_drawn, primitives);
            is_drawn = !is_drawn;
            remaining = if is_drawn { DASH.0 } else { DASH.1 };
        }
    }
    end_dash(&mut dash, is_drawn, primitives);
}

/// Draws the current dash, or skips it if it is a gap, and starts the next at its end.
fn end_dash(dash: &mut Vec<Point>, is_drawn: bool, primitives: &mut Vec<Primitive>) {
    let next = dash[dash.len() - 1];
    let points = std::mem::replace(dash, vec![next]);
    if is_drawn && points.len() > 1 {
        primitives.push(Primitive::Line { points, width: LINK_WIDTH, ink: Ink::Line });
    }
}

/// Draws the plugs of a link. They are in front of the plugs of cords.
pub(super) fn draw_pins(ends: [Point; 2], primitives: &mut Vec<Primitive>) {
    primitives.extend(ends.map(|centre| Primitive::Disc { centre, radius: PIN_RADIUS, ink: Ink::Line }));
}
