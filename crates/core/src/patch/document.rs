//! The patch: the document as a person wrote it, read but not yet judged.

use std::collections::HashSet;
use std::sync::Arc;

use indexmap::IndexMap;
use serde_json::Value;

use super::macros::{Instance, Item, Macro, Port};
use super::source::Source;
use super::table_file::{TableFile, Tables};
use crate::document::{Diagnostic, Phase, Placed, RangeViolation, Report, Span, parameter_in_si};
use crate::elements::Kind;
use patchcord_expr::{Formula, Unit};

/// The version of the format that this program reads and writes.
pub const FORMAT_VERSION: u64 = 1;

/// A physical quantity that a patch can be varied by.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Value in the unit declared.
    pub value: f64,
    /// Unit of value and range.
    pub unit: Unit,
    /// Least and largest value that the patch is made for.
    pub range: Option<(f64, f64)>,
    /// What it is.
    pub description: String,
    /// Where its name stands.
    pub span: Span,
    /// Where its value stands.
    pub value_span: Span,
}

impl Parameter {
    /// A value in the declared unit, converted to SI units, if the parameter may have it.
    ///
    /// # Errors
    /// If the value is not finite in SI units, or is outside the range.
    pub(crate) fn in_si(&self, name: &str, value: f64) -> Result<f64, RangeViolation> {
        parameter_in_si(name, value, (self.unit.text(), self.unit.factor()), self.range)
    }
}

/// What one volt stands for.
#[derive(Debug, Clone)]
pub struct Scale {
    /// Value of one volt; a plain number stands in `unit`. `None` where it could not be read.
    pub per_volt: Option<Placed<Formula>>,
    /// Unit of the quantity.
    pub unit: Unit,
    /// Where it stands.
    pub span: Span,
}

/// The value of a setting.
#[derive(Debug, Clone, PartialEq)]
pub enum Amount {
    /// A number or a formula.
    Formula(Formula),
    /// true or false.
    Flag(bool),
    /// The index of the word chosen.
    Choice(usize),
    /// Points of a table or a curve, the first numbers rising.
    Points(Vec<[f64; 2]>),
}

/// A cord from an output to an input of an element.
#[derive(Debug, Clone)]
pub struct Plug {
    /// Name of the jack as written ("x10", "in", "bias_plus").
    pub jack: Placed<String>,
    /// Name of the element, drive or reference that drives it.
    pub from: Placed<String>,
}

/// An element or a drive.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Its kind.
    pub kind: &'static Kind,
    /// Its cords, in the order of the document.
    pub plugs: Vec<Plug>,
    /// Jacks that stand there with an empty list, and where.
    pub empty_jacks: Vec<Placed<String>>,
    /// Whether a key or a cord of it could not be understood: what seems to be missing may be that.
    pub doubtful: bool,
    /// Its settings, in the order of the kind's; `None` where the patch says nothing.
    pub settings: Vec<Option<Placed<Amount>>>,
    /// The files that its settings are still to be read from.
    pub(crate) files: Vec<TableFile>,
    /// Names of the machine's parts that it lists, by key of the part.
    pub uses: Vec<(Placed<String>, Vec<Placed<String>>)>,
    /// The scale of a drive.
    pub scale: Option<Placed<String>>,
    /// Free text.
    pub note: String,
    /// Where its name stands.
    pub span: Span,
}

/// A quantity that can be recorded.
#[derive(Debug, Clone)]
pub struct Signal {
    /// The element or drive at whose output it is read.
    pub at: Placed<String>,
    /// Its scale; without one it is read in volts.
    pub scale: Option<Placed<String>>,
    /// What the scaled voltage is multiplied by.
    pub factor: f64,
    /// Where it stands.
    pub span: Span,
}

/// How long and how finely to run, in problem seconds.
#[derive(Debug, Clone, Default)]
pub struct RunPlan {
    /// Length of the run, where it has no phases: one initial condition, and operate.
    pub duration: Option<Placed<f64>>,
    /// Step of the solver.
    pub step: Option<Placed<f64>>,
    /// What the errors of all steps may add up to, in machine units of 100 V, [`LEAST_TOLERANCE`](crate::document::LEAST_TOLERANCE) or more: steps are then as
    /// long as that allows.
    pub tolerance: Option<Placed<f64>>,
    /// Time between recorded samples; the step where absent.
    pub every: Option<Placed<f64>>,
    /// How many times to run from initial condition (repetitive operation), where it has no phases.
    pub repeat: Option<Placed<f64>>,
    /// Whether the machine goes into hold when a lamp lights.
    pub hold_on_overload: bool,
    /// The phases of the run, instead of a length.
    pub phases: Vec<Phase>,
}

impl RunPlan {
    /// What is done in the run; `None` where the plan does not say.
    pub fn all_phases(&self) -> Option<Vec<Phase>> {
        if !self.phases.is_empty() {
            return Some(self.phases.clone());
        }
        let once = vec![Phase::InitialCondition, Phase::operate(self.duration.as_ref()?.value)];
        let times = self.repeat.as_ref().map_or(1, |repeat| repeat.value as u64);
        Some(if times == 1 { once } else { vec![Phase::Repeat { times, phases: once }] })
    }
}

