//! Shades of traces that fill an area, from the share of time that they spend at each place. A screen with phosphor has
//! such shades.

use std::mem;

use super::cells::{Cells, positions};
use super::clip::{Line, visible_part};

/// Number of shades. The last one is the colour of the trace.
const SHADES: usize = 6;
/// The share of the trace's colour in the palest shade.
const MIN_SHARE: f64 = 0.35;
/// The factor between the times of two shades that follow each other.
const TIME_RATIO: f64 = 1.6;
/// The index of the shade that begins at the median of the times.
const MEDIAN_SHADE: f64 = 2.0;

/// The largest vertical distance of two parts that become one line, in cells.
const MAX_JOIN: f64 = 4.0;
/// Number of lines of a shade that a part may continue.
const RECENT_LINES: usize = 6;

/// The time that a trace spends in each of the square cells around it.
///
/// [`strokes`](super::strokes) makes it, and its caller adds its path.
#[derive(Debug, Clone)]
pub struct Exposure {
    /// The cells.
    cells: Cells,
    /// The time in each cell in seconds.
    seconds: Vec<f64>,
}

/// Lines in one shade of the colour of a trace.
#[derive(Debug, Clone, PartialEq)]
pub struct Shade {
    /// The share of the trace's colour, from 0 to 1. The rest is the background.
    pub share: f64,
    /// The opaque lines.
    pub lines: Vec<Vec<(f64, f64)>>,
}

impl Exposure {
    /// Returns cells in which the trace has not been.
    pub(super) fn new(cells: Cells) -> Exposure {
        Exposure { cells, seconds: vec![0.0; cells.count()] }
    }

    /// Adds a straight path between two positions, with constant speed and this duration. Parts outside the cells are
    /// omitted, and so is a duration that is not positive and finite.
    pub fn add(&mut self, from: (f64, f64), to: (f64, f64), seconds: f64) {
        let whole = distance(from, to);
        let Some((begin, end)) = visible_part(from, to, self.cells.area()) else { return };
        if !(whole.is_finite() && seconds.is_finite()) || seconds <= 0.0 {
            return;
        }
        let share = if whole > 0.0 { distance(begin, end) / whole } else { 1.0 };
        let (begin, end) = (self.cells.within_area(begin), self.cells.within_area(end));
        let (left, right) = if begin.0 <= end.0 { (begin, end) } else { (end, begin) };
        self.add_within(left, right, share * seconds);
    }

    /// Adds a path within the cells. Its ends are in cells from the upper left corner.
    fn add_within(&mut self, left: (f64, f64), right: (f64, f64), seconds: f64) {
        let across = right.0 - left.0;
        let column_at = |x: f64| (x as usize).min(self.cells.columns - 1);
        let (first, last) = (column_at(left.0), column_at(right.0));
        let mut from = left;
        for column in first..=last {
            let border = column as f64 + 1.0;
            let at_border = (border, left.1 + (border - left.0) / across * (right.1 - left.1));
            let to = if column < last { at_border } else { right };
            let share = if first < last { (to.0 - from.0) / across } else { 1.0 };
            self.add_in_column(column, (from.1, to.1), share * seconds);
            from = to;
        }
    }

    /// Adds a path in a column between two heights, in cells from the top.
    fn add_in_column(&mut self, column: usize, (from, to): (f64, f64), seconds: f64) {
        let (high, low) = (from.min(to), from.max(to));
        let rows = self.cells.rows;
        let cells = &mut self.seconds[column * rows..][..rows];
        let (first, last) = ((high as usize).min(rows - 1), (low as usize).min(rows - 1));
        if first == last {
            cells[first] += seconds;
            return;
        }
        let per_cell = seconds / (low - high);
        cells[first] += per_cell * (first as f64 + 1.0 - high);
        cells[last] += per_cell * (low - last as f64);
        cells[first + 1..last].iter_mut().for_each(|cell| *cell += per_cell);
    }

    /// Returns the lines in shades, from the palest to that of the trace's colour, which is to be drawn last. A line is
    /// darker where the trace spends more time than at the median of its cells. `None` if no time was added.
    pub(super) fn shades(&self, lines: &[Line]) -> Option<Vec<Shade>> {
        let (means, width) = (self.means(), self.cells.width);
        let median = self.median(&means)?;
        let shade_at = |at| shade_index(means[self.cells.at(at)] / median);
        let share = |index: usize| MIN_SHARE + (1.0 - MIN_SHARE) * index as f64 / (SHADES - 1) as f64;
        let mut shades: Vec<Shade> =
            (0..SHADES).map(|index| Shade { share: share(index), lines: Vec::new() }).collect();
        for line in lines {
            for (index, part) in parts(line, width, shade_at) {
                append(&mut shades[index].lines, part, width);
            }
        }
        Some(shades)
    }

