//! The circuit: a checked patch, as a graph of elements and cords.
//!
//! [`Circuit::new`] resolves every name of the patch and checks names, inputs, units, settings, machine parts, phases
//! and signals. It continues after a fault, so one report shows all faults. Then it finds the order in which voltages
//! are computed, with the loops that have no integrator. Lowering makes a program from the circuit.
//!
//! The checks run in the order in which they need each other: names, machine, quantities, cords, settings, parts,
//! phases, signals, equations, loops. Warnings about unused elements come last, and only if there is no error. Scales
//! are compared with the wiring, and times of tables with the run, when the warnings are requested.

mod element;
mod equations;
mod inventory;
mod loops;
mod macros;
mod names;
mod parameters;
mod phases;
mod resolve;
mod scaling;
mod scope;
mod settings;
mod signals;
mod table_times;

use std::collections::BTreeSet;

use petgraph::Direction;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef as _;

use crate::document::{Diagnostic, Report};
use crate::machines::{MachineModel, Part};
use crate::patch::{Parameter, Patch, RunPlan};
use patchcord_expr::{Formula, Unit};

pub use element::{Cord, Element, EvaluationStep, SignalPoint};
pub use equations::EquationScope;
pub use inventory::part_count;
pub use scaling::ScalingRow;
pub use scope::Quantities;
pub use settings::{RangeCheck, RangeFault};

/// A patch that passed all checks: every input is driven, the units agree and the machine has enough parts.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let integrator = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", integrator).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let names: Vec<_> = circuit.elements().into_iter().map(|element| element.name.as_str()).collect();
/// assert_eq!(names, ["+100", "-100", "ground", "A1"]);
/// // The only cord goes from A1, the element with index 3, to itself.
/// let cords = circuit.cords(3);
/// assert_eq!((cords.len(), cords[0].0, cords[0].1.gain), (1, 3, 1.0));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Circuit {
    /// The patch from which the circuit was made, as it was given.
    patch: Patch,
    /// The changed parameters with their values in the declared units.
    changes: Vec<(String, f64)>,
    /// The machine of the patch, or the machine without limits.
    machine: &'static MachineModel,
    /// The parameters, scales and settings of macros' instances, with their values.
    quantities: Quantities,
    /// References, drives and elements, in this order and otherwise in that of the document, with their cords.
    graph: DiGraph<Element, Cord>,
    /// The steps of one instant. Every element is a member of exactly one step.
    evaluation_order: Vec<EvaluationStep>,
    /// Everything that can be recorded: signals, then drives, then elements.
    signals: Vec<SignalPoint>,
    /// Indices of the signals that the patch records.
    record: Vec<usize>,
    /// The auxiliary quantities of the equations. All their dimensions are known.
    auxiliaries: equations::Auxiliaries,
    /// The parts of the machine that the patch uses, with their numbers.
    parts: Vec<(Part, usize)>,
    /// The warnings of all checks. There are no errors among them.
    warnings: Vec<Diagnostic>,
}

impl Circuit {
    /// Resolves and checks a patch with its own parameter values.
    ///
    /// # Errors
    /// If the patch is wrong. The report has all errors and warnings.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::document::Code;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let summer = ElementBuilder::new("summer").cords("x1", ["A9"]);
    /// let patch = PatchBuilder::new("wrong").element("A1", summer).build()?;
    /// let report = Circuit::new(&patch).unwrap_err();
    /// assert_eq!(report.findings[0].code, Code::UNKNOWN_NAME);
    /// assert_eq!(report.findings[0].message, "A1 is driven by A9, which is not in the patch");
    /// # Ok(())
    /// # }
    /// ```
    pub fn new(patch: &Patch) -> Result<Circuit, Box<Report>> {
        resolve::resolve(patch, &[])
    }