/// A scope picture asked for by the patch.
#[derive(Debug, Clone)]
pub struct PictureSpec {
    /// Title above it.
    pub title: String,
    /// Signal along the horizontal axis; "t" is time.
    pub x: Placed<String>,
    /// Signals along the vertical axis.
    pub y: Vec<Placed<String>>,
}

/// Names that stand in the document and could not be read, which has been reported.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lost {
    /// Names whose entries could not be read.
    pub names: HashSet<String>,
    /// Whether a whole section of names could not be read.
    pub section: bool,
}

impl Lost {
    /// Whether a name that is not known may be one of these, or "lost.port" of an instance that is one.
    pub fn may_hold(&self, name: &str) -> bool {
        self.section || beginnings(name).chain([name]).any(|name| self.names.contains(name))
    }
}

/// A patch as it was written.
///
/// The fields are what was read from the document. To change a patch, use [`Patch::edit`], which changes the fields and the
/// document: what is written is the document, not the fields.
#[derive(Debug, Clone)]
pub struct Patch {
    pub(super) file: String,
    /// The text that was read, and the edits made since.
    pub(super) origin: Source,
    pub(super) findings: Vec<Diagnostic>,
    pub(super) lost: Lost,
    /// The section "elements" as it is written, before macros are expanded.
    pub(super) own: IndexMap<String, Item>,
    /// The tables that were read from CSV files.
    pub(super) tables: Arc<Tables>,
    /// Title of the patch.
    pub title: String,
    /// Where it comes from.
    pub source: String,
    /// Free text.
    pub note: String,
    /// The machine it is made for.
    pub machine: Option<Placed<String>>,
    /// Machine seconds per problem second.
    pub time_scale: f64,
    /// Parameters by name.
    pub parameters: IndexMap<String, Parameter>,
    /// Scales by name.
    pub scales: IndexMap<String, Scale>,
    /// Drives by name.
    pub drives: IndexMap<String, Entry>,
    /// Elements by name, those of instances of macros among them ("L1.A1").
    pub elements: IndexMap<String, Entry>,
    /// Macros by name.
    pub macros: IndexMap<String, Macro>,
    /// Instances of macros by name; one inside another ("L1.inner") comes after it.
    pub instances: IndexMap<String, Instance>,
    /// The names that cords and signals give to elements inside instances: "L1", "L1.minus".
    pub(crate) ports: IndexMap<String, Port>,
    /// Where the section of macros stands.
    pub(crate) macros_at: Span,
    /// Signals by name.
    pub signals: IndexMap<String, Signal>,
    /// How to run.
    pub run: RunPlan,
    /// What to record.
    pub record: Vec<Placed<String>>,
    /// What to draw.
    pub pictures: Vec<PictureSpec>,
}

impl Patch {
    pub(super) fn empty(file: &str, text: &str) -> Patch {
        Patch {
            file: file.to_owned(),
            origin: Source::read(text),
            findings: Vec::new(),
            lost: Lost::default(),
            own: IndexMap::new(),
            tables: Arc::default(),
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
            ports: IndexMap::new(),
            macros_at: Span::default(),
            signals: IndexMap::new(),
            run: RunPlan::default(),
            record: Vec::new(),
            pictures: Vec::new(),
        }
    }

    /// What was found wrong while reading.
    pub(crate) fn findings(&self) -> &[Diagnostic] {
        &self.findings
    }

    /// The names that could not be read.
    pub(crate) fn lost(&self) -> &Lost {
        &self.lost
    }

    /// The file's name, as the reader wrote it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The text as it was written, or as [`Patch::from_value`] printed it. If the patch was edited since, the text is
    /// rendered with the edits when it is first read: only the edited places differ from the text that was read.
    pub fn text(&self) -> &str {
        self.origin.text()
    }

    /// The document as a JSON value: key order and the text of numbers as written. It is made when it is first read.
    pub fn value(&self) -> &Value {
        self.origin.value()
    }

    /// The cords of an element, or of an instance of a macro, as the document has them: the jack or port, and the name
    /// that is plugged in there ("E1.out", not the element behind it). Empty if the section "elements" has no such name.
    pub fn written_cords<'p>(&'p self, element: &str) -> impl Iterator<Item = (&'p str, &'p str)> + use<'p> {
        self.own.get(element).map_or_else(Vec::new, Item::written_cords).into_iter()
    }

    /// The patch read again from its text, so that its parts have their positions there. `None` if it was not edited since
    /// it was read.
    pub(crate) fn reread(&self) -> Option<Result<Patch, Box<Report>>> {
        self.origin.is_edited().then(|| Patch::parse(&self.file, self.text()))
    }
}

/// What stands before the dots of a name: the instances that it may be a port of. More dots than these are never
/// instances inside instances.
pub(super) fn beginnings(name: &str) -> impl Iterator<Item = &str> {
    name.match_indices('.').map(|(dot, _)| &name[..dot]).take(64)
}
