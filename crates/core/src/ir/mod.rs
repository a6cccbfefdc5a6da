//! The intermediate representation: a circuit as primitive operations on volts, with states and modes.
//!
//! A [`Program`] has two lists of operations. The *prologue* runs once per run and turns parameters into coefficients.
//! The *body* turns coefficients, states, modes and time into every voltage and every rate. Every backend reads only
//! the program: the interpreter here, the kernels and native code.
//!
//! `lower` makes a program from a circuit: it calls each element's law with a [`Builder`]. Then this module puts the
//! body in order and finds loops, kinks and discontinuities. It also differentiates the program.

mod angles;
mod builder;
mod cache;
mod coefficient;
mod curved;
mod evaluate;
mod interval;
mod kinks;
mod level;
mod linear_piece;
mod linearise;
mod loop_report;
mod loops;
mod noise;
mod number;
mod op;
mod parameters;
mod scope;
mod sections;
mod state_space;
mod table_corners;
mod tangent;
mod upstream;

pub(crate) use angles::Angle;
pub use builder::{Builder, Draft};
use cache::Cache;
pub use coefficient::{Coefficient, SettingFault};
use sections::Sections;

pub use linearise::Linearisation;
pub(crate) use linearise::OperatingPoint;
pub use op::{Op, Register};
pub use parameters::{Declared, ParameterSlot, SettingError};
pub use state_space::{DelayTerm, Port, StateHold, StateSpace, StateTerm};

pub(crate) use coefficient::{InvalidCoefficient, Relation, SettingOrder};
pub(crate) use evaluate::Scratch;
pub(crate) use kinks::{KINK_TOLERANCE, Kink, KinkCrossing};
pub(crate) use level::{Level, held_value, points_passed};
pub(crate) use loop_report::{describe_solutions, remedy};
pub(crate) use loops::{LoopFault, Solutions};
pub(crate) use noise::{Distribution, Noise};
pub(crate) use number::{Number, segment, segment_after};
pub(crate) use op::Sources;
pub(crate) use parameters::ChangedParameters;
pub(crate) use scope::{RunScope, ScaleSlot};
pub(crate) use table_corners::TableCorners;
pub(crate) use tangent::{RunScopeSlopes, SourceSlopes, TangentBase};

use std::sync::Arc;

use crate::machines::REFERENCE;
use patchcord_expr::Dimension;

/// A circuit as a list of operations. `Program::new` makes it and `solve::Machine` runs it.
///
/// Copies share everything that a run cannot change, so a copy per run is cheap. Parameter values and tables belong to
/// each copy.
#[derive(Debug, Clone, Default)]
pub struct Program {
    /// The parameters of the patch with their present values, in the order of the patch.
    pub(crate) parameters: Vec<ParameterSlot>,
    /// The points of all tables; the index is the one in [`Op::Table`].
    pub(crate) tables: Arc<Tables>,
    /// The times at which tables of time have corners. No step reaches across one.
    pub(crate) corners: Arc<TableCorners>,
    /// Everything that no run changes.
    pub(crate) lowered: Arc<Lowered>,
}

