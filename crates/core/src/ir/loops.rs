//! Loops without an integrator: finds all solutions for the tear.
//!
//! A loop of straight elements is a piecewise linear function of its tear. The search walks from -100 V to 100 V, one
//! linear piece at a time. On each piece it computes where the recomputed output equals the tear. A loop with curved
//! elements goes to the search in `curved`.
//!
//! A loop must have exactly one solution. If it has none or several, the patch is refused or the run stops.

use super::evaluate::Scratch;
use super::linear_piece::{LinearPiece, MIN_PIECE};
use super::number::Number;
use super::op::{Op, Sources};
use super::{Program, curved};
use crate::machines::REFERENCE;

/// A loop that does not have exactly one solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LoopFault {
    /// Index of the loop.
    pub index: usize,
    /// What was found instead.
    pub solutions: Solutions,
}

/// The voltages of the tear that solve a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Solutions {
    /// The number of solutions and the first of them, in volts.
    Counted { count: usize, first: [f64; MAX_LISTED] },
    /// A continuous range of voltages.
    Range,
    /// A voltage in the loop is not a number.
    NotANumber,
    /// The loop has more pieces than the search examines.
    TooManyPieces,
}

/// The reason why a walk along linear pieces ends early.
enum Obstacle {
    /// The loop contains a curved element. Or an inner loop does not have exactly one solution for every voltage of
    /// the outer tear.
    Curve,
    /// The loop has no usable solution.
    Fault(Solutions),
}

/// Maximum number of linear pieces of a loop. More would take too long in every evaluation.
const MAX_PIECES: usize = 10_000;
/// Number of solutions that messages list.
const MAX_LISTED: usize = 4;
/// Solutions that differ by less than this, in volts, count as one.
pub(super) const SOLUTION_SPACING: f64 = 1e-6;
/// A piece whose slope differs from 1 by less than this is parallel to the tear: it has no solution or every voltage
/// solves it.
const UNIT_SLOPE_TOLERANCE: f64 = 1e-12;

/// The voltage of the tear that solves a loop. If there is not exactly one, the result is NaN and the fault is added
/// to the scratch.
pub(super) fn solve_tear(
    program: &Program,
    index: usize,
    from: &Sources<'_, f64>,
    registers: &[f64],
    scratch: &mut Scratch,
) -> f64 {
    let mut walker = Walker::new(program, index, from, registers, &mut scratch.pieces);
    let found = match walker.walk(index, walker.origin) {
        Ok(found) => found.only().map_err(|solutions| LoopFault { index, solutions }),
        Err(Obstacle::Fault(solutions)) => Err(LoopFault { index, solutions }),
        Err(Obstacle::Curve) => curved::search(program, index, from, registers, &mut scratch.intervals),
    };
    found.unwrap_or_else(|fault| {
        scratch.faults.push(fault);
        f64::NAN
    })
}

/// A tear that increases from this voltage.
fn moving(volts: f64) -> LinearPiece {
    LinearPiece { slope: 1.0, ..LinearPiece::constant(volts) }
}

/// Varies the tear of a loop, and the tears of the loops inside it.
struct Walker<'a> {
    /// The program that contains the loop.
    program: &'a Program,
    /// What operations read in addition to registers.
    from: &'a Sources<'a, f64>,
    /// Voltages outside the outermost loop.
    registers: &'a [f64],
    /// Register of the outermost tear. The registers from here on are in `pieces`.
    origin: usize,
    /// Pieces of the registers from `origin` on, in the present evaluation.
    pieces: &'a mut [LinearPiece],
}

impl<'a> Walker<'a> {
    /// A walker along the loop with this index. `pieces` has an entry for every register of the body.
    fn new(
        program: &'a Program,
        index: usize,
        from: &'a Sources<'a, f64>,
        registers: &'a [f64],
        pieces: &'a mut [LinearPiece],
    ) -> Self {
        Walker { program, from, registers, origin: program.lowered.loops[index].tear.index(), pieces }
    }

    /// Finds the solutions of a loop from left to right, one piece at a time. Registers below `frozen` are constant.
    fn walk(&mut self, index: usize, frozen: usize) -> Result<SolutionSet, Obstacle> {
        let (mut begin, mut probe) = (-REFERENCE, -REFERENCE);
        let mut found = SolutionSet::default();
        for _ in 0..MAX_PIECES {
            let result = self.follow(index, moving(probe), frozen)?;
            let end = (probe + result.reach).min(REFERENCE);
            match intersection(result, probe) {
                Intersection::Everywhere => return Err(Obstacle::Fault(Solutions::Range)),
                Intersection::At(tear)
                    if tear >= begin - SOLUTION_SPACING && tear <= end + SOLUTION_SPACING =>
                {
                    found.add(tear)
                }
                _ => {}
            }
            if end >= REFERENCE {
                return Ok(found);
            }
            begin = end;
            probe = end.max(probe) + MIN_PIECE;
        }
        Err(Obstacle::Fault(Solutions::TooManyPieces))
    }

