//! Edits of a patch: of its fields at once, and of its text when a caller reads it.
//!
//! [`Patch::edit`] begins typed edits. Each changes the fields of the patch with the decoder that reads documents, so that an
//! edited part is as if it was read, and notes what it changes in the document. At the end instances of macros are expanded
//! again if an edit touched cords, elements or macros. Where an edit cannot follow in the fields, the rendered text is read
//! again. [`Patch::edited`] puts values at any paths, and always reads the text again.

use std::path::Path;

use serde_json::{Value, json};

use super::builder::{ElementBuilder, MacroBuilder, ParameterBuilder};
use super::document::Patch;
use super::macros::{self, Item, Macros};
use super::render::{DocumentEdit, render, root_of, splice};
use super::{decode, decode_entry, table_file};
use crate::document::fields::Findings;
use crate::document::tree::{Entry, Node};
use crate::document::{Diagnostic, Placed, Report, Span, any_error};
use crate::elements::{Family, Measure};

/// What is put where.
#[derive(Debug, Clone, PartialEq)]
pub struct Edit {
    /// The keys that lead there from the document's beginning. All but the last stand in the document.
    pub path: Vec<String>,
    /// What stands there afterwards.
    pub value: Value,
}

impl Edit {
    /// A value at the end of a path such as `"parameters/VcL/value"`.
    pub fn new(path: &str, value: impl Into<Value>) -> Edit {
        Edit { path: path.split('/').map(str::to_owned).collect(), value: value.into() }
    }
}

/// Why a document cannot be edited.
#[derive(Debug, thiserror::Error)]
pub enum EditError {
    /// A path on which something other than the last key is missing, or is no object.
    #[error("there is no {0} in the document")]
    NoPlace(String),
    /// Two edits of one place, there or not, or of which one lies within the other.
    #[error("{0} is edited twice")]
    Twice(String),
    /// A name that the patch does not have.
    #[error("there is no {noun} {name} in the patch")]
    Unknown {
        /// What was to be edited: "parameter", "element".
        noun: &'static str,
        /// Its name.
        name: String,
    },
    /// An element that an instance of a macro holds: it has no place of its own in the document.
    #[error("{0} is inside an instance: edit its macro")]
    InsideInstance(String),
    /// A value that is infinite or not a number, for what is named.
    #[error("{0} must be a finite number")]
    NotFinite(String),
    /// What comes out is no document.
    #[error(transparent)]
    Text(#[from] Box<Report>),
}

/// Changes parts of a patch. The fields follow at once; the text is rendered when it is read.
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
    patch: Patch,
    /// What the edits change in the document, in the order of the calls.
    batch: Vec<DocumentEdit>,
    /// Whether instances of macros have to be expanded again.
    must_expand: bool,
    /// Whether the fields do not follow, so that the text has to be read again.
    must_read: bool,
}

impl PatchEditor {
    /// The patch as edited so far. Elements that were put, and cords, are in [`Patch::elements`] only after
    /// [`PatchEditor::finish`].
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// Sets a parameter, in its unit.
    ///
    /// # Errors
    /// If there is no such parameter, or the value is not finite.
    pub fn set_parameter(&mut self, name: &str, value: f64) -> Result<(), EditError> {
        let json = finite(name, value)?;
        let span = self.new_span();
        let parameter = self.patch.parameters.get_mut(name).ok_or_else(|| unknown("parameter", name))?;
        (parameter.value, parameter.value_span) = (value, span);
        self.note(["parameters", name, "value"], json);
        Ok(())
    }

    /// Sets the least and the largest value of a parameter, in its unit.
    ///
    /// # Errors
    /// If there is no such parameter, or a value is not finite.
    pub fn set_range(&mut self, name: &str, range: [f64; 2]) -> Result<(), EditError> {
        let [low, high] = range;
        let json = json!([finite(name, low)?, finite(name, high)?]);
        let parameter = self.patch.parameters.get_mut(name).ok_or_else(|| unknown("parameter", name))?;
        parameter.range = Some((low, high));
        self.must_read |= low > high;
        self.note(["parameters", name, "range"], json);
        Ok(())
    }

