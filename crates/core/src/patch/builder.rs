//! Builders that make a patch in Rust instead of reading it from a file.
//!
//! A builder collects JSON values under the keys of the document format. [`PatchBuilder::build`] prints the document
//! and decodes it like a file. A built patch therefore passes the same checks, and its faults have positions in a text.
//! `parts` has the builders of parameters, elements and macros, and `scaled` those of scales and signals.

mod parts;
mod scaled;

pub use parts::{ElementBuilder, MacroBuilder, ParameterBuilder};
pub use scaled::{ScaleBuilder, SignalBuilder};

use serde::Serialize;
use serde_json::{Map, Value};

use super::document::{FORMAT_VERSION, Patch};
use super::picture_entry::PictureEntry;
use crate::document::{Report, json_value};

/// Builds a patch from its parts.
///
/// A part with a name that exists already replaces the earlier part.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// // x' = -x / 0.1 s: an integrator fed back through a pot.
/// let patch = PatchBuilder::new("decay")
///     .element("A1", ElementBuilder::new("integrator").cords("x100", ["P1"]).set("initial", 50))
///     .element("I1", ElementBuilder::new("summer").cords("x1", ["A1"]))
///     .element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.1))
///     .run(1.0, 1e-3)
///     .build()?;
/// assert_eq!(patch.elements.len(), 3);
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PatchBuilder {
    /// The document so far, with the sections in the order of the calls.
    document: Map<String, Value>,
}

impl PatchBuilder {
    /// Begins a patch with a title, for the machine without limits.
    pub fn new(title: &str) -> Self {
        let mut document = Map::new();
        document.insert("patchcord".into(), FORMAT_VERSION.into());
        document.insert("title".into(), title.into());
        PatchBuilder { document }
    }

    /// Sets the source, such as a book and a figure.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::PatchBuilder;
    ///
    /// let patch = PatchBuilder::new("spring").source("any first lesson").note("without losses").build()?;
    /// assert_eq!((patch.source.as_str(), patch.note.as_str()), ("any first lesson", "without losses"));
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn source(mut self, text: &str) -> Self {
        self.document.insert("source".into(), text.into());
        self
    }

    /// Sets the note.
    pub fn note(mut self, text: &str) -> Self {
        self.document.insert("note".into(), text.into());
        self
    }

    /// Sets the machine for which the patch is made.
    pub fn machine(mut self, name: &str) -> Self {
        self.document.insert("machine".into(), name.into());
        self
    }

    /// Sets the time scale in machine seconds per problem second. It must be positive.
    pub fn time_scale(mut self, scale: f64) -> Self {
        self.document.insert("time_scale".into(), scale.into());
        self
    }

    /// Adds a parameter. The value and the range (smallest, largest) are in `unit`.
    pub fn parameter(self, name: &str, value: f64, unit: &str, range: [f64; 2]) -> Self {
        self.insert("parameters", name, ParameterBuilder::new(value, unit).range(range).into_value())
    }

    /// Adds a scale: the value of one volt, as a number in `unit` or as a formula.
    pub fn scale(self, name: &str, per_volt: impl Into<Value>, unit: &str) -> Self {
        self.put_scale(name, ScaleBuilder::new(per_volt, unit))
    }

    /// Adds a scale with a description.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{PatchBuilder, ScaleBuilder};
    ///
    /// let scale = ScaleBuilder::new("10 * k", "N").description("force of the spring");
    /// let patch = PatchBuilder::new("spring").put_scale("force", scale).build()?;
    /// assert_eq!(patch.scales["force"].unit.text(), "N");
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn put_scale(self, name: &str, scale: ScaleBuilder) -> Self {
        self.insert("scales", name, scale.into_value())
    }

    /// Adds a drive. Its values are in the unit of the scale.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// // A step of 5 mm at 0.1 s, on a scale of 2 mm per volt.
    /// let patch = PatchBuilder::new("step")
    ///     .scale("position", 2.0, "mm")
    ///     .drive("D", "position", ElementBuilder::new("step").set("height", 5).set("at", 0.1))
    ///     .build()?;
    /// assert_eq!(patch.drives["D"].kind.name, "step");
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn drive(self, name: &str, scale: &str, drive: ElementBuilder) -> Self {
        self.insert("drives", name, drive.set("scale", scale).into_value())
    }

    /// Adds an element or an instance of a macro.
    pub fn element(self, name: &str, element: ElementBuilder) -> Self {
        self.insert("elements", name, element.into_value())
    }

    /// Defines a macro. An element whose kind is `name` is an instance of it.
    pub fn define(self, name: &str, definition: MacroBuilder) -> Self {
        self.insert("macros", name, definition.into_value())
    }