    /// Resolves and checks a patch with other values of some parameters, in their declared units. If a parameter is
    /// listed twice, its last value counts.
    ///
    /// # Errors
    /// If the patch is wrong, there is no such parameter, or a value is outside its range. The report has all errors
    /// and warnings.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let pot = ElementBuilder::new("pot").cord("in", "+100").set("setting", "share");
    /// let builder = PatchBuilder::new("pot").parameter("share", 0.5, "1", [0.0, 1.0]);
    /// let patch = builder.element("P1", pot).build()?;
    /// let circuit = Circuit::with_parameters(&patch, [("share", 0.25)])?;
    /// assert_eq!(circuit.parameters().next().map(|(_, _, value)| value), Some(0.25));
    ///
    /// let report = Circuit::with_parameters(&patch, [("share", 2.0)]).unwrap_err();
    /// assert_eq!(report.findings[0].message, "share = 2 is outside its range 0 ... 1");
    /// # Ok(())
    /// # }
    /// ```
    pub fn with_parameters(
        patch: &Patch,
        values: impl IntoIterator<Item = (impl AsRef<str>, f64)>,
    ) -> Result<Circuit, Box<Report>> {
        let values: Vec<_> =
            values.into_iter().map(|(name, value)| (name.as_ref().to_owned(), value)).collect();
        resolve::resolve(patch, &values)
    }

