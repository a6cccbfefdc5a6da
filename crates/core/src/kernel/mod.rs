//! The kernel: what a program comes to while its modes stand and its amplifiers stay within their range, or beyond the same
//! end of it.
//!
//! Signs, gains, potentiometers and formulas are gathered into factors, which a prologue of its own works out once a
//! run; what is left are sums of voltages times factors, and what is no sum. A kernel gives the rates, the voltages
//! that are recorded, and what has to be watched: as long as every watched voltage stays within its bounds, the
//! kernel tells the same as the program. It is folded for one stance: a set of modes, and of overloaded amplifiers.
//!
//! Every backend runs the same operations in the same order, each rounded once, and gives the same bits.

mod abreast;
mod backend;
mod bounds;
mod code;
mod echoes;
mod fold;
mod form;
mod frame;
mod known;
mod lane;
mod layout;
#[cfg(feature = "native")]
mod native;
#[cfg(not(feature = "native"))]
#[path = "no_native.rs"]
mod native;
mod node;
mod posts;
#[cfg_attr(not(feature = "native"), allow(dead_code, reason = "native code alone goes steps blindly"))]
mod rows;
mod schedules;
mod sides;
mod span;
mod step;
mod store;
#[cfg(test)]
mod tests;

pub(crate) use abreast::Formation;
pub use abreast::LANES;
pub use backend::Backend;
pub(crate) use frame::Frame;
pub(crate) use native::Native;
pub(crate) use sides::{Kind, Met};
pub(crate) use step::{Look, Steps};
pub(crate) use store::{FEWEST_ABREAST, Folded, Kernels};

use crate::ir::{ON_THE_KINK, Op, Program, Register, Sources};
use crate::machines::REFERENCE;
use code::{Code, Slot};
use form::Factor;

/// An amplifier that is asked for no more than this, in volts, is within its range. What stands just at its limit, by a
/// diode, is not beyond it by rounding.
const WITHIN_RANGE: f64 = REFERENCE + ON_THE_KINK;

/// What an amplifier is asked for: less than it can give, what it can, or more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    TooLow,
    Within,
    TooHigh,
}

impl Asked {
    pub fn of(volts: f64) -> Asked {
        match volts {
            volts if volts > WITHIN_RANGE => Asked::TooHigh,
            volts if volts < -WITHIN_RANGE => Asked::TooLow,
            _ => Asked::Within,
        }
    }
}

/// What a program is folded for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stance<'a> {
    pub modes: &'a [f64],
    /// Of every lamp, what its amplifier is asked for.
    pub asked: &'a [Asked],
}

/// A program folded for one stance.
#[derive(Debug, Clone)]
pub(crate) struct Kernel {
    /// What its factors are worked out by, from the program's coefficients.
    early: Vec<Op>,
    /// What stands in the first slots.
    factors: Vec<Factor>,
    /// Numbers that must lie between two others, or the kernel does not hold with these coefficients.
    still: Vec<[Factor; 3]>,
    pub layout: Layout,
    /// What the rates need.
    moving: Code,
    /// What tells that a step is quiet.
    quick: Checks,
    /// What tells what is met.
    thorough: Checks,
    pub rates: Vec<Slot>,
    pub kept: Vec<Slot>,
    /// What goes into the delay lines.
    stored: Vec<Slot>,
    /// What is recorded.
    pub seen: Vec<Seen>,
    /// The voltages that this follows, whose extremes are looked for.
    followed: Vec<Slot>,
    /// Corners first, then guards, then ranges.
    pub watches: Vec<Watch>,
    corners: usize,
    fences: Vec<Fence>,
    /// So many numbers are given beside the coefficients.
    given: usize,
    /// The tables that are looked up at time itself.
    scheduled: Vec<u32>,
}

/// Where the slots begin of what is given to a kernel; after these stand the results of its operations.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Layout {
    pub states: usize,
    pub time: usize,
    pub scheduled: usize,
    pub delayed: usize,
    pub kept: usize,
    pub levels: usize,
    pub results: usize,
    pub all: usize,
}

/// What is looked at in a step.
#[derive(Debug, Clone)]
struct Checks {
    /// What the rates do not need, and is looked at in the middle of a step too.
    middle: Code,
    /// What is looked at or recorded at its end, beyond that.
    ending: Code,
    /// So many are looked at in the middle of a step, and so many at its end.
    in_middle: usize,
    all: usize,
}

