//! Kernels: programs specialised to one set of modes and amplifier states.
//!
//! While no mode changes and no amplifier enters or leaves overload, most of a program is linear. Signs, gains,
//! potentiometers and formulas are combined into factors, which are computed once per run. Sums of voltages times
//! factors remain, and the operations that are not sums. A kernel computes the rates, the recorded voltages and the
//! *watches*. As long as no watch is hit, the kernel and the program give the same voltages except for rounding.
//!
//! A kernel is built in three steps: specialise (`specialise`, with `form` and `bounds`), lay out (`layout`, `guards`)
//! and, for long runs, compile to native code (`native`). It runs on a [`Frame`] for one run or on a [`LaneFrame`] for
//! several.
//!
//! All backends run the same operations in the same order, each rounded once, and so give the same bits.

mod backend;
mod bounds;
mod branch_cache;
mod branches;
mod code;
mod delays;
mod form;
mod frame;
mod guards;
mod lane;
mod lane_frame;
mod layout;
#[cfg(feature = "native")]
mod native;
#[cfg(not(feature = "native"))]
#[path = "no_native.rs"]
mod native;
mod node;
#[cfg_attr(not(feature = "native"), allow(dead_code, reason = "only native code writes rows"))]
mod rows;
mod schedules;
mod span;
mod specialise;
mod step;
mod steps;
mod store;
#[cfg(test)]
mod tests;

pub use backend::Backend;
pub(crate) use branches::{WatchHit, WatchKind};
pub(crate) use frame::Frame;
pub use lane_frame::LANES;
pub(crate) use lane_frame::LaneFrame;
pub(crate) use native::Native;
pub(crate) use step::LookResult;
pub(crate) use steps::Steps;
pub(crate) use store::{Kernels, MIN_LANES, SharedKernel};

use crate::ir::{KINK_TOLERANCE, Op, Program, Register, Sources};
use crate::machines::REFERENCE;
use code::{Code, Slot};
use form::Factor;

/// Demanded output, in volts, up to which an amplifier is in range. The margin prevents an overload by rounding of an
/// output that a diode holds exactly at the limit.
const WITHIN_RANGE: f64 = REFERENCE + KINK_TOLERANCE;

/// Where the demanded output of an amplifier is, relative to its range of ±100 V.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AmplifierState {
    /// The demand is below -100 V, so the output is -100 V.
    Below,
    /// The output equals the demand.
    Within,
    /// The demand is above 100 V, so the output is 100 V.
    Above,
}

impl AmplifierState {
    /// The state for a demanded output in volts. A demand that is not a number counts as within the range.
    pub(crate) fn of(volts: f64) -> AmplifierState {
        match volts {
            volts if volts > WITHIN_RANGE => AmplifierState::Above,
            volts if volts < -WITHIN_RANGE => AmplifierState::Below,
            _ => AmplifierState::Within,
        }
    }
}

/// The modes and amplifier states to which a program is specialised.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Specialisation<'a> {
    /// Values of the modes.
    pub modes: &'a [f64],
    /// State of the amplifier of every lamp.
    pub amplifiers: &'a [AmplifierState],
}

