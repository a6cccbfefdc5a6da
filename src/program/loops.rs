//! Loops without an integrator: every solution of the tear, found by walking its straight pieces.

use super::Program;
use super::evaluate::Scratch;
use super::number::Number;
use super::op::{Op, Sources};
use super::piece::{LEAST_PIECE, Piece};
use crate::machines::REFERENCE;

/// A loop that has not exactly one solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LoopFault {
    /// Index of the loop.
    pub index: usize,
    pub solutions: Solutions,
}

/// The tear voltages that close a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Solutions {
    /// These many; the first few are kept.
    Counted { count: usize, first: [f64; KEPT] },
    /// A whole range of voltages.
    Range,
    /// Cannot be told: an element of the loop is not made of straight pieces.
    NotStraight,
    /// A voltage of the loop is not a number.
    NotANumber,
    /// More straight pieces than can be walked.
    TooManyPieces,
}

/// More pieces than this would take too long at every evaluation.
const MOST_PIECES: usize = 10_000;
/// How many solutions are told one by one.
const KEPT: usize = 4;
/// Solutions nearer to each other than this, in volts, are one.
const APART: f64 = 1e-6;
/// Slopes nearer to 1 than this make the tear follow itself.
const FOLLOWS: f64 = 1e-12;

/// The tear that closes a loop. Where there is not exactly one, NaN, and the scratch says why.
pub(super) fn solve_tear(
    program: &Program,
    index: usize,
    from: &Sources<'_, f64>,
    registers: &[f64],
    scratch: &mut Scratch,
) -> f64 {
    let mut walker = Walker::new(program, index, from, registers, &mut scratch.pieces);
    let solutions = walker.walk(index, walker.origin);
    if let Solutions::Counted { count: 1, first } = solutions {
        return first[0];
    }
    scratch.faults.push(LoopFault { index, solutions });
    f64::NAN
}

/// How steeply a loop's result follows its tear at a solution.
pub(super) fn tear_slope(
    program: &Program,
    index: usize,
    from: &Sources<'_, f64>,
    registers: &[f64],
    solution: f64,
    scratch: &mut Scratch,
) -> f64 {
    let mut walker = Walker::new(program, index, from, registers, &mut scratch.pieces);
    let result = walker.follow(index, moving(solution), walker.origin);
    result.map_or(f64::NAN, |piece| piece.slope)
}

/// A tear that moves to the right.
fn moving(volts: f64) -> Piece {
    Piece { slope: 1.0, ..Piece::constant(volts) }
}

/// Moves the tear of a loop, and those of the loops inside it.
struct Walker<'a> {
    program: &'a Program,
    from: &'a Sources<'a, f64>,
    /// Voltages from outside the outermost loop.
    registers: &'a [f64],
    /// The tear of the outermost loop: from here on voltages are in `pieces`.
    origin: usize,
    pieces: &'a mut [Piece],
}

impl<'a> Walker<'a> {
    fn new(
        program: &'a Program,
        index: usize,
        from: &'a Sources<'a, f64>,
        registers: &'a [f64],
        pieces: &'a mut [Piece],
    ) -> Self {
        Walker { program, from, registers, origin: program.loops[index].tear.index(), pieces }
    }

    /// Goes through a tear's range from left to right, piece by piece; what stands before `frozen` stays.
    fn walk(&mut self, index: usize, frozen: usize) -> Solutions {
        let (mut begin, mut probe) = (-REFERENCE, -REFERENCE);
        let mut found = Found::default();
        for _ in 0..MOST_PIECES {
            let result = match self.follow(index, moving(probe), frozen) {
                Ok(result) => result,
                Err(solutions) => return solutions,
            };
            let end = (probe + result.reach).min(REFERENCE);
            match crossing(result, probe) {
                Crossing::Everywhere => return Solutions::Range,
                Crossing::At(tear) if tear >= begin - APART && tear <= end + APART => found.add(tear),
                _ => {}
            }
            if end >= REFERENCE {
                return Solutions::Counted { count: found.count, first: found.first };
            }
            begin = end;
            probe = end.max(probe) + LEAST_PIECE;
        }
        Solutions::TooManyPieces
    }

