//! Straight loops: finds all solutions by enumerating the linear pieces of the loop.
//!
//! Every operation of a straight loop is an affine form of the tears, up to the choice that a limit, a diode or a table
//! makes. The search follows the operations. Where the voltages of the tears do not decide a choice, it tries each
//! case. A case bounds an affine form, which narrows the intervals of the tears. So does the equation of every tear
//! whose output is complete. A case whose intervals are empty is abandoned. At the end of the operations a system of
//! linear equations remains.

use super::interval::Interval;
use super::matrix::Factors;
use super::singular::{Feasible, feasible};
use super::{Problem, SolutionSet, Solutions};
use crate::ir::number::segment_after;
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

/// A choice with the cases that were not tried yet.
struct Choice {
    /// Index of the operation, counted from the first tear.
    at: usize,
    /// The next case.
    next: usize,
    /// Number of cases.
    count: usize,
    /// The intervals of the tears before the choice.
    tears: Vec<Interval>,
    /// Number of bounds before the choice.
    bounds: usize,
}

/// How far the operations were followed.
enum Progress {
    /// To the end.
    Complete,
    /// To an operation with this number of cases.
    Undecided(usize),
    /// The intervals are empty.
    Empty,
}

/// The enumeration.
struct Search<'a> {
    /// The loop.
    problem: &'a Problem<'a>,
    /// Affine forms of the tears and operations. Each has `order` coefficients and then the constant.
    forms: Vec<f64>,
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
        let mut forms = vec![0.0; span * (order + 1)];
        let mut completes = vec![None; span];
        for (position, tear) in problem.entry.tears.iter().enumerate() {
            forms[position * (order + 1) + position] = 1.0;
            if let Some(inner) = tear.result.index().checked_sub(problem.outside.len()) {
                completes[inner] = Some(position);
            }
        }
        let tears = vec![Interval::new(-REFERENCE, REFERENCE); order];
        let found = SolutionSet::default();
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
                Progress::Undecided(count) => {
                    let (tears, bounds) = (self.tears.clone(), self.bounds.len());
                    open.push(Choice { at, next: 0, count, tears, bounds });
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
            if choice.next == choice.count {
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
            let case = choice.next;
            choice.next += 1;
            if self.enter(*at, case) {
                *at += 1;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Follows operations until the end or an undecided choice.
    fn follow(&mut self, at: &mut usize) -> Result<Progress, Solutions> {
        while *at < self.completes.len() {
            let op = self.op(*at);
            let cases = self.cases(op)?;
            if cases > 1 {
                return Ok(Progress::Undecided(cases));
            }
            if !self.enter(*at, 0) {
                return Ok(Progress::Empty);
            }
            *at += 1;
        }
        Ok(Progress::Complete)
    }

    /// The operation with this index, counted from the first tear.
    fn op(&self, at: usize) -> Op {
        self.problem.program.lowered.body[self.problem.outside.len() + at]
    }

    /// Number of cases of an operation that the intervals of the tears leave.
    fn cases(&self, op: Op) -> Result<usize, Solutions> {
        let count = match op {
            Op::Minimum(a, b) | Op::Maximum(a, b) => cases_of_sign(self.range(&self.difference(a, b))),
            Op::Absolute(a) => cases_of_sign(self.range(&self.form(a))),
            Op::Table(table, at) => self.segments(table, at).len(),
            _ => 1,
        };
        if count == 0 { Err(Solutions::NotANumber) } else { Ok(count) }
    }

    /// The segments of a table that the abscissa can reach. Segment n begins at point n - 1.
    fn segments(&self, table: u32, at: Register) -> std::ops::Range<usize> {
        let points = &self.problem.program.tables[table as usize];
        let range = self.range(&self.form(at));
        if range.low.is_nan() || range.high.is_nan() {
            return 0..0;
        }
        let first = points.partition_point(|point| point[0] <= range.low);
        let last = points.partition_point(|point| point[0] < range.high).max(first);
        first..last + 1
    }

    /// Computes an operation in one of its cases. `false` if the case leaves no voltages.
    fn enter(&mut self, at: usize, case: usize) -> bool {
        let op = self.op(at);
        let (form, bounds) = self.case(op, case);
        let width = self.problem.order() + 1;
        self.forms[at * width..(at + 1) * width].copy_from_slice(&form);
        let count = bounds.len();
        self.bounds.extend(bounds.into_iter().map(|form| Bound { form, is_equation: false }));
        if let Some(tear) = self.completes[at] {
            let mut form = form;
            form[tear] -= 1.0;
            self.bounds.push(Bound { form, is_equation: true });
        } else if count == 0 {
            return true;
        }
        self.narrow()
    }

    /// The affine form of an operation in one of its cases, and the forms that must not be negative there.
    fn case(&self, op: Op, case: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
        let plain = |form: Vec<f64>| (form, Vec::new());
        match op {
            Op::Add(a, b) => plain(combined(&self.form(a), 1.0, &self.form(b))),
            Op::Subtract(a, b) => plain(self.difference(a, b)),
            Op::Multiply(a, b) => plain(product(self.form(a), self.form(b))),
            Op::Divide(a, b) => {
                let divisor = self.form(b)[self.problem.order()];
                plain(self.form(a).iter().map(|term| term / divisor).collect())
            }
            Op::Minimum(a, b) => self.sign_case(case, self.difference(a, b), self.form(b), self.form(a)),
            Op::Maximum(a, b) => self.sign_case(case, self.difference(a, b), self.form(a), self.form(b)),
            Op::Absolute(a) => self.sign_case(case, self.form(a), self.form(a), scaled(&self.form(a), -1.0)),
            Op::Select { left, right, then, otherwise } => {
                let test = self.difference(left, right)[self.problem.order()];
                plain(self.form(if test >= 0.0 { then } else { otherwise }))
            }
            Op::Table(table, at) => self.segment_case(case, table, at),
            _ => plain(vec![f64::NAN; self.problem.order() + 1]),
        }
    }

    /// The form that applies if a test is not negative (case 0) or not positive (case 1). If the intervals decide the
    /// sign, there is only one case.
    fn sign_case(
        &self,
        case: usize,
        test: Vec<f64>,
        above: Vec<f64>,
        below: Vec<f64>,
    ) -> (Vec<f64>, Vec<Vec<f64>>) {
        let range = self.range(&test);
        if range.low >= 0.0 {
            (above, Vec::new())
        } else if range.high <= 0.0 {
            (below, Vec::new())
        } else if case == 0 {
            (above, vec![test])
        } else {
            (below, vec![scaled(&test, -1.0)])
        }
    }

    /// The form of a table on one of the segments that its abscissa can reach.
    fn segment_case(&self, case: usize, table: u32, at: Register) -> (Vec<f64>, Vec<Vec<f64>>) {
        let points = &self.problem.program.tables[table as usize];
        let segments = self.segments(table, at);
        let after = segments.start + case;
        let (value, slope, origin) = segment_after(points, after);
        let abscissa = self.form(at);
        let constant = self.problem.order();
        let mut form = scaled(&abscissa, slope);
        form[constant] += value - slope * origin;
        let mut bounds = Vec::new();
        if after > segments.start {
            let mut above = abscissa.clone();
            above[constant] -= points[after - 1][0];
            bounds.push(above);
        }
        if after + 1 < segments.end {
            let mut below = scaled(&abscissa, -1.0);
            below[constant] += points[after][0];
            bounds.push(below);
        }
        (form, bounds)
    }

    /// The affine form of a register.
    fn form(&self, register: Register) -> Vec<f64> {
        let width = self.problem.order() + 1;
        match register.index().checked_sub(self.problem.outside.len()) {
            Some(at) => self.forms[at * width..(at + 1) * width].to_vec(),
            None => {
                let mut form = vec![0.0; width];
                form[width - 1] = self.problem.outside[register.index()];
                form
            }
        }
    }

    /// The affine form a - b.
    fn difference(&self, a: Register, b: Register) -> Vec<f64> {
        combined(&self.form(a), -1.0, &self.form(b))
    }

    /// The range of an affine form over the present intervals.
    fn range(&self, form: &[f64]) -> Interval {
        range(form, &self.tears)
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
        let (mut rows, mut sides) = (Vec::with_capacity(order * order), Vec::with_capacity(order));
        for (position, tear) in self.problem.entry.tears.iter().enumerate() {
            let form = self.form(tear.result);
            rows.extend((0..order).map(|column| if column == position { 1.0 } else { 0.0 } - form[column]));
            sides.push(form[order]);
        }
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

/// Number of cases of a choice by the sign of a test; 0 if it is not a number.
fn cases_of_sign(test: Interval) -> usize {
    if test.low >= 0.0 || test.high <= 0.0 {
        1
    } else if test.low.is_nan() || test.high.is_nan() {
        0
    } else {
        2
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

/// The value of an affine form.
pub(super) fn value(form: &[f64], tears: &[f64]) -> f64 {
    form[tears.len()] + form.iter().zip(tears).map(|(slope, tear)| slope * tear).sum::<f64>()
}

/// Margin for rounding of an affine form of voltages up to 100 V.
pub(super) fn slack(form: &[f64]) -> f64 {
    let (constant, slopes) = form.split_last().unwrap_or((&0.0, &[]));
    let terms = constant.abs() + REFERENCE * slopes.iter().map(|slope| slope.abs()).sum::<f64>();
    SLACK + RELATIVE_SLACK * terms
}

/// a + factor b.
fn combined(a: &[f64], factor: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + factor * b).collect()
}

/// factor form.
fn scaled(form: &[f64], factor: f64) -> Vec<f64> {
    form.iter().map(|term| factor * term).collect()
}

/// The product of two forms, of which one is a constant.
fn product(a: Vec<f64>, b: Vec<f64>) -> Vec<f64> {
    let order = a.len() - 1;
    let is_constant = a[..order].iter().all(|slope| *slope == 0.0);
    if is_constant { scaled(&b, a[order]) } else { scaled(&a, b[order]) }
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