    /// Adds a signal: the voltage at the output of `element`, converted by a scale and multiplied by `factor`.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// // The integrator inverts, so the factor of the signal is -1.
    /// let patch = PatchBuilder::new("ramp")
    ///     .scale("speed", 0.5, "m/s")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["+100"]))
    ///     .signal("v", "A1", "speed", -1.0)
    ///     .build()?;
    /// assert_eq!(patch.signals["v"].factor, -1.0);
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn signal(self, name: &str, element: &str, scale: &str, factor: f64) -> Self {
        self.put_signal(name, SignalBuilder::new(element).scale(scale).factor(factor))
    }

    /// Adds a signal with a description, or one in volts.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder, SignalBuilder};
    ///
    /// let signal = SignalBuilder::new("A1").description("output of the integrator");
    /// let patch = PatchBuilder::new("ramp")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["+100"]))
    ///     .put_signal("ramp", signal)
    ///     .build()?;
    /// assert_eq!((patch.signals["ramp"].factor, patch.signals["ramp"].scale.is_none()), (1.0, true));
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn put_signal(self, name: &str, signal: SignalBuilder) -> Self {
        self.insert("signals", name, signal.into_value())
    }

    /// Adds an equation that the wiring is meant to solve, in the units of the problem.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let patch = PatchBuilder::new("decay")
    ///     .parameter("T", 1.0, "s", [0.1, 10.0])
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]))
    ///     .equation("T x' = -x")
    ///     .build()?;
    /// assert_eq!(patch.equations[0].value.text(), "T x' = -x");
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn equation(self, text: &str) -> Self {
        self.append("equations", text.into())
    }

    /// Sets the duration of the run and the step of the solver, both in problem seconds and positive.
    pub fn run(mut self, duration: f64, step: f64) -> Self {
        self.document.insert("run".into(), json_value(&RunEntry { duration, step }));
        self
    }

    /// Sets the signals, drives and elements to record.
    pub fn record(mut self, signals: impl IntoIterator<Item = impl AsRef<str>>) -> Self {
        self.document.insert("record".into(), name_list(signals).into());
        self
    }

    /// Adds a picture of the signals `y` against the signal `x`, or against time if `x` is "t".
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let patch = PatchBuilder::new("decay")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]))
    ///     .picture("The decay", "t", ["A1"])
    ///     .build()?;
    /// assert_eq!(patch.pictures[0].title, "The decay");
    /// assert_eq!(patch.pictures[0].y[0].value, "A1");
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn picture(self, title: &str, x: &str, y: impl IntoIterator<Item = impl AsRef<str>>) -> Self {
        self.append("pictures", json_value(&PictureEntry::new(title, x, y)))
    }

    /// Sets a section of the document to a JSON value, as a document writes it. An earlier section of the same key is
    /// replaced.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::PatchBuilder;
    /// use serde_json::json;
    ///
    /// let run = json!({"for": 2, "step": 1e-3, "every": 1e-2});
    /// let patch = PatchBuilder::new("two seconds").section("run", run).build()?;
    /// assert_eq!(patch.run.every.map(|every| every.value), Some(1e-2));
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn section(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.document.insert(key.to_owned(), value.into());
        self
    }

    /// Decodes the collected document.
    ///
    /// # Errors
    /// If the document cannot be decoded, for example because it is longer than 16 MB. Faults of its parts are reported
    /// by [`Circuit::new`](crate::circuit::Circuit::new).
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::PatchBuilder;
    ///
    /// let patch = PatchBuilder::new("empty").build()?;
    /// assert_eq!(patch.file(), "(built)");
    /// assert!(patch.text().contains("\"title\": \"empty\""));
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn build(self) -> Result<Patch, Box<Report>> {
        Patch::from_value("(built)", &Value::Object(self.document))
    }

    /// Adds an entry to a section.
    fn insert(mut self, section: &str, name: &str, value: Value) -> Self {
        insert_in_section(&mut self.document, section, name, value);
        self
    }

    /// Adds an item to the end of a list.
    fn append(mut self, list: &str, value: Value) -> Self {
        let items = self.document.entry(list).or_insert_with(|| Value::Array(Vec::new()));
        if let Value::Array(items) = items {
            items.push(value);
        }
        self
    }
}

/// The section "run".
#[derive(Serialize)]
struct RunEntry {
    #[serde(rename = "for")]
    duration: f64,
    step: f64,
}

/// The JSON object of a scale: the value of one volt, and its unit.
pub(super) fn scale_entry(per_volt: impl Into<Value>, unit: &str) -> Value {
    ScaleBuilder::new(per_volt, unit).into_value()
}

/// A list of names as JSON texts.
fn name_list(names: impl IntoIterator<Item = impl AsRef<str>>) -> Vec<Value> {
    names.into_iter().map(|name| Value::from(name.as_ref())).collect()
}

/// Adds an entry to a section of an object. A missing section is added.
fn insert_in_section(object: &mut Map<String, Value>, section: &str, name: &str, value: Value) {
    let section = object.entry(section).or_insert_with(|| Value::Object(Map::new()));
    if let Value::Object(entries) = section {
        entries.insert(name.to_owned(), value);
    }
}
