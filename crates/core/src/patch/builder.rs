//! Patches made in Rust instead of in a file.

use serde_json::{Map, Value, json};

use super::document::{FORMAT_VERSION, Patch};
use crate::document::Report;

/// Collects the parts of a patch; [`PatchBuilder::build`] makes the patch, in the same format as a file.
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
    document: Map<String, Value>,
}

impl PatchBuilder {
    /// A patch with a title, on the machine without limits.
    pub fn new(title: &str) -> Self {
        let mut document = Map::new();
        document.insert("patchcord".into(), FORMAT_VERSION.into());
        document.insert("title".into(), title.into());
        PatchBuilder { document }
    }

    /// The machine that the patch is made for.
    pub fn machine(mut self, name: &str) -> Self {
        self.document.insert("machine".into(), name.into());
        self
    }

    /// Machine seconds per problem second.
    pub fn time_scale(mut self, scale: f64) -> Self {
        self.document.insert("time_scale".into(), scale.into());
        self
    }

    /// A parameter with its range, in a unit.
    pub fn parameter(self, name: &str, value: f64, unit: &str, range: [f64; 2]) -> Self {
        self.insert("parameters", name, json!({"value": value, "unit": unit, "range": range}))
    }

    /// A scale: what one volt stands for, as a number in `unit` or a formula.
    pub fn scale(self, name: &str, per_volt: impl Into<Value>, unit: &str) -> Self {
        self.insert("scales", name, json!({"per_volt": per_volt.into(), "unit": unit}))
    }

    /// A drive in the units of a scale.
    pub fn drive(self, name: &str, scale: &str, drive: ElementBuilder) -> Self {
        let drive = drive.set("scale", scale);
        self.insert("drives", name, Value::Object(drive.entry))
    }

    /// An element.
    pub fn element(self, name: &str, element: ElementBuilder) -> Self {
        self.insert("elements", name, Value::Object(element.entry))
    }

    /// A macro: elements may name it as their kind.
    pub fn define(self, name: &str, definition: MacroBuilder) -> Self {
        self.insert("macros", name, Value::Object(definition.entry))
    }

    /// A signal read at an element's output: `factor` times the voltage in a scale.
    pub fn signal(self, name: &str, at: &str, scale: &str, factor: f64) -> Self {
        self.insert("signals", name, json!({"at": at, "scale": scale, "factor": factor}))
    }

    /// How long to run and with which step, in problem seconds.
    pub fn run(mut self, duration: f64, step: f64) -> Self {
        self.document.insert("run".into(), json!({"for": duration, "step": step}));
        self
    }

    /// What to record.
    pub fn record<const N: usize>(mut self, signals: [&str; N]) -> Self {
        self.document.insert("record".into(), json!(signals.to_vec()));
        self
    }

    /// A picture, beside those that there are: signals against a signal, or against "t".
    pub fn picture<const N: usize>(mut self, title: &str, x: &str, y: [&str; N]) -> Self {
        let pictures = self.document.entry("pictures").or_insert_with(|| json!([]));
        if let Value::Array(pictures) = pictures {
            pictures.push(json!({"title": title, "x": x, "y": y.to_vec()}));
        }
        self
    }

    /// The patch.
    ///
    /// # Errors
    /// When a name or a value could not be read back from the document.
    pub fn build(self) -> Result<Patch, Box<Report>> {
        Patch::from_value("(built)", &Value::Object(self.document))
    }

    fn insert(mut self, section: &str, name: &str, value: Value) -> Self {
        insert(&mut self.document, section, name, value);
        self
    }
}

fn insert(into: &mut Map<String, Value>, section: &str, name: &str, value: Value) {
    let section = into.entry(section).or_insert_with(|| Value::Object(Map::new()));
    if let Value::Object(named) = section {
        named.insert(name.to_owned(), value);
    }
}

/// A parameter of a [`PatchEditor`](super::PatchEditor).
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
    entry: Map<String, Value>,
}

impl ParameterBuilder {
    /// A parameter with a value in a unit.
    pub fn new(value: impl Into<Value>, unit: &str) -> Self {
        let mut entry = Map::new();
        entry.insert("value".into(), value.into());
        entry.insert("unit".into(), unit.into());
        ParameterBuilder { entry }
    }

    /// Its least and its largest value, in its unit.
    pub fn range(mut self, range: [impl Into<Value>; 2]) -> Self {
        let range: Vec<Value> = range.into_iter().map(Into::into).collect();
        self.entry.insert("range".into(), range.into());
        self
    }

    /// What it is.
    pub fn description(mut self, description: &str) -> Self {
        self.entry.insert("description".into(), description.into());
        self
    }

    pub(super) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }
}

/// A macro of a [`PatchBuilder`].
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
    entry: Map<String, Value>,
}

impl MacroBuilder {
    /// A macro of nothing yet.
    pub fn new() -> Self {
        MacroBuilder::default()
    }

    /// A macro as a document has it: an object with "outputs", "elements" and the other keys of a macro.
    pub fn of(entry: Map<String, Value>) -> Self {
        MacroBuilder { entry }
    }

    pub(super) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }

    /// An input port, and what it is for.
    pub fn input(self, port: &str, description: &str) -> Self {
        self.insert("inputs", port, description.into())
    }

    /// An output port: an element inside. The first is what the bare name of an instance means.
    pub fn output(self, port: &str, element: &str) -> Self {
        self.insert("outputs", port, element.into())
    }

    /// A setting in a unit; `default` may be null: then every instance must give it.
    pub fn setting(self, name: &str, unit: &str, default: impl Into<Value>) -> Self {
        let default = default.into();
        let setting =
            if default.is_null() { json!({"unit": unit}) } else { json!({"unit": unit, "default": default}) };
        self.insert("settings", name, setting)
    }

    /// An element, or an instance of another macro.
    pub fn element(self, name: &str, element: ElementBuilder) -> Self {
        self.insert("elements", name, Value::Object(element.entry))
    }

    fn insert(mut self, section: &str, name: &str, value: Value) -> Self {
        insert(&mut self.entry, section, name, value);
        self
    }
}

/// An element or a drive of a [`PatchBuilder`].
#[derive(Debug, Clone)]
pub struct ElementBuilder {
    entry: Map<String, Value>,
}

impl ElementBuilder {
    /// An element of a kind, such as "summer".
    pub fn new(kind: &str) -> Self {
        let mut entry = Map::new();
        entry.insert("kind".into(), kind.into());
        ElementBuilder { entry }
    }

    /// An element or a drive as a document has it: an object with "kind" and the other keys of the kind.
    pub fn of(entry: Map<String, Value>) -> Self {
        ElementBuilder { entry }
    }

    pub(super) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }

    /// One cord into an input, such as "in" or "bias_plus".
    pub fn cord(self, input: &str, from: &str) -> Self {
        self.set(input, from)
    }

    /// Cords into a summing input, such as "x10", beside those that it has.
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

    /// A setting, as a number, a formula or a word.
    pub fn set(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.entry.insert(name.to_owned(), value.into());
        self
    }
}
