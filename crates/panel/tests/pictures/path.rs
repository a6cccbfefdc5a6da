//! SVG paths with few characters: along lines, or along parabolas close to them.

use std::fmt::Write as _;

/// A position in half pixels.
pub(super) type Point = (f64, f64);

/// Units of a path in half a pixel. A path has whole units only.
pub(super) const UNITS: f64 = 2.0;

/// The largest distance of two points that parabolas are fitted to, in half pixels.
const SPACING: f64 = 1.0;
/// A parabola whose control point is at most this part of the tolerance from the line between its ends is drawn as
/// that line.
const STRAIGHT: f64 = 0.5;

/// The data of a path that is being written. All positions after the first one are relative to the one before.
struct Pen {
    /// The data so far.
    data: String,
    /// Where the path ends, in units.
    at: (i64, i64),
    /// The last command.
    command: char,
}

impl Pen {
    /// A path that begins at a position.
    fn new(begin: Point) -> Pen {
        let mut pen = Pen { data: String::new(), at: (0, 0), command: ' ' };
        pen.at = pen.to(begin);
        pen.write('M', &[pen.at.0, pen.at.1]);
        pen
    }

    /// The units from the end of the path to a position.
    fn to(&self, point: Point) -> (i64, i64) {
        let whole = |value: f64| (UNITS * value + 0.5).floor() as i64;
        (whole(point.0) - self.at.0, whole(point.1) - self.at.1)
    }

    /// Appends a command. A minus sign separates two numbers, and after a command no separator is needed.
    fn write(&mut self, command: char, numbers: &[i64]) {
        let is_new = command != self.command;
        if is_new {
            self.data.push(command);
        }
        for (index, number) in numbers.iter().enumerate() {
            if *number >= 0 && (index > 0 || !is_new) {
                self.data.push(' ');
            }
            write!(self.data, "{number}").unwrap();
        }
        self.command = command;
    }

    /// Appends a line.
    fn line(&mut self, end: Point) {
        let (x, y) = self.to(end);
        match (x, y) {
            (0, 0) => return,
            (0, _) => self.write('v', &[y]),
            (_, 0) => self.write('h', &[x]),
            _ => self.write('l', &[x, y]),
        }
        self.at = (self.at.0 + x, self.at.1 + y);
    }

    /// Appends a parabola with this control point.
    fn parabola(&mut self, control: Point, end: Point) {
        let ((x1, y1), (x, y)) = (self.to(control), self.to(end));
        self.write('q', &[x1, y1, x, y]);
        self.at = (self.at.0 + x, self.at.1 + y);
    }
}

/// The data of a path along a line.
pub(super) fn polygon(line: &[Point]) -> String {
    let mut pen = Pen::new(line[0]);
    line.iter().for_each(|point| pen.line(*point));
    pen.data
}

/// The data of a path of parabolas with at most this distance from a line, as few as possible. It is round where the
/// line is a polygon along a round curve.
pub(super) fn curve(line: &[Point], tolerance: f64) -> String {
    let points = with_spacing(line);
    let lengths = lengths(&points);
    let (mut pen, mut begin) = (Pen::new(points[0]), 0);
    while begin + 1 < points.len() {
        let fitted = |end: usize| fitted(&points[begin..=end], &lengths[begin..=end]);
        let end = farthest(begin + 1, points.len() - 1, |end| fitted(end).1 <= tolerance);
        let (control, _) = fitted(end);
        if distance_from_line(control, points[begin], points[end]) <= STRAIGHT * tolerance {
            pen.line(points[end]);
        } else {
            pen.parabola(control, points[end]);
        }
        begin = end;
    }
    pen.data
}

/// The points of a line, and points between them where they are far from each other.
fn with_spacing(line: &[Point]) -> Vec<Point> {
    let mut points = vec![line[0]];
    for ends in line.windows(2) {
        let (x, y) = (ends[1].0 - ends[0].0, ends[1].1 - ends[0].1);
        let count = (x.hypot(y) / SPACING).ceil().max(1.0) as u32;
        let share = |index: u32| f64::from(index) / f64::from(count);
        points.extend((1..=count).map(|index| (ends[0].0 + share(index) * x, ends[0].1 + share(index) * y)));
    }
    points
}

/// The length of a line up to each of its points.
fn lengths(points: &[Point]) -> Vec<f64> {
    let steps = points.windows(2).map(|ends| (ends[1].0 - ends[0].0).hypot(ends[1].1 - ends[0].1));
    let sums = steps.scan(0.0, |sum, step| {
        *sum += step;
        Some(*sum)
    });
    [0.0].into_iter().chain(sums).collect()
}

