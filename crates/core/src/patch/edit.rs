//! Edits of a patch. The fields change immediately; the text changes when a caller reads it.
//!
//! [`Patch::edit`] begins typed edits. Each edit decodes the new part with the decoder for documents, so that an edited
//! part equals one that was read. It also adds a [`DocumentEdit`] to the batch. At the end, macros are expanded again
//! if an edit changed cords, elements or macros. Some edits have effects that the fields cannot follow; the rendered
//! text is then read again.
//!
//! [`Patch::with_edits`] puts values at arbitrary paths, and always reads the text again.

use std::path::Path;

use serde_json::{Value, json};

use super::builder::{ElementBuilder, MacroBuilder, ParameterBuilder};
use super::document::Patch;
use super::macros::{self, Macros, SectionEntry};
use super::render::{DocumentEdit, render, root_of, splice};
use super::{decode, decode_entry, table_file};
use crate::document::fields::Findings;
use crate::document::tree::{KeyValue, Node};
use crate::document::{Diagnostic, Placed, Report, Span, any_error};
use crate::elements::{Family, Measure};

/// A new value at a path of keys in a document.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::Edit;
///
/// let edit = Edit::new("parameters/k/value", 3);
/// assert_eq!(edit.path(), ["parameters", "k", "value"]);
/// assert_eq!(edit.value(), &serde_json::json!(3));
/// let edit = Edit::at(["parameters", "k", "note"], "a/b");
/// assert_eq!(edit.path().len(), 3);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Edit {
    /// The keys from the root of the document. All except the last must exist in the document.
    pub(super) path: Vec<String>,
    /// The new value.
    pub(super) value: Value,
}

impl Edit {
    /// A new value at a path such as `"parameters/VcL/value"`. The separator is a slash.
    pub fn new(path: &str, value: impl Into<Value>) -> Edit {
        Edit { path: path.split('/').map(str::to_owned).collect(), value: value.into() }
    }

    /// A new value at a path of keys. Unlike [`Edit::new`], it permits keys with a slash.
    pub fn at(keys: impl IntoIterator<Item = impl Into<String>>, value: impl Into<Value>) -> Edit {
        Edit { path: keys.into_iter().map(Into::into).collect(), value: value.into() }
    }

    /// The keys from the root of the document to the value.
    pub fn path(&self) -> &[String] {
        &self.path
    }

    /// The new value.
    pub fn value(&self) -> &Value {
        &self.value
    }
}

/// The reason why a document cannot be edited.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{EditError, PatchBuilder};
///
/// let patch = PatchBuilder::new("spring").parameter("k", 2.0, "N/m", [0.0, 10.0]).build()?;
/// let error = patch.edit().set_parameter("m", 1.0).unwrap_err();
/// assert_eq!(error.to_string(), "there is no parameter m in the patch");
/// let error = patch.edit().set_parameter("k", f64::NAN).unwrap_err();
/// assert!(matches!(error, EditError::NotFinite(name) if name == "k"));
/// # Ok::<(), Box<patchcord_core::document::Report>>(())
/// ```
#[derive(Debug, thiserror::Error)]
pub enum EditError {
    /// A key of a path before the last is missing, or its value is not an object. The field is the path.
    #[error("there is no {0} in the document")]
    MissingPath(String),
    /// Two edits have the same path, or one path is within the other. The field is the path of the inner edit.
    #[error("{0} is edited twice")]
    OverlappingEdits(String),
    /// The patch does not have a parameter, element, setting or drive.
    #[error("there is no {noun} {name} in the patch")]
    Unknown {
        /// The kind of object: "parameter", "element", "setting", "drive".
        noun: &'static str,
        /// The name that does not exist.
        name: String,
    },
    /// The element belongs to an instance of a macro, so it is not in the document. The field is its name.
    #[error("{0} is inside an instance: edit its macro")]
    InsideInstance(String),
    /// A value is infinite or not a number. The field is the name of the parameter.
    #[error("{0} must be a finite number")]
    NotFinite(String),
    /// The edited text cannot be decoded, for example because it is longer than 16 MB.
    #[error(transparent)]
    InvalidDocument(#[from] Box<Report>),
}

/// Edits a patch: its fields immediately, and its document when the text is read.
///
/// Methods named `set_` change a part that exists. Methods named `put_` add a part or replace the part with the same
/// name. A fault in a new value is not an error here; [`Circuit::new`](crate::circuit::Circuit::new) reports it.
///
/// # Examples
///
/// ```
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// let patch = PatchBuilder::new("decay")
///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50))
///     .run(1.0, 1e-3)
///     .build()?;
/// let mut editor = patch.edit();
/// editor.set_initial("A1", 20)?;
/// editor.put_element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.1));
/// editor.replug("A1", "A1", "P1")?;
/// let slower = editor.finish("slower.json")?;
/// assert_eq!(slower.elements["A1"].plugs[0].from.value, "P1");
/// assert!(slower.text().contains("\"x1\": [\"P1\"]"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct PatchEditor {
    /// The patch with the edits in its fields, but not in its text.
    patch: Patch,
    /// The edits of the document, in the order of the calls.
    batch: Vec<DocumentEdit>,
    /// Whether macros must be expanded again.
    must_expand: bool,
    /// Whether the text must be read again, because the fields do not have the effect of an edit.
    must_reread: bool,
}

