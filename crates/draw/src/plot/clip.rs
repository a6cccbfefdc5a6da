/// A rectangle of the picture; `top` is above `bottom` and has the lower number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Its left edge.
    pub left: f64,
    /// Its upper edge.
    pub top: f64,
    /// Its right edge.
    pub right: f64,
    /// Its lower edge.
    pub bottom: f64,
}

impl Area {
    /// From left to right.
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    /// From top to bottom.
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// The area with so much more on every side.
    pub(super) fn grown(&self, by: f64) -> Area {
        Area { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }

    /// Whether another area lies inside this one.
    pub(super) fn holds(&self, other: &Area) -> bool {
        self.contains((other.left, other.top)) && self.contains((other.right, other.bottom))
    }

    /// Whether another area has anything in common with this one.
    pub(super) fn meets(&self, other: &Area) -> bool {
        let across = self.left <= other.right && other.left <= self.right;
        across && self.top <= other.bottom && other.top <= self.bottom
    }

    fn contains(&self, at: (f64, f64)) -> bool {
        (self.left..=self.right).contains(&at.0) && (self.top..=self.bottom).contains(&at.1)
    }
}

/// The pieces of a line that lie in an area. A lone point is a piece of its own.
pub(super) fn clipped(points: &[(f64, f64)], area: Area) -> Vec<Vec<(f64, f64)>> {
    if let [point] = points {
        let inside = area.contains(*point).then(|| vec![*point]);
        return inside.into_iter().collect();
    }
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    for ends in points.windows(2) {
        if let Some((from, to)) = visible_part(ends[0], ends[1], area) {
            match pieces.last_mut().filter(|piece| piece.last() == Some(&from)) {
                Some(piece) => piece.push(to),
                None => pieces.push(vec![from, to]),
            }
        }
    }
    pieces
}

type Segment = ((f64, f64), (f64, f64));

/// The part of a straight line that lies in an area.
fn visible_part(from: (f64, f64), to: (f64, f64), area: Area) -> Option<Segment> {
    let along_x = inside_part(from.0, to.0, area.left, area.right)?;
    let along_y = inside_part(from.1, to.1, area.top, area.bottom)?;
    let (enter, leave) = (along_x.0.max(along_y.0), along_x.1.min(along_y.1));
    let between = |part: f64| match part {
        0.0 => from,
        1.0 => to,
        _ => (from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1)),
    };
    (enter <= leave).then(|| (between(enter), between(leave)))
}

/// Between which parts of the way, 0 to 1, a coordinate is between two limits.
fn inside_part(from: f64, to: f64, low: f64, high: f64) -> Option<(f64, f64)> {
    if from == to {
        return (low..=high).contains(&from).then_some((0.0, 1.0));
    }
    let (one, other) = ((low - from) / (to - from), (high - from) / (to - from));
    let (enter, leave) = (one.min(other).max(0.0), one.max(other).min(1.0));
    (enter <= leave).then_some((enter, leave))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Area = Area { left: 0.0, top: 0.0, right: 1.0, bottom: 1.0 };

    #[test]
    fn inner_lines_stay_whole() {
        let line = [(0.0, 0.0), (0.5, 1.0), (1.0, 0.3)];
        assert_eq!(clipped(&line, UNIT), [line.to_vec()]);
    }

    #[test]
    fn crossing_lines_are_cut_at_the_edges() {
        let line = [(-1.0, 0.5), (2.0, 0.5)];
        assert_eq!(clipped(&line, UNIT), [[(0.0, 0.5), (1.0, 0.5)]]);
    }

    #[test]
    fn an_excursion_splits_the_line() {
        let line = [(0.25, 0.5), (0.25, 3.0), (0.75, 3.0), (0.75, 0.5)];
        let pieces = clipped(&line, UNIT);
        assert_eq!(pieces, [[(0.25, 0.5), (0.25, 1.0)], [(0.75, 1.0), (0.75, 0.5)]]);
    }

    #[test]
    fn outer_lines_and_points_vanish() {
        assert!(clipped(&[(2.0, 0.0), (0.0, 2.5)], UNIT).is_empty());
        assert!(clipped(&[(2.0, 2.0)], UNIT).is_empty());
        assert!(clipped(&[], UNIT).is_empty());
        assert_eq!(clipped(&[(0.5, 0.5)], UNIT), [[(0.5, 0.5)]]);
    }
}