    /// Adds a parameter, or replaces the one of this name.
    pub fn put_parameter(&mut self, name: &str, parameter: ParameterBuilder) {
        let value = parameter.into_value();
        let (named, mut findings) = (self.entry(name, &value), Findings::new());
        let read = decode::parameter(&named, &mut findings);
        self.follow(&findings);
        if let Some(parameter) = read {
            self.patch.parameters.insert(name.to_owned(), parameter);
        }
        // Names and formulas of macros are checked with the quantities of the patch.
        self.must_expand |= !self.patch.macros.is_empty();
        self.note_within(["parameters", name], value);
    }

    /// Adds a scale, or replaces the one of this name: what one volt stands for, as a number in `unit` or a formula.
    pub fn put_scale(&mut self, name: &str, per_volt: impl Into<Value>, unit: &str) {
        let value = json!({"per_volt": per_volt.into(), "unit": unit});
        let (named, mut findings) = (self.entry(name, &value), Findings::new());
        let read = decode::scale(&named, &mut findings);
        self.follow(&findings);
        if let Some(scale) = read {
            // Tables in files were brought to the unit of the scale before.
            let is_new = self.patch.scales.insert(name.to_owned(), scale).is_none();
            self.must_read |= !is_new && !self.patch.tables.is_empty();
        }
        self.must_expand |= !self.patch.macros.is_empty();
        self.note_within(["scales", name], value);
    }

    /// Sets a setting of an element of the patch itself: a number, a formula or a word. A setting of a group is named with
    /// its group: "limit.lower".
    ///
    /// # Errors
    /// If there is no such element, it is inside an instance of a macro, or its kind has no such setting.
    pub fn set_setting(
        &mut self,
        element: &str,
        setting: &str,
        value: impl Into<Value>,
    ) -> Result<(), EditError> {
        let value = value.into();
        let Patch { own, elements, origin, .. } = &mut self.patch;
        let Some(Item::Element(entry)) = own.get_mut(element) else {
            return Err(self.no_element(element));
        };
        let index = entry.kind.setting(setting).ok_or_else(|| unknown("setting", setting))?;
        let mut findings = Findings::new();
        match entry.kind.settings[index].measure {
            // Other settings, or files, have a say in these.
            Measure::Choice(_) | Measure::Points | Measure::Curve(_) => self.must_read = true,
            measure => {
                let node = Node::of(&value, &mut origin.next_span);
                let key = setting.rsplit('.').next().unwrap_or(setting);
                let amount = decode_entry::amount(&node, key, measure, entry, &mut findings);
                if let Some(expanded) = elements.get_mut(element) {
                    expanded.settings[index].clone_from(&amount);
                }
                entry.settings[index] = amount;
            }
        }
        self.follow(&findings);
        let keys = ["elements", element].into_iter().chain(setting.split('.'));
        let path = keys.map(str::to_owned).collect();
        self.batch.push(DocumentEdit::PutWithin { path, value });
        Ok(())
    }

    /// Sets the initial voltage of an element of the patch itself.
    ///
    /// # Errors
    /// Those of [`PatchEditor::set_setting`].
    pub fn set_initial(&mut self, element: &str, initial: impl Into<Value>) -> Result<(), EditError> {
        self.set_setting(element, "initial", initial)
    }

    /// Adds an element or an instance of a macro behind the others, or replaces the one of this name.
    pub fn put_element(&mut self, name: &str, element: ElementBuilder) {
        let value = element.into_value();
        let (named, mut findings) = (self.entry(name, &value), Findings::new());
        let macros = Macros::take_from(&mut self.patch);
        let item = macros.item(&named, &mut findings);
        macros.give_back(&mut self.patch);
        self.follow(&findings);
        match item {
            Some(item) => {
                let is_instance = item.is_instance();
                if let Some(old) = self.patch.own.insert(name.to_owned(), item) {
                    // What is recorded at ports was led to elements before.
                    self.must_read |= is_instance || old.is_instance();
                }
            }
            None => self.must_read = true,
        }
        self.must_expand = true;
        self.note_within(["elements", name], value);
    }