impl PatchEditor {
    /// The patch with the edits so far.
    ///
    /// New elements and changed cords are in [`Patch::elements`] only after [`PatchEditor::finish`].
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// Sets the value of a parameter, in its declared unit.
    ///
    /// # Errors
    /// If the patch does not have the parameter, or the value is not finite.
    pub fn set_parameter(&mut self, name: &str, value: f64) -> Result<(), EditError> {
        let json = finite_json(name, value)?;
        let span = self.new_span();
        let parameter = self.patch.parameters.get_mut(name).ok_or_else(|| unknown_name("parameter", name))?;
        (parameter.value, parameter.value_span) = (value, span);
        self.put_in_document(["parameters", name, "value"], json);
        Ok(())
    }

    /// Sets the smallest and the largest permitted value of a parameter, in its declared unit.
    ///
    /// # Errors
    /// If the patch does not have the parameter, or a value is not finite.
    pub fn set_range(&mut self, name: &str, range: [f64; 2]) -> Result<(), EditError> {
        let [low, high] = range;
        let json = json!([finite_json(name, low)?, finite_json(name, high)?]);
        let parameter = self.patch.parameters.get_mut(name).ok_or_else(|| unknown_name("parameter", name))?;
        parameter.range = Some((low, high));
        self.must_reread |= low > high;
        self.put_in_document(["parameters", name, "range"], json);
        Ok(())
    }

    /// Adds a parameter, or replaces the parameter with this name.
    pub fn put_parameter(&mut self, name: &str, parameter: ParameterBuilder) {
        let value = parameter.into_value();
        let (source, mut findings) = (self.tree_entry(name, &value), Findings::new());
        let parameter = decode::parameter(&source, &mut findings);
        self.reread_if_faulty(&findings);
        if let Some(parameter) = parameter {
            self.patch.parameters.insert(name.to_owned(), parameter);
        }
        // The expansion checks the names and formulas of macros together with the quantities of the patch.
        self.must_expand |= !self.patch.macros.is_empty();
        self.put_within_document(["parameters", name], value);
    }

    /// Adds a scale, or replaces the scale with this name. `per_volt` is the value of one volt: a number in `unit`, or
    /// a formula.
    pub fn put_scale(&mut self, name: &str, per_volt: impl Into<Value>, unit: &str) {
        let value = json!({"per_volt": per_volt.into(), "unit": unit});
        let (source, mut findings) = (self.tree_entry(name, &value), Findings::new());
        let scale = decode::scale(&source, &mut findings);
        self.reread_if_faulty(&findings);
        if let Some(scale) = scale {
            // Tables from files were converted to the unit of the old scale.
            let is_new = self.patch.scales.insert(name.to_owned(), scale).is_none();
            self.must_reread |= !is_new && !self.patch.tables.is_empty();
        }
        self.must_expand |= !self.patch.macros.is_empty();
        self.put_within_document(["scales", name], value);
    }

