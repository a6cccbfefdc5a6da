//! Builders that make a patch in Rust instead of reading it from a file.
//!
//! A builder collects JSON values under the keys of the document format. [`PatchBuilder::build`] prints the document
//! and decodes it like a file. A built patch therefore passes the same checks, and its faults have positions in a text.

use serde_json::{Map, Value, json};

use super::document::{FORMAT_VERSION, Patch};
use crate::document::Report;

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
        self.insert("parameters", name, json!({"value": value, "unit": unit, "range": range}))
    }

    /// Adds a scale: the value of one volt, as a number in `unit` or as a formula.
    pub fn scale(self, name: &str, per_volt: impl Into<Value>, unit: &str) -> Self {
        self.insert("scales", name, json!({"per_volt": per_volt.into(), "unit": unit}))
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
        let drive = drive.set("scale", scale);
        self.insert("drives", name, Value::Object(drive.entry))
    }

    /// Adds an element or an instance of a macro.
    pub fn element(self, name: &str, element: ElementBuilder) -> Self {
        self.insert("elements", name, Value::Object(element.entry))
    }

    /// Defines a macro. An element whose kind is `name` is an instance of it.
    pub fn define(self, name: &str, definition: MacroBuilder) -> Self {
        self.insert("macros", name, Value::Object(definition.entry))
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
        self.insert("signals", name, json!({"at": element, "scale": scale, "factor": factor}))
    }

    /// Sets the duration of the run and the step of the solver, both in problem seconds and positive.
    pub fn run(mut self, duration: f64, step: f64) -> Self {
        self.document.insert("run".into(), json!({"for": duration, "step": step}));
        self
    }

    /// Sets the signals, drives and elements to record.
    pub fn record<const N: usize>(mut self, signals: [&str; N]) -> Self {
        self.document.insert("record".into(), json!(signals.to_vec()));
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
    pub fn picture<const N: usize>(mut self, title: &str, x: &str, y: [&str; N]) -> Self {
        let pictures = self.document.entry("pictures").or_insert_with(|| json!([]));
        if let Value::Array(pictures) = pictures {
            pictures.push(json!({"title": title, "x": x, "y": y.to_vec()}));
        }
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
}

/// Adds an entry to a section of an object. A missing section is added.
fn insert_in_section(object: &mut Map<String, Value>, section: &str, name: &str, value: Value) {
    let section = object.entry(section).or_insert_with(|| Value::Object(Map::new()));
    if let Value::Object(entries) = section {
        entries.insert(name.to_owned(), value);
    }
}

/// Builds a parameter for [`PatchEditor::put_parameter`](super::PatchEditor::put_parameter).
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{Patch, ParameterBuilder};
///
/// let patch = Patch::parse("empty.json", "{\"patchcord\": 1}")?;
/// let mut editor = patch.edit();
/// editor.put_parameter("k", ParameterBuilder::new(2, "N/m").range([0, 10]).description("stiffness"));
/// let patch = editor.finish("spring.json")?;
/// assert_eq!(patch.parameters["k"].value, 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ParameterBuilder {
    /// The JSON object of the parameter.
    entry: Map<String, Value>,
}

impl ParameterBuilder {
    /// Begins a parameter with a value in `unit`.
    pub fn new(value: impl Into<Value>, unit: &str) -> Self {
        let mut entry = Map::new();
        entry.insert("value".into(), value.into());
        entry.insert("unit".into(), unit.into());
        ParameterBuilder { entry }
    }

    /// Sets the smallest and the largest permitted value, in the unit of the parameter.
    pub fn range(mut self, range: [impl Into<Value>; 2]) -> Self {
        let range: Vec<Value> = range.into_iter().map(Into::into).collect();
        self.entry.insert("range".into(), range.into());
        self
    }

    /// Sets the description.
    pub fn description(mut self, description: &str) -> Self {
        self.entry.insert("description".into(), description.into());
        self
    }

    /// The JSON object of the document.
    pub(super) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }
}