/// A program specialised to one set of modes and amplifier states.
#[derive(Debug, Clone)]
pub(crate) struct Kernel {
    /// Operations that compute the factors from the program's coefficients.
    parameter_code: Vec<Op>,
    /// The factors, which occupy the first slots.
    factors: Vec<Factor>,
    /// Triples (value, least, largest) of factors. The kernel is valid only if each value is within its bounds.
    fixed: Vec<[Factor; 3]>,
    /// Where the inputs and the results are in a frame.
    pub layout: Layout,
    /// Operations for the rates: they run in every stage of a step.
    moving: Code,
    /// Checks of a quick step, which only tests whether anything is hit.
    quick: Checks,
    /// Checks of a thorough step, which finds out what is hit.
    thorough: Checks,
    /// Slots of the rates, by state.
    pub rates: Vec<Slot>,
    /// Slots of what is sampled at the end of every step: first the sampled values of the program, then the voltages
    /// whose value at the beginning of a step is needed.
    pub sampled: Vec<Slot>,
    /// Slots of the inputs of the delay lines.
    delay_inputs: Vec<Slot>,
    /// The recorded voltages.
    pub recorded: Vec<RecordedVoltage>,
    /// Slots of the voltages whose extremes are tracked.
    tracked: Vec<Slot>,
    /// The watches: corners first, then guards, then ranges.
    pub watches: Vec<Watch>,
    /// Number of watches that are corners.
    corners: usize,
    /// The voltages that a quick step tests, with their intervals. Those that are tested within a step come first, and
    /// of these first the ones that are tested at the first stage.
    safe_intervals: Vec<SafeInterval>,
    /// Number of intervals that are tested at the first stage: those that are not followed.
    first_intervals: usize,
    /// The voltages whose parabola within a step is computed: first those of the other intervals that are tested within
    /// a step, then the sampled values whose turning points count.
    followed: Vec<Followed>,
    /// Number of the first followed voltages that have an interval.
    curved_intervals: usize,
    /// Number of values that depend on the branch: on which side of each corner the voltages are.
    branch_values: usize,
    /// The tables that are looked up at time.
    scheduled: Vec<u32>,
}

/// First slots of the inputs of a kernel. The factors are in front of them, the results of operations behind.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Layout {
    /// The states, in volts.
    pub states: usize,
    /// Problem time in seconds: one slot.
    pub time: usize,
    /// The tables that are looked up at time.
    pub scheduled: usize,
    /// The outputs of the delay lines, in volts.
    pub delayed: usize,
    /// The sampled values of the program.
    pub sampled: usize,
    /// The followed voltages at the beginning of a step.
    pub begins: usize,
    /// The levels.
    pub levels: usize,
    /// The results of the operations.
    pub results: usize,
    /// Number of slots.
    pub all: usize,
}

/// What is computed and tested in a step in addition to the rates.
#[derive(Debug, Clone)]
struct Checks {
    /// Operations for the tests within a step. They run at the first stage and at the end.
    first: Code,
    /// Operations for the voltages whose value at the second stage is needed as well.
    second: Code,
    /// Operations for the tests at the end of a step only, and for the recorded voltages.
    ending: Code,
    /// Number of tests within a step; the first ones of all.
    within: usize,
    /// Number of tests at the end of a step, with those that are also made within it.
    all: usize,
}

/// A voltage whose parabola within a step is computed.
#[derive(Debug, Clone, Copy)]
struct Followed {
    /// Slot of the voltage.
    slot: Slot,
    /// Slot of its value at the beginning of the step.
    begin: Slot,
}

/// A voltage with an interval in which no watch of it is hit. Watches of linear functions of the voltage count as
/// well.
#[derive(Debug, Clone)]
struct SafeInterval {
    /// Slot of the voltage.
    slot: Slot,
    /// The watches that limit the interval; empty for a state that no watch depends on.
    watches: Vec<IntervalWatch>,
}

/// A recorded voltage.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RecordedVoltage {
    /// Slot of the voltage.
    slot: Slot,
    /// Index of the tracked voltage from which it follows as constant + factor x voltage. The slots of constant and
    /// factor are `None` if both voltages are the same. The whole is `None` if it is constant or a linear function of
    /// time.
    tracks: Option<(usize, Option<[Slot; 2]>)>,
}

/// A watch that limits the interval of a voltage, with the slots of constant and factor if the watched voltage is a
/// linear function of it.
#[derive(Debug, Clone, Copy)]
struct IntervalWatch {
    /// Index of the watch.
    watch: usize,
    /// Slots of constant and factor; `None` if the watch tests the voltage itself.
    line: Option<[Slot; 2]>,
}

/// A watched voltage. It is hit if slope x voltage + offset falls below 0. Slope and offset are in the frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watch {
    /// Slot of the watched voltage.
    pub slot: Slot,
    /// What must hold for the voltage.
    pub condition: WatchCondition,
}