    /// Sets a setting of an element to a number, a formula or a word.
    ///
    /// The name of a setting in a group includes the group: "limit.lower". Elements of macro instances cannot be
    /// edited.
    ///
    /// # Errors
    /// If the patch does not have the element, the element is inside an instance of a macro, or its kind does not have
    /// the setting.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let summer = ElementBuilder::new("summer").cords("x1", ["+100"]);
    /// let patch = PatchBuilder::new("limited").element("A1", summer).build()?;
    /// let mut editor = patch.edit();
    /// editor.set_setting("A1", "limit.upper", 20)?;
    /// let limited = editor.finish("limited.json")?;
    /// assert_eq!(limited.value()["elements"]["A1"]["limit"]["upper"], 20);
    /// # Ok(())
    /// # }
    /// ```
    pub fn set_setting(
        &mut self,
        element: &str,
        setting: &str,
        value: impl Into<Value>,
    ) -> Result<(), EditError> {
        let value = value.into();
        let Patch { element_section, elements, edited_text, .. } = &mut self.patch;
        let Some(SectionEntry::Element(entry)) = element_section.get_mut(element) else {
            return Err(self.missing_element(element));
        };
        let index = entry.kind.setting(setting).ok_or_else(|| unknown_name("setting", setting))?;
        let mut findings = Findings::new();
        match entry.kind.settings[index].measure {
            // Other settings or files depend on these, or they depend on other settings.
            Measure::Choice(_) | Measure::Points | Measure::Curve(_) => self.must_reread = true,
            measure => {
                let node = Node::of(&value, &mut edited_text.next_span);
                let key = setting.rsplit('.').next().unwrap_or(setting);
                let amount = decode_entry::amount(&node, key, measure, entry, &mut findings);
                if let Some(expanded) = elements.get_mut(element) {
                    expanded.settings[index].clone_from(&amount);
                }
                entry.settings[index] = amount;
            }
        }
        self.reread_if_faulty(&findings);
        let keys = ["elements", element].into_iter().chain(setting.split('.'));
        let path = keys.map(str::to_owned).collect();
        self.batch.push(DocumentEdit::PutWithin { path, value });
        Ok(())
    }

    /// Sets the setting "initial" of an element: its initial voltage, as a number in volts or a formula.
    ///
    /// # Errors
    /// If the patch does not have the element, the element is inside an instance of a macro, or its kind does not have
    /// an initial voltage.
    pub fn set_initial(&mut self, element: &str, initial: impl Into<Value>) -> Result<(), EditError> {
        self.set_setting(element, "initial", initial)
    }

    /// Adds an element or a macro instance after the others, or replaces the one with this name.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("empty").build()?;
    /// let mut editor = patch.edit();
    /// editor.put_element("A1", ElementBuilder::new("summer").cords("x1", ["+100"]));
    /// let patch = editor.finish("summer.json")?;
    /// assert_eq!(patch.elements["A1"].kind.name, "summer");
    /// # Ok(())
    /// # }
    /// ```
    pub fn put_element(&mut self, name: &str, element: ElementBuilder) {
        let value = element.into_value();
        let (source, mut findings) = (self.tree_entry(name, &value), Findings::new());
        let macros = Macros::take_from(&mut self.patch);
        let entry = macros.section_entry(&source, &mut findings);
        macros.put_back(&mut self.patch);
        self.reread_if_faulty(&findings);
        match entry {
            Some(entry) => {
                let is_instance = entry.is_instance();
                if let Some(old) = self.patch.element_section.insert(name.to_owned(), entry) {
                    // The fields of records and signals contain the elements behind the ports of the old instance.
                    self.must_reread |= is_instance || old.is_instance();
                }
            }
            None => self.must_reread = true,
        }
        self.must_expand = true;
        self.put_within_document(["elements", name], value);
    }

