//! Cords that hang from jack to jack.

use super::Cord;
use crate::plot::{Ink, Stroke};

/// Thickness of a cord and of the gap that sets it off from those behind it.
const CORD: f64 = 2.4;
const GAP: f64 = 4.6;

/// Radius of a plug.
const PLUG: f64 = 4.4;

/// How far a cord sags in its middle: so much, and so much of its length.
const SAG: (f64, f64) = (14.0, 0.13);

/// Pieces that the curve is drawn in.
const PIECES: u32 = 28;

/// Draws a cord with its plugs.
pub(super) fn draw(cord: &Cord, marks: &mut Vec<Stroke>) {
    let [from, to] = cord.ends;
    let sag = SAG.0 + SAG.1 * (to.0 - from.0).hypot(to.1 - from.1);
    let point = |piece: u32| {
        let share = f64::from(piece) / f64::from(PIECES);
        let straight = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
        (straight.0, straight.1 + 4.0 * sag * share * (1.0 - share))
    };
    let points: Vec<_> = (0..=PIECES).map(point).collect();
    let ink = Ink::Cord(cord.colour);
    marks.push(Stroke::Line { points: points.clone(), width: GAP, ink: Ink::Page });
    marks.push(Stroke::Line { points, width: CORD, ink });
    for centre in cord.ends {
        marks.push(Stroke::Disc { centre, radius: PLUG, ink });
    }
}
