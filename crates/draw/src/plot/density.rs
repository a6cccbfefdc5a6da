//! Strokes and shades of dense traces, so that their density is visible.
//!
//! The screen is divided into square cells as wide as the trace. The trace *passes* a cell whenever it enters it, unless
//! it has just left it.
//!
//! * A trace that fills an area has shades by the share of time that it spends in each cell, if its x only rises or only
//!   falls. Its strokes are parallel, so that their opacities would not add up to the same value everywhere.
//! * Another trace that fills an area, or that passes most of its cells several times, is divided into strokes that pass
//!   no cell twice. Where strokes overlap, their opacities add up.

use std::mem;

use super::cells::{Cells, NEAR_CELLS, positions};
use super::clip::Line;
use super::exposure::{Exposure, Shade};
use super::thin::is_monotonic;

/// Mean number of passes at the points of a trace up to which it is opaque, unless it fills an area.
const MAX_OPAQUE_PASSES: f64 = 3.2;
/// The largest share of the passes of an opaque trace in cells that it fills.
const MAX_OPAQUE_FILLED_SHARE: f64 = 0.2;
/// A trace fills a cell if it passes at least this share of the cells near it.
const MIN_FILLED_SHARE: f64 = 0.9;
/// The part of what is below a trace that the mean number of passes covers together.
const COVERED_SHARE: f64 = 0.9;
/// Least opacity. With it, a single stroke is still visible.
const MIN_OPACITY: f64 = 0.2;

/// Number of positions after which a trace that enters a cell again passes it again.
const RETURN: u32 = 8;

/// How the lines of a trace are drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Strokes<'a> {
    /// As they are, opaque.
    Opaque(&'a [Vec<(f64, f64)>]),
    /// Divided into strokes that are drawn one after the other with this opacity, from 0 to 1.
    Translucent(f64, Vec<Vec<(f64, f64)>>),
    /// In opaque shades, the palest first.
    Shades(Vec<Shade>),
}

/// Returns how a trace of this thickness is drawn so that its density is visible. An ordinary trace is opaque.
///
/// The lines are within the picture. Those of a long record may be thinned to what is visible. `expose` adds the whole
/// path of the trace with its times. It is called only if they are needed.
///
/// # Examples
///
/// ```
/// use patchcord_draw::plot::{Exposure, Strokes, strokes};
///
/// // Strokes between two heights, one in each second.
/// let strokes_of = |width: f64| {
///     let line = (0..400).map(|n| (width / 400.0 * f64::from(n), 100.0 * f64::from(n % 2))).collect();
///     let lines: [Vec<(f64, f64)>; 1] = [line];
///     let expose = |exposure: &mut Exposure| {
///         lines[0].windows(2).for_each(|ends| exposure.add(ends[0], ends[1], 1.0));
///     };
///     match strokes(&lines, 1.6, expose) {
///         Strokes::Opaque(_) => 0,
///         Strokes::Translucent(..) => 1,
///         Strokes::Shades(shades) => shades.len(),
///     }
/// };
/// assert_eq!((strokes_of(2000.0), strokes_of(200.0)), (0, 6));
/// ```
pub fn strokes(lines: &[Vec<(f64, f64)>], width: f64, expose: impl FnOnce(&mut Exposure)) -> Strokes<'_> {
    let Some(passes) = Passes::of(lines, width) else { return Strokes::Opaque(lines) };
    let (mean, fills) = (passes.mean(), passes.filled_share() > MAX_OPAQUE_FILLED_SHARE);
    if fills && lines.iter().all(|line| is_monotonic(line)) {
        let mut exposure = Exposure::new(passes.cells);
        expose(&mut exposure);
        if let Some(shades) = exposure.shades(lines) {
            return Strokes::Shades(shades);
        }
    }
    if !fills && mean <= MAX_OPAQUE_PASSES {
        return Strokes::Opaque(lines);
    }
    let opacity = (1.0 - (1.0 - COVERED_SHARE).powf(1.0 / mean)).max(MIN_OPACITY);
    // Two decimals are short in an SVG file.
    Strokes::Translucent((100.0 * opacity).round() / 100.0, divided(lines, &passes.cells))
}

