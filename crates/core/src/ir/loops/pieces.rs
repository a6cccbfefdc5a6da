//! Straight loops: finds all solutions by enumerating the linear pieces of the loop.
//!
//! Every operation of a straight loop is an affine form of the tears, up to the choice that a limit, a diode or a table
//! makes. The search follows the operations. Where the voltages of the tears do not decide a choice, it tries each
//! case. A case bounds an affine form, which narrows the intervals of the tears. So does the equation of every tear
//! whose output is complete. A case whose intervals are empty is abandoned. At the end of the operations a system of
//! linear equations remains.

use std::ops::Range;

use super::forms::{Forms, value};
use super::interval::Interval;
use super::matrix::Factors;
use super::singular::{Feasible, feasible};
use super::{Problem, SolutionSet, Solutions};
use crate::ir::op::{Op, Register};
use crate::machines::REFERENCE;

/// Maximum number of cases, of all choices together.
const MAX_CASES: usize = 40_000;
/// Maximum number of cases times the square of the number of terms of a form, which the time is proportional to.
const MAX_WORK: usize = 4_000_000;
/// Maximum number of times that all bounds are applied to the intervals after a new one.
const MAX_SWEEPS: usize = 3;
/// Margin for rounding, in volts.
const SLACK: f64 = 1e-9;
/// Margin for rounding, as a share of the terms of an affine form.
const RELATIVE_SLACK: f64 = 1e-13;

/// All solutions of a straight loop.
///
/// # Errors
/// If a voltage is not a number, if a range of voltages solves the loop, or if there are too many cases.
pub(super) fn solutions(problem: &Problem<'_>) -> Result<SolutionSet, Solutions> {
    let mut search = Search::new(problem);
    search.run()?;
    Ok(search.found)
}

/// An affine form of the tears must not be negative, or must be 0.
#[derive(Debug, Clone)]
pub(super) struct Bound {
    /// The coefficients of the tears, and last the constant.
    pub form: Vec<f64>,
    /// Whether the form must be 0.
    pub is_equation: bool,
}

/// A choice with the pieces that were not tried yet.
struct Choice {
    /// Index of the operation, counted from the first tear.
    at: usize,
    /// The pieces that the intervals leave.
    pieces: Range<usize>,
    /// The next of them.
    next: usize,
    /// The intervals of the tears before the choice.
    tears: Vec<Interval>,
    /// Number of bounds before the choice.
    bounds: usize,
}

/// How far the operations were followed.
enum Progress {
    /// To the end.
    Complete,
    /// To an operation of which the intervals leave these pieces.
    Undecided(Range<usize>),
    /// The intervals are empty.
    Empty,
}

/// The enumeration.
struct Search<'a> {
    /// The loop.
    problem: &'a Problem<'a>,
    /// The affine forms of the present case.
    forms: Forms<'a>,
    /// The tear whose output an operation completes.
    completes: Vec<Option<usize>>,
    /// The present intervals of the tears.
    tears: Vec<Interval>,
    /// The bounds of the present case.
    bounds: Vec<Bound>,
    /// Number of cases so far.
    cases: usize,
    /// The solutions so far.
    found: SolutionSet,
}

impl<'a> Search<'a> {
    /// The search before the first operation.
    fn new(problem: &'a Problem<'a>) -> Self {
        let (order, span) = (problem.order(), problem.order() + problem.entry.operations.len());
        let mut completes = vec![None; span];
        for (position, tear) in problem.entry.tears.iter().enumerate() {
            if let Some(inner) = tear.result.index().checked_sub(problem.outside.len()) {
                completes[inner] = Some(position);
            }
        }
        let tears = vec![Interval::new(-REFERENCE, REFERENCE); order];
        let (forms, found) = (Forms::new(problem), SolutionSet::default());
        Search { problem, forms, completes, tears, bounds: Vec::new(), cases: 0, found }
    }

