//! The fields of a patch, decoded from its document but not yet checked.
//!
//! Decoding fills the types of this module. [`Circuit::new`](crate::circuit::Circuit::new) checks them together:
//! whether every cord has a source, whether units agree, whether the machine has enough parts. Values are kept in the
//! units of the document, and names are kept with their position ([`Placed`]) for reports.

use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;

use indexmap::IndexMap;
use serde_json::Value;

use super::edited_text::EditedText;
use super::macros::{Instance, InstanceOutput, Macro, SectionEntry};
use super::table_access::TableAccess;
use super::table_file::{PointsBySpan, TableFile};
use crate::document::{
    Diagnostic, ParameterRangeError, Phase, Placed, Report, RunExtent, Span, parameter_in_si,
};
use crate::elements::Kind;
use patchcord_expr::{Dimension, Equation, Formula, Unit};

/// The version of the document format that this program reads and writes. It is the value of the key "patchcord".
pub const FORMAT_VERSION: u64 = 1;

/// A physical quantity that a user can vary, and that formulas name.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Value in `unit`.
    pub value: f64,
    /// Unit of the value and the range.
    pub unit: Unit,
    /// Smallest and largest permitted value, in `unit`. `None` if every finite value is permitted.
    pub range: Option<(f64, f64)>,
    /// Description for the reader; empty if the document has none.
    pub description: String,
    /// Position of its name in the document.
    pub span: Span,
    /// Position of its value in the document.
    pub value_span: Span,
}

impl Parameter {
    /// Converts a value from the declared unit to SI units and checks it. `name` is the parameter's name, for the
    /// error.
    ///
    /// # Errors
    /// If the value is not finite in SI units, or is outside the range.
    pub(crate) fn in_si(&self, name: &str, value: f64) -> Result<f64, ParameterRangeError> {
        parameter_in_si(name, value, (self.unit.text(), self.unit.factor()), self.range)
    }
}

/// A scale: the value of one volt as a physical quantity.
#[derive(Debug, Clone)]
pub struct Scale {
    /// Value of one volt. A plain number is in `unit`; a formula has its own unit. `None` if it could not be read.
    pub per_volt: Option<Placed<Formula>>,
    /// Unit of the quantity.
    pub unit: Unit,
    /// Position of its name in the document.
    pub span: Span,
}

/// The value of a setting, in the form that its [quantity](crate::elements::SettingQuantity) requires.
#[derive(Debug, Clone, PartialEq)]
pub enum Amount {
    /// A number or a formula.
    Formula(Formula),
    /// true or false.
    Flag(bool),
    /// The index of the chosen word among the words that the setting permits.
    Choice(usize),
    /// Points [time, value] of a table or [input, output] of a curve. The first numbers are strictly increasing.
    Points(Vec<[f64; 2]>),
}

/// A cord from an output to an input of an element.
#[derive(Debug, Clone)]
pub struct Plug {
    /// Name of the jack in the document: "x10", "in", "bias_plus".
    pub jack: Placed<String>,
    /// Name of the element, drive or reference that drives the jack.
    pub from: Placed<String>,
}

/// An element or a drive of the document.
#[derive(Debug, Clone)]
pub struct ElementEntry {
    /// The kind of element.
    pub kind: &'static Kind,
    /// The cords, in the order of the document. All cords of a jack have its span.
    pub plugs: Vec<Plug>,
    /// Jacks with an empty list of cords, with the position of the list.
    pub empty_jacks: Vec<Placed<String>>,
    /// Whether a key or a cord could not be read. If so, a missing cord is not reported, because it may be that one.
    pub is_incomplete: bool,
    /// The settings, in the order of the kind's settings. `None` if the document does not specify the setting.
    pub settings: Vec<Option<Placed<Amount>>>,
    /// The CSV files of settings that are not read yet.
    pub(crate) table_files: Vec<TableFile>,
    /// The machine's parts that the element uses: keys such as "integrators", each with the names of the parts.
    pub machine_parts: Vec<(Placed<String>, Vec<Placed<String>>)>,
    /// Name of the scale if this is a drive; `None` for an element.
    pub scale: Option<Placed<String>>,
    /// Free text; empty if the document has none.
    pub note: String,
    /// Position of its name in the document.
    pub span: Span,
}