/// The part of a [`Program`] that no run changes.
#[derive(Debug, Clone, Default)]
pub struct Lowered {
    /// Operations that compute the coefficients from the parameters.
    pub(crate) prologue: Vec<Op>,
    /// The coefficients; the index is the one in [`Op::Coefficient`].
    pub(crate) coefficients: Vec<Coefficient>,
    /// Relations between settings, such as a lower and an upper limit. They are checked again after each change of
    /// parameters.
    pub(crate) orders: Vec<SettingOrder>,
    /// Operations that compute every voltage and rate, in order of evaluation.
    pub(crate) body: Vec<Op>,
    /// Where the sections of the body begin.
    pub(crate) sections: Sections,
    /// The output of every reference, drive and element, in the order of the circuit.
    pub(crate) elements: Vec<ElementOutput>,
    /// The registers of the drives' outputs.
    pub(crate) drives: Vec<Register>,
    /// The states; the index is the one in [`Op::State`].
    pub(crate) states: Vec<State>,
    /// The modes; the index is the one in [`Op::Mode`].
    pub(crate) modes: Vec<Mode>,
    /// The delay lines; the index is the one in [`Op::Delayed`].
    pub(crate) delays: Vec<Delay>,
    /// The sampled values; the index is the one in [`Op::Sampled`].
    pub(crate) kept: Vec<SampledValue>,
    /// The sources that are constant between known instants; the index is the one in [`Op::Level`].
    pub(crate) levels: Vec<Level>,
    /// The tables that are looked up at time.
    pub(crate) timetables: Vec<Timetable>,
    /// The element and the table of every curve that is looked up at a voltage.
    pub(crate) curves: Vec<(usize, usize)>,
    /// The loops without an integrator; the index is the one in [`Op::Tear`].
    pub(crate) loops: Vec<Loop>,
    /// Kinks that change a rate, a sampled value or the input of a delay line.
    pub(crate) kinks: Vec<Kink>,
    /// Kinks that change guards only.
    pub(crate) guard_kinks: Vec<Kink>,
    /// The arguments of periodic functions.
    pub(crate) angles: Vec<Angle>,
    /// The overload lamps of the amplifiers without a state.
    pub(crate) lamps: Vec<Lamp>,
    /// The signals that a run can record.
    pub(crate) signals: Vec<SignalInfo>,
    /// The scales that formulas in a run can name.
    pub(crate) scales: Vec<ScaleSlot>,
    /// The elements that switch between positions.
    pub(crate) switches: Vec<Switch>,
    /// Machine seconds per problem second.
    pub(crate) time_scale: f64,
    /// The elements in order of evaluation.
    pub(crate) order: Vec<usize>,
    /// For every element, the elements that read its output.
    pub(crate) readers: Vec<Vec<usize>>,
    /// Data that a backend has derived from the program.
    pub(crate) cache: Cache,
}

impl Program {
    /// The part that no run changes, for construction. A program under construction has no copies; with copies, this
    /// would clone what they share.
    pub(crate) fn lowered_mut(&mut self) -> &mut Lowered {
        Arc::make_mut(&mut self.lowered)
    }
}

/// The points [abscissa, ordinate] of every table.
pub(crate) type Tables = Vec<Vec<[f64; 2]>>;

/// A table that a drive looks up at time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Timetable {
    /// Index of the drive among the elements.
    pub element: usize,
    /// Index of the table.
    pub table: usize,
    /// Whether the drive follows straight lines between the points. Otherwise it keeps each value until the next
    /// point.
    pub is_straight: bool,
}

/// The output of an element, drive or reference.
#[derive(Debug, Clone)]
pub struct ElementOutput {
    /// Its name in the patch.
    pub name: String,
    /// The register of the body that contains its voltage.
    pub register: Register,
}

/// The state of an integrator or a lag: its output voltage.
#[derive(Debug, Clone)]
pub(crate) struct State {
    /// Index of the element.
    pub element: usize,
    /// Register of the rate, in volts per problem second. The rate is 0 while a limit holds the state.
    pub rate: Register,
    /// Register of the rate without the limit.
    pub demand: Register,
    /// Registers of the lower and the upper voltage at which the state is held.
    pub limits: [Register; 2],
    /// Index of the coefficient with the initial voltage.
    pub initial: u32,
    /// The time constant if the element is a lag. No step may be longer.
    pub lag: Option<TimeConstant>,
}

/// The time constant of a lag.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TimeConstant {
    /// Coefficient of the time in machine seconds.
    pub time: u32,
    /// Problem seconds per machine second.
    pub problem_seconds: f64,
}