    /// Adds a drive behind the others, or replaces the one of this name. Its scale is one of its settings.
    pub fn put_drive(&mut self, name: &str, drive: ElementBuilder) {
        let value = drive.into_value();
        let (named, mut findings) = (self.entry(name, &value), Findings::new());
        let read = decode_entry::entry(&named, Family::Drive, &mut findings);
        self.follow(&findings);
        match read {
            Some(drive) => {
                let has_files = !drive.files.is_empty();
                let is_new = self.patch.drives.insert(name.to_owned(), drive).is_none();
                // Expansion needs only the names of drives.
                self.must_expand |= is_new || has_files;
            }
            None => self.must_read = true,
        }
        self.note_within(["drives", name], value);
    }

    /// Replaces a drive by a table of one point, zero, in the same scale. `hold` is what it gives between points: "linear" or
    /// "previous". A program of the patch then takes points for the drive.
    ///
    /// # Errors
    /// If there is no such drive.
    pub fn feed_drive(&mut self, name: &str, hold: &str) -> Result<(), EditError> {
        let drive = self.patch.drives.get(name).ok_or_else(|| unknown("drive", name))?;
        let scale = drive.scale.as_ref().map(|scale| scale.value.clone());
        let table =
            ElementBuilder::new("table").set("scale", scale).set("points", json!([[0, 0]])).set("hold", hold);
        self.put_drive(name, table);
        Ok(())
    }

    /// Adds a macro behind the others, or replaces the one of this name.
    pub fn put_macro(&mut self, name: &str, definition: MacroBuilder) {
        let value = definition.into_value();
        let (named, mut findings) = (self.entry(name, &value), Findings::new());
        // What is recorded at ports was led to elements before.
        self.must_read |= self.patch.macros.contains_key(name);
        let mut macros = Macros::take_from(&mut self.patch);
        macros.define(&named, &mut findings);
        macros.give_back(&mut self.patch);
        self.follow(&findings);
        self.must_expand = true;
        self.note_within(["macros", name], value);
    }

    /// Adds a cord from a name ("A1", "L1.out", "+100") to a jack ("x10", "in") of an element or a port of an instance, behind
    /// the cords that are there.
    ///
    /// # Errors
    /// If there is no such element, or it is inside an instance of a macro.
    pub fn add_cord(&mut self, element: &str, jack: &str, from: &str) -> Result<(), EditError> {
        let [jack, from_placed] = [jack, from].map(|name| self.placed(name));
        let Some(item) = self.patch.own.get_mut(element) else {
            return Err(self.no_element(element));
        };
        let (jack, is_in_order) = item.add_cord(jack, from_placed);
        self.must_expand = true;
        self.must_read |= !is_in_order;
        let (element, from) = (element.to_owned(), from.to_owned());
        self.batch.push(DocumentEdit::AddCord { element, jack, from });
        Ok(())
    }

    /// Puts the name `to` in place of `from` in all cords into an element or an instance of a macro, as they are written.
    ///
    /// # Errors
    /// If there is no such element, or it is inside an instance of a macro.
    pub fn replug(&mut self, element: &str, from: &str, to: &str) -> Result<(), EditError> {
        let Patch { own, origin, .. } = &mut self.patch;
        let Some(item) = own.get_mut(element) else {
            return Err(self.no_element(element));
        };
        let jacks = item.replug(from, to, &mut origin.next_span);
        self.must_expand = true;
        let [element, from, to] = [element, from, to].map(str::to_owned);
        self.batch.push(DocumentEdit::Replug { element, jacks, from, to });
        Ok(())
    }

