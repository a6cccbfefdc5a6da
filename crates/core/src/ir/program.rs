//! The program: its two parts, and the look-ups by name.
//!
//! Copies of a program share the part that no run changes ([`Lowered`]). Parameter values and tables belong to each
//! copy, because a run or a fit sets them.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{
    Angle, Cache, Coefficient, Delay, ElementOutput, Kink, Lamp, Level, Loop, Mode, Op, ParameterValue,
    Register, SampledValue, ScaleFactor, Sections, SettingOrder, SignalInfo, State, Switch, TableCorners,
    Timetable,
};

/// A circuit as a list of operations. [`Program::new`] makes it and [`Machine`](crate::solve::Machine) runs it.
///
/// Copies share everything that a run cannot change, so a copy per run is cheap. Parameter values and tables belong to
/// each copy.
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
/// assert_eq!(program.states(), ["A1"]);
/// // A copy has its own parameters.
/// let mut faster = program.clone();
/// faster.set_parameters([("k", 1.0)])?;
/// assert_eq!((program.parameters()[0].value, faster.parameters()[0].value), (0.5, 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Program {
    /// The parameters of the patch with their present values, in the order of the patch.
    pub(crate) parameters: Vec<ParameterValue>,
    /// The points of all tables; the index is the one in [`Op::Table`].
    pub(crate) tables: Arc<Tables>,
    /// The times at which tables of time have corners. No step reaches across one.
    pub(crate) corners: Arc<TableCorners>,
    /// Everything that no run changes.
    pub(crate) lowered: Arc<Lowered>,
}

/// The part of a [`Program`] that no run changes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lowered {
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
    /// The index of every element in `elements`, by name.
    pub(crate) element_indices: BTreeMap<String, usize>,
    /// The registers of the drives' outputs.
    pub(crate) drives: Vec<Register>,
    /// The states; the index is the one in [`Op::State`].
    pub(crate) states: Vec<State>,
    /// The modes; the index is the one in [`Op::Mode`].
    pub(crate) modes: Vec<Mode>,
    /// The delay lines; the index is the one in [`Op::Delayed`].
    pub(crate) delays: Vec<Delay>,
    /// The sampled values; the index is the one in [`Op::Sampled`].
    pub(crate) sampled: Vec<SampledValue>,
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
    /// The index of every signal in `signals`, by name.
    pub(crate) signal_indices: BTreeMap<String, usize>,
    /// The scales that formulas in a run can name.
    pub(crate) scales: Vec<ScaleFactor>,
    /// The elements that switch between positions, in the order of the elements.
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

impl Program {
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
        self.lowered.element_indices.get(name).copied()
    }

    /// Index of the drive with this name.
    pub(crate) fn drive(&self, name: &str) -> Option<usize> {
        self.element(name)
            .filter(|element| self.lowered.drives.contains(&self.lowered.elements[*element].register))
    }

    /// Index of the table that a drive looks up at time. `drive` is its index in [`Program::element_outputs`].
    pub fn drive_table(&self, drive: usize) -> Option<usize> {
        self.lowered.timetables.iter().find(|entry| entry.element == drive).map(|entry| entry.table)
    }

    /// Index of the table that an element looks up at a voltage. `element` is its index in
    /// [`Program::element_outputs`].
    pub fn element_curve(&self, element: usize) -> Option<usize> {
        self.lowered.curves.iter().find(|curve| curve.0 == element).map(|curve| curve.1)
    }

    /// Replaces the points of a table.
    pub(crate) fn set_points(&mut self, table: usize, points: Vec<[f64; 2]>) {
        Arc::make_mut(&mut self.tables)[table] = points;
        self.find_corners();
    }

    /// Updates the times at which tables of time have corners.
    pub(crate) fn find_corners(&mut self) {
        let straight = self.lowered.timetables.iter().filter(|timetable| timetable.is_straight);
        let tables = straight.map(|timetable| &self.tables[timetable.table][..]);
        self.corners = Arc::new(TableCorners::from_tables(tables));
    }

    /// The scale with this name.
    pub(crate) fn scale(&self, name: &str) -> Option<&ScaleFactor> {
        self.lowered.scales.iter().find(|scale| scale.name == name)
    }

    /// The signal with this name, if the patch defines it under `signals`.
    pub(crate) fn signal(&self, name: &str) -> Option<&SignalInfo> {
        self.recordable_signal(name).filter(|signal| signal.is_named)
    }

    /// The signal with this name, which may be that of an element or a drive.
    pub(crate) fn recordable_signal(&self, name: &str) -> Option<&SignalInfo> {
        self.lowered.signal_indices.get(name).map(|index| &self.lowered.signals[*index])
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
    /// let k = &program.parameters()[0];
    /// assert_eq!((k.declared.name.as_str(), k.value), ("k", 0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn parameters(&self) -> &[ParameterValue] {
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
    /// assert!(program.loops()[0].openers().eq(["S1"]));
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
