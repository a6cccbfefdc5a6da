//! Labels away from their line, with a leader from the line to the label.
//!
//! They are for lines that are so close to others that no label fits next to them. A position is tried for some points
//! of the line, some directions and some distances. It must be on the screen, on no line and on no text, and the leader
//! must cross no text. Of these the position whose leader crosses the fewest lines is used, and then the nearest one.

use super::clip::{Area, Line, clip};

/// A label away from its line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Callout {
    /// The area of the text.
    pub area: Area,
    /// The ends of the leader, from the line to the label.
    pub leader: [(f64, f64); 2],
}

/// The distances of a label from its point.
const DISTANCES: [f64; 5] = [18.0, 32.0, 50.0, 75.0, 110.0];

/// The directions from a point to its label; y points down.
const DIRECTIONS: [(f64, f64); 6] =
    [(0.5, -0.87), (0.87, -0.5), (-0.5, -0.87), (0.5, 0.87), (0.87, 0.5), (-0.5, 0.87)];

/// The minimum distance of a label from lines and other texts.
const CLEARANCE: f64 = 2.0;

/// The number of points of a line that are tried.
const MAX_ANCHORS: usize = 9;

/// The length of a leader that is as undesirable as the crossing of a line.
const CROSSING_LENGTH: f64 = 40.0;

/// Returns the best position of a label of this size for a line through `points`; `None` if there is none.
///
/// `points` are the positions at which the leader may begin, `lines` all lines, `taken` the areas of other texts.
pub(super) fn best(
    points: &[(f64, f64)],
    size: (f64, f64),
    screen: Area,
    lines: &[Line],
    taken: &[Area],
) -> Option<Callout> {
    let stride = points.len().div_ceil(MAX_ANCHORS).max(1);
    let is_visible = |point: &&(f64, f64)| screen.encloses(&Area::around(**point, 0.0));
    let anchors = points.iter().step_by(stride).filter(is_visible);
    let all = anchors.flat_map(|anchor| candidates(*anchor, size));
    let free = all.filter(|callout| is_free(callout, screen, lines, taken));
    let costed = free.map(|callout| (cost(&callout, lines), callout));
    costed.min_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, callout)| callout)
}

/// Returns the possible positions of a label for a point of its line.
fn candidates(anchor: (f64, f64), (width, height): (f64, f64)) -> impl Iterator<Item = Callout> {
    let all = DISTANCES.into_iter().flat_map(|distance| DIRECTIONS.map(|direction| (distance, direction)));
    all.map(move |(distance, (right, down))| {
        let end = (anchor.0 + distance * right, anchor.1 + distance * down);
        let left = if right > 0.0 { end.0 } else { end.0 - width };
        let top = end.1 - height / 2.0;
        Callout { area: Area { left, top, right: left + width, bottom: top + height }, leader: [anchor, end] }
    })
}

/// Whether a label is on the screen, on no line and on no other text, and its leader crosses no text.
fn is_free(callout: &Callout, screen: Area, lines: &[Line], taken: &[Area]) -> bool {
    let wide = callout.area.grown(CLEARANCE);
    screen.encloses(&callout.area)
        && taken.iter().all(|other| !other.overlaps(&wide) && clip(&callout.leader, *other).is_empty())
        && lines.iter().all(|line| clip(line, wide).is_empty())
}

/// Returns the cost of a position: the length of the leader and the lines that it crosses.
///
/// The leader begins on its own line, so a short part at its beginning is ignored.
fn cost(callout: &Callout, lines: &[Line]) -> f64 {
    let [from, to] = callout.leader;
    let length = (to.0 - from.0).hypot(to.1 - from.1);
    let share = (OWN_LENGTH / length).min(1.0);
    let begin = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
    let crosses = |line: &&Line| line.windows(2).any(|pair| cross([begin, to], [pair[0], pair[1]]));
    length + CROSSING_LENGTH * lines.iter().filter(crosses).count() as f64
}

/// The length of the beginning of a leader that may touch its own line.
const OWN_LENGTH: f64 = 3.0;

/// Whether two straight lines cross.
fn cross(one: [(f64, f64); 2], other: [(f64, f64); 2]) -> bool {
    let side = |[from, to]: [(f64, f64); 2], at: (f64, f64)| {
        (to.0 - from.0) * (at.1 - from.1) - (to.1 - from.1) * (at.0 - from.0) > 0.0
    };
    side(one, other[0]) != side(one, other[1]) && side(other, one[0]) != side(other, one[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: Area = Area { left: 0.0, top: 0.0, right: 400.0, bottom: 300.0 };

    #[test]
    fn straight_lines_cross_between_their_ends_only() {
        let diagonal = [(0.0, 0.0), (10.0, 10.0)];
        assert!(cross(diagonal, [(0.0, 10.0), (10.0, 0.0)]));
        assert!(!cross(diagonal, [(0.0, 10.0), (4.0, 6.0)]));
        assert!(!cross(diagonal, [(20.0, 0.0), (20.0, 30.0)]));
    }

    #[test]
    fn labels_of_close_lines_are_free_of_lines_and_of_each_other() {
        let line = |y: f64| -> Line { (0..6).map(|n| (80.0 * f64::from(n), y)).collect() };
        let lines: Vec<Line> = (0..6).map(|n| line(150.0 + 3.0 * f64::from(n))).collect();
        let mut taken: Vec<Area> = Vec::new();
        for line in &lines {
            let callout = best(line, (50.0, 12.0), SCREEN, &lines, &taken).unwrap();
            assert!(taken.iter().all(|other| !other.overlaps(&callout.area)), "{callout:?}");
            assert!(lines.iter().all(|other| clip(other, callout.area).is_empty()), "{callout:?}");
            assert_eq!(callout.leader[0].1, line[0].1);
            taken.push(callout.area);
        }
    }

    #[test]
    fn without_space_there_is_no_position() {
        let line = |y: f64| -> Line { vec![(0.0, y), (400.0, y)] };
        let lines: Vec<Line> = (0..100).map(|n| line(3.0 * f64::from(n))).collect();
        assert_eq!(best(&lines[50], (50.0, 12.0), SCREEN, &lines, &[]), None);
    }
}
