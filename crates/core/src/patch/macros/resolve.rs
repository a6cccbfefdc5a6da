//! Resolves the names that cords use, before macros are expanded.
//!
//! The same name can mean different outputs in different sections. Inside a macro it can be an input port of the macro.
//! In any section it can be an element, an instance (its first output), a port of an instance ("L1.out"), a drive or a
//! reference. [`SectionScope::resolve`] finds the meaning. This module also finds macros that contain themselves or
//! that are nested too deep, because their expansion would not end or would be too large.

use std::collections::{BTreeSet, HashSet};

use indexmap::IndexMap;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::{InstanceEntry, Macro, Macros, SectionEntry};
use crate::document::fields::Findings;
use crate::document::{Code, Diagnostic, MAX_SUGGESTIONS, Placed, suggestion};
use crate::patch::cord_faults::fixed_voltage_hint;
use crate::patch::document::{ElementEntry, instance_prefixes};
use crate::patch::names::is_reference;

/// Largest depth to which macros may be nested. A macro without instances inside it has depth 1. Resolving a name
/// recurses once per level, so the limit also bounds the stack.
const MAX_NESTING_DEPTH: usize = 20;

/// A section of elements, with everything that its cords can name.
#[derive(Clone, Copy)]
pub(super) struct SectionScope<'m> {
    /// The elements and instances of the section.
    pub entries: &'m IndexMap<String, SectionEntry>,
    /// The name and the definition of the macro to which the section belongs. `None` for the section of the patch.
    pub owner: Option<(&'m str, &'m Macro)>,
    /// Names in the section whose entries could not be read.
    pub unread: &'m HashSet<String>,
    /// All macros of the patch.
    pub macros: &'m Macros,
    /// The drives of the patch, which every section can use.
    pub drives: &'m IndexMap<String, ElementEntry>,
}

/// The origin of a cord: the meaning of its name in a section.
pub(super) enum CordOrigin<'m> {
    /// The output of an element. The field is its name relative to the section: "A1", or "L1.A1" inside an instance.
    Element(String),
    /// A drive or a reference.
    DriveOrReference,
    /// An input port of the macro to which the section belongs.
    MacroInput,
    /// A port or an element of an instance that is not among the outputs of its macro.
    NotAnOutput(MissingOutput<'m>),
    /// A name whose entry could not be read. The fault has been reported.
    Unread,
    /// No object has this name.
    Unknown,
}

/// An instance and a name that is not among the outputs of its macro.
pub(super) struct MissingOutput<'m> {
    /// Name of the instance.
    instance: &'m str,
    /// Name of the macro.
    macro_name: &'m str,
    definition: &'m Macro,
    /// The name that was looked for among the outputs.
    port: String,
}

impl MissingOutput<'_> {
    /// The diagnostic for a cord from this name. If it is an element inside the macro, the hint recommends an output.
    pub(super) fn diagnostic(&self, cord: &Placed<String>) -> Diagnostic {
        let MissingOutput { instance, macro_name, definition, port } = self;
        let message = format!("{instance} (macro {macro_name}) has no output \"{port}\"");
        let outputs: Vec<&str> = definition.outputs.keys().map(String::as_str).collect();
        let hint = match definition.entries.contains_key(port) {
            true => Some(format!("{port} is inside the macro: add it to the outputs of the macro")),
            false => suggestion(port, &outputs),
        };
        Diagnostic::at(Code::UNKNOWN_NAME, cord.span, message).maybe_hint(hint)
    }
}