    /// Returns for each cell the mean time in the cells near it in which the trace was. Neighbouring cells of a dense
    /// trace have different numbers of strokes, which must not be visible.
    fn means(&self) -> Vec<f64> {
        let mean = |cell| {
            let times = self.cells.near(cell).map(|near| self.seconds[near]).filter(|seconds| *seconds > 0.0);
            let (sum, count) = times.fold((0.0, 0.0), |(sum, count), seconds| (sum + seconds, count + 1.0));
            if count > 0.0 { sum / count } else { 0.0 }
        };
        (0..self.cells.count()).map(mean).collect()
    }

    /// Returns the median of the means of the cells in which the trace was; `None` if there is no such cell.
    fn median(&self, means: &[f64]) -> Option<f64> {
        let visited = means.iter().zip(&self.seconds).filter(|(_, seconds)| **seconds > 0.0);
        let mut visited: Vec<f64> = visited.map(|(mean, _)| *mean).collect();
        visited.sort_unstable_by(f64::total_cmp);
        visited.get(visited.len() / 2).copied()
    }
}

/// Returns the index of the shade for a time. `ratio` is this time divided by the median.
fn shade_index(ratio: f64) -> usize {
    ((ratio.log(TIME_RATIO) + MEDIAN_SHADE) as usize).min(SHADES - 1)
}

/// Returns the parts of a line with the indices of their shades. Each part is at least half a cell long, unless the line
/// is shorter.
fn parts(line: &[(f64, f64)], width: f64, shade_at: impl Fn((f64, f64)) -> usize) -> Vec<(usize, Line)> {
    let Some(first) = line.first() else { return Vec::new() };
    let (mut parts, mut length): (Vec<(usize, Line)>, f64) = (Vec::new(), 0.0);
    let (mut shade, mut part) = (shade_at(*first), vec![*first]);
    for ends in line.windows(2) {
        let mut before = ends[0];
        for at in positions(ends[0], ends[1], width) {
            let next = shade_at(at);
            if next != shade && length >= 0.5 * width {
                if part.last() != Some(&before) {
                    part.push(before);
                }
                parts.push((shade, mem::replace(&mut part, vec![before])));
                length = 0.0;
            }
            shade = next;
            length += distance(before, at);
            before = at;
        }
        part.push(ends[1]);
    }
    match parts.last_mut() {
        Some((_, last)) if length < 0.5 * width => last.extend(part),
        _ => parts.push((shade, part)),
    }
    parts
}

/// Appends a part of a trace to the lines of its shade. It continues a line that ends next to its begin, because each
/// line takes space in a file.
fn append(lines: &mut Vec<Line>, part: Line, width: f64) {
    let begin = part.first().copied().unwrap_or_default();
    let is_next = |line: &Line| {
        let is_near = |end: &(f64, f64)| {
            (end.0 - begin.0).abs() <= width && (end.1 - begin.1).abs() <= MAX_JOIN * width
        };
        line.last().is_some_and(is_near)
    };
    let older = lines.len().saturating_sub(RECENT_LINES);
    match lines[older..].iter().rposition(is_next) {
        Some(index) => lines[older + index].extend(part),
        None => lines.push(part),
    }
}