/// A voltage that stays between two numbers as long as nothing is met of what is watched of it, and of straight lines
/// over it.
#[derive(Debug, Clone)]
struct Fence {
    slot: Slot,
    watches: Vec<Posted>,
}

/// A voltage that is recorded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen {
    slot: Slot,
    /// Index of the voltage that it follows, as a constant and that voltage times a factor, or as that voltage itself;
    /// none of what stands still or goes straight on in time.
    follows: Option<(usize, Option<[Slot; 2]>)>,
}

/// A watch at a fence, of a constant and the fence's voltage times a factor, or of that voltage itself.
#[derive(Debug, Clone, Copy)]
struct Posted {
    watch: usize,
    line: Option<[Slot; 2]>,
}

/// A voltage that is watched: slope x voltage + room must not fall below 0, slope and room being numbers of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watch {
    pub slot: Slot,
    pub what: Watched,
}

/// What a voltage is watched for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Watched {
    /// A corner where it is 0; at a place among the given numbers stands its side, 1 where it is 0 or above, else 0.
    Corner { side: u32 },
    /// A corner at the next point of a table below it, or above it, whose watch comes next; at a place among the given
    /// numbers begin slope, origin and ordinate of the piece.
    Points { table: u32, above: bool, piece: u32 },
    /// It must stay above the number in a slot.
    Above(Slot),
    /// It must stay below it.
    Below(Slot),
    /// Its size must; it is watched without sign.
    Size(Slot),
}

impl Watched {
    fn is_corner(self) -> bool {
        matches!(self, Watched::Corner { .. } | Watched::Points { .. })
    }
}

impl Kernel {
    /// Whether a program has kernels: one with loops has none.
    pub fn can_be_of(program: &Program) -> bool {
        program.loops.is_empty()
    }

    /// The kernel of a program in a stance, which also gives the voltages of these registers.
    pub fn new(program: &Program, stance: Stance<'_>, seen: &[Register]) -> Option<Kernel> {
        Kernel::can_be_of(program).then(|| layout::laid_out(fold::folded(program, stance, seen), program))
    }

    /// Whether all that is recorded follows states, which do not jump where a step ends.
    fn records_states(&self) -> bool {
        let states = self.layout.states..self.layout.time;
        let is_state =
            |seen: &Seen| seen.follows.is_some_and(|(at, _)| states.contains(&(self.followed[at] as usize)));
        self.seen.iter().all(is_state)
    }

    /// How many operations its native code has, or would have. A step and a look have four stages each, and checks in their
    /// middle and at their end; at the slots everything is worked out once.
    fn operations(&self) -> usize {
        let length = |code: &Code| code.instructions.len() + code.terms.len();
        let moving = length(&self.moving);
        let all = |checks: &Checks| length(&checks.middle) + length(&checks.ending) + checks.all;
        let in_the_middle = |checks: &Checks| length(&checks.middle) + checks.in_middle;
        let stepped = |checks: &Checks| 4 * moving + in_the_middle(checks) + all(checks);
        stepped(&self.quick) + stepped(&self.thorough) + moving + all(&self.thorough)
    }

    /// What stands in a slot whatever the parameters are.
    fn number(&self, slot: Slot) -> Option<f64> {
        match self.factors.get(slot as usize) {
            Some(Factor::Number(value)) => Some(*value),
            _ => None,
        }
    }

    /// Works the factors of a frame out from a program's coefficients and what is given of its corners. Tells whether they
    /// can be used: not where an amplifier that stands still is asked for something else than they are folded for.
    pub fn put_factors(&self, frame: &mut Frame<f64>, program: &Program, coefficients: &[f64]) -> bool {
        let mut registers = std::mem::take(&mut frame.early);
        let from = Sources { coefficients, states: &frame.given, tables: &program.tables, ..Sources::none() };
        registers.clear();
        for op in &self.early {
            registers.push(op.apply(&from, |register| registers[register.index()]));
        }
        let value = |factor: &Factor| match factor {
            Factor::Number(value) => *value,
            Factor::Early(register) => registers[register.index()],
        };
        for (slot, factor) in frame.slots.iter_mut().zip(&self.factors) {
            *slot = value(factor);
        }
        let holds = |[of, low, high]: &[Factor; 3]| value(low) <= value(of) && value(of) <= value(high);
        let can_be_used = self.still.iter().all(holds);
        frame.early = registers;
        can_be_used
    }
}
