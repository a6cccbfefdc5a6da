//! The builders of the parts of a patch: parameters, macros, and elements, drives and instances.

use serde::Serialize;
use serde_json::{Map, Value};

use super::{insert_in_section, name_list};
use crate::document::json_value;

/// Builds a parameter for [`PatchEditor::put_parameter`](crate::patch::PatchEditor::put_parameter).
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
    pub(in crate::patch) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }
}

/// Builds a macro for [`PatchBuilder::define`](super::PatchBuilder::define).
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
    pub(in crate::patch) fn into_value(self) -> Value {
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
        self.insert("settings", name, json_value(&MacroSettingEntry { unit, default: default.into() }))
    }

    /// Adds an element, or an instance of another macro.
    pub fn element(self, name: &str, element: ElementBuilder) -> Self {
        self.insert("elements", name, element.into_value())
    }

    /// Adds an entry to a section of the macro.
    fn insert(mut self, section: &str, name: &str, value: Value) -> Self {
        insert_in_section(&mut self.entry, section, name, value);
        self
    }
}

/// An entry of the section "settings" of a macro.
#[derive(Serialize)]
struct MacroSettingEntry<'a> {
    unit: &'a str,
    /// Null, and then absent, if every instance must specify the setting.
    #[serde(skip_serializing_if = "Value::is_null")]
    default: Value,
}

/// Builds an element, a drive or an instance of a macro for [`PatchBuilder`](super::PatchBuilder).
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
    pub(in crate::patch) fn into_value(self) -> Value {
        Value::Object(self.entry)
    }

    /// Sets the only cord into an input such as "in" or "bias_plus". `from` is the name of the output that drives it.
    pub fn cord(self, input: &str, from: &str) -> Self {
        self.set(input, from)
    }

    /// Adds cords into a summing input such as "x10". Earlier cords into the same input remain.
    pub fn cords(mut self, jack: &str, from: impl IntoIterator<Item = impl AsRef<str>>) -> Self {
        let jacks = self.entry.entry("in").or_insert_with(|| Value::Object(Map::new()));
        if let Value::Object(jacks) = jacks {
            let cords = jacks.entry(jack).or_insert_with(|| Value::Array(Vec::new()));
            if let Value::Array(cords) = cords {
                cords.extend(name_list(from));
            }
        }
        self
    }

    /// Sets the note.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let inverter = ElementBuilder::new("inverter").cord("in", "+100").note("- 100 V");
    /// let patch = PatchBuilder::new("inverter").element("B1", inverter).build()?;
    /// assert_eq!(patch.elements["B1"].note, "- 100 V");
    /// # Ok::<(), Box<patchcord_core::document::Report>>(())
    /// ```
    pub fn note(self, text: &str) -> Self {
        self.set("note", text)
    }

    /// Sets a setting to a number, a formula or a word. A group of settings such as "limit" is an object.
    pub fn set(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.entry.insert(name.to_owned(), value.into());
        self
    }
}