/// Returns the distance of two positions.
fn distance(one: (f64, f64), other: (f64, f64)) -> f64 {
    (one.0 - other.0).hypot(one.1 - other.1)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// The exposure of one line whose points have times, in cells of this width.
    fn exposure(lines: &[Line], times: &[f64], width: f64) -> Exposure {
        let mut exposure = Exposure::new(Cells::around(lines, width).unwrap());
        for (ends, times) in lines[0].windows(2).zip(times.windows(2)) {
            exposure.add(ends[0], ends[1], times[1] - times[0]);
        }
        exposure
    }

    /// The share of the colour at a position: that of the last shade with a line there. 0 if there is none.
    fn share_at(shades: &[Shade], at: (f64, f64)) -> f64 {
        let is_there =
            |ends: &[(f64, f64)]| positions(ends[0], ends[1], 0.5).any(|on| distance(on, at) < 0.8);
        let found = shades.iter().rfind(|shade| shade.lines.iter().any(|line| line.windows(2).any(is_there)));
        found.map_or(0.0, |shade| shade.share)
    }

    /// Strokes between heights of 0 and 200 over a width of 400, two for each unit. The height is this function of the
    /// number of strokes so far, which is the time as well.
    fn strokes(height: impl Fn(f64) -> f64) -> ([Line; 1], Vec<f64>) {
        let times: Vec<f64> = (0..=16_000).map(|n| f64::from(n) / 20.0).collect();
        ([times.iter().map(|time| (0.5 * time, height(*time))).collect()], times)
    }

    /// The height of a sine.
    fn sine(time: f64) -> f64 {
        100.0 - 100.0 * (time * TAU / 2.0).cos()
    }

    #[test]
    fn the_time_of_a_path_is_divided_by_its_length_in_each_cell() {
        let mut exposure = exposure(&[vec![(0.0, 0.0), (4.0, 3.0)]], &[0.0, 8.0], 2.0);
        assert_eq!((exposure.cells.columns, exposure.cells.rows), (3, 2));
        let is_near = |exposure: &Exposure, expected: [f64; 6]| {
            exposure.seconds.iter().zip(expected).all(|(seconds, other)| (seconds - other).abs() < 1e-12)
        };
        // The first column has the heights from 0 to 1.5, the second one those from 1.5 to 3.
        assert!(is_near(&exposure, [4.0, 0.0, 4.0 / 3.0, 8.0 / 3.0, 0.0, 0.0]), "{exposure:?}");
        // Two fifths of this path are in the cells, a fifth in each of them.
        exposure.add((2.5, 10.0), (2.5, 0.0), 10.0);
        assert!(is_near(&exposure, [4.0, 0.0, 10.0 / 3.0, 14.0 / 3.0, 0.0, 0.0]), "{exposure:?}");
        exposure.add((1.0, 1.0), (1.0, 1.0), 0.5);
        for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            exposure.add((0.0, 0.0), (4.0, 3.0), seconds);
        }
        exposure.add((f64::NAN, 0.0), (4.0, 3.0), 1.0);
        exposure.add((90.0, 0.0), (94.0, 3.0), 1.0);
        assert!(is_near(&exposure, [4.5, 0.0, 10.0 / 3.0, 14.0 / 3.0, 0.0, 0.0]), "{exposure:?}");
    }

    #[test]
    fn a_dense_oscillation_is_darkest_where_it_turns() {
        let (line, times) = strokes(sine);
        let shades = exposure(&line, &times, 1.6).shades(&line).unwrap();
        let shares = [100.0, 150.0, 185.0, 199.0].map(|height| share_at(&shades, (200.0, height)));
        // In the middle, a sine spends 0.87 of its median time: one shade less than the median.
        assert!((shares[0] - 0.48).abs() < 1e-9, "{shares:?}");
        assert!(shares.is_sorted() && shares[2] > 0.7 && shares[3] > 0.85, "{shares:?}");
        assert!(share_at(&shades, (200.0, 15.0)) > 0.7 && share_at(&shades, (200.0, 1.0)) > 0.85);
    }

    #[test]
    fn a_trace_is_paler_where_it_is_faster() {
        let (line, times) = strokes(|time| 200.0 * (1.0 - (time.rem_euclid(2.0) - 1.0).abs()));
        let faster = |time: &f64| if *time < 500.0 { *time } else { 500.0 + 0.25 * (time - 500.0) };
        let times: Vec<f64> = times.iter().map(faster).collect();
        let shades = exposure(&line, &times, 1.6).shades(&line).unwrap();
        assert!(share_at(&shades, (100.0, 100.0)) > 0.45);
        assert_eq!(share_at(&shades, (300.0, 100.0)), MIN_SHARE);
    }

    #[test]
    fn shades_cover_the_whole_trace_with_few_lines() {
        let (line, times) = strokes(sine);
        let shades = exposure(&line, &times, 1.6).shades(&line).unwrap();
        assert!(line[0].iter().step_by(1601).all(|at| share_at(&shades, *at) > 0.0));
        // Each of 800 strokes has parts in most of the shades.
        let lines: Vec<&Line> = shades.iter().flat_map(|shade| &shade.lines).collect();
        assert!(lines.len() < 800, "{}", lines.len());
        let has_length = |line: &&Line| line.iter().any(|at| distance(*at, line[0]) > 0.1);
        assert!(lines.iter().all(has_length), "a line without length would be drawn as a disc");
    }

    #[test]
    fn without_times_there_are_no_shades() {
        let line = [vec![(0.0, 0.0), (4.0, 3.0)]];
        assert!(exposure(&line, &[1.0, 1.0], 1.6).shades(&line).is_none());
    }
}
