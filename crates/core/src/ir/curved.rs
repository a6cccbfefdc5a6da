//! Loops with curved elements: every solution of the tear, found by halving its range and leaving out what
//! cannot hold one.

use super::Program;
use super::loops::{APART, Found, LoopFault, Solutions, moved};
use super::number::Number;
use super::op::{Op, Sources};
use super::range::Range;
use crate::machines::REFERENCE;

/// Looks at a stretch of the tear, those at inner loops counted too, before the search is given up.
const MOST_LOOKS: usize = 100_000;
/// Stretches are halved down to this width, in volts; those that are left side by side hold one solution.
const FINEST: f64 = 1e-7;
/// What rounding may put between a tear and its loop's result, in volts.
const ROUNDING: f64 = 1e-9;
/// The tear follows a stretch inside a wider loop this much more finely than that loop's own stretch.
const FINER: f64 = 1.0 / 8.0;
/// Where the looks are used up by a stretch wider than this, in volts, all of it solves the loop.
const WIDE: f64 = 1e-3;

/// The tear that closes a loop.
///
/// # Errors
/// When there is not exactly one, of this loop or of one inside it.
pub(super) fn search(
    program: &Program,
    index: usize,
    from: &Sources<'_, f64>,
    registers: &[f64],
    ranges: &mut [Range],
) -> Result<f64, LoopFault> {
    let origin = program.loops[index].tear.index();
    Search { program, from, registers, origin, ranges, looks: 0 }.only_solution(index)
}

struct Search<'a> {
    program: &'a Program,
    from: &'a Sources<'a, f64>,
    /// Voltages from outside the outermost loop.
    registers: &'a [f64],
    /// The tear of the outermost loop: from here on voltages are in `ranges`.
    origin: usize,
    ranges: &'a mut [Range],
    looks: usize,
}

/// Stretches that may hold solutions, met from left to right; those side by side are one.
#[derive(Default)]
struct Suspects {
    last: Option<Range>,
    found: Found,
}

impl Search<'_> {
    fn only_solution(&mut self, index: usize) -> Result<f64, LoopFault> {
        self.solutions(index)?.only().map_err(|solutions| LoopFault { index, solutions })
    }

    fn solutions(&mut self, index: usize) -> Result<Found, LoopFault> {
        let mut suspects = Suspects::default();
        let narrowed = self.narrow(index, WHOLE, FINEST, &mut |search, stretch| {
            search.suspect(index, stretch, &mut suspects)
        });
        let is_wide = suspects.last.is_some_and(|last| last.width() > WIDE);
        narrowed.map_err(|fault| match fault.solutions {
            Solutions::TooManyPieces if is_wide => LoopFault { index, solutions: Solutions::Range },
            _ => fault,
        })?;
        if let Some(last) = suspects.last {
            self.cross(index, last, &mut suspects.found)?;
        }
        Ok(suspects.found)
    }

    /// Hands on, from left to right, the stretches of at most this width that cannot be left out.
    fn narrow(
        &mut self,
        index: usize,
        tear: Range,
        finest: f64,
        keep: &mut dyn FnMut(&mut Self, Range) -> Result<(), LoopFault>,
    ) -> Result<(), LoopFault> {
        let result = self.follow(index, tear)?;
        let stretch = Range::new(tear.low.max(result.low - ROUNDING), tear.high.min(result.high + ROUNDING));
        if stretch.low > stretch.high {
            return Ok(());
        }
        if stretch.width() <= finest {
            return keep(self, stretch);
        }
        let middle = stretch.middle();
        self.narrow(index, Range::new(stretch.low, middle), finest, keep)?;
        self.narrow(index, Range::new(middle, stretch.high), finest, keep)
    }

    fn suspect(&mut self, index: usize, stretch: Range, suspects: &mut Suspects) -> Result<(), LoopFault> {
        match &mut suspects.last {
            Some(last) if stretch.low - last.high <= APART => *last = last.hull(stretch),
            last => {
                if let Some(done) = last.replace(stretch) {
                    self.cross(index, done, &mut suspects.found)?;
                }
            }
        }
        Ok(())
    }

    /// Halves a stretch down to the place where the loop's result crosses the tear, if it does. Nothing jumps
    /// within a loop, as modes stand still: a change of sign is a solution, however steep.
    fn cross(&mut self, index: usize, stretch: Range, found: &mut Found) -> Result<(), LoopFault> {
        let (mut low, mut high) =
            ((stretch.low - APART).max(WHOLE.low), (stretch.high + APART).min(WHOLE.high));
        let (mut above, mut below) = (self.excess(index, low)?, self.excess(index, high)?);
        if above * below > 0.0 {
            return Ok(());
        }
        while above != 0.0 && below != 0.0 {
            let middle = Range::new(low, high).middle();
            if middle <= low || middle >= high {
                break;
            }
            let excess = self.excess(index, middle)?;
            if excess * above > 0.0 {
                (low, above) = (middle, excess)
            } else {
                (high, below) = (middle, excess)
            }
        }
        found.add(if above.abs() < below.abs() { low } else { high });
        Ok(())
    }

    /// How far the loop's result lies above a tear.
    fn excess(&mut self, index: usize, tear: f64) -> Result<f64, LoopFault> {
        let excess = self.follow(index, Range::constant(tear))?.low - tear;
        let solutions = Solutions::NotANumber;
        if excess.is_nan() { Err(LoopFault { index, solutions }) } else { Ok(excess) }
    }

    /// The loop's result for a stretch of its tear.
    fn follow(&mut self, index: usize, tear: Range) -> Result<Range, LoopFault> {
        self.looks += 1;
        if self.looks > MOST_LOOKS {
            return Err(LoopFault { index, solutions: Solutions::TooManyPieces });
        }
        let program = self.program;
        let entry = &program.loops[index];
        self.ranges[entry.tear.index()] = tear;
        for at in entry.tear.index() + 1..=entry.result.index() {
            self.ranges[at] = match program.body[at] {
                Op::Tear(inner) => self.inner_tear(inner as usize, tear.width())?,
                op => moved(op, self.from, |register| self.get(register)),
            };
        }
        Ok(self.ranges[entry.result.index()])
    }

    fn get(&self, register: usize) -> Range {
        if register < self.origin { Range::constant(self.registers[register]) } else { self.ranges[register] }
    }

    /// Everything that the tear of a loop inside this one may be while this one's tear lies in a stretch.
    fn inner_tear(&mut self, index: usize, width: f64) -> Result<Range, LoopFault> {
        if width == 0.0 {
            return self.only_solution(index).map(Range::constant);
        }
        let mut all: Option<Range> = None;
        self.narrow(index, WHOLE, FINEST.max(width * FINER), &mut |_, stretch| {
            all = Some(all.map_or(stretch, |all| all.hull(stretch)));
            Ok(())
        })?;
        all.ok_or_else(|| LoopFault { index, solutions: Found::default().solutions() })
    }
}

/// Where a tear can be.
const WHOLE: Range = Range { low: -REFERENCE, high: REFERENCE };