/// A quantity that can be recorded: the voltage of an output, in a scale.
#[derive(Debug, Clone)]
pub struct Signal {
    /// Name of the element or drive whose output is read.
    pub element: Placed<String>,
    /// Name of the scale. `None` if the signal is in volts.
    pub scale: Option<Placed<String>>,
    /// Factor by which the scaled voltage is multiplied; not 0 in a valid patch.
    pub factor: f64,
    /// Position of its name in the document.
    pub span: Span,
}

/// The section "run": length, step and phases of a run. Times are in problem seconds and positive.
#[derive(Debug, Clone, Default)]
pub struct RunPlan {
    /// Duration of operate after one initial condition, if the run has no phases.
    pub duration: Option<Placed<f64>>,
    /// Step of the solver. It may be absent if there is a tolerance.
    pub step: Option<Placed<f64>>,
    /// Permitted sum of the errors of all steps, in machine units of 100 V. The solver then chooses the longest steps
    /// that keep this tolerance. The value satisfies [`is_tolerance`](crate::document::is_tolerance).
    pub tolerance: Option<Placed<f64>>,
    /// Time between recorded samples. `None` if it equals the step.
    pub every: Option<Placed<f64>>,
    /// Number of runs from initial condition (repetitive operation), if the run has no phases. It is a whole number; 1
    /// if absent.
    pub repeat: Option<Placed<f64>>,
    /// Whether the machine changes to hold when an overload lamp lights.
    pub hold_on_overload: bool,
    /// The phases of the run. If there are any, `duration` and `repeat` are not permitted.
    pub phases: Vec<Phase>,
}

impl RunPlan {
    /// The phases of the run. A run without phases has an initial condition and operate, repeated `repeat` times.
    ///
    /// `None` if the plan specifies neither phases nor a duration.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::document::Phase;
    /// use patchcord_core::patch::PatchBuilder;
    ///
    /// let patch = PatchBuilder::new("two seconds").run(2.0, 1e-3).build()?;
    /// assert_eq!(patch.run.all_phases(), Some(vec![Phase::InitialCondition, Phase::operate(2.0)]));
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn all_phases(&self) -> Option<Vec<Phase>> {
        if !self.phases.is_empty() {
            return Some(self.phases.clone());
        }
        let once = vec![Phase::InitialCondition, Phase::operate(self.duration.as_ref()?.value)];
        let times = self.repeat.as_ref().map_or(1, |repeat| repeat.value as u64);
        Some(if times == 1 { once } else { vec![Phase::Repeat { times, phases: once }] })
    }

    /// Length of the longest repetition in problem seconds; `None` if the plan has no duration.
    pub fn longest_repetition(&self) -> Option<f64> {
        self.all_phases().map(|phases| RunExtent::of(&phases).longest_repetition)
    }
}

/// A picture that the patch requests: signals against time or against another signal.
#[derive(Debug, Clone)]
pub struct PictureSpec {
    /// Title above the picture; empty if the document has none.
    pub title: String,
    /// Name of the signal along the horizontal axis; "t" is time.
    pub x: Placed<String>,
    /// Names of the signals along the vertical axis.
    pub y: Vec<Placed<String>>,
    /// Whether one unit has the same length along both axes of a picture against a signal in the same unit.
    pub equal_scales: bool,
}

/// Names of entries that the document has but that could not be read. Their faults have been reported.
///
/// Checks of names use this to avoid a second report, such as an unknown element whose entry has a fault.
#[derive(Debug, Clone, Default)]
pub(crate) struct UnreadNames {
    /// Names whose entries could not be read.
    pub names: HashSet<String>,
    /// Whether a whole section could not be read. If so, every unknown name may belong to it.
    pub has_unread_section: bool,
}

impl UnreadNames {
    /// Whether an unknown name may be an unread one, or a port ("L1.out") of an unread instance.
    pub(crate) fn can_include(&self, name: &str) -> bool {
        self.has_unread_section || instance_prefixes(name).chain([name]).any(|name| self.names.contains(name))
    }
}

