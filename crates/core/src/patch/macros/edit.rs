//! Edits of elements, instances and macros of a patch that has been read.
//!
//! The edits change the section "elements" as written. `PatchEditor` then expands the macros again.

use indexmap::IndexMap;

use super::{Macro, Macros, SectionEntry};
use crate::document::{Placed, Span};
use crate::patch::document::{Patch, Plug};

impl Macros {
    /// Takes the macros out of a patch without errors. [`Macros::put_back`] and `expand_macros` return them.
    pub(in crate::patch) fn take_from(patch: &mut Patch) -> Macros {
        Macros { defined: std::mem::take(&mut patch.macros), span: patch.macros_span, ..Macros::default() }
    }

    /// Returns the macros to the patch from which they were taken.
    pub(in crate::patch) fn put_back(self, patch: &mut Patch) {
        patch.macros = self.defined;
    }
}

impl SectionEntry {
    /// Whether the entry is an instance of a macro.
    pub(in crate::patch) fn is_instance(&self) -> bool {
        matches!(self, SectionEntry::Instance(_))
    }

    /// The cords in the document: for each the jack or port, and the name that is plugged in.
    pub(in crate::patch) fn written_cords(&self) -> Vec<(&str, &str)> {
        match self {
            SectionEntry::Element(entry) => {
                let plugs = entry.plugs.iter();
                plugs.map(|plug| (plug.jack.value.as_str(), plug.from.value.as_str())).collect()
            }
            SectionEntry::Instance(instance) => {
                let ports = instance.cords.iter();
                let cords = ports.flat_map(|(port, cords)| {
                    cords.value.iter().map(move |from| (port.as_str(), from.value.as_str()))
                });
                cords.collect()
            }
        }
    }

    /// Adds a cord to a jack or port, after the cords that it has.
    ///
    /// Returns the keys from the entry to the jack in the document, and whether the cords are now in the order of the
    /// edited document. If they are not, the document must be read again.
    ///
    /// A new jack of an amplifier becomes the last key of "in", which is also the order of the cords. In other elements
    /// it becomes the last key of the entry, but its cord may belong before others, so the document is read again.
    pub(in crate::patch) fn add_cord(
        &mut self,
        jack: Placed<String>,
        from: Placed<String>,
    ) -> (Vec<String>, bool) {
        match self {
            SectionEntry::Element(entry) => {
                let has_gains = entry.kind.has_gains();
                let group = has_gains.then(|| "in".to_owned());
                let keys = group.into_iter().chain([jack.value.clone()]).collect();
                let is_in_order = match entry.plugs.iter().rposition(|plug| plug.jack.value == jack.value) {
                    Some(last) => {
                        // All cords of a jack have the span of its key.
                        let jack = entry.plugs[last].jack.clone();
                        entry.plugs.insert(last + 1, Plug { jack, from });
                        true
                    }
                    None => {
                        let is_last_key =
                            has_gains && !entry.plugs.is_empty() && entry.empty_jacks.is_empty();
                        entry.plugs.push(Plug { jack, from });
                        is_last_key
                    }
                };
                (keys, is_in_order)
            }
            SectionEntry::Instance(instance) => {
                let keys = vec![jack.value.clone()];
                let cords = instance.cords.get_mut(&jack.value);
                let is_known = cords.is_some();
                if let Some(cords) = cords {
                    cords.value.push(from);
                }
                (keys, is_known)
            }
        }
    }

    /// Replaces the name `from` by `to` in all cords. Returns the keys of the entry whose values contain cords.
    ///
    /// Changed cords get new spans, which begin at `next_span` beyond the text.
    pub(in crate::patch) fn replug(&mut self, from: &str, to: &str, next_span: &mut usize) -> Vec<String> {
        let mut replug = |cord: &mut Placed<String>| {
            if cord.value == from {
                *cord = Placed { value: to.to_owned(), span: Span::beyond_text(next_span) };
            }
        };
        match self {
            SectionEntry::Element(entry) => {
                entry.plugs.iter_mut().for_each(|plug| replug(&mut plug.from));
                match entry.kind.has_gains() {
                    true => vec!["in".to_owned()],
                    false => entry.kind.inputs.iter().map(|input| input.name.to_owned()).collect(),
                }
            }
            SectionEntry::Instance(instance) => {
                instance.cords.values_mut().flat_map(|cords| &mut cords.value).for_each(replug);
                instance.cords.keys().cloned().collect()
            }
        }
    }

    /// Removes all cords and empty jacks.
    pub(in crate::patch) fn clear_cords(&mut self) {
        match self {
            SectionEntry::Element(entry) => {
                entry.plugs.clear();
                entry.empty_jacks.clear();
            }
            SectionEntry::Instance(instance) => instance.cords.clear(),
        }
    }

    /// Whether the kind of the element, or the macro of the instance, has a setting with this name.
    pub(in crate::patch) fn has_setting(&self, setting: &str, macros: &IndexMap<String, Macro>) -> bool {
        match self {
            SectionEntry::Element(entry) => entry.kind.setting(setting).is_some(),
            SectionEntry::Instance(instance) => {
                let definition = macros.get(&instance.macro_name.value);
                definition.is_some_and(|definition| definition.settings.contains_key(setting))
            }
        }
    }
}