    /// The recomputed output for a tear. Reports an obstacle if it is not a linear piece.
    fn follow(&mut self, index: usize, tear: LinearPiece, frozen: usize) -> Result<LinearPiece, Obstacle> {
        let program = self.program;
        let entry = &program.lowered.loops[index];
        self.pieces[entry.tear.index()] = tear;
        for at in entry.tear.index() + 1..=entry.result.index() {
            self.pieces[at] = match program.lowered.body[at] {
                Op::Tear(inner) => self.inner_tear(inner as usize, frozen)?,
                op => apply_inside(op, self.from, |register| self.get(register, frozen)),
            };
        }
        let result = self.pieces[entry.result.index()];
        match result {
            LinearPiece { is_straight: false, .. } => Err(Obstacle::Curve),
            LinearPiece { value, slope, .. } if value.is_nan() || slope.is_nan() => {
                Err(Obstacle::Fault(Solutions::NotANumber))
            }
            _ => Ok(result),
        }
    }

    /// A register as a linear piece; those outside the loop and those below `frozen` are constant.
    fn get(&self, register: usize, frozen: usize) -> LinearPiece {
        if register < self.origin {
            LinearPiece::constant(self.registers[register])
        } else if register < frozen {
            LinearPiece::constant(self.pieces[register].value)
        } else {
            self.pieces[register]
        }
    }

    /// The tear of an inner loop as a function of the outer tear. The slope follows from dy = dF / (1 - dF/dy).
    fn inner_tear(&mut self, index: usize, frozen: usize) -> Result<LinearPiece, Obstacle> {
        let tear = self.program.lowered.loops[index].tear.index();
        let inner = self.walk(index, tear).ok().and_then(|found| found.only().ok());
        let solution = inner.ok_or(Obstacle::Curve)?;
        let by_itself = self.follow(index, moving(solution), tear)?.slope;
        let by_the_outer = self.follow(index, LinearPiece::constant(solution), frozen)?.slope;
        Ok(LinearPiece { slope: by_the_outer / (1.0 - by_itself), ..LinearPiece::constant(solution) })
    }
}

/// The slope of a tear y = F(y, x): dy = dF (at constant y) / (1 - dF/dy). `slope_with` returns the slope of F for a
/// slope of the tear.
pub(super) fn closing_slope(mut slope_with: impl FnMut(f64) -> f64) -> f64 {
    let (by_the_rest, by_both) = (slope_with(0.0), slope_with(1.0));
    by_the_rest / (1.0 - (by_both - by_the_rest))
}

/// Where a piece equals the tear.
enum Intersection {
    /// It is parallel to the tear, at a distance.
    Nowhere,
    /// At this voltage.
    At(f64),
    /// It is identical with the tear.
    Everywhere,
}

/// The voltage at which a linear piece that starts at `probe` equals the tear.
fn intersection(result: LinearPiece, probe: f64) -> Intersection {
    let (gap, steepness) = (result.value - probe, 1.0 - result.slope);
    if steepness.abs() > UNIT_SLOPE_TOLERANCE {
        return Intersection::At(probe + gap / steepness);
    }
    if gap.abs() < MIN_PIECE { Intersection::Everywhere } else { Intersection::Nowhere }
}

/// The solutions found so far, in ascending order.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SolutionSet {
    /// Number of solutions.
    count: usize,
    /// The first solutions, in volts.
    first: [f64; MAX_LISTED],
    /// The last solution.
    last: Option<f64>,
}

impl SolutionSet {
    /// Adds a solution, unless the previous piece ended with the same one.
    pub(super) fn add(&mut self, tear: f64) {
        if self.last.is_some_and(|last| (tear - last).abs() <= SOLUTION_SPACING) {
            return;
        }
        if let Some(entry) = self.first.get_mut(self.count) {
            *entry = tear;
        }
        self.count += 1;
        self.last = Some(tear);
    }

    /// The number of solutions and the first of them.
    pub(super) fn solutions(self) -> Solutions {
        Solutions::Counted { count: self.count, first: self.first }
    }

    /// The only solution. The error has the solutions that were found.
    ///
    /// # Errors
    /// If there is no solution, or more than one.
    pub(super) fn only(self) -> Result<f64, Solutions> {
        if self.count == 1 { Ok(self.first[0]) } else { Err(self.solutions()) }
    }
}

/// Evaluates an operation inside a loop in another number type. Values from outside the loop are constants.
pub(super) fn apply_inside<N: Number>(op: Op, from: &Sources<'_, f64>, get: impl Fn(usize) -> N) -> N {
    match op {
        Op::Constant(_)
        | Op::Coefficient(_)
        | Op::State(_)
        | Op::Mode(_)
        | Op::Time
        | Op::Delayed(_)
        | Op::Sampled(_)
        | Op::Level(_) => N::constant(op.apply(from, |_| f64::NAN)),
        Op::Table(index, at) => get(at.index()).table(&from.tables[index as usize]),
        _ => op.apply(&Sources::none(), |register| get(register.index())),
    }
}