/// A discrete value of an element, constant within a step. Relays, brakes, limits and drives with corners use modes.
#[derive(Debug, Clone)]
pub(crate) struct Mode {
    /// Index of the element.
    pub element: usize,
    /// Whether the element is a drive: its mode depends on time only.
    pub is_drive: bool,
    /// The value in initial condition.
    pub initial: f64,
    /// The possible changes; of several that are due, the first one happens.
    pub transitions: Vec<Transition>,
    /// What the error message recommends if the mode changes without end.
    pub chatter_remedy: ChatterRemedy,
}

/// The means of an element against endless switching (chatter). Error messages recommend it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChatterRemedy {
    /// The distance between the thresholds.
    Hysteresis,
    /// The speed below which the element stays at rest at a stop. Bounces follow each other ever sooner, so a shorter
    /// step does not help.
    Rest,
    /// The element has no such means; the cause is in its inputs.
    None,
}

/// A change of a mode from one value to another.
#[derive(Debug, Clone)]
pub struct Transition {
    /// The value of the mode before the change.
    pub(crate) from: f64,
    /// The value of the mode after the change.
    pub(crate) to: f64,
    /// The condition for the change.
    pub(crate) guard: Guard,
    /// The state that the change sets, if any.
    pub(crate) reset: Option<Reset>,
    /// Indices of other modes that change at the same time, with their new values.
    pub(crate) sets: Vec<(u32, f64)>,
}

/// A mode of the element whose law is being emitted.
#[derive(Debug, Clone, Copy)]
pub struct ModeHandle {
    /// Index of the mode in the program.
    pub(crate) index: u32,
    /// The register with the mode's present value.
    pub value: Register,
}

/// The condition for a transition: the value of a register reaches or passes 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard {
    /// The register that is compared with 0.
    pub(crate) register: Register,
    /// Whether the value must be above 0; otherwise 0 is sufficient.
    pub(crate) strict: bool,
}

/// A state that a transition sets to a new value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reset {
    /// Index of the state.
    pub state: u32,
    /// Register with the new value.
    pub to: Register,
}

impl Guard {
    /// A guard that holds if the value is 0 or above.
    pub fn reached(register: Register) -> Self {
        Guard { register, strict: false }
    }

    /// A guard that holds if the value is above 0.
    pub fn passed(register: Register) -> Self {
        Guard { register, strict: true }
    }

    /// The value that is compared with 0; negative before the transition is due.
    pub(crate) fn value(self, registers: &[f64]) -> f64 {
        registers[self.register.index()]
    }

    /// Whether the transition is due at these voltages.
    pub(crate) fn holds(self, registers: &[f64]) -> bool {
        let value = self.value(registers);
        if self.strict { value > 0.0 } else { value >= 0.0 }
    }
}

impl Transition {
    /// A change from one value of a mode to another.
    pub fn new(from: f64, to: f64, guard: Guard) -> Self {
        Transition { from, to, guard, reset: None, sets: Vec::new() }
    }

    /// The same change, which also sets the element's state to a value.
    pub fn reset(mut self, builder: &dyn Builder, to: Register) -> Self {
        self.reset = Some(Reset { state: builder.own_state(), to });
        self
    }

    /// The same change, which also sets another mode.
    pub fn with_mode(mut self, mode: ModeHandle, value: f64) -> Self {
        self.sets.push((mode.index, value));
        self
    }
}

/// A delay line of the program.
#[derive(Debug, Clone)]
pub(crate) struct Delay {
    /// Index of the element.
    pub element: usize,
    /// Register of the input.
    pub input: Register,
    /// Indices of the delay lines on whose output the input depends through anything except other delay lines. The
    /// line itself may be among them.
    pub upstream: Vec<usize>,
    /// Index of the coefficient with the delay, in machine seconds.
    pub time: u32,
    /// Index of the coefficient with the output before the first input arrives.
    pub initial: u32,
    /// Problem seconds per machine second.
    pub problem_seconds: f64,
}