    /// Adds a drive after the others, or replaces the drive with this name. The builder must set the setting "scale".
    pub fn put_drive(&mut self, name: &str, drive: ElementBuilder) {
        let value = drive.into_value();
        let (source, mut findings) = (self.tree_entry(name, &value), Findings::new());
        let drive = decode_entry::element_entry(&source, Family::Drive, &mut findings);
        self.reread_if_faulty(&findings);
        match drive {
            Some(drive) => {
                let has_files = !drive.table_files.is_empty();
                let is_new = self.patch.drives.insert(name.to_owned(), drive).is_none();
                // The expansion uses only the names of drives. It also reads the files of tables.
                self.must_expand |= is_new || has_files;
            }
            None => self.must_reread = true,
        }
        self.put_within_document(["drives", name], value);
    }

    /// Replaces a drive by a table drive with one point, [0, 0], in the same scale.
    ///
    /// A running program can then replace the points of the table. `hold` is the value between points: "linear" for
    /// straight lines, or "previous" for the value of the preceding point.
    ///
    /// # Errors
    /// If the patch does not have the drive.
    pub fn put_table_drive(&mut self, name: &str, hold: &str) -> Result<(), EditError> {
        let drive = self.patch.drives.get(name).ok_or_else(|| unknown_name("drive", name))?;
        let scale = drive.scale.as_ref().map(|scale| scale.value.clone());
        let table =
            ElementBuilder::new("table").set("scale", scale).set("points", json!([[0, 0]])).set("hold", hold);
        self.put_drive(name, table);
        Ok(())
    }

    /// Adds a macro after the others, or replaces the macro with this name.
    pub fn put_macro(&mut self, name: &str, definition: MacroBuilder) {
        let value = definition.into_value();
        let (source, mut findings) = (self.tree_entry(name, &value), Findings::new());
        // The fields of records and signals contain the elements behind the ports of the old macro's instances.
        self.must_reread |= self.patch.macros.contains_key(name);
        let mut macros = Macros::take_from(&mut self.patch);
        macros.define(&source, &mut findings);
        macros.put_back(&mut self.patch);
        self.reread_if_faulty(&findings);
        self.must_expand = true;
        self.put_within_document(["macros", name], value);
    }

    /// Adds a cord to an element or an instance, after the cords that the jack has.
    ///
    /// `jack` is a jack ("x10", "in") or a port of the instance. `from` is an output ("A1", "L1.out", "+100").
    ///
    /// # Errors
    /// If the patch does not have the element, or the element is inside an instance of a macro.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let summer = ElementBuilder::new("summer").cords("x1", ["+100"]);
    /// let patch = PatchBuilder::new("sum").element("A1", summer).build()?;
    /// let mut editor = patch.edit();
    /// editor.add_cord("A1", "x1", "-100")?;
    /// let patch = editor.finish("sum.json")?;
    /// assert_eq!(patch.elements["A1"].plugs.len(), 2);
    /// assert!(patch.text().contains("\"x1\": [\"+100\", \"-100\"]"));
    /// # Ok(())
    /// # }
    /// ```
    pub fn add_cord(&mut self, element: &str, jack: &str, from: &str) -> Result<(), EditError> {
        let [jack, placed_from] = [jack, from].map(|name| self.placed(name));
        let Some(entry) = self.patch.element_section.get_mut(element) else {
            return Err(self.missing_element(element));
        };
        let (jack, is_in_order) = entry.add_cord(jack, placed_from);
        self.must_expand = true;
        self.must_reread |= !is_in_order;
        let (element, from) = (element.to_owned(), from.to_owned());
        self.batch.push(DocumentEdit::AddCord { element, jack, from });
        Ok(())
    }

