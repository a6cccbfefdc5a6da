//! Chords: straight lines at constant speed that replace the points of a curve between their ends.
//!
//! The curve of one voltage against another one comes as points in order of time. A chord is extended from point to
//! point as long as it passes all of them within a tolerance, so a long curve needs few points.

/// A point of a curve of one voltage against another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Its time in seconds. Two points with the same time are the two sides of a jump.
    pub time: f64,
    /// Its coordinates in volts: to the right, and upwards.
    pub volts: [f64; 2],
    /// Whether a curve begins with it.
    pub begins: bool,
}

/// A straight line, at constant speed, that replaces the points between its ends.
///
/// # Examples
///
/// ```
/// use patchcord_core::chords::{Chord, CurvePoint};
///
/// let point = |time: f64, y: f64| CurvePoint { time, volts: [time, y], begins: time == 0.0 };
/// let mut chord = Chord::new(point(0.0, 0.0));
/// assert_eq!(chord.extend(point(1.0, 0.01), [0.02; 2]), [None; 2]);
/// assert_eq!(chord.extend(point(2.0, 0.0), [0.02; 2]), [None; 2]);
/// // The line to (3, 5) is too far from the points before, so the chord ends at (2, 0).
/// assert_eq!(chord.extend(point(3.0, 5.0), [0.02; 2]), [Some(point(2.0, 0.0)), None]);
/// assert_eq!(chord.open_end(), Some(point(3.0, 5.0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    /// Its beginning.
    anchor: CurvePoint,
    /// Its end so far. It is the anchor if there is no other point.
    end: CurvePoint,
    /// Least and largest speed in volts per second, for each coordinate, at which the line passes all points within
    /// the tolerance.
    speeds: [[f64; 2]; 2],
}

impl Chord {
    /// A chord that consists of its beginning.
    pub fn new(anchor: CurvePoint) -> Self {
        Chord { anchor, end: anchor, speeds: [[f64::NEG_INFINITY, f64::INFINITY]; 2] }
    }

    /// The end, unless it is the beginning.
    pub fn open_end(&self) -> Option<CurvePoint> {
        (self.end != self.anchor).then_some(self.end)
    }

    /// Extends the chord to the next point. If that is not possible, it begins a chord at the present end. The answer
    /// are the points with which chords ended. `tolerances` are those of the coordinates, in volts.
    pub fn extend(&mut self, point: CurvePoint, tolerances: [f64; 2]) -> [Option<CurvePoint>; 2] {
        let mut ended = None;
        if point.begins || !self.reaches(&point, tolerances) {
            ended = self.open_end();
            *self = Chord::new(self.end);
            if point.begins || !self.reaches(&point, tolerances) {
                *self = Chord::new(point);
                return [ended, Some(point)];
            }
        }
        self.end = point;
        let seconds = point.time - self.anchor.time;
        if seconds > 0.0 {
            for (axis, [least, largest]) in self.speeds.iter_mut().enumerate() {
                let distance = point.volts[axis] - self.anchor.volts[axis];
                *least = least.max((distance - tolerances[axis]) / seconds);
                *largest = largest.min((distance + tolerances[axis]) / seconds);
            }
        }
        [ended, None]
    }

    /// Whether the line to a point passes all points so far within the tolerances.
    fn reaches(&self, point: &CurvePoint, tolerances: [f64; 2]) -> bool {
        let seconds = point.time - self.anchor.time;
        self.speeds.iter().enumerate().all(|(axis, [least, largest])| {
            let distance = point.volts[axis] - self.anchor.volts[axis];
            if seconds > 0.0 {
                (*least..=*largest).contains(&(distance / seconds))
            } else {
                distance.abs() <= tolerances[axis]
            }
        })
    }
}

/// Removes points that chords do not need. Those that remain have these tolerances of the coordinates, in volts.
pub fn thin(points: &mut Vec<CurvePoint>, tolerances: [f64; 2]) {
    let Some(first) = points.first() else { return };
    let mut chord = Chord::new(*first);
    let mut kept = 1;
    for index in 1..points.len() {
        // At most one point is kept for each one that was read, so no point is overwritten before it is read.
        for ended in chord.extend(points[index], tolerances).into_iter().flatten() {
            points[kept] = ended;
            kept += 1;
        }
    }
    points.truncate(kept);
    points.extend(chord.open_end());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(volts: &[(f64, f64)]) -> Vec<CurvePoint> {
        let point = |(index, (time, y)): (usize, &(f64, f64))| CurvePoint {
            time: *time,
            volts: [*time, *y],
            begins: index == 0,
        };
        volts.iter().enumerate().map(point).collect()
    }

    #[test]
    fn points_on_a_line_are_removed_and_corners_and_jumps_stay() {
        let mut all = points(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 0.0), (3.0, 50.0), (4.0, 50.0)]);
        let kept: Vec<_> = [0, 2, 3, 4, 5].map(|index| all[index]).to_vec();
        thin(&mut all, [0.02; 2]);
        assert_eq!(all, kept);
    }

    #[test]
    fn each_coordinate_has_its_tolerance() {
        let bent = [(0.0, 0.0), (1.0, 0.5), (2.0, 0.0)];
        for (tolerance, kept) in [(0.6, 2), (0.4, 3)] {
            let mut all = points(&bent);
            thin(&mut all, [0.02, tolerance]);
            assert_eq!(all.len(), kept, "{tolerance}");
        }
    }

    #[test]
    fn a_curve_without_points_stays_empty() {
        let mut none = Vec::new();
        thin(&mut none, [1.0; 2]);
        assert!(none.is_empty());
    }
}