/// How often a trace passes each cell.
struct Passes {
    /// The cells.
    cells: Cells,
    /// The number of passes of each cell.
    counts: Vec<u32>,
}

impl Passes {
    /// Counts the passes of a trace of this thickness; `None` if it has no points.
    fn of(lines: &[Line], width: f64) -> Option<Passes> {
        let cells = Cells::around(lines, width)?;
        let (mut entered, mut counts) = (vec![0_u32; cells.count()], vec![0_u32; cells.count()]);
        let mut position = 0;
        for line in lines {
            position += RETURN;
            for ends in line.windows(2) {
                for at in positions(ends[0], ends[1], width) {
                    position += 1;
                    let cell = cells.at(at);
                    let last = mem::replace(&mut entered[cell], position);
                    counts[cell] += u32::from(position - last > RETURN);
                }
            }
        }
        Some(Passes { cells, counts })
    }

    /// Returns the mean number of passes through the cell of a point of the trace.
    fn mean(&self) -> f64 {
        self.mean_of_passes(|cell| f64::from(self.counts[cell]))
    }

    /// Returns the share of the passes in cells that the trace fills.
    fn filled_share(&self) -> f64 {
        let is_filled = |cell: usize| {
            let passed = self.cells.near(cell).filter(|near| self.counts[*near] > 0).count();
            passed as f64 >= MIN_FILLED_SHARE * NEAR_CELLS as f64
        };
        self.mean_of_passes(|cell| f64::from(u8::from(self.counts[cell] > 0 && is_filled(cell))))
    }

    /// Returns the mean over all passes of a value of their cells; 0 without a pass.
    fn mean_of_passes(&self, value: impl Fn(usize) -> f64) -> f64 {
        let counts = self.counts.iter().map(|count| f64::from(*count));
        let (sum, weighted) = counts
            .enumerate()
            .fold((0.0, 0.0), |(sum, weighted), (cell, count)| (sum + count, weighted + count * value(cell)));
        if sum > 0.0 { weighted / sum } else { 0.0 }
    }
}