/// A value that is constant within a step and sampled at its end: the memory of backlash and track-and-hold.
#[derive(Debug, Clone)]
pub(crate) struct SampledValue {
    /// Index of the coefficient with the initial value.
    pub initial: u32,
    /// Register whose value is sampled at the end of every step.
    pub next: Register,
}

/// A loop without an integrator.
///
/// The loop is opened at one element, whose output becomes an unknown, the tear. The operations after the tear up to
/// the result compute that output again. A voltage at which both agree solves the loop.
#[derive(Debug, Clone)]
pub struct Loop {
    /// Register of the tear.
    pub(crate) tear: Register,
    /// Register of the recomputed output; the tear must equal it.
    pub(crate) result: Register,
    /// Names of the members. The last one is the element that opens the loop.
    pub members: Vec<String>,
    /// Whether an open amplifier opens the loop.
    pub(crate) is_open: bool,
}

impl Loop {
    /// Name of the element that opens the loop.
    pub fn opened(&self) -> &str {
        self.members.last().map_or("", String::as_str)
    }
}

/// An overload lamp of an amplifier without a state.
#[derive(Debug, Clone)]
pub(crate) struct Lamp {
    /// Index of the element.
    pub element: usize,
    /// Register of the demanded output, before the amplifier's limit.
    pub demand: Register,
    /// Register of the output, within ±100 V.
    pub output: Register,
}

/// A signal that can be recorded.
#[derive(Debug, Clone)]
pub struct SignalInfo {
    /// Name of the signal.
    pub name: String,
    /// Register with its voltage.
    pub(crate) register: Register,
    /// Index of the coefficient with the signal's value per volt, in SI. `None` if the signal is in volts.
    pub(crate) per_volt: Option<u32>,
    /// Text of the unit.
    pub unit: String,
    /// Value of the unit in SI.
    pub(crate) per_unit: f64,
    /// Dimension of the unit; that of a voltage if the signal has no scale.
    pub(crate) dimension: Dimension,
    /// Whether the patch defines it under `signals`. The outputs of elements and drives are recordable under their own
    /// names.
    pub(crate) is_named: bool,
}

/// An element that switches between named positions.
#[derive(Debug, Clone)]
pub(crate) struct Switch {
    /// Index of the element.
    pub element: usize,
    /// Index of the mode. Its values 0, 1 and so on are the indices of the positions.
    pub mode: usize,
    /// Names of the positions.
    pub positions: &'static [&'static str],
}

/// Demanded output above which a lamp lights, in volts. The margin of 1e-6 of the reference prevents a lamp from
/// lighting by rounding.
pub(crate) const LAMP_THRESHOLD: f64 = REFERENCE * (1.0 + 1e-6);

impl Program {
    /// Makes every change of mode that is due at these voltages, at most one per mode, and passes each to `changed`.
    ///
    /// If modes of drives change, only these change now: the other guards would act on voltages from before the jump.
    /// After a change the caller must evaluate the body again.
    pub(crate) fn change_modes(
        &self,
        registers: &[f64],
        modes: &mut [f64],
        states: &mut [f64],
        mut changed: impl FnMut(usize, &Transition),
    ) {
        let mut any = false;
        for is_drive in [true, false] {
            let those = self.lowered.modes.iter().enumerate().filter(|(_, mode)| mode.is_drive == is_drive);
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

    /// Name of the element with this index.
    pub(crate) fn name(&self, element: usize) -> &str {
        &self.lowered.elements[element].name
    }

    /// The outputs of the elements in order of evaluation.
    pub(crate) fn in_evaluation_order(&self) -> impl Iterator<Item = &ElementOutput> {
        self.lowered.order.iter().map(|element| &self.lowered.elements[*element])
    }

    /// Index of the element, drive or reference with this name.
    pub(crate) fn element(&self, name: &str) -> Option<usize> {
        self.lowered.elements.iter().position(|output| output.name == name)
    }

    /// Index of the drive with this name.
    pub(crate) fn drive(&self, name: &str) -> Option<usize> {
        self.element(name)
            .filter(|element| self.lowered.drives.contains(&self.lowered.elements[*element].register))
    }

    /// Index of the table that a drive looks up at time.
    pub(crate) fn drive_table(&self, drive: usize) -> Option<usize> {
        self.lowered.timetables.iter().find(|own| own.element == drive).map(|own| own.table)
    }

    /// Index of the table that an element looks up at a voltage.
    pub(crate) fn element_curve(&self, element: usize) -> Option<usize> {
        self.lowered.curves.iter().find(|own| own.0 == element).map(|own| own.1)
    }

    /// Replaces the points of a table.
    pub(crate) fn set_points(&mut self, table: usize, points: Vec<[f64; 2]>) {
        Arc::make_mut(&mut self.tables)[table] = points;
        self.find_corners();
    }

    /// Updates the times at which tables of time have corners.
    pub(crate) fn find_corners(&mut self) {
        let straight = self.lowered.timetables.iter().filter(|own| own.is_straight);
        self.corners = Arc::new(TableCorners::from_tables(straight.map(|own| &self.tables[own.table][..])));
    }

    /// Index of the parameter with this name.
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|slot| slot.declared.name == name)
    }