    /// The patch from which the circuit was made.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// The machine on which the circuit is patched.
    pub fn machine(&self) -> &'static MachineModel {
        self.machine
    }

    /// The gains that the machine has at the inputs of an element, in ascending order. Empty if it has all gains.
    pub fn input_gains(&self, element: usize) -> &'static [f64] {
        self.element(element).kind.available_gains(self.machine)
    }

    /// The warnings about the patch. If the patch was edited, its text is read again for the positions.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let summer = ElementBuilder::new("summer").cords("x1", ["+100"]);
    /// let patch = PatchBuilder::new("unused").element("A1", summer).build()?;
    /// let warnings = Circuit::new(&patch)?.warnings();
    /// assert!(!warnings.has_errors());
    /// assert_eq!(warnings.findings[0].message, "nothing uses the output of A1");
    /// # Ok(())
    /// # }
    /// ```
    pub fn warnings(&self) -> Report {
        self.warnings_for(self.run_plan())
    }

    /// Like [`Circuit::warnings`], for a run with another plan than that of the patch. Times of tables are compared
    /// with the length of this run.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::document::{Placed, Span};
    /// use patchcord_core::patch::{Patch, RunPlan};
    ///
    /// let text = r#"{"patchcord": 1, "scales": {"volt": {"per_volt": 1, "unit": "V"}},
    ///  "drives": {"D": {"kind": "table", "scale": "volt", "points": [[4, 0], [5, 1]]}},
    ///  "signals": {"d": {"at": "D", "scale": "volt"}}, "run": {"for": 3, "step": 0.01}}"#;
    /// let circuit = Circuit::new(&Patch::parse("p.json", text)?)?;
    /// assert_eq!(circuit.warnings().warning_count(), 1);
    /// let duration = Some(Placed { value: 10.0, span: Span::default() });
    /// let longer = RunPlan { duration, ..circuit.run_plan().clone() };
    /// assert_eq!(circuit.warnings_for(&longer).warning_count(), 0);
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn warnings_for(&self, plan: &RunPlan) -> Report {
        match self.reread() {
            Some(Ok(read)) => read.warnings_for(plan),
            Some(Err(report)) => *report,
            None => {
                let mut found = scaling::integral_warnings(self);
                if found.is_empty() {
                    found.extend(scaling::time_scale_warning(self));
                }
                table_times::check(&self.patch, plan, &mut found);
                self.report_with(macros::merge_instances(&self.patch, found))
            }
        }
    }

    /// Line and column of the name of an element or drive in the text of the patch. Both count from 1; columns count
    /// characters.
    ///
    /// If the patch was edited, its text is read again. `None` if the name is not in the patch, as for references.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::Patch;
    ///
    /// let text = r#"{"patchcord": 1,
    ///  "elements": {"A1": {"kind": "summer", "in": {"x1": ["+100"]}}}}"#;
    /// let circuit = Circuit::new(&Patch::parse("p.json", text)?)?;
    /// assert_eq!(circuit.position_of("A1"), Some((2, 15)));
    /// assert_eq!(circuit.position_of("+100"), None);
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn position_of(&self, element: &str) -> Option<(usize, usize)> {
        let read = self.patch.reread().transpose().ok()?;
        let patch = read.as_ref().unwrap_or(&self.patch);
        let entry = patch.drives.get(element).or_else(|| patch.elements.get(element))?;
        let report = Report::new(patch.file(), patch.text(), Vec::new());
        Some(report.line_and_column(entry.span.start))
    }

    /// The circuit of the patch when its text is read again. `None` if the patch was not edited since it was read.
    pub(crate) fn reread(&self) -> Option<Result<Circuit, Box<Report>>> {
        let read = self.patch.reread()?;
        Some(read.and_then(|patch| resolve::resolve(&patch, &self.changes)))
    }

    /// A report with the warnings and further diagnostics.
    pub(crate) fn report_with(&self, more: Vec<Diagnostic>) -> Report {
        let findings = self.warnings.iter().cloned().chain(more).collect();
        Report::new(self.patch.file(), self.patch.text(), findings)
    }

    /// All references, drives and elements, in the order of their indices.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let summer = ElementBuilder::new("summer").cords("x1", ["+100"]);
    /// let circuit = Circuit::new(&PatchBuilder::new("sum").element("A1", summer).build()?)?;
    /// // The three references come first.
    /// assert_eq!(circuit.elements().len(), 4);
    /// assert_eq!(circuit.element(3).kind.name, "summer");
    /// # Ok(())
    /// # }
    /// ```
    pub fn elements(&self) -> Vec<&Element> {
        self.graph.node_weights().collect()
    }

    /// The element, drive or reference with this index.
    pub fn element(&self, index: usize) -> &Element {
        &self.graph[NodeIndex::new(index)]
    }

    /// The cords into an element in the order of the document, each with the index of the element that drives it.
    pub fn cords(&self, element: usize) -> Vec<(usize, Cord)> {
        let incoming = self.graph.edges_directed(NodeIndex::new(element), Direction::Incoming);
        let mut cords: Vec<_> =
            incoming.map(|edge| (edge.id(), edge.source().index(), *edge.weight())).collect();
        cords.sort_by_key(|(id, ..)| *id);
        cords.into_iter().map(|(_, from, cord)| (from, cord)).collect()
    }

    /// For every element, the indices of the elements that read its output, in rising order.
    pub(crate) fn all_readers(&self) -> Vec<Vec<usize>> {
        let readers = |element| {
            let readers: BTreeSet<_> = self.graph.neighbors(element).map(NodeIndex::index).collect();
            readers.into_iter().collect()
        };
        self.graph.node_indices().map(readers).collect()
    }

    /// The steps in which the voltages of an instant are computed. A step only needs the results of earlier steps.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::{Circuit, EvaluationStep};
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// // A summer that drives itself is a loop without an integrator: out = -(out + 100 V).
    /// let summer = ElementBuilder::new("summer").cords("x1", ["A1", "+100"]);
    /// let circuit = Circuit::new(&PatchBuilder::new("loop").element("A1", summer).build()?)?;
    /// let is_loop = |step: &EvaluationStep| matches!(step, EvaluationStep::Loop { openers, .. } if *openers == [3]);
    /// assert!(circuit.evaluation_order().iter().any(is_loop));
    /// # Ok(())
    /// # }
    /// ```
    pub fn evaluation_order(&self) -> &[EvaluationStep] {
        &self.evaluation_order
    }

    /// Name, declaration and present value of every parameter. Values are in the declared units.
    pub fn parameters(&self) -> impl Iterator<Item = (&str, &Parameter, f64)> {
        let values = self.quantities.parameter_values();
        self.patch
            .parameters
            .iter()
            .zip(values)
            .map(|((name, parameter), value)| (name.as_str(), parameter, value))
    }

    /// Name and formula of a derived quantity: a scale, or a setting of a macro's instance such as "L1.T".
    pub fn derived(&self, index: usize) -> (&str, &Formula) {
        self.quantities.derived(index)
    }

    /// Index of the derived quantity with this name. A scale has the same index as in the patch.
    pub fn derived_index(&self, name: &str) -> Option<usize> {
        self.quantities.derived_index(name)
    }

    /// Unit of the derived quantity with this index.
    pub fn derived_unit(&self, index: usize) -> &Unit {
        self.quantities.unit(index)
    }

    /// The value of one volt in a scale, in the scale's unit.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let step = ElementBuilder::new("step").set("height", 5);
    /// let builder = PatchBuilder::new("step").scale("position", 0.5, "mm").drive("D", "position", step);
    /// let circuit = Circuit::new(&builder.build()?)?;
    /// let scale = circuit.derived_index("position").expect("the patch has the scale");
    /// let per_volt = circuit.per_volt(scale).expect("the scale has a value");
    /// assert!((per_volt - 0.5).abs() < 1e-15);
    /// assert_eq!(circuit.derived_unit(scale).text(), "mm");
    /// # Ok(())
    /// # }
    /// ```
    pub fn per_volt(&self, scale: usize) -> Option<f64> {
        Some(self.derived_unit(scale).out_of_si(self.quantities.per_volt(scale)?))
    }

    /// The quantities that formulas can name, with their values and units.
    pub fn quantities(&self) -> &Quantities {
        &self.quantities
    }

    /// Whether a formula consists of bare numbers. Its value is then in the unit that its context expects.
    pub fn is_literal(&self, formula: &Formula) -> bool {
        self.quantities.is_literal(formula)
    }

    /// Machine seconds per problem second.
    pub fn time_scale(&self) -> f64 {
        self.patch.time_scale
    }

    /// The run plan of the patch: duration, step, phases and so on.
    pub fn run_plan(&self) -> &RunPlan {
        &self.patch.run
    }

    /// The gains of the wiring between scaled signals, with the physical gains that they represent (eq. 4-8).
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("inverter")
    ///     .scale("volt", 1.0, "V")
    ///     .drive("D", "volt", ElementBuilder::new("step").set("height", 1))
    ///     .element("A1", ElementBuilder::new("inverter").cord("in", "D"))
    ///     .signal("in", "D", "volt", 1.0)
    ///     .signal("out", "A1", "volt", 1.0)
    ///     .build()?;
    /// let rows = Circuit::new(&patch)?.scaling();
    /// assert_eq!((rows[0].input.as_str(), rows[0].output.as_str()), ("in", "out"));
    /// assert_eq!((rows[0].computer_gain, rows[0].block.as_deref()), (-1.0, Some("1")));
    /// # Ok(())
    /// # }
    /// ```
    pub fn scaling(&self) -> Vec<ScalingRow> {
        scaling::audit(self)
    }
}

/// The circuit of a patch with its own parameter values, as by [`Circuit::new`].
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let summer = ElementBuilder::new("summer").cords("x1", ["+100"]);
/// let patch = PatchBuilder::new("sum").element("A1", summer).build()?;
/// assert_eq!(Circuit::try_from(&patch)?.patch().title, "sum");
/// # Ok(())
/// # }
/// ```
impl TryFrom<&Patch> for Circuit {
    type Error = Box<Report>;

    fn try_from(patch: &Patch) -> Result<Circuit, Box<Report>> {
        Circuit::new(patch)
    }
}
