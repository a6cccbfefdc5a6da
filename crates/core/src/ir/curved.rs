//! Loops with curved elements: finds all solutions for the tear by interval bisection.
//!
//! The interval from -100 V to 100 V is halved repeatedly. The loop is evaluated on each part with interval
//! arithmetic. A part that cannot contain a solution is discarded. Adjacent parts that remain at the smallest width
//! count as one candidate. A change of sign of the residual confirms it, and bisection then finds the solution.

use super::Program;
use super::interval::Interval;
use super::loops::{LoopFault, SOLUTION_SPACING, SolutionSet, Solutions, apply_inside};
use super::number::Number;
use super::op::{Op, Sources};
use crate::machines::REFERENCE;

/// Maximum number of evaluations of a loop, including inner loops, before the search is given up.
const MAX_EVALUATIONS: usize = 100_000;
/// Width, in volts, at which intervals are no longer halved. Adjacent ones that remain contain one solution.
const MIN_WIDTH: f64 = 1e-7;
/// Margin for rounding between the tear and the recomputed output, in volts.
const RESULT_SLACK: f64 = 1e-9;
/// Smallest width at which the tear of an inner loop is searched, as a share of the outer interval's width.
const INNER_WIDTH_SHARE: f64 = 1.0 / 8.0;
/// If the evaluations are used up by a candidate wider than this, in volts, every voltage in it solves the loop.
const RANGE_WIDTH: f64 = 1e-3;

/// The voltage of the tear that solves a loop.
///
/// # Errors
/// If the loop, or a loop inside it, does not have exactly one solution.
pub(super) fn search(
    program: &Program,
    index: usize,
    from: &Sources<'_, f64>,
    registers: &[f64],
    intervals: &mut [Interval],
) -> Result<f64, LoopFault> {
    let origin = program.lowered.loops[index].tear.index();
    Search { program, from, registers, origin, intervals, evaluations: 0 }.only_solution(index)
}

/// The search for the solutions of one outermost loop.
struct Search<'a> {
    /// The program that contains the loop.
    program: &'a Program,
    /// What operations read in addition to registers.
    from: &'a Sources<'a, f64>,
    /// Voltages outside the outermost loop.
    registers: &'a [f64],
    /// Register of the outermost tear. The registers from here on are in `intervals`.
    origin: usize,
    /// Intervals of the registers from `origin` on, in the present evaluation.
    intervals: &'a mut [Interval],
    /// Number of evaluations so far.
    evaluations: usize,
}

/// Intervals that may contain solutions, in ascending order. Adjacent ones are merged.
#[derive(Default)]
struct Candidates {
    /// The candidate that may still grow.
    last: Option<Interval>,
    /// The solutions in the candidates before it.
    found: SolutionSet,
}

