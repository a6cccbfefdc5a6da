//! What cords and links look like.

use super::Cord;
use super::face::JACK;
use crate::plot::{Ink, Stroke};
use crate::schematic::layout::Point;

/// Thickness of a cord and of the gap that sets it off from those behind it.
const CORD: f64 = 2.4;
const GAP: f64 = 4.6;

/// Thickness of a link, radius of its plugs, and lengths of its dashes and of the gaps between them.
const LINK: f64 = 1.3;
const PIN: f64 = 2.4;
const DASH: (f64, f64) = (9.0, 4.0);

/// Draws a cord.
pub(super) fn draw(cord: &Cord, marks: &mut Vec<Stroke>) {
    marks.push(Stroke::Line { points: cord.points.clone(), width: GAP, ink: Ink::Page });
    marks.push(Stroke::Line { points: cord.points.clone(), width: CORD, ink: Ink::Cord(cord.colour) });
}

/// Draws the plugs of a cord, in front of the jacks.
pub(super) fn draw_plugs(cord: &Cord, marks: &mut Vec<Stroke>) {
    let ink = Ink::Cord(cord.colour);
    marks.extend(cord.ends.map(|centre| Stroke::Disc { centre, radius: JACK, ink }));
}

/// Draws a link: thin and dashed.
pub(super) fn draw_link(points: &[Point], marks: &mut Vec<Stroke>) {
    let mut dash = vec![points[0]];
    let (mut left, mut is_drawn) = (DASH.0, true);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        loop {
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            if length <= left {
                left -= length;
                dash.push(to);
                break;
            }
            let share = left / length;
            from = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
            dash.push(from);
            end_dash(&mut dash, is_drawn, marks);
            is_drawn = !is_drawn;
            left = if is_drawn { DASH.0 } else { DASH.1 };
        }
    }
    end_dash(&mut dash, is_drawn, marks);
}

/// Draws a dash, or leaves a gap, and begins the next where it ends.
fn end_dash(dash: &mut Vec<Point>, is_drawn: bool, marks: &mut Vec<Stroke>) {
    let next = dash[dash.len() - 1];
    let points = std::mem::replace(dash, vec![next]);
    if is_drawn && points.len() > 1 {
        marks.push(Stroke::Line { points, width: LINK, ink: Ink::Line });
    }
}

/// Draws the plugs of a link, in front of those of cords.
pub(super) fn draw_pins(ends: [Point; 2], marks: &mut Vec<Stroke>) {
    marks.extend(ends.map(|centre| Stroke::Disc { centre, radius: PIN, ink: Ink::Line }));
}