    /// Replaces the output `from` by `to` in all cords into an element or an instance.
    ///
    /// Names are compared as written in the document: "L1" and "L1.out" are different names. If no cord comes from
    /// `from`, nothing changes.
    ///
    /// # Errors
    /// If the patch does not have the element, or the element is inside an instance of a macro.
    pub fn replug(&mut self, element: &str, from: &str, to: &str) -> Result<(), EditError> {
        let Patch { element_section, edited_text, .. } = &mut self.patch;
        let Some(entry) = element_section.get_mut(element) else {
            return Err(self.missing_element(element));
        };
        let jacks = entry.replug(from, to, &mut edited_text.next_span);
        self.must_expand = true;
        let [element, from, to] = [element, from, to].map(str::to_owned);
        self.batch.push(DocumentEdit::Replug { element, jacks, from, to });
        Ok(())
    }

    /// Sets the title.
    pub fn set_title(&mut self, text: &str) {
        text.clone_into(&mut self.patch.title);
        self.put_in_document(["title"], text.into());
    }

    /// Sets the source of the patch, such as a book and a figure.
    pub fn set_source(&mut self, text: &str) {
        text.clone_into(&mut self.patch.source);
        self.put_in_document(["source"], text.into());
    }

    /// Sets the note.
    pub fn set_note(&mut self, text: &str) {
        text.clone_into(&mut self.patch.note);
        self.put_in_document(["note"], text.into());
    }

    /// Sets the machine for which the patch is made.
    pub fn set_machine(&mut self, name: &str) {
        self.patch.machine = Some(self.placed(name));
        self.put_in_document(["machine"], name.into());
    }

    /// Puts a value at a path of keys. If the last key does not exist, it is added at the end of its object.
    ///
    /// The text is read again at the end, so typed edits are faster. [`PatchEditor::finish`] reports a path that does
    /// not exist.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::Patch;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = Patch::parse("p.json", r#"{"patchcord": 1, "run": {"for": 8}}"#)?;
    /// let mut editor = patch.edit();
    /// editor.put(&["run", "every"], 0.5);
    /// let patch = editor.finish("q.json")?;
    /// assert_eq!(patch.run.every.as_ref().map(|every| every.value), Some(0.5));
    /// # Ok(())
    /// # }
    /// ```
    pub fn put(&mut self, path: &[&str], value: impl Into<Value>) {
        let path = path.iter().map(|key| (*key).to_owned()).collect();
        self.batch.push(DocumentEdit::Put { path, value: value.into() });
        self.must_reread = true;
    }

    /// Returns the edited patch under the name `file`. Paths of tables in files are relative to its folder.
    ///
    /// # Errors
    /// If a path of [`PatchEditor::put`] does not exist, or if the text must be read again and cannot be decoded.
    /// Faults inside the document are reported by [`Circuit::new`](crate::circuit::Circuit::new).
    pub fn finish(self, file: &str) -> Result<Patch, EditError> {
        let PatchEditor { mut patch, batch, must_expand, must_reread } = self;
        let folder = folder_of(file);
        let is_moved = !patch.tables.is_empty() && folder != folder_of(&patch.file);
        if must_reread || is_moved {
            let text = render(patch.text(), &batch)?;
            return Ok(Patch::parse(file, &text)?);
        }
        file.clone_into(&mut patch.file);
        if !batch.is_empty() {
            patch.edited_text.push(batch);
        }
        if must_expand {
            let mut findings = Findings::new();
            let (macros, section) =
                (Macros::take_from(&mut patch), std::mem::take(&mut patch.element_section));
            macros::expand_macros(macros, &section, &mut patch, &mut findings);
            (patch.element_section, patch.findings) = (section, findings);
            table_file::read_tables(&mut patch, folder);
            if any_error(&patch.findings) {
                return Ok(Patch::parse(file, patch.text())?);
            }
        }
        Ok(patch)
    }