/// The largest index of a point up to which a parabola fits. At `first` it does. An index that fits is found, even if
/// one between does not.
fn farthest(first: usize, last: usize, fits: impl Fn(usize) -> bool) -> usize {
    let (mut found, mut step) = (first, 1);
    while found + step <= last && fits(found + step) {
        found += step;
        step *= 2;
    }
    while step > 0 {
        if found + step <= last && fits(found + step) {
            found += step;
        }
        step /= 2;
    }
    found
}

/// The control point of the parabola from the first to the last point that is nearest to the points between, by least
/// squares, and its largest distance from them. Each point is compared with the parabola at the same share of the length.
fn fitted(points: &[Point], lengths: &[f64]) -> (Point, f64) {
    let last = points.len() - 1;
    let (from, to) = (points[0], points[last]);
    let whole = (lengths[last] - lengths[0]).max(f64::MIN_POSITIVE);
    let share = |index: usize| (lengths[index] - lengths[0]) / whole;
    let offset = |index: usize, control: Point| {
        let [begin, middle, end] = weights(share(index));
        let x = points[index].0 - begin * from.0 - middle * control.0 - end * to.0;
        let y = points[index].1 - begin * from.1 - middle * control.1 - end * to.1;
        (x, y)
    };
    let sums = (1..last).fold([0.0; 3], |[x, y, squares], index| {
        let (weight, rest) = (weights(share(index))[1], offset(index, (0.0, 0.0)));
        [x + weight * rest.0, y + weight * rest.1, squares + weight * weight]
    });
    let control = if sums[2] > 0.0 {
        (sums[0] / sums[2], sums[1] / sums[2])
    } else {
        (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1))
    };
    let distance = |index: usize| {
        let (x, y) = offset(index, control);
        x.hypot(y)
    };
    (control, (1..last).map(distance).fold(0.0, f64::max))
}

/// The weights of the first, the control and the last point of a parabola at a share of its parameter.
fn weights(share: f64) -> [f64; 3] {
    let rest = 1.0 - share;
    [rest * rest, 2.0 * share * rest, share * share]
}

/// The distance of a point from the straight line through two points.
fn distance_from_line(point: Point, from: Point, to: Point) -> f64 {
    let (along, off) = ((to.0 - from.0, to.1 - from.1), (point.0 - from.0, point.1 - from.1));
    let length = along.0.hypot(along.1);
    if length > 0.0 { (off.0 * along.1 - off.1 * along.0).abs() / length } else { off.0.hypot(off.1) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn a_path_along_a_line_has_no_character_too_many() {
        assert_eq!(polygon(&[(0.0, 0.0), (10.0, 10.0), (20.0, 0.0)]), "M0 0l20 20 20-20");
        let corners = [(3.0, 4.0), (8.0, 4.0), (8.0, 9.0), (8.0, 5.0), (8.1, 5.1), (7.0, 3.0)];
        assert_eq!(polygon(&corners), "M6 8h10v10-8l-2-4");
        assert_eq!(polygon(&[(3.0, 4.0)]), "M6 8");
        assert_eq!(curve(&[(3.0, 4.0)], 0.3), "M6 8");
        assert_eq!(curve(&[(0.0, 0.0), (20.0, 10.0), (40.0, 20.0)], 0.3), "M0 0l80 40");
    }

    #[test]
    fn a_parabola_fits_to_its_points() {
        let points: Vec<Point> =
            (-100..=100).map(|n| 0.1 * f64::from(n)).map(|x| (x, x * x / 40.0)).collect();
        let ((x, y), distance) = fitted(&points, &lengths(&points));
        assert!(x.abs() < 0.01 && (y + 2.5).abs() < 0.1 && distance < 0.2, "{x} {y} {distance}");
        // The corner of a triangle is far from every parabola through its other ends.
        let corner = with_spacing(&[(0.0, 0.0), (20.0, 20.0), (40.0, 0.0)]);
        assert!(fitted(&corner, &lengths(&corner)).1 > 2.0);
    }

    #[test]
    fn a_circle_consists_of_few_parabolas() {
        let angle = |n: i32| f64::from(n) * TAU / 200.0;
        let circle: Vec<Point> =
            (0..=200).map(|n| (100.0 + 50.0 * angle(n).cos(), 100.0 + 50.0 * angle(n).sin())).collect();
        let data = curve(&circle, 0.3);
        assert!(data.starts_with("M300 200q") && !data.contains(['l', 'h', 'v']), "{data}");
        let numbers = data.split(['M', 'q', ' ', '-']).filter(|number| !number.is_empty()).count();
        assert!((2 + 4 * 5..=2 + 4 * 10).contains(&numbers), "{data}");
    }
}
