//! Edits of elements, instances and macros of a patch that was read.

use super::{Item, Macros};
use crate::document::{Placed, Span};
use crate::elements::{Jacks, Kind};
use crate::patch::document::{Patch, Plug};

impl Macros {
    /// The macros of a patch without errors, taken out of it. [`Macros::give_back`] and `write_out` put them back.
    pub(in crate::patch) fn take_from(patch: &mut Patch) -> Macros {
        Macros { defined: std::mem::take(&mut patch.macros), span: patch.macros_at, ..Macros::default() }
    }

    /// Puts macros back into the patch that they were taken from.
    pub(in crate::patch) fn give_back(self, patch: &mut Patch) {
        patch.macros = self.defined;
    }
}

impl Item {
    /// Whether it is an instance of a macro.
    pub(in crate::patch) fn is_instance(&self) -> bool {
        matches!(self, Item::Use(_))
    }

    /// Its cords as the document has them: the jack or port, and the name that is plugged in there.
    pub(in crate::patch) fn written_cords(&self) -> Vec<(&str, &str)> {
        match self {
            Item::Element(entry) => {
                let plugs = entry.plugs.iter();
                plugs.map(|plug| (plug.jack.value.as_str(), plug.from.value.as_str())).collect()
            }
            Item::Use(made) => {
                let ports = made.cords.iter();
                let each = ports.flat_map(|(port, cords)| {
                    cords.value.iter().map(move |from| (port.as_str(), from.value.as_str()))
                });
                each.collect()
            }
        }
    }

    /// Adds a cord behind those of its jack. Returns the keys that lead from the element to the jack in the document, and
    /// whether the cords are now in the order in which a reader of the document finds them.
    pub(in crate::patch) fn add_cord(
        &mut self,
        jack: Placed<String>,
        from: Placed<String>,
    ) -> (Vec<String>, bool) {
        match self {
            Item::Element(entry) => {
                let has_gains = has_gains(entry.kind);
                let before = has_gains.then(|| "in".to_owned());
                let keys = before.into_iter().chain([jack.value.clone()]).collect();
                let is_in_order = match entry.plugs.iter().rposition(|plug| plug.jack.value == jack.value) {
                    Some(last) => {
                        // Cords of one jack share the place of its key.
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
            Item::Use(made) => {
                let keys = vec![jack.value.clone()];
                let cords = made.cords.get_mut(&jack.value);
                let is_known = cords.is_some();
                if let Some(cords) = cords {
                    cords.value.push(from);
                }
                (keys, is_known)
            }
        }
    }

    /// Puts a name in place of another in all of its cords. Returns the keys of the element below which cords are.
    pub(in crate::patch) fn replug(&mut self, from: &str, to: &str, next_span: &mut usize) -> Vec<String> {
        let mut replug = |cord: &mut Placed<String>| {
            if cord.value == from {
                *cord = Placed { value: to.to_owned(), span: Span::beyond_text(next_span) };
            }
        };
        match self {
            Item::Element(entry) => {
                entry.plugs.iter_mut().for_each(|plug| replug(&mut plug.from));
                match has_gains(entry.kind) {
                    true => vec!["in".to_owned()],
                    false => entry.kind.inputs.iter().map(|input| input.name.to_owned()).collect(),
                }
            }
            Item::Use(made) => {
                made.cords.values_mut().flat_map(|cords| &mut cords.value).for_each(replug);
                made.cords.keys().cloned().collect()
            }
        }
    }
}

/// Whether the cords of a kind are under "in", in jacks with gains.
fn has_gains(kind: &Kind) -> bool {
    kind.inputs.first().is_some_and(|main| main.jacks == Jacks::Gains)
}
