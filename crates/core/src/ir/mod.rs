//! The program: a circuit flattened to primitive operations on volts, with states and modes.
//!
//! A *prologue*, run once a run, turns parameters into coefficients; the *body* turns coefficients,
//! states, modes and time into every voltage and every rate. Every backend reads nothing else.

mod angles;
mod arrange;
mod builder;
mod cache;
mod coefficient;
mod corners;
mod curved;
mod echoes;
mod evaluate;
mod kinks;
mod level;
mod linearise;
mod loop_report;
mod loops;
mod noise;
mod number;
mod op;
mod parameters;
mod piece;
mod range;
mod scope;
mod state_space;
mod tangent;

pub(crate) use angles::Angle;
use arrange::Parts;
pub use builder::{Builder, Draft};
use cache::Cache;
pub use coefficient::{Coefficient, SettingFault};

pub use linearise::Linearisation;
pub(crate) use linearise::OperatingPoint;
pub use op::{Op, Register};
pub use parameters::{Declared, ParameterSlot, SettingError};
pub use state_space::{DelayTerm, Hold, Port, StateSpace, StateTerm};

pub(crate) use coefficient::{Order, Relation, Unfit};
pub(crate) use corners::Corners;
pub(crate) use evaluate::Scratch;
pub(crate) use kinks::{Crossing, Kink, ON_THE_KINK};
pub(crate) use level::{Level, held, points_by};
pub(crate) use loop_report::{remedy, tell};
pub(crate) use loops::{LoopFault, Solutions};
pub(crate) use noise::{Distribution, Noise};
pub(crate) use number::{Number, segment, segment_after};
pub(crate) use op::Sources;
pub(crate) use parameters::ChangedParameters;
pub(crate) use scope::{ScaleSlot, Standing};
pub(crate) use tangent::{Beside, Slopes, StandingSlopes};

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use crate::machines::REFERENCE;
use patchcord_expr::Dimension;

/// A circuit as operations. Made by `Program::new`; run by `solve::Machine`. Copies, which runs of their own turn, share
/// what no run changes.
#[derive(Debug, Clone, Default)]
pub struct Program {
    pub(crate) parameters: Vec<ParameterSlot>,
    pub(crate) tables: Arc<Tables>,
    /// When tables have corners: no step reaches across one.
    pub(crate) corners: Arc<Corners>,
    pub(crate) lowered: Arc<Lowered>,
}

/// What of a [`Program`] no run changes.
#[derive(Debug, Clone, Default)]
pub struct Lowered {
    pub(crate) prologue: Vec<Op>,
    pub(crate) coefficients: Vec<Coefficient>,
    pub(crate) orders: Vec<Order>,
    pub(crate) body: Vec<Op>,
    /// Where the parts of the body begin.
    pub(crate) parts: Parts,
    pub(crate) elements: Vec<Outlet>,
    /// The outputs of the drives.
    pub(crate) drives: Vec<Register>,
    pub(crate) states: Vec<State>,
    pub(crate) modes: Vec<Mode>,
    pub(crate) delays: Vec<Delay>,
    pub(crate) kept: Vec<Kept>,
    /// What drives numbers that stay the same between known instants.
    pub(crate) levels: Vec<Level>,
    /// The tables that are looked up at time itself.
    pub(crate) timetables: Vec<Timetable>,
    /// The element and the table of every curve that is looked up at a voltage.
    pub(crate) curves: Vec<(usize, usize)>,
    pub(crate) loops: Vec<Loop>,
    /// Where rates turn corners.
    pub(crate) kinks: Vec<Kink>,
    /// Where guards turn corners, and no rates.
    pub(crate) guard_kinks: Vec<Kink>,
    /// What periodic functions are taken of.
    pub(crate) angles: Vec<Angle>,
    pub(crate) lamps: Vec<Lamp>,
    pub(crate) signals: Vec<Probe>,
    pub(crate) scales: Vec<ScaleSlot>,
    /// The elements that switch between positions.
    pub(crate) switches: Vec<Switch>,
    /// Machine seconds per problem second.
    pub(crate) time_scale: f64,
    /// The elements in the order in which they are worked out.
    pub(crate) order: Vec<usize>,
    /// For every element, those that read it.
    pub(crate) readers: Vec<Vec<usize>>,
    /// What a backend has derived from it.
    pub(crate) cache: Cache,
}

impl Deref for Program {
    type Target = Lowered;

    fn deref(&self) -> &Lowered {
        &self.lowered
    }
}

impl DerefMut for Program {
    /// While a program is made it is alone; a copy would part with all that it shares here.
    fn deref_mut(&mut self) -> &mut Lowered {
        Arc::make_mut(&mut self.lowered)
    }
}

/// The points of every table.
pub(crate) type Tables = Vec<Vec<[f64; 2]>>;

/// A table that a drive looks up at time itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Timetable {
    pub element: usize,
    pub table: usize,
    /// Whether it goes straight from point to point; else each value stays until the next.
    pub is_straight: bool,
}