impl<'m> SectionScope<'m> {
    /// Resolves the name of a cord in this section.
    ///
    /// Input ports of the macro come first, then entries of the section, then drives and references, then ports of
    /// instances.
    pub(super) fn resolve(&self, name: &str) -> CordOrigin<'m> {
        if self.owner.is_some_and(|(_, owner)| owner.inputs.contains_key(name)) {
            return CordOrigin::MacroInput;
        }
        match self.entries.get_key_value(name) {
            Some((_, SectionEntry::Element(_))) => return CordOrigin::Element(name.to_owned()),
            Some((name, SectionEntry::Instance(instance))) => {
                return self.resolve_output(name, instance, None);
            }
            None => {}
        }
        if self.drives.contains_key(name) || is_reference(name) {
            return CordOrigin::DriveOrReference;
        }
        self.resolve_port(name)
    }

    /// Resolves a name of the form "instance.port". Both parts may contain dots, so each dot is tried as the separator.
    fn resolve_port(&self, name: &str) -> CordOrigin<'m> {
        let mut first_missing = None;
        for prefix in instance_prefixes(name) {
            let port = &name[prefix.len() + 1..];
            match self.entries.get_key_value(prefix) {
                Some((instance_name, SectionEntry::Instance(instance))) => {
                    match self.resolve_output(instance_name, instance, Some(port)) {
                        missing @ CordOrigin::NotAnOutput(_) => drop(first_missing.get_or_insert(missing)),
                        origin => return origin,
                    }
                }
                _ if self.unread.contains(prefix) => return CordOrigin::Unread,
                _ => {}
            }
        }
        let is_unread = self.unread.contains(name);
        first_missing.unwrap_or(if is_unread { CordOrigin::Unread } else { CordOrigin::Unknown })
    }

    /// Resolves an output of an instance: the port with this name, or the first port if `port` is `None`.
    fn resolve_output(
        &self,
        instance_name: &'m str,
        instance: &'m InstanceEntry,
        port: Option<&str>,
    ) -> CordOrigin<'m> {
        let Some((macro_name, definition)) = self.macros.usable(&instance.macro_name.value) else {
            return CordOrigin::Unread;
        };
        let output = match port {
            Some(port) => definition.outputs.get(port),
            None => definition.outputs.values().next(),
        };
        let port = port.unwrap_or_default().to_owned();
        match output {
            None if port.is_empty() => CordOrigin::Unread,
            None => {
                let instance = instance_name;
                CordOrigin::NotAnOutput(MissingOutput { instance, macro_name, definition, port })
            }
            Some(output) => {
                let inner_scope = || self.macro_scope(macro_name, definition);
                let origin = output.element.as_ref().map(|element| inner_scope().resolve(&element.value));
                match origin {
                    Some(CordOrigin::Element(element)) => {
                        CordOrigin::Element(format!("{instance_name}.{element}"))
                    }
                    _ => CordOrigin::Unread,
                }
            }
        }
    }

    /// The section of a macro.
    pub(super) fn macro_scope(&self, name: &'m str, definition: &'m Macro) -> SectionScope<'m> {
        SectionScope {
            entries: &definition.entries,
            owner: Some((name, definition)),
            unread: &definition.unread,
            ..*self
        }
    }

    /// The diagnostic for a cord from an unknown name.
    ///
    /// `reader` is the element that the cord drives, and `searched` names the section: "the patch" or "the macro X".
    /// `finding_count` is the number of findings so far: if there are many, no suggestion is made.
    pub(super) fn unknown_source(
        &self,
        reader: &str,
        cord: &Placed<String>,
        searched: &str,
        finding_count: usize,
    ) -> Diagnostic {
        let is_suggesting = finding_count < MAX_SUGGESTIONS;
        let message = format!("{reader} is driven by {}, which is not in {searched}", cord.value);
        let hint = is_suggesting.then(|| self.source_hint(&cord.value)).flatten();
        Diagnostic::at(Code::UNKNOWN_NAME, cord.span, message).maybe_hint(hint)
    }

    /// The hint for a cord from an unknown name.
    fn source_hint(&self, name: &str) -> Option<String> {
        let known = self.source_names();
        fixed_voltage_hint(name, known.iter().copied()).or_else(|| suggestion(name, &known))
    }

    /// The names that cords in this section can use, without ports of instances and references.
    pub(super) fn source_names(&self) -> Vec<&'m str> {
        let inputs = self.owner.into_iter().flat_map(|(_, owner)| owner.inputs.keys());
        inputs.chain(self.entries.keys()).chain(self.drives.keys()).map(String::as_str).collect()
    }
}

