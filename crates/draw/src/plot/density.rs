//! Translucent strokes for traces that are drawn over themselves many times, so that their density is visible.
//!
//! The screen is divided into square cells as wide as the trace. The trace *passes* a cell whenever it enters it, unless
//! it has just left it. A trace with several passes through most of its cells is divided into strokes that pass no cell
//! twice. Where strokes overlap, their opacities add up.

use std::borrow::Cow;
use std::mem;

use super::trace::Line;

/// Mean number of passes at the points of a trace up to which it is opaque. Two strokes per unit of the width are 3.2
/// passes, because a trace is 1.6 units thick.
const MAX_OPAQUE_PASSES: f64 = 3.2;
/// The part of what is below a trace that the mean number of passes covers together.
const COVERED_SHARE: f64 = 0.9;
/// Least opacity. With it, a single stroke is still visible.
const MIN_OPACITY: f64 = 0.2;

/// Number of positions along a trace in the width of a cell.
const POSITIONS_PER_CELL: f64 = 2.0;
/// Number of positions after which a trace that enters a cell again passes it again.
const RETURN: u32 = 8;

/// Returns the opacity and the strokes of a trace of this thickness. They are the lines themselves, and opaque, unless
/// the trace is drawn over itself many times.
pub(super) fn strokes(lines: &[Line], width: f64) -> (f64, Cow<'_, [Line]>) {
    let passes = mean_passes(lines, width);
    if passes <= MAX_OPAQUE_PASSES {
        return (1.0, Cow::Borrowed(lines));
    }
    let opacity = (1.0 - (1.0 - COVERED_SHARE).powf(1.0 / passes)).max(MIN_OPACITY);
    // Two decimals are short in an SVG file.
    ((100.0 * opacity).round() / 100.0, Cow::Owned(divided(lines, width)))
}

/// Returns the mean number of passes through the cell of a point of the trace.
fn mean_passes(lines: &[Line], width: f64) -> f64 {
    let Some(mut grid) = Grid::around(lines, width) else { return 0.0 };
    let mut passes = vec![0_u32; grid.entered.len()];
    let mut position = 0;
    for line in lines {
        position += RETURN;
        for ends in line.windows(2) {
            for at in positions(ends[0], ends[1], width) {
                position += 1;
                let cell = grid.cell(at);
                let last = mem::replace(&mut grid.entered[cell], position);
                passes[cell] += u32::from(position - last > RETURN);
            }
        }
    }
    let counts = passes.into_iter().map(f64::from);
    let (sum, squares) =
        counts.fold((0.0, 0.0), |(sum, squares), count| (sum + count, squares + count * count));
    if sum > 0.0 { squares / sum } else { 0.0 }
}

/// Returns the lines divided into strokes that pass no cell twice. A stroke ends at a point of its line.
fn divided(lines: &[Line], width: f64) -> Vec<Line> {
    let Some(mut grid) = Grid::around(lines, width) else { return Vec::new() };
    let mut position = 0;
    let mut strokes = Vec::new();
    for line in lines {
        position += RETURN;
        let mut begin = position;
        let mut stroke: Line = line.iter().take(1).copied().collect();
        for ends in line.windows(2) {
            let before = position;
            let mut is_passed = false;
            for at in positions(ends[0], ends[1], width) {
                position += 1;
                let cell = grid.cell(at);
                let last = mem::replace(&mut grid.entered[cell], position);
                is_passed |= last > begin && position - last > RETURN;
            }
            if is_passed {
                strokes.push(mem::replace(&mut stroke, vec![ends[0]]));
                begin = before;
            }
            stroke.push(ends[1]);
        }
        strokes.push(stroke);
    }
    strokes
}

/// Returns the positions from one point to another at which the cells of a trace of this thickness are looked up.
fn positions(from: (f64, f64), to: (f64, f64), width: f64) -> impl Iterator<Item = (f64, f64)> {
    let (across, down) = (to.0 - from.0, to.1 - from.1);
    let count = (across.hypot(down) / width * POSITIONS_PER_CELL).ceil().max(1.0) as u32;
    (1..=count).map(move |index| {
        let share = f64::from(index) / f64::from(count);
        (from.0 + share * across, from.1 + share * down)
    })
}

/// The cells of the part of the screen that a trace uses.
struct Grid {
    /// The upper left corner.
    corner: (f64, f64),
    /// The length of the sides of a cell.
    width: f64,
    /// The number of cells from left to right.
    columns: usize,
    /// The position along the trace that was last in each cell, row by row; 0 if there was none.
    entered: Vec<u32>,
}