/// An element's output.
#[derive(Debug, Clone)]
pub struct Outlet {
    /// Name of the element, drive or reference.
    pub name: String,
    /// Where the body leaves its voltage.
    pub register: Register,
}

/// The output of an integrator.
#[derive(Debug, Clone)]
pub(crate) struct State {
    pub element: usize,
    /// d/dt in volts per problem second; 0 where a limit holds it.
    pub rate: Register,
    /// The same before the limit.
    pub demand: Register,
    /// The voltages, lower and upper, at which it is held.
    pub limits: [Register; 2],
    /// Coefficient of the initial condition.
    pub initial: u32,
    /// Of a lag: how fast it comes back by itself.
    pub lag: Option<TimeConstant>,
}

/// The time constant of a lag.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TimeConstant {
    /// Coefficient of the time in machine seconds.
    pub time: u32,
    /// Problem seconds in a machine second.
    pub problem_seconds: f64,
}

/// A named discrete value, constant within a step.
#[derive(Debug, Clone)]
pub(crate) struct Mode {
    pub element: usize,
    /// Whether it depends on time alone.
    pub of_drive: bool,
    pub initial: f64,
    pub transitions: Vec<Transition>,
    pub calmed_by: Calm,
}

/// What keeps something that switches without end from doing so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Calm {
    /// Thresholds farther apart.
    Hysteresis,
    /// Rest against a stop below a speed; no step is short enough for bounces that follow each other ever sooner.
    Rest,
    /// Nothing of its own.
    Drive,
}

/// A change of a mode, with what it resets.
#[derive(Debug, Clone)]
pub struct Transition {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) guard: Guard,
    pub(crate) reset: Option<Reset>,
    /// Other modes that change with it, and to what.
    pub(crate) sets: Vec<(u32, f64)>,
}

/// A mode of the element whose law is being emitted.
#[derive(Debug, Clone, Copy)]
pub struct ModeHandle {
    pub(crate) index: u32,
    /// Where the body reads the mode's present value.
    pub value: Register,
}

/// When a transition happens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard {
    pub(crate) register: Register,
    pub(crate) strict: bool,
}

/// A state that a transition sets anew.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reset {
    pub state: u32,
    pub to: Register,
}

impl Guard {
    /// When this value is 0 or above.
    pub fn reached(register: Register) -> Self {
        Guard { register, strict: false }
    }

    /// When this value is above 0.
    pub fn passed(register: Register) -> Self {
        Guard { register, strict: true }
    }

    /// How far the guard is past its mark; negative before it.
    pub(crate) fn excess(self, registers: &[f64]) -> f64 {
        registers[self.register.index()]
    }

    pub(crate) fn holds(self, registers: &[f64]) -> bool {
        let value = self.excess(registers);
        if self.strict { value > 0.0 } else { value >= 0.0 }
    }
}

impl Transition {
    /// A change between two values of a mode.
    pub fn new(from: f64, to: f64, guard: Guard) -> Self {
        Transition { from, to, guard, reset: None, sets: Vec::new() }
    }

    /// The same change, which also sets the element's state.
    pub fn reset(mut self, builder: &dyn Builder, to: Register) -> Self {
        self.reset = Some(Reset { state: builder.own_state(), to });
        self
    }

    /// The same change, which also puts another mode to a value.
    pub fn and_sets(mut self, mode: ModeHandle, value: f64) -> Self {
        self.sets.push((mode.index, value));
        self
    }
}

/// A delay line.
#[derive(Debug, Clone)]
pub(crate) struct Delay {
    pub element: usize,
    pub input: Register,
    /// The delay lines, this one too perhaps, on whose output its input depends by any way but other delay lines.
    pub hears: Vec<usize>,
    /// Coefficient of its time, in machine seconds.
    pub time: u32,
    /// Coefficient of what it gives before its time.
    pub initial: u32,
    /// Problem seconds per machine second.
    pub problem_seconds: f64,
}

/// A value that stays the same within a step.
#[derive(Debug, Clone)]
pub(crate) struct Kept {
    /// Coefficient of what it is in initial condition.
    pub initial: u32,
    /// What it becomes at the end of every stretch.
    pub next: Register,
}

/// A loop without an integrator: the operations from after the tear to the result.
#[derive(Debug, Clone)]
pub struct Loop {
    /// The tear's own register.
    pub(crate) tear: Register,
    /// The register that the tear must equal.
    pub(crate) result: Register,
    /// Names of the members, the one that opens it last.
    pub members: Vec<String>,
    /// Whether an open amplifier opens it.
    pub(crate) is_open: bool,
}

impl Loop {
    /// Name of the element that opens it.
    pub fn opened(&self) -> &str {
        self.members.last().map_or("", String::as_str)
    }
}

/// An overload lamp of an amplifier that does not integrate.
#[derive(Debug, Clone)]
pub(crate) struct Lamp {
    pub element: usize,
    /// What the amplifier is asked for.
    pub demand: Register,
    /// What it gives, within ±100 V.
    pub output: Register,
}