/// Builds a macro for [`PatchBuilder::define`].
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{ElementBuilder, MacroBuilder, PatchBuilder};
///
/// let decay = MacroBuilder::new()
///     .output("out", "A")
///     .setting("start", "V", 50)
///     .element("A", ElementBuilder::new("integrator").cords("x1", ["I"]).set("initial", "start"))
///     .element("I", ElementBuilder::new("summer").cords("x1", ["A"]));
/// let patch = PatchBuilder::new("two decays")
///     .define("decay", decay)
///     .element("D1", ElementBuilder::new("decay"))
///     .element("D2", ElementBuilder::new("decay").set("start", 20))
///     .build()?;
/// assert_eq!(patch.elements.len(), 4);
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct MacroBuilder {
    /// The JSON object of the macro.
    entry: Map<String, Value>,
}

impl MacroBuilder {
    /// Begins a macro without ports and elements.
    pub fn new() -> Self {
        MacroBuilder::default()
    }

    /// Makes a macro from its JSON object with "outputs", "elements" and the other keys of a macro.
    pub fn from_entry(entry: Map<String, Value>) -> Self {
        MacroBuilder { entry }
    }

    /// The JSON object of the document.
    pub(super) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }

    /// Adds an input port with a description.
    pub fn input(self, port: &str, description: &str) -> Self {
        self.insert("inputs", port, description.into())
    }

    /// Adds an output port: the output of an element of the macro. The name of an instance alone means its first port.
    pub fn output(self, port: &str, element: &str) -> Self {
        self.insert("outputs", port, element.into())
    }

    /// Adds a setting in `unit`. If `default` is null, every instance must specify the setting.
    pub fn setting(self, name: &str, unit: &str, default: impl Into<Value>) -> Self {
        let default = default.into();
        let setting =
            if default.is_null() { json!({"unit": unit}) } else { json!({"unit": unit, "default": default}) };
        self.insert("settings", name, setting)
    }

    /// Adds an element, or an instance of another macro.
    pub fn element(self, name: &str, element: ElementBuilder) -> Self {
        self.insert("elements", name, Value::Object(element.entry))
    }

    /// Adds an entry to a section of the macro.
    fn insert(mut self, section: &str, name: &str, value: Value) -> Self {
        insert_in_section(&mut self.entry, section, name, value);
        self
    }
}

/// Builds an element, a drive or an instance of a macro for [`PatchBuilder`].
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// let integrator = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 20);
/// let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.25);
/// let patch = PatchBuilder::new("decay").element("A1", integrator).element("P1", pot).build()?;
/// assert_eq!(patch.elements["A1"].kind.name, "integrator");
/// assert_eq!(patch.elements["P1"].plugs[0].jack.value, "in");
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ElementBuilder {
    /// The JSON object of the element, drive or instance.
    entry: Map<String, Value>,
}

impl ElementBuilder {
    /// Begins an element of a kind such as "summer", or an instance of the macro of that name.
    pub fn new(kind: &str) -> Self {
        let mut entry = Map::new();
        entry.insert("kind".into(), kind.into());
        ElementBuilder { entry }
    }

    /// Makes an element or a drive from its JSON object with "kind" and the other keys of the kind.
    pub fn from_entry(entry: Map<String, Value>) -> Self {
        ElementBuilder { entry }
    }

    /// The JSON object of the document.
    pub(super) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }

    /// Sets the only cord into an input such as "in" or "bias_plus". `from` is the name of the output that drives it.
    pub fn cord(self, input: &str, from: &str) -> Self {
        self.set(input, from)
    }

    /// Adds cords into a summing input such as "x10". Earlier cords into the same input remain.
    pub fn cords<const N: usize>(mut self, jack: &str, from: [&str; N]) -> Self {
        let jacks = self.entry.entry("in").or_insert_with(|| Value::Object(Map::new()));
        if let Value::Object(jacks) = jacks {
            let cords = jacks.entry(jack).or_insert_with(|| json!([]));
            if let Value::Array(cords) = cords {
                cords.extend(from.map(Value::from));
            }
        }
        self
    }

    /// Sets a setting to a number, a formula or a word.
    pub fn set(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.entry.insert(name.to_owned(), value.into());
        self
    }
}
