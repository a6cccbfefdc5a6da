//! Typed edits of a patch. The fields change immediately; the text changes when a caller reads it.
//!
//! [`Patch::edit`] begins the edits. Each edit decodes the new part with the decoder for documents, so that an edited
//! part equals one that was read. It also adds a [`DocumentEdit`] to the batch. At the end, macros are expanded again
//! if an edit changed cords, elements or macros. Some edits have effects that the fields cannot follow; the rendered
//! text is then read again. `parts` has the edits that add or replace parts and cords, and `removal` those that remove
//! them.

mod parts;
mod removal;

use serde_json::Value;

use super::decode_entry::UNITS_OF_SCALE;
use super::document::Patch;
use super::edit::EditError;
use super::macros::{self, Macros, SectionEntry};
use super::render::{DocumentEdit, render};
use super::{decode, decode_entry, table_file};
use crate::document::fields::Findings;
use crate::document::tree::{KeyValue, Node};
use crate::document::{Diagnostic, Placed, Span, any_error, is_allowed_factor};
use crate::elements::SettingQuantity;

/// Edits a patch: its fields immediately, and its document when the text is read.
///
/// Methods named `set_` change a part that exists. Methods named `put_` add a part or replace the part with the same
/// name. Methods named `remove_` remove a part with everything that names it. A fault in a new value is not an error
/// here; [`Circuit::new`](crate::circuit::Circuit::new) reports it.
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
    /// New elements and changed cords are in [`Patch::elements`] only after [`PatchEditor::finish`], or after the removal of
    /// a cord, a setting or an element.
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
        let json = Value::from(vec![finite_json(name, low)?, finite_json(name, high)?]);
        let parameter = self.patch.parameters.get_mut(name).ok_or_else(|| unknown_name("parameter", name))?;
        parameter.range = Some((low, high));
        self.must_reread |= low > high;
        self.put_in_document(["parameters", name, "range"], json);
        Ok(())
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
        match entry.kind.settings[index].quantity {
            // Other settings or files depend on these, or they depend on other settings.
            SettingQuantity::Choice(_) | SettingQuantity::Points | SettingQuantity::Curve(_) => {
                self.must_reread = true
            }
            quantity => {
                let node = Node::of(&value, &mut edited_text.next_span);
                let key = setting.rsplit('.').next().unwrap_or(setting);
                let quantity = (quantity, UNITS_OF_SCALE);
                let amount = decode_entry::amount(&node, key, quantity, entry, &mut findings);
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

    /// Sets the equations that the wiring is meant to solve. They replace those of the patch.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::PatchBuilder;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let mut editor = PatchBuilder::new("spring").equation("x' = v").build()?.edit();
    /// editor.set_equations(["m x'' = -k x"]);
    /// let patch = editor.finish("spring.json")?;
    /// assert_eq!(patch.equations.len(), 1);
    /// assert_eq!(patch.value()["equations"][0], "m x'' = -k x");
    /// # Ok(())
    /// # }
    /// ```
    pub fn set_equations(&mut self, texts: impl IntoIterator<Item = impl AsRef<str>>) {
        let value: Value = texts.into_iter().map(|text| Value::from(text.as_ref())).collect();
        let node = Node::of(&value, &mut self.patch.edited_text.next_span);
        let mut findings = Findings::new();
        self.patch.equations = decode::equations(&node, &[], &mut self.patch.unread.names, &mut findings);
        self.reread_if_faulty(&findings);
        self.put_in_document(["equations"], value);
    }

    /// Sets the machine for which the patch is made.
    pub fn set_machine(&mut self, name: &str) {
        self.patch.machine = Some(self.placed(name));
        self.put_in_document(["machine"], name.into());
    }

    /// Sets the time scale: the machine seconds of one problem second. A value outside 1e-12 ... 1e12 is reported by
    /// [`Circuit::new`](crate::circuit::Circuit::new).
    pub fn set_time_scale(&mut self, value: f64) {
        match is_allowed_factor(value) {
            true => self.patch.time_scale = value,
            false => self.must_reread = true,
        }
        self.put_in_document(["time_scale"], value.into());
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
    /// editor.put(["run", "every"], 0.5);
    /// let patch = editor.finish("q.json")?;
    /// assert_eq!(patch.run.every.as_ref().map(|every| every.value), Some(0.5));
    /// # Ok(())
    /// # }
    /// ```
    pub fn put(&mut self, path: impl IntoIterator<Item = impl AsRef<str>>, value: impl Into<Value>) {
        let path = path.into_iter().map(|key| key.as_ref().to_owned()).collect();
        self.batch.push(DocumentEdit::Put { path, value: value.into() });
        self.must_reread = true;
    }

    /// Returns the edited patch under the name `file`. Paths of tables in files are relative to its folder,
    /// unless [`Patch::table_access`] names the folder from which tables may be read.
    ///
    /// # Errors
    /// If a path of [`PatchEditor::put`] does not exist, or if the text must be read again and cannot be decoded.
    /// Faults inside the document are reported by [`Circuit::new`](crate::circuit::Circuit::new).
    pub fn finish(self, file: &str) -> Result<Patch, EditError> {
        let PatchEditor { mut patch, batch, must_expand, must_reread } = self;
        let table_access = patch.table_access.renamed(&patch.file, file);
        let is_moved = !patch.tables.is_empty() && table_access != patch.table_access;
        if must_reread || is_moved {
            let text = render(patch.text(), &batch)?;
            return Ok(Patch::parse_with(table_access, file, &text)?);
        }
        file.clone_into(&mut patch.file);
        patch.table_access = table_access;
        if !batch.is_empty() {
            patch.edited_text.push(batch);
        }
        if must_expand {
            let mut findings = Findings::new();
            let (macros, section) =
                (Macros::take_from(&mut patch), std::mem::take(&mut patch.element_section));
            macros::expand_macros(macros, &section, &mut patch, &mut findings);
            (patch.element_section, patch.findings) = (section, findings);
            table_file::read_tables(&mut patch);
            if any_error(&patch.findings) {
                return Ok(Patch::parse_with(patch.table_access.clone(), file, patch.text())?);
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
}