/// A patch: a document and the fields decoded from it.
///
/// To change a patch, use [`Patch::edit`], which changes the fields and the document together. [`Patch::write`] writes
/// the document, so direct changes of the fields are not written.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// let patch = PatchBuilder::new("spring")
///     .parameter("k", 2.0, "N/mm", [0.0, 10.0])
///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]))
///     .build()?;
/// assert_eq!(patch.title, "spring");
/// assert_eq!(patch.parameters["k"].unit.to_si(2.0), 2000.0);
/// assert_eq!(patch.elements["A1"].plugs[0].from.value, "A1");
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Patch {
    /// Name of the file, as reports print it.
    pub(super) file: String,
    /// The text that was read, and the edits made since.
    pub(super) edited_text: EditedText,
    /// The faults found while decoding, in the order of decoding.
    pub(super) findings: Vec<Diagnostic>,
    /// The names whose entries could not be read.
    pub(super) unread: UnreadNames,
    /// The section "elements" as written, before macros are expanded.
    pub(super) element_section: IndexMap<String, SectionEntry>,
    /// Which CSV files may be read.
    pub(super) table_access: TableAccess,
    /// The points that were read from CSV files. Copies of the patch share them.
    pub(super) tables: Arc<PointsBySpan>,
    /// The CSV files that were read, each once.
    pub(super) table_files: Vec<PathBuf>,
    /// Title of the patch; empty if the document has none.
    pub title: String,
    /// Source of the patch, such as a book and a figure.
    pub source: String,
    /// Free text; empty if the document has none.
    pub note: String,
    /// Name of the machine for which the patch is made. `None` is the machine without limits.
    pub machine: Option<Placed<String>>,
    /// Machine seconds per problem second; 1 by default.
    pub time_scale: f64,
    /// Parameters by name.
    pub parameters: IndexMap<String, Parameter>,
    /// Scales by name.
    pub scales: IndexMap<String, Scale>,
    /// Drives by name.
    pub drives: IndexMap<String, ElementEntry>,
    /// Elements by name, including the elements of macro instances ("L1.A1").
    pub elements: IndexMap<String, ElementEntry>,
    /// Macros by name.
    pub macros: IndexMap<String, Macro>,
    /// Instances of macros by name. An instance inside another one ("L1.inner") follows it.
    pub instances: IndexMap<String, Instance>,
    /// The outputs of instances under the names that cords and signals use: "L1", "L1.minus".
    pub(crate) instance_outputs: IndexMap<String, InstanceOutput>,
    /// Position of the section "macros" in the document.
    pub(crate) macros_span: Span,
    /// Signals by name.
    pub signals: IndexMap<String, Signal>,
    /// The equations that the wiring is meant to solve, in the units of the problem.
    pub equations: Vec<Placed<Equation>>,
    /// The tables that the equations of a problem can apply, with the dimensions of their argument and of their value.
    /// `None` if the document is not a problem.
    pub(crate) problem_tables: Option<IndexMap<String, (Dimension, Dimension)>>,
    /// Whether loops of integrators with positive feedback are intended.
    pub positive_feedback: bool,
    /// Length, step and phases of the run.
    pub run: RunPlan,
    /// Names of the signals, drives and elements to record.
    pub record: Vec<Placed<String>>,
    /// The pictures to draw.
    pub pictures: Vec<PictureSpec>,
}

impl Patch {
    /// A patch with a text but with default values in all fields. The decoder fills it.
    pub(super) fn empty(file: &str, text: &str, table_access: TableAccess) -> Patch {
        Patch {
            file: file.to_owned(),
            edited_text: EditedText::unedited(text),
            findings: Vec::new(),
            unread: UnreadNames::default(),
            element_section: IndexMap::new(),
            table_access,
            tables: Arc::default(),
            table_files: Vec::new(),
            title: String::new(),
            source: String::new(),
            note: String::new(),
            machine: None,
            time_scale: 1.0,
            parameters: IndexMap::new(),
            scales: IndexMap::new(),
            drives: IndexMap::new(),
            elements: IndexMap::new(),
            macros: IndexMap::new(),
            instances: IndexMap::new(),
            instance_outputs: IndexMap::new(),
            macros_span: Span::default(),
            signals: IndexMap::new(),
            equations: Vec::new(),
            problem_tables: None,
            positive_feedback: false,
            run: RunPlan::default(),
            record: Vec::new(),
            pictures: Vec::new(),
        }
    }

