//! The circuit: the patch resolved and checked, as a graph of elements and cords.

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

use std::collections::BTreeSet;

use indexmap::IndexSet;
use petgraph::Direction;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef as _;

use crate::document::{Diagnostic, Placed, Report, Span, derivative_of};
use crate::elements::Kind;
use crate::machines::{Machine, Part};
use crate::patch::{Amount, Parameter, Patch, PictureSpec, RunPlan};
use patchcord_expr::{Formula, Unit};

pub use scaling::ScalingRow;
pub use scope::Quantities;

/// A patch that can be run: every input driven, units and inventory in order, loops known.
#[derive(Debug)]
pub struct Circuit {
    patch: Patch,
    /// The parameters that were changed, in their declared units.
    changes: Vec<(String, f64)>,
    machine: &'static Machine,
    quantities: Quantities,
    graph: DiGraph<Element, Cord>,
    stages: Vec<Stage>,
    signals: Vec<SignalPoint>,
    record: Vec<usize>,
    used: Vec<(Part, usize)>,
    warnings: Vec<Diagnostic>,
}

/// An element, a drive or a reference.
#[derive(Debug, Clone)]
pub struct Element {
    /// Its name, by which cords reach it.
    pub name: String,
    /// Its kind.
    pub kind: &'static Kind,
    /// Its settings, in the order of the kind's; `None` where the patch says nothing.
    pub settings: Vec<Option<Placed<Amount>>>,
    /// Index of a drive's scale.
    pub scale: Option<usize>,
    /// Where its name stands; references stand nowhere.
    pub span: Option<Span>,
}

/// A cord into an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cord {
    /// Index of the input among the kind's inputs.
    pub input: usize,
    /// Gain of the jack; 1 where it has none.
    pub gain: f64,
}

/// A step of working out every voltage of an instant.
#[derive(Debug, Clone, PartialEq)]
pub enum Stage {
    /// An element whose direct inputs are known by now.
    Element(usize),
    /// A loop without an integrator.
    Loop {
        /// The element that opens it; worked out last.
        opened: usize,
        /// The other members in order once it is opened; loops among them stand inside this one.
        inside: Vec<Stage>,
    },
}

impl Stage {
    /// The elements of the stage in order; the one that opens a loop last.
    pub fn members(&self) -> Vec<usize> {
        match self {
            Stage::Element(element) => vec![*element],
            Stage::Loop { opened, inside } => {
                inside.iter().flat_map(Stage::members).chain([*opened]).collect()
            }
        }
    }
}

/// A place where a quantity is read.
#[derive(Debug, Clone)]
pub struct SignalPoint {
    /// Name of the signal.
    pub name: String,
    /// Index of the element at whose output it is read.
    pub element: usize,
    /// Index of its scale; without one it is in volts.
    pub scale: Option<usize>,
    /// What the scaled voltage is multiplied by.
    pub factor: f64,
}

impl Circuit {
    /// Resolves and checks a patch; `changes` are parameters set anew, in their declared units.
    ///
    /// # Errors
    /// Everything that is wrong with the patch and the changes, all at once.
    pub fn new(patch: &Patch, changes: &[(String, f64)]) -> Result<Circuit, Box<Report>> {
        resolve::circuit(patch, changes)
    }