    /// Follows the operations through all cases.
    fn run(&mut self) -> Result<(), Solutions> {
        let mut open: Vec<Choice> = Vec::new();
        let mut at = self.problem.order();
        loop {
            match self.follow(&mut at)? {
                Progress::Complete => self.solve_case()?,
                Progress::Empty => {}
                Progress::Undecided(pieces) => {
                    let (tears, bounds) = (self.tears.clone(), self.bounds.len());
                    open.push(Choice { at, next: pieces.start, pieces, tears, bounds });
                }
            }
            if !self.next_case(&mut open, &mut at)? {
                return Ok(());
            }
        }
    }

    /// Enters the next case that does not have empty intervals. `false` if there is none.
    fn next_case(&mut self, open: &mut Vec<Choice>, at: &mut usize) -> Result<bool, Solutions> {
        while let Some(choice) = open.last_mut() {
            if choice.next == choice.pieces.end {
                open.pop();
                continue;
            }
            self.cases += 1;
            let width = self.problem.order() + 1;
            if self.cases > MAX_CASES.min(MAX_WORK / (width * width)) {
                return Err(Solutions::TooManyPieces);
            }
            self.tears.copy_from_slice(&choice.tears);
            self.bounds.truncate(choice.bounds);
            *at = choice.at;
            let piece = choice.next;
            choice.next += 1;
            let pieces = choice.pieces.clone();
            if self.enter(*at, piece, &pieces) {
                *at += 1;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Follows operations until the end or an undecided choice.
    fn follow(&mut self, at: &mut usize) -> Result<Progress, Solutions> {
        while *at < self.completes.len() {
            let pieces = self.pieces(self.forms.op(*at))?;
            if pieces.len() > 1 {
                return Ok(Progress::Undecided(pieces));
            }
            if !self.enter(*at, pieces.start, &pieces) {
                return Ok(Progress::Empty);
            }
            *at += 1;
        }
        Ok(Progress::Complete)
    }

    /// The pieces of an operation that the intervals of the tears leave.
    ///
    /// # Errors
    /// If its test is not a number.
    fn pieces(&self, op: Op) -> Result<Range<usize>, Solutions> {
        let pieces = match op {
            Op::Table(table, at) => self.segments(table, at),
            _ => self.forms.sign_test(op).map_or(0..1, |test| pieces_of_sign(range(&test, &self.tears))),
        };
        if pieces.is_empty() { Err(Solutions::NotANumber) } else { Ok(pieces) }
    }

    /// The segments of a table that the abscissa can reach.
    fn segments(&self, table: u32, at: Register) -> Range<usize> {
        let points = &self.problem.program.tables[table as usize];
        let range = range(&self.forms.get(at), &self.tears);
        if range.low.is_nan() || range.high.is_nan() {
            return 0..0;
        }
        let first = points.partition_point(|point| point[0] <= range.low);
        let last = points.partition_point(|point| point[0] < range.high).max(first);
        first..last + 1
    }

    /// Computes an operation in one of the pieces that the intervals leave. `false` if no voltages are left.
    fn enter(&mut self, at: usize, piece: usize, pieces: &Range<usize>) -> bool {
        let op = self.forms.op(at);
        let form = self.forms.piece(op, piece);
        let tests = if pieces.len() > 1 { self.forms.tests(op, piece) } else { Vec::new() };
        let bounds = tests.into_iter().filter(|test| pieces.contains(&test.beyond));
        let count = self.bounds.len();
        self.bounds.extend(bounds.map(|test| Bound { form: test.form, is_equation: false }));
        self.forms.set(at, &form);
        if let Some(tear) = self.completes[at] {
            let mut form = form;
            form[tear] -= 1.0;
            self.bounds.push(Bound { form, is_equation: true });
        } else if self.bounds.len() == count {
            return true;
        }
        self.narrow()
    }

    /// Narrows the intervals of the tears by the bounds, first by the last one. `false` if one becomes empty.
    fn narrow(&mut self) -> bool {
        for _ in 0..MAX_SWEEPS {
            let before = self.tears.iter().map(|tear| tear.width()).sum::<f64>();
            if !self.bounds.iter().rev().all(|bound| narrow_by(bound, &mut self.tears)) {
                return false;
            }
            let after = self.tears.iter().map(|tear| tear.width()).sum::<f64>();
            if after > 0.9 * before {
                break;
            }
        }
        true
    }

    /// Adds the solution of the linear equations of the present case, if it is within the intervals and bounds.
    fn solve_case(&mut self) -> Result<(), Solutions> {
        let order = self.problem.order();
        let (rows, mut sides) = self.forms.equations();
        if rows.iter().chain(&sides).any(|entry| entry.is_nan()) {
            return Err(Solutions::NotANumber);
        }
        if let Some(factors) = Factors::new(&rows, order) {
            factors.solve(&mut sides);
            if self.is_inside(&sides) {
                self.found.add(sides);
            }
            return Ok(());
        }
        match feasible(&rows, &sides, &self.tears, &self.bounds) {
            Feasible::Nothing => Ok(()),
            Feasible::Point(tears) => {
                self.found.add(tears);
                Ok(())
            }
            Feasible::Range => Err(Solutions::Range),
        }
    }

    /// Whether the tears are within their intervals and bounds, up to rounding.
    fn is_inside(&self, tears: &[f64]) -> bool {
        let is_within = |(tear, interval): (&f64, &Interval)| {
            *tear >= interval.low - SLACK && *tear <= interval.high + SLACK
        };
        tears.iter().zip(&self.tears).all(is_within)
            && self
                .bounds
                .iter()
                .all(|bound| bound.is_equation || value(&bound.form, tears) >= -slack(&bound.form))
    }
}

/// The pieces that the range of a test leaves; none if it is not a number.
fn pieces_of_sign(test: Interval) -> Range<usize> {
    if test.low >= 0.0 {
        0..1
    } else if test.high <= 0.0 {
        1..2
    } else if test.low.is_nan() || test.high.is_nan() {
        0..0
    } else {
        0..2
    }
}

/// The range of an affine form over intervals of the tears.
fn range(form: &[f64], tears: &[Interval]) -> Interval {
    let constant = form[tears.len()];
    let (mut low, mut high) = (constant, constant);
    for (slope, tear) in form.iter().zip(tears).filter(|(slope, _)| **slope != 0.0) {
        let ends = [slope * tear.low, slope * tear.high];
        low += ends[0].min(ends[1]);
        high += ends[0].max(ends[1]);
    }
    Interval::new(low, high)
}

/// Margin for rounding of an affine form of voltages up to 100 V.
pub(super) fn slack(form: &[f64]) -> f64 {
    let (constant, slopes) = form.split_last().unwrap_or((&0.0, &[]));
    let terms = constant.abs() + REFERENCE * slopes.iter().map(|slope| slope.abs()).sum::<f64>();
    SLACK + RELATIVE_SLACK * terms
}

/// Narrows the intervals of the tears by a bound: each to what the others leave. `false` if one becomes empty.
fn narrow_by(bound: &Bound, tears: &mut [Interval]) -> bool {
    let order = tears.len();
    let margin = slack(&bound.form);
    for position in 0..order {
        let slope = bound.form[position];
        if slope == 0.0 {
            continue;
        }
        let all = range(&bound.form, tears);
        let own = [slope * tears[position].low, slope * tears[position].high];
        // The other terms are between `low` and `high`: slope x tear >= - high, and <= - low in an equation.
        let (low, high) = (all.low - own[0].min(own[1]), all.high - own[0].max(own[1]));
        let least = (-high - margin) / slope;
        let most = if bound.is_equation { (-low + margin) / slope } else { f64::INFINITY.copysign(slope) };
        let (below, above) = (least.min(most), least.max(most));
        let tear = &mut tears[position];
        *tear = Interval::new(tear.low.max(below), tear.high.min(above));
        if tear.low > tear.high {
            return false;
        }
    }
    let all = range(&bound.form, tears);
    all.high >= -margin && (!bound.is_equation || all.low <= margin)
}