impl Macros {
    /// The name and the definition of a macro. `None` if it does not exist or cannot be expanded.
    pub(crate) fn usable(&self, name: &str) -> Option<(&str, &Macro)> {
        let (name, definition) = self.defined.get_key_value(name)?;
        (!self.unusable.contains(name)).then_some((name.as_str(), definition))
    }

    /// Reports macros that contain themselves and macros that are nested too deep, and marks them as unusable.
    ///
    /// The depth of a macro is 1 plus the largest depth of the macros inside it. An unusable macro counts as depth 0,
    /// so that a fault is reported once.
    pub(crate) fn mark_unusable(&mut self, findings: &mut Findings) {
        let nesting = self.nesting_graph();
        let mut depths = vec![0; self.defined.len()];
        // The components are sorted so that a macro follows the macros inside it.
        for mut members in kosaraju_scc(&nesting) {
            members.sort_unstable();
            let first = members[0];
            let finding = if members.len() > 1 || nesting.contains_edge(first, first) {
                Some(self.cycle(&members))
            } else {
                let inner_depths = nesting.neighbors(first).map(|inner| depths[inner.index()]);
                depths[first.index()] = 1 + inner_depths.max().unwrap_or(0);
                (depths[first.index()] > MAX_NESTING_DEPTH).then(|| self.too_deep(first))
            };
            if let Some(finding) = finding {
                findings.push(finding);
                members.iter().for_each(|member| depths[member.index()] = 0);
                let names: Vec<_> = members.iter().map(|member| self.name(*member).to_owned()).collect();
                self.unusable.extend(names);
            }
        }
    }

    /// The graph of macros, with an edge from each macro to every macro of which it contains an instance.
    fn nesting_graph(&self) -> DiGraph<(), ()> {
        let mut nesting = DiGraph::new();
        for _ in &self.defined {
            nesting.add_node(());
        }
        for (outer, definition) in self.defined.values().enumerate() {
            let inner_macros: BTreeSet<usize> = definition
                .instances()
                .filter_map(|instance| self.defined.get_index_of(&instance.macro_name.value))
                .collect();
            for inner in inner_macros {
                nesting.add_edge(NodeIndex::new(outer), NodeIndex::new(inner), ());
            }
        }
        nesting
    }

    /// The name of a macro in the graph.
    fn name(&self, index: NodeIndex) -> &str {
        self.defined.get_index(index.index()).map_or("", |(name, _)| name)
    }

    /// The diagnostic for macros that contain each other, at the first of them.
    fn cycle(&self, members: &[NodeIndex]) -> Diagnostic {
        let names: Vec<_> = members.iter().map(|index| self.name(*index)).collect();
        let message = match names.as_slice() {
            [only] => format!("the macro {only} contains itself"),
            names => format!("the macros {} contain each other", names.join(", ")),
        };
        Diagnostic::at(Code::MACRO_RING, self.defined[members[0].index()].span, message)
            .hint("remove an instance from one of them")
    }

    /// The diagnostic for a macro that is nested too deep.
    fn too_deep(&self, index: NodeIndex) -> Diagnostic {
        let message =
            format!("the macro {} contains macros more than {MAX_NESTING_DEPTH} deep", self.name(index));
        Diagnostic::at(Code::MACRO_TOO_LARGE, self.defined[index.index()].span, message)
            .hint("replace some of the instances by their elements")
    }
}

impl Macro {
    /// The instances inside the macro.
    pub(super) fn instances(&self) -> impl Iterator<Item = &InstanceEntry> {
        self.entries.values().filter_map(|entry| match entry {
            SectionEntry::Instance(instance) => Some(instance),
            SectionEntry::Element(_) => None,
        })
    }
}
