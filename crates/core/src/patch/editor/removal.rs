//! Edits that remove parts of a patch.
//!
//! The text is read again after each of these edits, so the fields have all their effects immediately. Only
//! [`PatchEditor::remove_all_cords`] waits for the next edit of this kind, or for [`PatchEditor::finish`].

use super::{PatchEditor, unknown_name};
use crate::patch::document::Patch;
use crate::patch::edit::EditError;
use crate::patch::prune::Removal;
use crate::patch::render::{DocumentEdit, render};

impl PatchEditor {
    /// Removes a cord from an element or an instance of a macro.
    ///
    /// `jack` is a jack ("x10", "in") or a port of the instance, and `from` is the output that is plugged in, as the
    /// document has it. If the same output is plugged in twice, one cord stays. A jack without cords is no longer in
    /// the document.
    ///
    /// # Errors
    /// If the patch does not have the element or the cord, the element is inside an instance of a macro, or the path of
    /// an earlier [`PatchEditor::put`] does not exist.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let summer = ElementBuilder::new("summer").cords("x1", ["+100", "-100"]);
    /// let patch = PatchBuilder::new("sum").element("A1", summer).build()?;
    /// let mut editor = patch.edit();
    /// editor.remove_cord("A1", "x1", "-100")?;
    /// let error = editor.remove_cord("A1", "x1", "-100").unwrap_err();
    /// assert_eq!(error.to_string(), "there is no cord from -100 into x1 of A1 in the patch");
    /// let patch = editor.finish("sum.json")?;
    /// assert_eq!(patch.written_cords("A1").collect::<Vec<_>>(), [("x1", "+100")]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn remove_cord(&mut self, element: &str, jack: &str, from: &str) -> Result<(), EditError> {
        let Some(entry) = self.patch.element_section.get(element) else {
            return Err(self.missing_element(element));
        };
        if !entry.written_cords().contains(&(jack, from)) {
            return Err(unknown_name("cord", &format!("from {from} into {jack} of {element}")));
        }
        let [element, jack, from] = [element, jack, from].map(str::to_owned);
        self.remove(Removal::Cord { element, jack, from })
    }

    /// Removes all cords of elements and instances. Elements, settings and signals stay, and so do the cords inside
    /// macros.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let integrator = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let mut editor = PatchBuilder::new("decay").element("A1", integrator).build()?.edit();
    /// editor.remove_all_cords();
    /// let patch = editor.finish("integrator.json")?;
    /// assert_eq!(patch.written_cords("A1").count(), 0);
    /// assert_eq!(patch.value()["elements"]["A1"]["initial"], 50);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn remove_all_cords(&mut self) {
        for entry in self.patch.element_section.values_mut() {
            entry.clear_cords();
        }
        self.batch.push(DocumentEdit::Remove(Removal::AllCords));
        self.must_reread = true;
    }

    /// Removes a setting of an element or an instance of a macro, which then has its default.
    ///
    /// The name of a setting in a group includes the group: "limit.lower". A group without settings is removed too. If
    /// the document does not specify the setting, nothing changes. A missing setting without a default is not an error
    /// here; [`Circuit::new`](crate::circuit::Circuit::new) reports it.
    ///
    /// # Errors
    /// If the patch does not have the element, its kind or macro does not have the setting, the element is inside an
    /// instance of a macro, or the path of an earlier [`PatchEditor::put`] does not exist.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let summer = ElementBuilder::new("summer").cords("x1", ["+100"]);
    /// let mut editor = PatchBuilder::new("sum").element("A1", summer).build()?.edit();
    /// editor.set_setting("A1", "limit.upper", 20)?;
    /// editor.remove_setting("A1", "limit.upper")?;
    /// let patch = editor.finish("sum.json")?;
    /// assert!(patch.value()["elements"]["A1"].get("limit").is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn remove_setting(&mut self, element: &str, setting: &str) -> Result<(), EditError> {
        let Some(entry) = self.patch.element_section.get(element) else {
            return Err(self.missing_element(element));
        };
        if !entry.has_setting(setting, &self.patch.macros) {
            return Err(unknown_name("setting", setting));
        }
        let keys = ["elements", element].into_iter().chain(setting.split('.'));
        self.remove(Removal::Key { path: keys.map(str::to_owned).collect() })
    }

    /// Removes an element, an instance of a macro or a drive, and everything that names its outputs.
    ///
    /// These are cords into other elements, signals, names in the record and in pictures, conditions of phases
    /// ("until"), and equations that name a removed signal or drive. A picture without signals along an axis is removed.
    /// A phase that waited for the element then lasts for its whole time. Inputs of other elements can become open.
    ///
    /// # Errors
    /// If the patch does not have the element, it is inside an instance of a macro, or the path of an earlier
    /// [`PatchEditor::put`] does not exist.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    ///
    /// let patch = PatchBuilder::new("decay")
    ///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["A1", "P1"]))
    ///     .element("P1", ElementBuilder::new("pot").cord("in", "+100").set("setting", 0.5))
    ///     .record(["A1", "P1"])
    ///     .build()?;
    /// let mut editor = patch.edit();
    /// editor.remove_element("P1")?;
    /// let patch = editor.finish("decay.json")?;
    /// assert_eq!(patch.written_cords("A1").collect::<Vec<_>>(), [("x1", "A1")]);
    /// assert_eq!(patch.record.len(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn remove_element(&mut self, name: &str) -> Result<(), EditError> {
        self.apply_batch()?;
        // The document also has the elements that could not be read.
        let has_entry = |section: &&str| self.patch.value()[*section].get(name).is_some();
        let Some(section) = ["elements", "drives"].into_iter().find(has_entry) else {
            return Err(self.missing_element(name));
        };
        self.remove(Removal::Entry { section, name: name.to_owned() })
    }

    /// Adds a removal and applies all edits.
    fn remove(&mut self, removal: Removal) -> Result<(), EditError> {
        self.batch.push(DocumentEdit::Remove(removal));
        self.apply_batch()
    }

    /// Renders the edits so far, and reads the text again.
    fn apply_batch(&mut self) -> Result<(), EditError> {
        if self.batch.is_empty() {
            return Ok(());
        }
        let text = render(self.patch.text(), &self.batch)?;
        self.patch = Patch::parse_with(self.patch.table_access.clone(), self.patch.file(), &text)?;
        self.batch.clear();
        (self.must_expand, self.must_reread) = (false, true);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