    /// Sets the title.
    pub fn set_title(&mut self, text: &str) {
        text.clone_into(&mut self.patch.title);
        self.note(["title"], text.into());
    }

    /// Sets where the patch comes from.
    pub fn set_source(&mut self, text: &str) {
        text.clone_into(&mut self.patch.source);
        self.note(["source"], text.into());
    }

    /// Sets the note.
    pub fn set_note(&mut self, text: &str) {
        text.clone_into(&mut self.patch.note);
        self.note(["note"], text.into());
    }

    /// Sets the machine that the patch is made for.
    pub fn set_machine(&mut self, name: &str) {
        self.patch.machine = Some(self.placed(name));
        self.note(["machine"], name.into());
    }

    /// Puts a value at the end of a path of keys; a last key that is not there is added at the end of its object. The whole
    /// text is read again at the end. [`PatchEditor::finish`] refuses a path that leads nowhere.
    pub fn put(&mut self, path: &[&str], value: impl Into<Value>) {
        let path = path.iter().map(|key| (*key).to_owned()).collect();
        self.batch.push(DocumentEdit::Put { path, value: value.into() });
        self.must_read = true;
    }

    /// The patch, as one of this file. Tables in files are looked for from its folder.
    ///
    /// # Errors
    /// If a path of [`PatchEditor::put`] leads nowhere, or the text has to be read again and is no document. What is wrong
    /// inside the document is found by [`Circuit::new`](crate::circuit::Circuit::new).
    pub fn finish(self, file: &str) -> Result<Patch, EditError> {
        let PatchEditor { mut patch, batch, must_expand, must_read } = self;
        let folder = folder_of(file);
        let is_moved = !patch.tables.is_empty() && folder != folder_of(&patch.file);
        if must_read || is_moved {
            let text = render(patch.text(), &batch)?;
            return Ok(Patch::parse(file, &text)?);
        }
        file.clone_into(&mut patch.file);
        if !batch.is_empty() {
            patch.origin.push(batch);
        }
        if must_expand {
            let mut findings = Findings::new();
            let (macros, own) = (Macros::take_from(&mut patch), std::mem::take(&mut patch.own));
            macros::write_out(macros, &own, &mut patch, &mut findings);
            (patch.own, patch.findings) = (own, findings);
            table_file::read_all(&mut patch, folder);
            if any_error(&patch.findings) {
                return Ok(Patch::parse(file, patch.text())?);
            }
        }
        Ok(patch)
    }

    /// An entry of a section that is not in the text.
    fn entry(&mut self, name: &str, value: &Value) -> Entry {
        Entry::of(name, value, &mut self.patch.origin.next_span)
    }

    fn new_span(&mut self) -> Span {
        Span::beyond_text(&mut self.patch.origin.next_span)
    }

    fn placed(&mut self, name: &str) -> Placed<String> {
        Placed { value: name.to_owned(), span: self.new_span() }
    }

    /// What the decoder finds wrong is found again when the text is read.
    fn follow(&mut self, findings: &[Diagnostic]) {
        self.must_read |= !findings.is_empty();
    }

    fn note<const N: usize>(&mut self, path: [&str; N], value: Value) {
        self.batch.push(DocumentEdit::Put { path: path.map(str::to_owned).to_vec(), value });
    }

    fn note_within<const N: usize>(&mut self, path: [&str; N], value: Value) {
        self.batch.push(DocumentEdit::PutWithin { path: path.map(str::to_owned).to_vec(), value });
    }

    /// Why an element cannot be edited.
    fn no_element(&self, name: &str) -> EditError {
        match self.patch.elements.contains_key(name) && name.contains('.') {
            true => EditError::InsideInstance(name.to_owned()),
            false => unknown("element", name),
        }
    }
}

fn unknown(noun: &'static str, name: &str) -> EditError {
    EditError::Unknown { noun, name: name.to_owned() }
}