    /// The patch that it was made from.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// The machine that it is made for.
    pub fn machine(&self) -> &'static Machine {
        self.machine
    }

    /// What the reader should know although the circuit can be run. If the patch was edited, its text is read again.
    pub fn warnings(&self) -> Report {
        match self.reread() {
            Some(Ok(read)) => read.warnings(),
            Some(Err(report)) => *report,
            None => self.report_with(Vec::new()),
        }
    }

    /// Line and column (both from 1, columns in characters) of the name of an element or a drive in the text of the patch.
    /// If the patch was edited, its text is read again. `None` if the name is not in the patch, as for references.
    pub fn place_of(&self, element: &str) -> Option<(usize, usize)> {
        let read = self.patch.reread().transpose().ok()?;
        let patch = read.as_ref().unwrap_or(&self.patch);
        let entry = patch.drives.get(element).or_else(|| patch.elements.get(element))?;
        let report = Report::new(patch.file(), patch.text(), Vec::new());
        Some(report.line_and_column(entry.span.start))
    }

    /// The circuit of the patch read again from its text; `None` if the patch was not edited since it was read.
    pub(crate) fn reread(&self) -> Option<Result<Circuit, Box<Report>>> {
        let read = self.patch.reread()?;
        Some(read.and_then(|patch| resolve::circuit(&patch, &self.changes)))
    }

    /// The warnings and more findings.
    pub(crate) fn report_with(&self, more: Vec<Diagnostic>) -> Report {
        let findings = self.warnings.iter().cloned().chain(more).collect();
        Report::new(self.patch.file(), self.patch.text(), findings)
    }

    /// Every element, drive and reference, by index.
    pub fn elements(&self) -> Vec<&Element> {
        self.graph.node_weights().collect()
    }

    /// An element by index.
    pub fn element(&self, index: usize) -> &Element {
        &self.graph[NodeIndex::new(index)]
    }

    /// The cords into an element, in the order of the document, each with the element that it comes from.
    pub fn cords(&self, element: usize) -> Vec<(usize, Cord)> {
        let incoming = self.graph.edges_directed(NodeIndex::new(element), Direction::Incoming);
        let mut cords: Vec<_> =
            incoming.map(|edge| (edge.id(), edge.source().index(), *edge.weight())).collect();
        cords.sort_by_key(|(id, ..)| *id);
        cords.into_iter().map(|(_, from, cord)| (from, cord)).collect()
    }

    /// For every element, those that read it.
    pub(crate) fn all_readers(&self) -> Vec<Vec<usize>> {
        let readers = |element| {
            let readers: BTreeSet<_> = self.graph.neighbors(element).map(NodeIndex::index).collect();
            readers.into_iter().collect()
        };
        self.graph.node_indices().map(readers).collect()
    }

    /// The order in which voltages are worked out.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }

    /// The parameters with their values for this run, in their declared units.
    pub fn parameters(&self) -> impl Iterator<Item = (&str, &Parameter, f64)> {
        let values = self.quantities.parameter_values();
        self.patch
            .parameters
            .iter()
            .zip(values)
            .map(|((name, parameter), value)| (name.as_str(), parameter, value))
    }

    /// Name and formula of a scale or of a macro's setting ("L1.T").
    pub fn derived(&self, index: usize) -> (&str, &Formula) {
        self.quantities.derived(index)
    }

    /// Its index by name; scales have the same among the scales of the patch.
    pub fn derived_index(&self, name: &str) -> Option<usize> {
        self.quantities.derived_index(name)
    }

    /// Its unit.
    pub fn derived_unit(&self, index: usize) -> &Unit {
        self.quantities.unit(index)
    }

    /// What one volt of a scale stands for, in the scale's unit.
    pub fn per_volt(&self, scale: usize) -> Option<f64> {
        Some(self.derived_unit(scale).out_of_si(self.quantities.per_volt(scale)?))
    }

    /// Names, values and units of parameters and scales.
    pub fn quantities(&self) -> &Quantities {
        &self.quantities
    }

    /// Whether a formula has no unit of its own, and so stands in that of its place.
    pub fn is_plain(&self, formula: &Formula) -> bool {
        self.quantities.is_plain(formula)
    }

    /// Machine seconds per problem second.
    pub fn time_scale(&self) -> f64 {
        self.patch.time_scale
    }

    /// Everything that can be recorded: signals, drives, elements.
    pub fn signals(&self) -> &[SignalPoint] {
        &self.signals
    }

    /// The name under which something is recorded: its own, or of an instance's port that of the element that it is.
    pub fn recordable<'n>(&'n self, name: &'n str) -> Option<&'n str> {
        let is_signal = |name: &str| self.signals.iter().any(|point| point.name == name);
        let at_port = || self.patch.ports.get(name).map(|port| port.at.as_str());
        is_signal(name).then_some(name).or_else(at_port)
    }

    /// Names of what the patch records and of what its pictures show, each once.
    pub fn recorded(&self) -> Vec<String> {
        let asked = self.record.iter().map(|index| self.signals[*index].name.clone());
        let mut names: Vec<String> = asked.collect();
        for name in self.pictured() {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// Names of the signals that the patch's pictures show, or derivatives of.
    pub fn pictured(&self) -> impl Iterator<Item = String> + '_ {
        let signal = |name: &str| derivative_of(name).map_or(name, |(signal, _)| signal).to_owned();
        self.shown().filter(|name| *name != "t").map(signal)
    }

    /// Names of the parameters by which the patch's pictures show derivatives, each once.
    pub fn differentiated(&self) -> Vec<String> {
        let parameters = self.shown().filter_map(|name| Some(derivative_of(name)?.1.to_owned()));
        parameters.collect::<IndexSet<_>>().into_iter().collect()
    }

    fn shown(&self) -> impl Iterator<Item = &str> {
        let shown = self.patch.pictures.iter().flat_map(|picture| picture.y.iter().chain([&picture.x]));
        shown.map(|name| name.value.as_str())
    }

    /// Unit of a signal: its text, and what it is in SI.
    pub(crate) fn signal_unit(&self, signal: &SignalPoint) -> (String, f64) {
        match signal.scale {
            Some(scale) => {
                let unit = self.derived_unit(scale);
                (unit.text().to_owned(), unit.factor())
            }
            None => ("V".to_owned(), 1.0),
        }
    }

    /// The parts that the circuit takes.
    pub fn parts(&self) -> &[(Part, usize)] {
        &self.used
    }

    /// The parts that an element takes, the one that its kind names first in front.
    pub fn parts_of(&self, element: &str) -> Vec<(Part, usize)> {
        let Some(entry) = self.patch.elements.get(element) else { return Vec::new() };
        let mut parts: Vec<(Part, usize)> = Vec::new();
        for takes in entry.kind.parts {
            let count = inventory::taken(entry, takes.part);
            if count > 0 && parts.iter().all(|(part, _)| *part != takes.part) {
                parts.push((takes.part, count));
            }
        }
        parts
    }

    /// Names of the parts that the patch lists for an element.
    pub fn part_names(&self, element: &str, part: Part) -> Vec<String> {
        let entry = self.patch.elements.get(element);
        let uses = entry.into_iter().flat_map(|entry| &entry.uses).filter(|(key, _)| key.value == part.key());
        uses.flat_map(|(_, names)| names.iter().map(|name| name.value.clone())).collect()
    }

    /// How the patch asks to be run.
    pub fn run_plan(&self) -> &RunPlan {
        &self.patch.run
    }

    /// The pictures that the patch asks for; where it asks for none, each of these signals against time.
    pub fn picture_specs<'a>(&self, recorded: impl Iterator<Item = &'a str>) -> Vec<PictureSpec> {
        if !self.patch.pictures.is_empty() {
            return self.patch.pictures.clone();
        }
        let placed = |name: &str| Placed { value: name.to_owned(), span: Span::default() };
        let against_time = |name| PictureSpec { title: String::new(), x: placed("t"), y: vec![placed(name)] };
        recorded.map(against_time).collect()
    }

    /// The computer gain of the wiring between scaled signals, against the scales (eq. 4-8).
    pub fn scaling(&self) -> Vec<ScalingRow> {
        scaling::audit(self)
    }
}
