//! Removes parts from the tree of a document. `cut` then cuts the same parts out of the text.
//!
//! A list or an object that has lost its last part is removed where it would be a fault: a jack without cords, a group
//! without settings, a picture without signals. Sections such as "elements" stay, also if they are empty.
//!
//! `references` removes everything that names an output which is removed.

mod equations;
mod references;

use std::collections::{HashMap, HashSet};

use crate::document::tree::{Content, KeyValue, Node};
use crate::elements::{Family, find};

/// What is removed from a document.
#[derive(Debug, Clone)]
pub(super) enum Removal {
    /// One cord. If the jack has it twice, only the first one is removed.
    Cord {
        /// Name of the element or the macro instance.
        element: String,
        /// Name of the jack or the port.
        jack: String,
        /// Name of the output that is plugged in.
        from: String,
    },
    /// All cords of the section "elements".
    AllCords,
    /// A key, and every object around it that becomes empty.
    Key {
        /// The keys from the root of the document.
        path: Vec<String>,
    },
    /// An element, an instance or a drive, and everything that names its outputs.
    Entry {
        /// The section: "elements" or "drives".
        section: &'static str,
        /// Name of the element, the instance or the drive.
        name: String,
    },
}

impl Removal {
    /// A copy of the tree of a document without what is removed.
    pub(super) fn pruned(&self, root: &Node) -> Node {
        let mut pruned = root.clone();
        match self {
            Removal::Cord { element, jack, from } => {
                let entries = entries_mut(&mut pruned, "elements");
                if let Some(entry) = entries.iter_mut().find(|entry| entry.key == *element) {
                    remove_cord(&mut entry.value, jack, from);
                }
            }
            Removal::AllCords => {
                let ports = ports_of_macros(&pruned);
                for entry in entries_mut(&mut pruned, "elements") {
                    retain_jacks(&mut entry.value, &ports, &mut |_| false);
                }
            }
            Removal::Key { path } => {
                remove_key(&mut pruned, path);
            }
            Removal::Entry { section, name } => references::remove_entry(&mut pruned, section, name),
        }
        pruned
    }
}

/// Removes the first cord from an output into a jack of an entry. The jacks of an amplifier are in the object "in".
fn remove_cord(entry: &mut Node, jack: &str, from: &str) {
    let mut is_removed = false;
    let mut keeps = |name: &str| {
        let is_kept = is_removed || name != from;
        is_removed |= !is_kept;
        is_kept
    };
    let Content::Object(keys) = &mut entry.value else { return };
    retain(keys, |key| match &mut key.value.value {
        Content::Object(jacks) => {
            retain(jacks, |inner| inner.key != jack || retain_names(&mut inner.value, &mut keeps))
        }
        _ => key.key != jack || retain_names(&mut key.value, &mut keeps),
    });
}

/// Removes the key at a path. Returns whether the object stays: it is not empty, or was empty before.
fn remove_key(object: &mut Node, path: &[String]) -> bool {
    let (Some((key, rest)), Content::Object(entries)) = (path.split_first(), &mut object.value) else {
        return true;
    };
    retain(entries, |entry| entry.key != *key || (!rest.is_empty() && remove_key(&mut entry.value, rest)))
}

/// Keeps some of the parts of an object or a list. Returns whether it stays: it is not empty, or was empty before.
fn retain<T>(parts: &mut Vec<T>, keeps: impl FnMut(&mut T) -> bool) -> bool {
    let was_empty = parts.is_empty();
    parts.retain_mut(keeps);
    was_empty || !parts.is_empty()
}

/// Keeps some of the names in a value: a name, a list of names, or an object of both. Returns whether the value stays.
fn retain_names(value: &mut Node, keeps: &mut dyn FnMut(&str) -> bool) -> bool {
    match &mut value.value {
        Content::Text(name) => keeps(name),
        Content::List(items) => retain(items, |item| retain_names(item, keeps)),
        Content::Object(entries) => retain(entries, |entry| retain_names(&mut entry.value, keeps)),
        _ => true,
    }
}

/// The input ports of the macros of a document, by the name of the macro.
type Ports = HashMap<String, Vec<String>>;

/// The input ports of the macros of a document.
fn ports_of_macros(root: &Node) -> Ports {
    let ports =
        |definition: &KeyValue| names(&definition.value, "inputs").map(str::to_owned).collect::<Vec<_>>();
    entries(root, "macros").iter().map(|definition| (definition.key.clone(), ports(definition))).collect()
}

/// Keeps some of the cords of an element or an instance. A jack that loses all its cords is removed.
fn retain_jacks(entry: &mut Node, ports: &Ports, keeps: &mut dyn FnMut(&str) -> bool) {
    let jacks = jack_keys(entry, ports);
    if let Content::Object(keys) = &mut entry.value {
        retain(keys, |key| !jacks.contains(&key.key.as_str()) || retain_names(&mut key.value, keeps));
    }
}

/// The keys of an element or an instance whose values contain cords. There are none if its kind is not known.
fn jack_keys<'p>(entry: &Node, ports: &'p Ports) -> Vec<&'p str> {
    let Some(kind) = text(entry, "kind") else { return Vec::new() };
    match find(Family::Computing, kind) {
        Some(kind) if kind.has_gains() => vec!["in"],
        Some(kind) => kind.inputs.iter().map(|input| input.name).collect(),
        None => ports.get(kind).into_iter().flatten().map(String::as_str).collect(),
    }
}

/// The text under a key of an object. `None` if there is no such text.
fn text<'n>(object: &'n Node, key: &str) -> Option<&'n str> {
    match &object.child(key)?.value {
        Content::Text(text) => Some(text),
        _ => None,
    }
}

/// The entries of a section. There are none if the section is absent or is not an object.
fn entries<'n>(object: &'n Node, section: &str) -> &'n [KeyValue] {
    match object.child(section).map(|node| &node.value) {
        Some(Content::Object(entries)) => entries,
        _ => &[],
    }
}

/// The names in a section.
fn names<'n>(object: &'n Node, section: &str) -> impl Iterator<Item = &'n str> + use<'n> {
    entries(object, section).iter().map(|entry| entry.key.as_str())
}

/// The names in several sections.
fn name_set(object: &Node, sections: &[&str]) -> HashSet<String> {
    sections.iter().flat_map(|section| names(object, section)).map(str::to_owned).collect()
}

/// The entries of a section, which can be changed but not removed.
fn entries_mut<'n>(object: &'n mut Node, section: &str) -> &'n mut [KeyValue] {
    match section_mut(object, section) {
        Some(entries) => entries,
        None => &mut [],
    }
}

/// The entries of a section. `None` if the section is absent or is not an object.
fn section_mut<'n>(object: &'n mut Node, section: &str) -> Option<&'n mut Vec<KeyValue>> {
    let Content::Object(sections) = &mut object.value else { return None };
    let section = sections.iter_mut().find(|entry| entry.key == section)?;
    match &mut section.value.value {
        Content::Object(entries) => Some(entries),
        _ => None,
    }
}
