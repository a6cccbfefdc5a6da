//! Curved loops: finds all solutions by interval bisection and Newton's method with intervals.
//!
//! The search starts with the whole range of every tear: at one of the limits, or between them. Each box of intervals
//! is narrowed in two ways. A tear and its recomputed output must have a value in common. And Newton's method with
//! bounds of the slopes maps a box to one that contains the same solutions. If the result is inside the box, the box
//! has exactly one solution. A box that does not become smaller is halved. See A. Neumaier, Interval Methods for
//! Systems of Equations, 1990, chapter 5.

use nalgebra::{DMatrix, DVector};

use super::bounds::Bounds;
use super::interval::Interval;
use super::newton::Newton;
use super::{Problem, SOLUTION_SPACING, SolutionSet, Solutions};
use crate::ir::number::Number as _;
use crate::machines::REFERENCE;

/// Maximum number of boxes before the search is given up.
const MAX_BOXES: usize = 50_000;
/// Maximum number of boxes of the smallest width. If there are more, a range of voltages solves the loop.
const MAX_CANDIDATES: usize = 2_000;
/// Width, in volts, at which boxes are no longer halved.
const MIN_WIDTH: f64 = 1e-7;
/// Margin for rounding between a tear and its recomputed output, in volts and as a share of the amplification.
const SLACK: (f64, f64) = (1e-9, 4e-12);
/// Boxes without a clear solution that are nearer than this to a solution, in volts, belong to it.
const MEETING_DISTANCE: f64 = 1e-4;
/// A box that keeps more than this share of its width is halved.
const SLOW: f64 = 0.7;

/// All solutions of a loop.
///
/// # Errors
/// If a voltage is not a number, if a range of voltages solves the loop, or if there are too many boxes.
pub(super) fn solutions(problem: &Problem<'_>) -> Result<SolutionSet, Solutions> {
    let span = problem.order() + problem.entry.operations.len();
    let mut search = Search {
        problem,
        inside: vec![0.0; span],
        intervals: vec![Interval::constant(0.0); span],
        bounds: vec![Bounds::constant(0.0); span],
        newton: Newton::new(problem.order(), span),
        candidates: Vec::new(),
        found: SolutionSet::default(),
    };
    search.run()?;
    search.examine_candidates()?;
    Ok(search.found)
}

/// Where a tear is in a box.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// At its upper limit: at least this much is demanded.
    Top,
    /// At its lower limit.
    Bottom,
    /// Between its limits: it equals what is demanded.
    Within,
}

/// Intervals of all tears.
#[derive(Debug, Clone)]
struct TearBox {
    /// The intervals.
    tears: Vec<Interval>,
    /// Where the tears are.
    places: Vec<Place>,
}

impl TearBox {
    /// The largest width of an interval.
    fn width(&self) -> f64 {
        self.tears.iter().fold(0.0, |widest, tear| f64::max(widest, tear.width()))
    }

    /// The midpoints of the intervals.
    fn middle(&self) -> Vec<f64> {
        self.tears.iter().map(|tear| tear.middle()).collect()
    }

    /// The two halves along the widest interval.
    fn halves(self) -> [Self; 2] {
        let widths = self.tears.iter().map(|tear| tear.width());
        let widest = widths.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index);
        let middle = self.tears[widest].middle();
        let mut upper = self.clone();
        let mut lower = self;
        lower.tears[widest].high = middle;
        upper.tears[widest].low = middle;
        [lower, upper]
    }
}

/// What narrowing a box has shown.
enum Narrowed {
    /// It has no solution.
    Empty,
    /// It has exactly one solution.
    One,
    /// It may have solutions.
    Open(TearBox),
}

/// The search.
struct Search<'a> {
    /// The loop.
    problem: &'a Problem<'a>,
    /// Buffer for voltages.
    inside: Vec<f64>,
    /// Buffer for intervals.
    intervals: Vec<Interval>,
    /// Buffer for slopes.
    bounds: Vec<Bounds>,
    /// The iteration that ends the search for a solution.
    newton: Newton,
    /// Boxes of the smallest width that may have solutions.
    candidates: Vec<TearBox>,
    /// The solutions so far.
    found: SolutionSet,
}