    /// A tree entry for a JSON value. Its spans are beyond the text, because the text does not contain it yet.
    fn tree_entry(&mut self, name: &str, value: &Value) -> KeyValue {
        KeyValue::of(name, value, &mut self.patch.edited_text.next_span)
    }

    /// The next unused span beyond the text.
    fn new_span(&mut self) -> Span {
        Span::beyond_text(&mut self.patch.edited_text.next_span)
    }

    /// A name with a span beyond the text.
    fn placed(&mut self, name: &str) -> Placed<String> {
        Placed { value: name.to_owned(), span: self.new_span() }
    }

    /// Requires the text to be read again if the decoder reported a fault, so that the report gets a position in the
    /// text.
    fn reread_if_faulty(&mut self, findings: &[Diagnostic]) {
        self.must_reread |= !findings.is_empty();
    }

    /// Adds an edit that puts a value at a path whose parents exist.
    fn put_in_document<const N: usize>(&mut self, path: [&str; N], value: Value) {
        self.batch.push(DocumentEdit::Put { path: path.map(str::to_owned).to_vec(), value });
    }

    /// Adds an edit that puts a value at a path whose section may not exist yet.
    fn put_within_document<const N: usize>(&mut self, path: [&str; N], value: Value) {
        self.batch.push(DocumentEdit::PutWithin { path: path.map(str::to_owned).to_vec(), value });
    }

    /// The error for an element that cannot be edited: it is inside an instance, or it does not exist.
    fn missing_element(&self, name: &str) -> EditError {
        match self.patch.elements.contains_key(name) && name.contains('.') {
            true => EditError::InsideInstance(name.to_owned()),
            false => unknown_name("element", name),
        }
    }
}

/// The error for a name that the patch does not have.
fn unknown_name(noun: &'static str, name: &str) -> EditError {
    EditError::Unknown { noun, name: name.to_owned() }
}

/// Converts a value of a parameter to JSON, which cannot represent infinity.
///
/// # Errors
/// If the value is not finite.
fn finite_json(name: &str, value: f64) -> Result<Value, EditError> {
    if value.is_finite() { Ok(Value::from(value)) } else { Err(EditError::NotFinite(name.to_owned())) }
}

/// The folder of a file; an empty path if the name has no folder.
fn folder_of(file: &str) -> &Path {
    Path::new(file).parent().unwrap_or(Path::new(""))
}

impl Patch {
    /// An editor that begins with a copy of this patch.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::PatchBuilder;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = PatchBuilder::new("spring").parameter("k", 2.0, "N/m", [0.0, 10.0]).build()?;
    /// let mut editor = patch.edit();
    /// editor.set_parameter("k", 5.0)?;
    /// let stiffer = editor.finish("stiffer.json")?;
    /// assert_eq!((patch.parameters["k"].value, stiffer.parameters["k"].value), (2.0, 5.0));
    /// # Ok(())
    /// # }
    /// ```
    pub fn edit(&self) -> PatchEditor {
        // If some fields could not be read, edits cannot update them.
        let has_unread = self.unread.has_unread_section || !self.unread.names.is_empty();
        let must_reread = any_error(&self.findings) || has_unread;
        PatchEditor { patch: self.clone(), batch: Vec::new(), must_expand: false, must_reread }
    }

    /// Returns a patch with new values at some paths of the document. `file` is its name.
    ///
    /// Only these places of the text change. If the last key of a path does not exist, it is added at the end of its
    /// object.
    ///
    /// # Errors
    /// If a path does not exist, if two edits overlap, or if the new text cannot be decoded.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{Edit, Patch};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let patch = Patch::parse("old.json", r#"{"patchcord": 1, "run":  {"for": 8}}"#)?;
    /// let longer = patch.with_edits("new.json", &[Edit::new("run/for", 10), Edit::new("run/every", 0.5)])?;
    /// assert_eq!(longer.text(), r#"{"patchcord": 1, "run":  {"for": 10, "every": 0.5}}"#);
    /// # Ok(())
    /// # }
    /// ```
    pub fn with_edits(&self, file: &str, edits: &[Edit]) -> Result<Patch, EditError> {
        check_no_overlap(edits)?;
        let text = splice(self.text(), &root_of(self.text()), edits)?;
        Ok(Patch::parse(file, &text)?)
    }
}

