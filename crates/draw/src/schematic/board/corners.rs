//! Rounds the corners of cords.

use crate::schematic::layout::Point;

/// The number of times that the corners of a path are cut.
const CUTS: usize = 3;

/// The maximum length that is cut off a segment at its ends.
const MAX_CUT: f64 = 5.0;

/// Returns a line with rounded corners. Its ends stay where they are.
pub(super) fn rounded(corners: Vec<Point>) -> Vec<Point> {
    (0..CUTS).fold(corners, |corners, _| cut(&corners))
}

/// Returns the line with every corner cut off (Chaikin 1974).
fn cut(points: &[Point]) -> Vec<Point> {
    let mut rounder = vec![points[0]];
    for (index, pair) in points.windows(2).enumerate() {
        let length = (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1);
        let share = (MAX_CUT / length.max(1e-9)).min(0.25);
        let at = |share: f64| {
            (pair[0].0 + share * (pair[1].0 - pair[0].0), pair[0].1 + share * (pair[1].1 - pair[0].1))
        };
        if index > 0 {
            rounder.push(at(share));
        }
        if index + 2 < points.len() {
            rounder.push(at(1.0 - share));
        }
    }
    rounder.push(points[points.len() - 1]);
    rounder
}
