//! Edits that add or replace a part of a patch, and edits of cords.

use serde_json::Value;

use super::{PatchEditor, unknown_name};
use crate::document::fields::Findings;
use crate::elements::Family;
use crate::patch::builder::{ElementBuilder, MacroBuilder, ParameterBuilder, scale_entry};
use crate::patch::document::Patch;
use crate::patch::edit::EditError;
use crate::patch::macros::Macros;
use crate::patch::render::DocumentEdit;
use crate::patch::{decode, decode_entry};

impl PatchEditor {
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
        let value = scale_entry(per_volt, unit);
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
        let table = ElementBuilder::new("table").set("scale", scale);
        let table = table.set("points", vec![vec![0, 0]]).set("hold", hold);
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
        let (element, from) = (path_of(element), from.to_owned());
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
        let [from, to] = [from, to].map(str::to_owned);
        self.batch.push(DocumentEdit::Replug { element: path_of(element), jacks, from, to });
        Ok(())
    }
}

/// The keys from the root of the document to an element or an instance.
fn path_of(element: &str) -> Vec<String> {
    ["elements", element].map(str::to_owned).to_vec()
}
