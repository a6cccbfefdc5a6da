//! Rectangles, and clipping of lines to them.

/// The points of one connected line.
pub(super) type Line = Vec<(f64, f64)>;

/// A rectangle with y pointing down, so `top` is at most `bottom`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// The x of the left edge.
    pub left: f64,
    /// The y of the upper edge.
    pub top: f64,
    /// The x of the right edge.
    pub right: f64,
    /// The y of the lower edge.
    pub bottom: f64,
}

impl Area {
    /// Returns the square around a point; each edge is `radius` away from the point.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_draw::plot::Area;
    ///
    /// let area = Area::around((10.0, 20.0), 3.0);
    /// assert_eq!((area.left, area.top, area.width(), area.height()), (7.0, 17.0, 6.0, 6.0));
    /// ```
    pub fn around(centre: (f64, f64), radius: f64) -> Area {
        Area {
            left: centre.0 - radius,
            top: centre.1 - radius,
            right: centre.0 + radius,
            bottom: centre.1 + radius,
        }
    }

    /// Returns the distance from the left to the right edge.
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    /// Returns the distance from the upper to the lower edge.
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// Returns the area with every edge moved outward by `by`.
    pub(super) fn grown(&self, by: f64) -> Area {
        Area { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }

    /// Whether another area is inside this one.
    pub(super) fn encloses(&self, other: &Area) -> bool {
        self.contains((other.left, other.top)) && self.contains((other.right, other.bottom))
    }

    /// Whether another area has a point in common with this one.
    pub(super) fn overlaps(&self, other: &Area) -> bool {
        let overlaps_in_x = self.left <= other.right && other.left <= self.right;
        overlaps_in_x && self.top <= other.bottom && other.top <= self.bottom
    }

    /// Whether a point is inside the area or on its edge.
    fn contains(&self, at: (f64, f64)) -> bool {
        (self.left..=self.right).contains(&at.0) && (self.top..=self.bottom).contains(&at.1)
    }
}

/// Returns the pieces of a line that are inside an area. A single point is one piece.
pub(super) fn clip(points: &[(f64, f64)], area: Area) -> Vec<Line> {
    if let [point] = points {
        let inside = area.contains(*point).then(|| vec![*point]);
        return inside.into_iter().collect();
    }
    let mut pieces: Vec<Line> = Vec::new();
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

/// The two ends of a straight line.
pub(super) type Segment = ((f64, f64), (f64, f64));

/// Returns the part of a straight line that is inside an area; `None` if there is none.
pub(super) fn visible_part(from: (f64, f64), to: (f64, f64), area: Area) -> Option<Segment> {
    let along_x = inside_fractions(from.0, to.0, area.left, area.right)?;
    let along_y = inside_fractions(from.1, to.1, area.top, area.bottom)?;
    let (enter, leave) = (along_x.0.max(along_y.0), along_x.1.min(along_y.1));
    let point_at = |fraction: f64| match fraction {
        0.0 => from,
        1.0 => to,
        _ => (from.0 + fraction * (to.0 - from.0), from.1 + fraction * (to.1 - from.1)),
    };
    (enter <= leave).then(|| (point_at(enter), point_at(leave)))
}

/// Returns the fractions of the way, 0 to 1, between which a coordinate is within two limits.
///
/// `None` if the coordinate is never within the limits.
fn inside_fractions(from: f64, to: f64, low: f64, high: f64) -> Option<(f64, f64)> {
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
    fn inner_lines_are_unchanged() {
        let line = [(0.0, 0.0), (0.5, 1.0), (1.0, 0.3)];
        assert_eq!(clip(&line, UNIT), [line.to_vec()]);
    }

    #[test]
    fn crossing_lines_are_cut_at_the_edges() {
        let line = [(-1.0, 0.5), (2.0, 0.5)];
        assert_eq!(clip(&line, UNIT), [[(0.0, 0.5), (1.0, 0.5)]]);
    }

    #[test]
    fn leaving_the_area_splits_the_line() {
        let line = [(0.25, 0.5), (0.25, 3.0), (0.75, 3.0), (0.75, 0.5)];
        let pieces = clip(&line, UNIT);
        assert_eq!(pieces, [[(0.25, 0.5), (0.25, 1.0)], [(0.75, 1.0), (0.75, 0.5)]]);
    }

    #[test]
    fn outer_lines_and_points_are_dropped() {
        assert!(clip(&[(2.0, 0.0), (0.0, 2.5)], UNIT).is_empty());
        assert!(clip(&[(2.0, 2.0)], UNIT).is_empty());
        assert!(clip(&[], UNIT).is_empty());
        assert_eq!(clip(&[(0.5, 0.5)], UNIT), [[(0.5, 0.5)]]);
    }
}