impl Grid {
    /// Returns the cells of the rectangle around a trace of this thickness; `None` if it has no points.
    fn around(lines: &[Line], width: f64) -> Option<Grid> {
        let mut points = lines.iter().flatten();
        let first = *points.next()?;
        let (low, high) = points.fold((first, first), |(low, high), point| {
            ((low.0.min(point.0), low.1.min(point.1)), (high.0.max(point.0), high.1.max(point.1)))
        });
        let cells = |length: f64| (length / width) as usize + 1;
        let (columns, rows) = (cells(high.0 - low.0), cells(high.1 - low.1));
        Some(Grid { corner: low, width, columns, entered: vec![0; columns * rows] })
    }

    /// Returns the index of the cell at a position within the rectangle.
    fn cell(&self, at: (f64, f64)) -> usize {
        let index = |position: f64, low: f64| ((position - low) / self.width) as usize;
        let (column, row) = (index(at.0, self.corner.0), index(at.1, self.corner.1));
        // Rounding may put the last position just outside.
        (row * self.columns + column.min(self.columns - 1)).min(self.entered.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// The thickness of a trace.
    const WIDTH: f64 = 1.6;

    /// Strokes between heights of 0 and 200 over a width of 400, this number for each unit.
    fn zigzag(strokes_per_unit: f64) -> Line {
        let count = (400.0 * strokes_per_unit) as u32;
        (0..=count).map(|n| (f64::from(n) / strokes_per_unit, 200.0 * f64::from(n % 2))).collect()
    }

    /// A circle that is drawn this number of times.
    fn circles(times: u32) -> Line {
        let angle = |n: u32| f64::from(n) * TAU / 90.0;
        (0..=90 * times).map(|n| (100.0 + 80.0 * angle(n).cos(), 100.0 + 80.0 * angle(n).sin())).collect()
    }

    #[test]
    fn ordinary_traces_are_opaque_and_not_divided() {
        let sine = |n: u32| (f64::from(n) * 0.5, 100.0 + 100.0 * (0.05 * f64::from(n)).sin());
        let noise = |n: u32| (f64::from(n) * 0.5, 100.0 + f64::from(n * n % 7) * 0.3);
        let lines: [Vec<Line>; 7] = [
            vec![(0..1600).map(sine).collect()],
            vec![(0..1600).map(noise).collect()],
            vec![zigzag(0.5)],
            vec![zigzag(1.5)],
            vec![circles(3)],
            vec![vec![(5.0, 5.0)]],
            vec![],
        ];
        for lines in lines {
            let (opacity, strokes) = strokes(&lines, WIDTH);
            assert!(opacity == 1.0 && matches!(strokes, Cow::Borrowed(_)));
        }
    }

    #[test]
    fn the_mean_number_of_passes_is_that_of_the_strokes() {
        let cases = [(zigzag(3.0), 4.8), (zigzag(5.0), 8.0), (circles(6), 6.0), (circles(20), 20.0)];
        for (line, expected) in cases {
            let passes = mean_passes(&[line], WIDTH);
            assert!((passes / expected - 1.0).abs() < 0.15, "{passes}, expected {expected}");
        }
        // Runs that are equal pass the same cells.
        let passes = mean_passes(&vec![circles(1); 8], WIDTH);
        assert!((passes - 8.0).abs() < 0.5, "{passes}");
    }

    #[test]
    fn dense_traces_are_translucent_and_divided_into_strokes() {
        let line = circles(10);
        let (opacity, strokes) = strokes(std::slice::from_ref(&line), WIDTH);
        assert!(opacity > MIN_OPACITY && opacity < 0.3, "{opacity}");
        // A stroke is about one circle.
        assert!((9..=12).contains(&strokes.len()), "{}", strokes.len());
        let joined: Line = strokes.iter().flat_map(|stroke| &stroke[1..]).copied().collect();
        assert_eq!(joined, line[1..]);
        assert!(strokes.iter().all(|stroke| mean_passes(std::slice::from_ref(stroke), WIDTH) < 1.2));
        assert!(strokes.windows(2).all(|pair| pair[0].last() == pair[1].first()));
    }

    #[test]
    fn more_passes_have_less_opacity_down_to_a_limit() {
        let opacities = [4, 6, 9, 40].map(|times| strokes(&[circles(times)], WIDTH).0);
        assert!(opacities.is_sorted_by(|one, next| one > next), "{opacities:?}");
        assert_eq!(opacities[3], MIN_OPACITY);
    }
}
