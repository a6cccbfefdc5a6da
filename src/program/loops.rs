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
}

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
    let solutions = walk(program, index, from, registers, &mut scratch.pieces);
    if let Solutions::Counted { count: 1, first } = solutions {
        return first[0];
    }
    scratch.fault = scratch.fault.or(Some(LoopFault { index, solutions }));
    f64::NAN
}

/// How steeply a loop's result follows its tear at a solution.
pub(super) fn tear_slope(
    program: &Program,
    index: usize,
    from: &Sources<'_, f64>,
    registers: &mut [f64],
    solution: f64,
    scratch: &mut Scratch,
) -> f64 {
    follow(program, index, from, registers, solution, &mut scratch.pieces).slope
}

/// Goes through the tear's range from left to right, piece by piece.
fn walk(
    program: &Program,
    index: usize,
    from: &Sources<'_, f64>,
    registers: &[f64],
    pieces: &mut [Piece],
) -> Solutions {
    let (mut begin, mut probe) = (-REFERENCE, -REFERENCE);
    let mut found = Found::default();
    loop {
        let result = follow(program, index, from, registers, probe, pieces);
        if !result.straight {
            return Solutions::NotStraight;
        }
        if result.value.is_nan() || result.slope.is_nan() {
            return Solutions::NotANumber;
        }
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

/// The loop's result when the tear stands at `probe` and moves to the right.
fn follow(
    program: &Program,
    index: usize,
    from: &Sources<'_, f64>,
    registers: &[f64],
    probe: f64,
    pieces: &mut [Piece],
) -> Piece {
    let entry = &program.loops[index];
    let first = entry.tear.index();
    pieces[first] = Piece { slope: 1.0, ..Piece::constant(probe) };
    for at in first + 1..=entry.result.index() {
        pieces[at] = piece(program.body[at], from, |register: usize| {
            if register >= first { pieces[register] } else { Piece::constant(registers[register]) }
        });
    }
    pieces[entry.result.index()]
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
