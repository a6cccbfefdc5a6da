//! Loops without an integrator: every solution of the tear, found by walking its straight pieces, or by
//! narrowing down (`curved`) where it has curved ones.

use super::evaluate::Scratch;
use super::number::Number;
use super::op::{Op, Sources};
use super::piece::{LEAST_PIECE, Piece};
use super::{Program, curved};
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
    /// A voltage of the loop is not a number.
    NotANumber,
    /// More pieces than can be looked at.
    TooManyPieces,
}

/// Why a walk ends early.
enum Obstacle {
    /// An element of the loop is not made of straight pieces, or a loop inside it has not one solution all
    /// along this one's tear.
    Curve,
    Fault(Solutions),
}

/// More pieces than this would take too long at every evaluation.
const MOST_PIECES: usize = 10_000;
/// How many solutions are told one by one.
const KEPT: usize = 4;
/// Solutions nearer to each other than this, in volts, are one.
pub(super) const APART: f64 = 1e-6;
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
    let found = match walker.walk(index, walker.origin) {
        Ok(found) => found.only().map_err(|solutions| LoopFault { index, solutions }),
        Err(Obstacle::Fault(solutions)) => Err(LoopFault { index, solutions }),
        Err(Obstacle::Curve) => curved::search(program, index, from, registers, &mut scratch.ranges),
    };
    found.unwrap_or_else(|fault| {
        scratch.faults.push(fault);
        f64::NAN
    })
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
    fn walk(&mut self, index: usize, frozen: usize) -> Result<Found, Obstacle> {
        let (mut begin, mut probe) = (-REFERENCE, -REFERENCE);
        let mut found = Found::default();
        for _ in 0..MOST_PIECES {
            let result = self.follow(index, moving(probe), frozen)?;
            let end = (probe + result.reach).min(REFERENCE);
            match crossing(result, probe) {
                Crossing::Everywhere => return Err(Obstacle::Fault(Solutions::Range)),
                Crossing::At(tear) if tear >= begin - APART && tear <= end + APART => found.add(tear),
                _ => {}
            }
            if end >= REFERENCE {
                return Ok(found);
            }
            begin = end;
            probe = end.max(probe) + LEAST_PIECE;
        }
        Err(Obstacle::Fault(Solutions::TooManyPieces))
    }

    /// The loop's result for a tear; an error where it is not a straight piece.
    fn follow(&mut self, index: usize, tear: Piece, frozen: usize) -> Result<Piece, Obstacle> {
        let program = self.program;
        let entry = &program.loops[index];
        self.pieces[entry.tear.index()] = tear;
        for at in entry.tear.index() + 1..=entry.result.index() {
            self.pieces[at] = match program.body[at] {
                Op::Tear(inner) => self.inner_tear(inner as usize, frozen)?,
                op => moved(op, self.from, |register| self.get(register, frozen)),
            };
        }
        let result = self.pieces[entry.result.index()];
        match result {
            Piece { straight: false, .. } => Err(Obstacle::Curve),
            Piece { value, slope, .. } if value.is_nan() || slope.is_nan() => {
                Err(Obstacle::Fault(Solutions::NotANumber))
            }
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
    fn inner_tear(&mut self, index: usize, frozen: usize) -> Result<Piece, Obstacle> {
        let own = self.program.loops[index].tear.index();
        let inner = self.walk(index, own).ok().and_then(|found| found.only().ok());
        let solution = inner.ok_or(Obstacle::Curve)?;
        let by_itself = self.follow(index, moving(solution), own)?.slope;
        let by_the_outer = self.follow(index, Piece::constant(solution), frozen)?.slope;
        Ok(Piece { slope: by_the_outer / (1.0 - by_itself), ..Piece::constant(solution) })
    }
}

/// The slope of a tear y = F(y, rest): dy = (dF at fixed y) / (1 - dF/dy), from what F makes of a slope of the tear.
pub(super) fn closing_slope(mut slope_with: impl FnMut(f64) -> f64) -> f64 {
    let (by_the_rest, by_both) = (slope_with(0.0), slope_with(1.0));
    by_the_rest / (1.0 - (by_both - by_the_rest))
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

/// The solutions that a search from left to right has met.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Found {
    count: usize,
    first: [f64; KEPT],
    last: Option<f64>,
}

impl Found {
    /// Counts a solution, unless it is the last one seen from the next piece.
    pub fn add(&mut self, tear: f64) {
        if self.last.is_some_and(|last| (tear - last).abs() <= APART) {
            return;
        }
        if let Some(place) = self.first.get_mut(self.count) {
            *place = tear;
        }
        self.count += 1;
        self.last = Some(tear);
    }

    pub fn solutions(self) -> Solutions {
        Solutions::Counted { count: self.count, first: self.first }
    }

    /// The only solution, or what there is instead.
    pub fn only(self) -> Result<f64, Solutions> {
        if self.count == 1 { Ok(self.first[0]) } else { Err(self.solutions()) }
    }
}

/// One operation inside a loop, by another arithmetic: what it reads from outside stands still.
pub(super) fn moved<N: Number>(op: Op, from: &Sources<'_, f64>, get: impl Fn(usize) -> N) -> N {
    match op {
        Op::Constant(_)
        | Op::Coefficient(_)
        | Op::State(_)
        | Op::Mode(_)
        | Op::Time
        | Op::Delayed(_)
        | Op::Kept(_)
        | Op::Level(_) => N::constant(op.apply(from, |_| f64::NAN)),
        Op::Table(index, at) => get(at.index()).table(&from.tables[index as usize]),
        _ => op.apply(&Sources::none(), |register| get(register.index())),
    }
}