/// Returns the lines divided into strokes that pass no cell twice. A stroke ends at a point of its line.
fn divided(lines: &[Line], cells: &Cells) -> Vec<Line> {
    let (mut entered, mut position) = (vec![0_u32; cells.count()], 0);
    let mut strokes = Vec::new();
    for line in lines {
        position += RETURN;
        let mut begin = position;
        let mut stroke: Line = line.iter().take(1).copied().collect();
        for ends in line.windows(2) {
            let before = position;
            let mut is_passed = false;
            for at in positions(ends[0], ends[1], cells.width) {
                position += 1;
                let last = mem::replace(&mut entered[cells.at(at)], position);
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

    /// A spiral whose turns are this distance apart.
    fn spiral(distance: f64) -> Line {
        let place = |n: u32| {
            let turns = f64::from(n) / 90.0;
            let (radius, angle) = (20.0 + distance * turns, TAU * turns);
            (100.0 + radius * angle.cos(), 100.0 + radius * angle.sin())
        };
        (0..=90 * 40).map(place).collect()
    }

    /// The strokes of a trace that moves along x with constant speed.
    fn with_even_times(lines: &[Line]) -> Strokes<'_> {
        strokes(lines, WIDTH, |exposure| {
            for ends in lines.iter().flat_map(|line| line.windows(2)) {
                exposure.add(ends[0], ends[1], ends[1].0 - ends[0].0);
            }
        })
    }

    /// The opacity and the strokes of a trace that is translucent.
    fn translucent(lines: &[Line]) -> (f64, Vec<Line>) {
        match strokes(lines, WIDTH, |_| ()) {
            Strokes::Translucent(opacity, strokes) => (opacity, strokes),
            other => panic!("{other:?}"),
        }
    }

    fn mean_passes(lines: &[Line]) -> f64 {
        Passes::of(lines, WIDTH).map_or(0.0, |passes| passes.mean())
    }

    #[test]
    fn thin_traces_are_opaque_and_not_divided() {
        let sine = |n: u32| (f64::from(n) * 0.5, 100.0 + 100.0 * (0.05 * f64::from(n)).sin());
        let noise = |n: u32| (f64::from(n) * 0.5, 100.0 + f64::from(n * n % 7) * 0.3);
        let lines: [Vec<Line>; 7] = [
            vec![(0..1600).map(sine).collect()],
            vec![(0..1600).map(noise).collect()],
            vec![zigzag(0.5)],
            vec![spiral(4.0)],
            vec![circles(3)],
            vec![vec![(5.0, 5.0)]],
            vec![],
        ];
        for lines in lines {
            assert_eq!(with_even_times(&lines), Strokes::Opaque(&lines));
        }
    }

    #[test]
    fn a_trace_against_time_that_fills_an_area_has_shades() {
        // Fig 8.24 has 1.5 strokes for each unit, and a trace is 1.6 units thick.
        for strokes_per_unit in [1.0, 1.5, 5.0] {
            let lines = [zigzag(strokes_per_unit)];
            assert!(matches!(with_even_times(&lines), Strokes::Shades(_)), "{strokes_per_unit}");
            let backwards: [Line; 1] = [lines[0].iter().rev().copied().collect()];
            let times = |exposure: &mut Exposure| exposure.add((0.0, 0.0), (400.0, 200.0), 1.0);
            assert!(matches!(strokes(&backwards, WIDTH, times), Strokes::Shades(_)), "{strokes_per_unit}");
        }
        // Without times, and if x changes its direction, the strokes are translucent.
        assert!(translucent(&[zigzag(1.5)]).0 > 0.5);
        let there_and_back: Line = zigzag(1.5).into_iter().chain([(0.0, 0.0)]).collect();
        assert!(matches!(with_even_times(&[there_and_back]), Strokes::Translucent(..)));
    }

    #[test]
    fn a_curve_that_fills_an_area_is_translucent_after_one_pass() {
        let lines = [spiral(1.5)];
        assert!(mean_passes(&lines) < 1.5);
        let (opacity, strokes) = translucent(&lines);
        assert!((0.75..0.9).contains(&opacity) && strokes.len() > 20, "{opacity}, {} strokes", strokes.len());
    }

    #[test]
    fn the_mean_number_of_passes_is_that_of_the_strokes() {
        let cases = [(zigzag(3.0), 4.8), (zigzag(5.0), 8.0), (circles(6), 6.0), (circles(20), 20.0)];
        for (line, expected) in cases {
            let passes = mean_passes(&[line]);
            assert!((passes / expected - 1.0).abs() < 0.15, "{passes}, expected {expected}");
        }
        // Runs that are equal pass the same cells.
        let passes = mean_passes(&vec![circles(1); 8]);
        assert!((passes - 8.0).abs() < 0.5, "{passes}");
    }

    #[test]
    fn traces_drawn_over_themselves_are_translucent_and_divided_into_strokes() {
        let line = circles(10);
        let (opacity, strokes) = translucent(std::slice::from_ref(&line));
        assert!(opacity > MIN_OPACITY && opacity < 0.3, "{opacity}");
        // A stroke is about one circle.
        assert!((9..=12).contains(&strokes.len()), "{}", strokes.len());
        let joined: Line = strokes.iter().flat_map(|stroke| &stroke[1..]).copied().collect();
        assert_eq!(joined, line[1..]);
        assert!(strokes.iter().all(|stroke| mean_passes(std::slice::from_ref(stroke)) < 1.2));
        assert!(strokes.windows(2).all(|pair| pair[0].last() == pair[1].first()));
    }

    #[test]
    fn more_passes_have_less_opacity_down_to_a_limit() {
        let opacities = [4, 6, 9, 40].map(|times| translucent(&[circles(times)]).0);
        assert!(opacities.is_sorted_by(|one, next| one > next), "{opacities:?}");
        assert_eq!(opacities[3], MIN_OPACITY);
    }
}