/// A value as JSON, which has no number for infinity.
fn finite(name: &str, value: f64) -> Result<Value, EditError> {
    if value.is_finite() { Ok(Value::from(value)) } else { Err(EditError::NotFinite(name.to_owned())) }
}

fn folder_of(file: &str) -> &Path {
    Path::new(file).parent().unwrap_or(Path::new(""))
}

impl Patch {
    /// An editor that begins with this patch.
    pub fn edit(&self) -> PatchEditor {
        // Edits cannot follow in the fields where some could not be read.
        let must_read = any_error(&self.findings) || self.lost.section || !self.lost.names.is_empty();
        PatchEditor { patch: self.clone(), batch: Vec::new(), must_expand: false, must_read }
    }

    /// The same document with other values in some places: of the text only these change. A last key that does not stand there
    /// is added at the end of its object. `file` is the name of what comes out.
    ///
    /// # Errors
    /// When a path leads nowhere, or two edits overlap.
    pub fn edited(&self, file: &str, edits: &[Edit]) -> Result<Patch, EditError> {
        check_apart(edits)?;
        let text = splice(self.text(), &root_of(self.text()), edits)?;
        Ok(Patch::parse(file, &text)?)
    }
}

/// Refuses two edits of one place, and one within another.
fn check_apart(edits: &[Edit]) -> Result<(), EditError> {
    let is_twice = |(index, edit): &(usize, &Edit)| {
        let stood_before = edits[..*index].iter().any(|other| other.path == edit.path);
        let holds = |other: &Edit| other.path.len() < edit.path.len() && edit.path.starts_with(&other.path);
        stood_before || edits.iter().any(holds)
    };
    match edits.iter().enumerate().find(is_twice) {
        Some((_, edit)) => Err(EditError::Twice(edit.path.join("/"))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"{
  "patchcord": 1,
  "parameters": {"K":  {"value": 45e6, "unit": "N/m"}},
  "run": {"for": 8},
  "empty": {}
}
"#;

    fn edited(edits: &[Edit]) -> Result<Patch, EditError> {
        Patch::parse("old.json", TEXT).unwrap().edited("new.json", edits)
    }

    #[test]
    fn nothing_but_the_places_named_changes() {
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
    fn several_keys_come_into_one_object_in_their_order() {
        let text = |empty: &str| {
            let old = TEXT.replace("{}", empty);
            let keys = ["empty/b", "run/every", "empty/a", "run/step", "empty/c"];
            let edits: Vec<_> = keys.iter().map(|key| Edit::new(key, 1)).collect();
            Patch::parse("old.json", &old).unwrap().edited("new.json", &edits).unwrap().text().to_owned()
        };
        for empty in ["{}", "{ }"] {
            assert!(text(empty).contains(r#""run": {"for": 8, "every": 1, "step": 1},"#), "{}", text(empty));
            assert!(text(empty).contains(r#""empty": {"b": 1, "a": 1, "c": 1}"#), "{}", text(empty));
        }
    }

    #[test]
    fn what_leads_nowhere_or_meets_another_edit_is_refused() {
        let told = |edits: &[Edit]| edited(edits).unwrap_err().to_string();
        assert_eq!(
            told(&[Edit::new("parameters/M/value", 1)]),
            "there is no parameters/M/value in the document"
        );
        assert_eq!(told(&[Edit::new("patchcord/x", 1)]), "there is no patchcord/x in the document");
        let within = [Edit::new("parameters/K", json!({})), Edit::new("parameters/K/value", 1)];
        assert_eq!(told(&within), "parameters/K/value is edited twice");
        assert_eq!(told(&[Edit::new("run/for", 1), Edit::new("run/for", 2)]), "run/for is edited twice");
        for missing in ["run/every", "empty/key"] {
            let twice = [Edit::new(missing, 1), Edit::new("patchcord", 1), Edit::new(missing, 1)];
            assert_eq!(told(&twice), format!("{missing} is edited twice"));
        }
    }
}