    /// The scale with this name.
    pub(crate) fn scale(&self, name: &str) -> Option<&ScaleSlot> {
        self.lowered.scales.iter().find(|slot| slot.name == name)
    }

    /// The signal with this name, if the patch defines it under `signals`.
    pub(crate) fn signal(&self, name: &str) -> Option<&SignalInfo> {
        self.lowered.signals.iter().find(|signal| signal.is_named && signal.name == name)
    }

    /// The parameters, in the order of the patch.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("dx/dt = -k x").parameter("k", 0.5, "1", [0.0, 1.0]);
    /// let patch = patch.element("A1", decay).element("P1", pot).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let names: Vec<&str> = program.parameters().iter().map(|slot| slot.declared.name.as_str()).collect();
    /// assert_eq!(names, ["k"]);
    /// assert_eq!((program.parameter("k"), program.parameter("q")), (Some(0), None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn parameters(&self) -> &[ParameterSlot] {
        &self.parameters
    }

    /// The outputs of all references, drives and elements.
    pub fn element_outputs(&self) -> &[ElementOutput] {
        &self.lowered.elements
    }

    /// The signals that can be recorded.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").scale("length", 2, "mm").element("A1", decay);
    /// let patch = patch.signal("x", "A1", "length", 1.0).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// let names: Vec<_> = program.signals().iter().map(|signal| (&signal.name[..], &signal.unit[..])).collect();
    /// assert_eq!(names, [("x", "mm"), ("A1", "V")]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn signals(&self) -> &[SignalInfo] {
        &self.lowered.signals
    }

    /// The loops without an integrator.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::Machine;
    ///
    /// // out = -(60 V + out / 2)
    /// let input = ElementBuilder::new("pot").cord("in", "+100").set("setting", 0.6);
    /// let feedback = ElementBuilder::new("pot").cord("in", "S1").set("setting", 0.5);
    /// let summer = ElementBuilder::new("summer").cords("x1", ["P1", "P2"]);
    /// let patch = PatchBuilder::new("loop").element("P1", input).element("P2", feedback);
    /// let patch = patch.element("S1", summer).build()?;
    /// let program = Program::new(&Circuit::new(&patch)?)?;
    /// assert_eq!(program.loops()[0].opened(), "S1");
    /// assert!((Machine::new(&program, 1e-3)?.voltage("S1")? + 40.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn loops(&self) -> &[Loop] {
        &self.lowered.loops
    }

    /// Names of the states, in order.
    pub fn states(&self) -> Vec<&str> {
        self.lowered.states.iter().map(|state| self.name(state.element)).collect()
    }

    /// The operations of the body, in order of evaluation.
    pub fn body(&self) -> &[Op] {
        &self.lowered.body
    }
}