/// Checks that no edit has the same path as another one, or a path within that of another.
fn check_no_overlap(edits: &[Edit]) -> Result<(), EditError> {
    let overlaps = |(index, edit): &(usize, &Edit)| {
        let is_repeated = edits[..*index].iter().any(|earlier| earlier.path == edit.path);
        let contains_edit =
            |outer: &Edit| outer.path.len() < edit.path.len() && edit.path.starts_with(&outer.path);
        is_repeated || edits.iter().any(contains_edit)
    };
    match edits.iter().enumerate().find(overlaps) {
        Some((_, edit)) => Err(EditError::OverlappingEdits(edit.path.join("/"))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A document with an irregular layout, which edits must keep.
    const TEXT: &str = r#"{
  "patchcord": 1,
  "parameters": {"K":  {"value": 45e6, "unit": "N/m"}},
  "run": {"for": 8},
  "empty": {}
}
"#;

    /// The patch of `TEXT` with edits.
    fn edited(edits: &[Edit]) -> Result<Patch, EditError> {
        Patch::parse("old.json", TEXT).unwrap().with_edits("new.json", edits)
    }

    #[test]
    fn edits_change_only_their_places_in_the_text() {
        let edits = [
            Edit::new("run/every", 0.5),
            Edit::new("parameters/K/value", 1e3),
            Edit::new("pictures", json!([{"x": "t", "y": ["x", "v"]}])),
            Edit::new("empty/key", "text"),
        ];
        let patch = edited(&edits).unwrap();
        let text = r#"{
  "patchcord": 1,
  "parameters": {"K":  {"value": 1000.0, "unit": "N/m"}},
  "run": {"for": 8, "every": 0.5},
  "empty": {"key": "text"}, "pictures": [
    {"x": "t", "y": ["x", "v"]}
  ]
}
"#;
        assert_eq!((patch.text(), patch.file()), (text, "new.json"));
    }

    #[test]
    fn several_new_keys_are_added_to_one_object_in_the_order_of_the_edits() {
        let text = |empty: &str| {
            let old = TEXT.replace("{}", empty);
            let keys = ["empty/b", "run/every", "empty/a", "run/step", "empty/c"];
            let edits: Vec<_> = keys.iter().map(|key| Edit::new(key, 1)).collect();
            Patch::parse("old.json", &old).unwrap().with_edits("new.json", &edits).unwrap().text().to_owned()
        };
        for empty in ["{}", "{ }"] {
            assert!(text(empty).contains(r#""run": {"for": 8, "every": 1, "step": 1},"#), "{}", text(empty));
            assert!(text(empty).contains(r#""empty": {"b": 1, "a": 1, "c": 1}"#), "{}", text(empty));
        }
    }

    #[test]
    fn a_missing_path_and_overlapping_edits_are_rejected() {
        let message = |edits: &[Edit]| edited(edits).unwrap_err().to_string();
        assert_eq!(
            message(&[Edit::new("parameters/M/value", 1)]),
            "there is no parameters/M/value in the document"
        );
        assert_eq!(message(&[Edit::new("patchcord/x", 1)]), "there is no patchcord/x in the document");
        let within = [Edit::new("parameters/K", json!({})), Edit::new("parameters/K/value", 1)];
        assert_eq!(message(&within), "parameters/K/value is edited twice");
        assert_eq!(message(&[Edit::new("run/for", 1), Edit::new("run/for", 2)]), "run/for is edited twice");
        for missing in ["run/every", "empty/key"] {
            let twice = [Edit::new(missing, 1), Edit::new("patchcord", 1), Edit::new(missing, 1)];
            assert_eq!(message(&twice), format!("{missing} is edited twice"));
        }
    }
}