impl Search<'_> {
    /// Narrows boxes until none is left.
    fn run(&mut self) -> Result<(), Solutions> {
        let limited = self.problem.entry.tears.iter().filter(|tear| tear.demand.is_some()).count();
        // Every limited tear triples the number of boxes at the start.
        if 3f64.powf(limited as f64) > MAX_BOXES as f64 {
            return Err(Solutions::TooManyPieces);
        }
        let mut open = self.all_places();
        let mut boxes = 0;
        while let Some(present) = open.pop() {
            boxes += 1;
            if boxes > MAX_BOXES {
                return Err(Solutions::TooManyPieces);
            }
            let width = present.width();
            match self.narrow(present) {
                Narrowed::Empty | Narrowed::One => {}
                Narrowed::Open(left) if left.width() <= MIN_WIDTH => {
                    self.candidates.push(left);
                    if self.candidates.len() > MAX_CANDIDATES {
                        return Err(Solutions::Range);
                    }
                }
                Narrowed::Open(left) if left.width() < SLOW * width => open.push(left),
                Narrowed::Open(left) => open.extend(left.halves().into_iter().rev()),
            }
        }
        Ok(())
    }

    /// The boxes at the start: every limited tear is at a limit or between them.
    fn all_places(&self) -> Vec<TearBox> {
        let mut boxes = vec![TearBox { tears: Vec::new(), places: Vec::new() }];
        for tear in &self.problem.entry.tears {
            let within = (Interval::new(-REFERENCE, REFERENCE), Place::Within);
            let limits = [
                (Interval::constant(REFERENCE), Place::Top),
                (Interval::constant(-REFERENCE), Place::Bottom),
            ];
            let options = [within].into_iter().chain(limits.into_iter().filter(|_| tear.demand.is_some()));
            let extended = options.flat_map(|(interval, place)| {
                boxes.iter().map(move |before| {
                    let mut after = before.clone();
                    after.tears.push(interval);
                    after.places.push(place);
                    after
                })
            });
            boxes = extended.collect();
        }
        boxes
    }

    /// Narrows a box by the recomputed outputs and by Newton's method.
    fn narrow(&mut self, mut present: TearBox) -> Narrowed {
        let problem = self.problem;
        self.intervals[..problem.order()].copy_from_slice(&present.tears);
        problem.evaluate(&mut self.intervals);
        for (position, tear) in problem.entry.tears.iter().enumerate() {
            let demand = problem.get(&self.intervals, tear.demanded());
            let margin = SLACK.0 + SLACK.1 * problem.amplification(tear);
            let interval = &mut present.tears[position];
            let is_empty = match present.places[position] {
                Place::Top => demand.high < REFERENCE - margin,
                Place::Bottom => demand.low > margin - REFERENCE,
                Place::Within => {
                    let (low, high) = (demand.low - margin, demand.high + margin);
                    *interval = Interval::new(interval.low.max(low), interval.high.min(high));
                    interval.low > interval.high
                }
            };
            if is_empty {
                return Narrowed::Empty;
            }
        }
        self.narrow_by_slopes(present)
    }

    /// Narrows a box by Newton's method with intervals.
    ///
    /// With g(y) = y - a(y), the middle m, and the inverse C of the middle of the slopes S, every solution in the box X
    /// is in m - C g(m) + (1 - C S) (X - m).
    fn narrow_by_slopes(&mut self, mut present: TearBox) -> Narrowed {
        let free: Vec<usize> =
            (0..present.places.len()).filter(|tear| present.places[*tear] == Place::Within).collect();
        let middle = present.middle();
        let Some((slopes, inverse)) = self.slopes(&present, &free) else { return Narrowed::Open(present) };
        self.problem.evaluate_at(&middle, &mut self.inside);
        let gaps = DVector::from_iterator(free.len(), free.iter().map(|tear| self.gap(*tear, &middle)));
        let step = &inverse * gaps;
        let mut is_inside = true;
        for (row, tear) in free.iter().enumerate() {
            let mut image = Interval::constant(middle[*tear] - step[row]);
            for (column, other) in free.iter().enumerate() {
                let mut product = Interval::constant(if row == column { 1.0 } else { 0.0 });
                for (inner, entries) in slopes.iter().enumerate() {
                    product =
                        product.subtract(Interval::constant(inverse[(row, inner)]).multiply(entries[column]));
                }
                let offset = present.tears[*other].subtract(Interval::constant(middle[*other]));
                image = image.add(product.multiply(offset));
            }
            if image.low.is_nan() || image.high.is_nan() {
                return Narrowed::Open(present);
            }
            let margin = SLACK.0;
            let image = Interval::new(image.low - margin, image.high + margin);
            let before = present.tears[*tear];
            is_inside &= image.low > before.low && image.high < before.high;
            present.tears[*tear] = Interval::new(before.low.max(image.low), before.high.min(image.high));
            if present.tears[*tear].low > present.tears[*tear].high {
                return Narrowed::Empty;
            }
        }
        if is_inside && self.settle(&present) { Narrowed::One } else { Narrowed::Open(present) }
    }

    /// What is demanded of a tear less than its voltage, at the voltages evaluated last.
    fn gap(&self, tear: usize, tears: &[f64]) -> f64 {
        let entry = &self.problem.entry.tears[tear];
        tears[tear] - self.problem.get(&self.inside, entry.demanded())
    }

    /// Bounds of the slopes of y - a(y) over a box, by rows, for the tears between their limits, and the inverse of
    /// their middle. `None` if they are not bounded or the middle is singular.
    fn slopes(&mut self, present: &TearBox, free: &[usize]) -> Option<(Vec<Vec<Interval>>, DMatrix<f64>)> {
        let problem = self.problem;
        let mut slopes = vec![vec![Interval::constant(0.0); free.len()]; free.len()];
        for (column, moving) in free.iter().enumerate() {
            let fixed = present.tears.iter().map(|tear| Bounds::fixed(*tear));
            self.bounds.iter_mut().zip(fixed).for_each(|(entry, bounds)| *entry = bounds);
            self.bounds[*moving] = Bounds::moving(present.tears[*moving]);
            problem.evaluate(&mut self.bounds);
            for (row, tear) in free.iter().enumerate() {
                let entry = &problem.entry.tears[*tear];
                let demand = problem.get(&self.bounds, entry.demanded()).slope;
                let own = Interval::constant(if row == column { 1.0 } else { 0.0 });
                slopes[row][column] = own.subtract(demand);
            }
        }
        let is_bounded = slopes.iter().flatten().all(|slope| slope.low.is_finite() && slope.high.is_finite());
        let middle = DMatrix::from_fn(free.len(), free.len(), |row, column| slopes[row][column].middle());
        let inverse = if is_bounded { middle.try_inverse() } else { None };
        inverse.map(|inverse| (slopes, inverse))
    }

    /// Adds the solution that Newton's method reaches from the middle of a box. `false` if it is not in the box.
    fn settle(&mut self, present: &TearBox) -> bool {
        let mut tears = present.middle();
        self.newton.forget();
        let is_settled = present.places.iter().all(|place| *place != Place::Within)
            || self.newton.follow(self.problem, &mut tears, &mut self.inside);
        let is_near = |(tear, interval): (&f64, &Interval)| {
            *tear >= interval.low - SOLUTION_SPACING && *tear <= interval.high + SOLUTION_SPACING
        };
        let is_found = is_settled && tears.iter().zip(&present.tears).all(is_near);
        if is_found {
            self.found.add(tears);
        }
        is_found
    }

    /// Adds the solutions in the smallest boxes. Newton's method fails where two solutions meet; they count as one if
    /// the recomputed outputs are near the tears.
    fn examine_candidates(&mut self) -> Result<(), Solutions> {
        for candidate in std::mem::take(&mut self.candidates) {
            let middle = candidate.middle();
            self.problem.evaluate_at(&middle, &mut self.inside);
            if self.inside.iter().any(|volts| volts.is_nan()) {
                return Err(Solutions::NotANumber);
            }
            let is_near = self.problem.entry.tears.iter().enumerate().all(|(tear, entry)| {
                let gap = self.problem.get(&self.inside, entry.result) - middle[tear];
                gap.abs() <= SOLUTION_SPACING * self.problem.amplification(entry)
            });
            let is_known = |known: &Vec<f64>| {
                known.iter().zip(&middle).all(|(known, middle)| (known - middle).abs() <= MEETING_DISTANCE)
            };
            if !self.settle(&candidate) && is_near && !self.found.0.iter().any(is_known) {
                self.found.add(middle);
            }
        }
        Ok(())
    }
}