/// A signal that can be recorded.
#[derive(Debug, Clone)]
pub struct Probe {
    /// Its name.
    pub name: String,
    /// Where it is read.
    pub(crate) register: Register,
    /// Coefficient of its value per volt, in SI; `None` for volts.
    pub(crate) per_volt: Option<u32>,
    /// Text of its unit.
    pub unit: String,
    /// What that unit is in SI.
    pub(crate) per_unit: f64,
    pub(crate) dimension: Dimension,
    /// Whether it stands among the patch's signals: not a bare element or drive.
    pub(crate) is_named: bool,
}

/// An element that switches between positions.
#[derive(Debug, Clone)]
pub(crate) struct Switch {
    pub element: usize,
    /// Index of the mode whose value counts the positions.
    pub mode: usize,
    pub positions: &'static [&'static str],
}

/// The demanded output, in volts, above which a lamp lights: 1e-6 above the reference.
pub(crate) const LAMP_LEVEL: f64 = REFERENCE * (1.0 + 1e-6);

impl Program {
    /// Carries out every change of mode that is due at these voltages, at most one of each mode, and tells of
    /// each by its index and its transition: those of drives if any is due, else those of everything else, which should not act
    /// on a voltage from before a jump. The voltages have to be worked out again after it.
    pub(crate) fn change_modes(
        &self,
        registers: &[f64],
        modes: &mut [f64],
        states: &mut [f64],
        mut changed: impl FnMut(usize, &Transition),
    ) {
        let mut any = false;
        for of_drive in [true, false] {
            let those = self.modes.iter().enumerate().filter(|(_, mode)| mode.of_drive == of_drive);
            for (index, mode) in those {
                let value = modes[index];
                let due = |open: &&Transition| open.from == value && open.guard.holds(registers);
                let Some(transition) = mode.transitions.iter().find(due) else { continue };
                modes[index] = transition.to;
                transition.sets.iter().for_each(|(other, value)| modes[*other as usize] = *value);
                if let Some(reset) = transition.reset {
                    states[reset.state as usize] = registers[reset.to.index()];
                }
                any = true;
                changed(index, transition);
            }
            if any {
                return;
            }
        }
    }

    /// The element of this index.
    pub(crate) fn name(&self, element: usize) -> &str {
        &self.elements[element].name
    }

    /// The outlets in the order in which they are worked out.
    pub(crate) fn in_order(&self) -> impl Iterator<Item = &Outlet> {
        self.order.iter().map(|element| &self.elements[*element])
    }

    /// Index of an element, drive or reference by name.
    pub(crate) fn element(&self, name: &str) -> Option<usize> {
        self.elements.iter().position(|outlet| outlet.name == name)
    }

    /// Index of a drive by name.
    pub(crate) fn drive(&self, name: &str) -> Option<usize> {
        self.element(name).filter(|element| self.drives.contains(&self.elements[*element].register))
    }

    /// Index of the table that a drive looks up at time itself.
    pub(crate) fn table_of(&self, drive: usize) -> Option<usize> {
        self.timetables.iter().find(|own| own.element == drive).map(|own| own.table)
    }

    /// Index of the table that an element looks up at a voltage.
    pub(crate) fn curve_of(&self, element: usize) -> Option<usize> {
        self.curves.iter().find(|own| own.0 == element).map(|own| own.1)
    }

    /// Gives a table other points.
    pub(crate) fn put_points(&mut self, table: usize, points: Vec<[f64; 2]>) {
        Arc::make_mut(&mut self.tables)[table] = points;
        self.find_corners();
    }

    /// Notes when tables have corners.
    pub(crate) fn find_corners(&mut self) {
        let straight = self.timetables.iter().filter(|own| own.is_straight);
        self.corners = Arc::new(Corners::of(straight.map(|own| &self.tables[own.table][..])));
    }

    /// Index of a parameter by name.
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|slot| slot.name == name)
    }

    /// A scale by name.
    pub(crate) fn scale(&self, name: &str) -> Option<&ScaleSlot> {
        self.scales.iter().find(|slot| slot.name == name)
    }

    /// One of the patch's signals by name.
    pub(crate) fn signal(&self, name: &str) -> Option<&Probe> {
        self.signals.iter().find(|probe| probe.is_named && probe.name == name)
    }

    /// The parameters, in the order of the patch.
    pub fn parameters(&self) -> &[ParameterSlot] {
        &self.parameters
    }

    /// Everything with an output: references, drives, elements.
    pub fn outlets(&self) -> &[Outlet] {
        &self.elements
    }

    /// The signals that can be recorded.
    pub fn signals(&self) -> &[Probe] {
        &self.signals
    }

    /// The loops without an integrator.
    pub fn loops(&self) -> &[Loop] {
        &self.loops
    }

    /// Names of the states, in their order.
    pub fn states(&self) -> Vec<&str> {
        self.states.iter().map(|state| self.name(state.element)).collect()
    }

    /// The body's operations: what every backend runs.
    pub fn body(&self) -> &[Op] {
        &self.body
    }
}