    /// The loop's result for a tear; an error where it is not a straight piece.
    fn follow(&mut self, index: usize, tear: Piece, frozen: usize) -> Result<Piece, Solutions> {
        let program = self.program;
        let entry = &program.loops[index];
        self.pieces[entry.tear.index()] = tear;
        for at in entry.tear.index() + 1..=entry.result.index() {
            self.pieces[at] = match program.body[at] {
                Op::Tear(inner) => self.inner_tear(inner as usize, frozen)?,
                op => piece(op, self.from, |register| self.get(register, frozen)),
            };
        }
        let result = self.pieces[entry.result.index()];
        match result {
            Piece { straight: false, .. } => Err(Solutions::NotStraight),
            Piece { value, slope, .. } if value.is_nan() || slope.is_nan() => Err(Solutions::NotANumber),
            _ => Ok(result),
        }
    }

    fn get(&self, register: usize, frozen: usize) -> Piece {
        if register < self.origin {
            Piece::constant(self.registers[register])
        } else if register < frozen {
            Piece::constant(self.pieces[register].value)
        } else {
            self.pieces[register]
        }
    }

    /// The tear of a loop inside this one, and how it moves with the outer: dy = dF / (1 - dF/dy).
    fn inner_tear(&mut self, index: usize, frozen: usize) -> Result<Piece, Solutions> {
        let own = self.program.loops[index].tear.index();
        let solution = match self.walk(index, own) {
            Solutions::Counted { count: 1, first } => first[0],
            other => return Err(other),
        };
        let by_itself = self.follow(index, moving(solution), own)?.slope;
        let by_the_outer = self.follow(index, Piece::constant(solution), frozen)?.slope;
        Ok(Piece { slope: by_the_outer / (1.0 - by_itself), ..Piece::constant(solution) })
    }
}

enum Crossing {
    Nowhere,
    At(f64),
    Everywhere,
}

/// Where a straight piece through `probe` meets the tear itself.
fn crossing(result: Piece, probe: f64) -> Crossing {
    let (gap, steepness) = (result.value - probe, 1.0 - result.slope);
    if steepness.abs() > FOLLOWS {
        return Crossing::At(probe + gap / steepness);
    }
    if gap.abs() < LEAST_PIECE { Crossing::Everywhere } else { Crossing::Nowhere }
}

#[derive(Default)]
struct Found {
    count: usize,
    first: [f64; KEPT],
    last: Option<f64>,
}

impl Found {
    /// Counts a solution, unless it is the last one seen from the next piece.
    fn add(&mut self, tear: f64) {
        if self.last.is_some_and(|last| (tear - last).abs() <= APART) {
            return;
        }
        if let Some(place) = self.first.get_mut(self.count) {
            *place = tear;
        }
        self.count += 1;
        self.last = Some(tear);
    }
}

/// One operation inside a loop: what it reads from outside stands still.
fn piece(op: Op, from: &Sources<'_, f64>, get: impl Fn(usize) -> Piece) -> Piece {
    match op {
        Op::Constant(_) | Op::Coefficient(_) | Op::State(_) | Op::Mode(_) | Op::Time | Op::Delayed(_) => {
            Piece::constant(op.apply(from, |_| f64::NAN))
        }
        Op::Table(index, at) => get(at.index()).table(&from.tables[index as usize]),
        _ => op.apply(&STILL, |register| get(register.index())),
    }
}

/// For operations that read registers alone.
const STILL: Sources<'static, Piece> = Sources {
    parameters: &[],
    coefficients: &[],
    states: &[],
    modes: &[],
    time: Piece { value: 0.0, slope: 0.0, reach: f64::INFINITY, straight: true },
    tables: &[],
    delayed: &[],
};