    /// The faults found while decoding. The checks of [`Circuit::new`](crate::circuit::Circuit::new) add theirs.
    pub(crate) fn findings(&self) -> &[Diagnostic] {
        &self.findings
    }

    /// The names whose entries could not be read.
    pub(crate) fn unread_names(&self) -> &UnreadNames {
        &self.unread
    }

    /// The name of the file, as the caller specified it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The CSV files from which the tables of the patch were read, each once.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    /// use std::fs;
    ///
    /// let folder = tempfile::tempdir()?;
    /// let [patch, table] = ["pump.json", "pump.csv"].map(|name| folder.path().join(name));
    /// let drive = r#""u": {"kind": "table", "scale": "volt", "points": {"csv": "pump.csv"}}"#;
    /// let scale = r#""scales": {"volt": {"per_volt": 1, "unit": "V"}}"#;
    /// fs::write(&patch, format!("{{\"patchcord\": 1, {scale}, \"drives\": {{{drive}}}}}"))?;
    /// fs::write(&table, "t,u\n0,0\n1,50\n")?;
    /// assert_eq!(Patch::read(&patch)?.table_files(), [table]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn table_files(&self) -> &[PathBuf] {
        &self.table_files
    }

    /// Which CSV files may be read as tables of the patch.
    pub fn table_access(&self) -> &TableAccess {
        &self.table_access
    }

    /// The text of the document, as read or as printed by [`Patch::from_value`].
    ///
    /// If the patch has been edited since, the text is rendered with the edits on the first call. Only the edited
    /// places differ from the original text.
    pub fn text(&self) -> &str {
        self.edited_text.text()
    }

    /// The document as a JSON value, with keys in the order of the text and numbers as written. It is made on the first
    /// call.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    ///
    /// let patch = Patch::parse("p.json", r#"{"patchcord": 1, "time_scale": 10}"#)?;
    /// assert_eq!(patch.value()["time_scale"], 10);
    /// assert_eq!(patch.time_scale, 10.0);
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn value(&self) -> &Value {
        self.edited_text.value()
    }

    /// The cords into an element or an instance of a macro, as the document has them.
    ///
    /// Each item is the jack or port and the name that is plugged in: ("x1", "E1.out"), not the element behind the
    /// port. There are no items if the section "elements" does not contain the name.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let summer = ElementBuilder::new("summer").cords("x1", ["+100"]).cords("x10", ["A1"]);
    /// let patch = PatchBuilder::new("sum").element("A1", summer).build()?;
    /// let cords: Vec<_> = patch.written_cords("A1").collect();
    /// assert_eq!(cords, [("x1", "+100"), ("x10", "A1")]);
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn written_cords<'p>(&'p self, element: &str) -> impl Iterator<Item = (&'p str, &'p str)> + use<'p> {
        self.element_section.get(element).map_or_else(Vec::new, SectionEntry::written_cords).into_iter()
    }

    /// Reads the patch again from its text, so that all its parts have positions in the text.
    ///
    /// `None` if the patch was not edited since it was read: the positions are then valid.
    pub(crate) fn reread(&self) -> Option<Result<Patch, Box<Report>>> {
        self.edited_text
            .is_edited()
            .then(|| Patch::parse_with(self.table_access.clone(), &self.file, self.text()))
    }
}

/// Largest number of dots in a name at which a port is looked for. Macros nest at most 20 levels deep, but their names
/// may contain dots too. The limit keeps the search short for absurd names.
const MAX_PREFIXES: usize = 64;

/// The parts of a name before each of its dots: the instances of which it may name a port. "L1.inner.out" gives "L1"
/// and "L1.inner".
pub(super) fn instance_prefixes(name: &str) -> impl Iterator<Item = &str> {
    name.match_indices('.').map(|(dot, _)| &name[..dot]).take(MAX_PREFIXES)
}