/// The condition for which a voltage is watched.
#[derive(Debug, Clone, Copy)]
pub(crate) enum WatchCondition {
    /// A corner at 0 V. The branch value with index `side` is 1 if the voltage is 0 or above, and otherwise 0.
    Corner { side: u32 },
    /// A corner at the next point of a table below the voltage, or above it if `is_above`. The two watches follow
    /// each other. The branch values from index `piece` on are slope, origin and ordinate of the segment.
    Points { table: u32, is_above: bool, piece: u32 },
    /// The voltage must stay above the value in a slot.
    Above(Slot),
    /// The voltage must stay below the value in a slot.
    Below(Slot),
    /// The absolute value of the voltage must stay below the value in a slot.
    Size(Slot),
}

impl WatchCondition {
    /// Whether the kernel stays valid beyond the hit, on another branch.
    fn is_corner(self) -> bool {
        matches!(self, WatchCondition::Corner { .. } | WatchCondition::Points { .. })
    }
}

impl Kernel {
    /// Whether a program has kernels. A program with loops has none.
    pub(crate) fn is_supported(program: &Program) -> bool {
        program.lowered.loops.is_empty()
    }

    /// The kernel of a program, specialised, which also computes the voltages of these registers. `None` if the
    /// program has loops.
    pub(crate) fn new(
        program: &Program,
        specialisation: Specialisation<'_>,
        recorded: &[Register],
    ) -> Option<Kernel> {
        Kernel::is_supported(program)
            .then(|| layout::lay_out(specialise::specialise(program, specialisation, recorded), program))
    }

    /// Whether every recorded voltage tracks a state. States do not jump at the end of a step.
    fn is_tracking_states_only(&self) -> bool {
        let states = self.layout.states..self.layout.time;
        let is_state = |recorded: &RecordedVoltage| {
            recorded.tracks.is_some_and(|(at, _)| states.contains(&(self.tracked[at] as usize)))
        };
        self.recorded.iter().all(is_state)
    }

    /// The number of operations that native code of this kernel has. A step and a look-ahead have four stages each,
    /// with tests in the middle and at the end. `evaluate` has one stage.
    fn operations(&self) -> usize {
        let length = |code: &Code| code.instructions.len() + code.terms.len();
        let moving = length(&self.moving);
        let all = |checks: &Checks| length(&checks.first) + length(&checks.ending) + checks.all;
        let within = |checks: &Checks| length(&checks.first) + length(&checks.second) + checks.within;
        let stepped = |checks: &Checks| 4 * moving + within(checks) + all(checks) + self.followed.len();
        stepped(&self.quick) + stepped(&self.thorough) + moving + all(&self.thorough)
    }

    /// The sampled values whose turning points count.
    fn turning(&self) -> &[Followed] {
        &self.followed[self.curved_intervals..]
    }

    /// The value in a slot if it is a fixed number, whatever the parameters are.
    fn number(&self, slot: Slot) -> Option<f64> {
        match self.factors.get(slot as usize) {
            Some(Factor::Number(value)) => Some(*value),
            _ => None,
        }
    }

    /// Computes the factors of a frame from the program's coefficients and from the branch values. Returns whether
    /// they are valid. They are not if an amplifier with a constant output is in another state than the kernel
    /// assumes.
    pub(crate) fn compute_factors(
        &self,
        frame: &mut Frame<f64>,
        program: &Program,
        coefficients: &[f64],
    ) -> bool {
        let mut registers = std::mem::take(&mut frame.parameter_registers);
        let from = Sources {
            coefficients,
            states: &frame.branch_values,
            tables: &program.tables,
            ..Sources::none()
        };
        registers.clear();
        for op in &self.parameter_code {
            registers.push(op.apply(&from, |register| registers[register.index()]));
        }
        let value = |factor: &Factor| match factor {
            Factor::Number(value) => *value,
            Factor::Computed(register) => registers[register.index()],
        };
        for (slot, factor) in frame.slots.iter_mut().zip(&self.factors) {
            *slot = value(factor);
        }
        let is_within_bounds =
            |[of, low, high]: &[Factor; 3]| value(low) <= value(of) && value(of) <= value(high);
        let is_valid = self.fixed.iter().all(is_within_bounds);
        frame.parameter_registers = registers;
        is_valid
    }
}