impl Search<'_> {
    /// The only solution of a loop. If there is not exactly one, the fault says what was found.
    fn only_solution(&mut self, index: usize) -> Result<f64, LoopFault> {
        self.solutions(index)?.only().map_err(|solutions| LoopFault { index, solutions })
    }

    /// All solutions of a loop, in ascending order.
    fn solutions(&mut self, index: usize) -> Result<SolutionSet, LoopFault> {
        let mut candidates = Candidates::default();
        let narrowed = self.narrow(index, TEAR_INTERVAL, MIN_WIDTH, &mut |search, interval| {
            search.add_candidate(index, interval, &mut candidates)
        });
        let is_wide = candidates.last.is_some_and(|last| last.width() > RANGE_WIDTH);
        narrowed.map_err(|fault| match fault.solutions {
            Solutions::TooManyPieces if is_wide => LoopFault { index, solutions: Solutions::Range },
            _ => fault,
        })?;
        if let Some(last) = candidates.last {
            self.bisect(index, last, &mut candidates.found)?;
        }
        Ok(candidates.found)
    }

    /// Passes the intervals of at most this width that may contain a solution to `keep`, in ascending order.
    fn narrow(
        &mut self,
        index: usize,
        tear: Interval,
        min_width: f64,
        keep: &mut dyn FnMut(&mut Self, Interval) -> Result<(), LoopFault>,
    ) -> Result<(), LoopFault> {
        let result = self.follow(index, tear)?;
        let interval =
            Interval::new(tear.low.max(result.low - RESULT_SLACK), tear.high.min(result.high + RESULT_SLACK));
        if interval.low > interval.high {
            return Ok(());
        }
        if interval.width() <= min_width {
            return keep(self, interval);
        }
        let middle = interval.middle();
        self.narrow(index, Interval::new(interval.low, middle), min_width, keep)?;
        self.narrow(index, Interval::new(middle, interval.high), min_width, keep)
    }

    /// Adds an interval to the candidates. If it does not touch the last candidate, that one is complete and is
    /// bisected.
    fn add_candidate(
        &mut self,
        index: usize,
        interval: Interval,
        candidates: &mut Candidates,
    ) -> Result<(), LoopFault> {
        match &mut candidates.last {
            Some(last) if interval.low - last.high <= SOLUTION_SPACING => *last = last.hull(interval),
            last => {
                if let Some(done) = last.replace(interval) {
                    self.bisect(index, done, &mut candidates.found)?;
                }
            }
        }
        Ok(())
    }

    /// Adds the solution in a candidate interval, if the residual changes its sign there. Modes are constant, so the
    /// loop is continuous and a change of sign always is a solution.
    fn bisect(&mut self, index: usize, interval: Interval, found: &mut SolutionSet) -> Result<(), LoopFault> {
        let (mut low, mut high) = (
            (interval.low - SOLUTION_SPACING).max(TEAR_INTERVAL.low),
            (interval.high + SOLUTION_SPACING).min(TEAR_INTERVAL.high),
        );
        let (mut above, mut below) = (self.residual(index, low)?, self.residual(index, high)?);
        if above * below > 0.0 {
            return Ok(());
        }
        while above != 0.0 && below != 0.0 {
            let middle = Interval::new(low, high).middle();
            if middle <= low || middle >= high {
                break;
            }
            let residual = self.residual(index, middle)?;
            if residual * above > 0.0 {
                (low, above) = (middle, residual)
            } else {
                (high, below) = (middle, residual)
            }
        }
        found.add(if above.abs() < below.abs() { low } else { high });
        Ok(())
    }

    /// The recomputed output minus the tear, in volts; 0 at a solution.
    fn residual(&mut self, index: usize, tear: f64) -> Result<f64, LoopFault> {
        let residual = self.follow(index, Interval::constant(tear))?.low - tear;
        let solutions = Solutions::NotANumber;
        if residual.is_nan() { Err(LoopFault { index, solutions }) } else { Ok(residual) }
    }

    /// The recomputed output for an interval of the tear.
    fn follow(&mut self, index: usize, tear: Interval) -> Result<Interval, LoopFault> {
        self.evaluations += 1;
        if self.evaluations > MAX_EVALUATIONS {
            return Err(LoopFault { index, solutions: Solutions::TooManyPieces });
        }
        let program = self.program;
        let entry = &program.lowered.loops[index];
        self.intervals[entry.tear.index()] = tear;
        for at in entry.tear.index() + 1..=entry.result.index() {
            self.intervals[at] = match program.lowered.body[at] {
                Op::Tear(inner) => self.inner_tear(inner as usize, tear.width())?,
                op => apply_inside(op, self.from, |register| self.get(register)),
            };
        }
        Ok(self.intervals[entry.result.index()])
    }

    /// A register as an interval; those outside the loop are points.
    fn get(&self, register: usize) -> Interval {
        if register < self.origin {
            Interval::constant(self.registers[register])
        } else {
            self.intervals[register]
        }
    }

    /// All voltages that the tear of an inner loop can have while the outer tear varies within an interval of this
    /// width.
    fn inner_tear(&mut self, index: usize, width: f64) -> Result<Interval, LoopFault> {
        if width == 0.0 {
            return self.only_solution(index).map(Interval::constant);
        }
        let mut all: Option<Interval> = None;
        self.narrow(index, TEAR_INTERVAL, MIN_WIDTH.max(width * INNER_WIDTH_SHARE), &mut |_, interval| {
            all = Some(all.map_or(interval, |all| all.hull(interval)));
            Ok(())
        })?;
        all.ok_or_else(|| LoopFault { index, solutions: SolutionSet::default().solutions() })
    }
}

/// The voltages that a tear can have.
const TEAR_INTERVAL: Interval = Interval { low: -REFERENCE, high: REFERENCE };
