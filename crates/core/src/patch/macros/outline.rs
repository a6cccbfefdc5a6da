//! What names mean where they stand, before anything is written out.

use std::collections::{BTreeSet, HashSet};

use indexmap::IndexMap;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::{Item, Macro, Macros, Use};
use crate::document::fields::Findings;
use crate::document::{Code, Diagnostic, Placed, suggestion};
use crate::patch::document::{Entry, beginnings};
use crate::patch::names::is_reference;

/// Instances inside instances go no deeper.
const DEEPEST: usize = 20;

/// A section of elements: that of the patch, or that of a macro.
#[derive(Clone, Copy)]
pub(super) struct Section<'m> {
    pub items: &'m IndexMap<String, Item>,
    /// The macro that it is the inside of.
    pub of: Option<(&'m str, &'m Macro)>,
    pub lost: &'m HashSet<String>,
    pub macros: &'m Macros,
    pub drives: &'m IndexMap<String, Entry>,
}

/// What a name in a cord means.
pub(super) enum Meaning<'m> {
    /// The output of an element, by its name from this section on.
    Outlet(String),
    /// A drive or a reference.
    Source,
    /// An input of the macro whose inside this is.
    Input,
    /// Something in an instance that is no output of its macro.
    Inside(Inside<'m>),
    /// Something that could not be read, which has been reported.
    Lost,
    Unknown,
}

/// Something in an instance that is no output of its macro.
pub(super) struct Inside<'m> {
    instance: &'m str,
    name: &'m str,
    of: &'m Macro,
    port: String,
}

impl Inside<'_> {
    /// Tells that a cord cannot be read there.
    pub fn told(&self, cord: &Placed<String>) -> Diagnostic {
        let Inside { instance, name, of, port } = self;
        let message = format!("{instance} (macro {name}) has no output \"{port}\"");
        let known: Vec<&str> = of.outputs.keys().map(String::as_str).collect();
        let hint = match of.items.contains_key(port) {
            true => Some(format!("{port} stands inside: name it among the outputs of the macro")),
            false => suggestion(port, &known),
        };
        Diagnostic::at(Code::UnknownName, cord.span, message).maybe_hint(hint)
    }
}

impl<'m> Section<'m> {
    /// What a cord in this section means by a name.
    pub fn meaning(&self, name: &str) -> Meaning<'m> {
        if self.of.is_some_and(|(_, own)| own.inputs.contains_key(name)) {
            return Meaning::Input;
        }
        match self.items.get_key_value(name) {
            Some((_, Item::Element(_))) => return Meaning::Outlet(name.to_owned()),
            Some((instance, Item::Use(made))) => return self.output(instance, made, None),
            None => {}
        }
        if self.drives.contains_key(name) || is_reference(name) {
            return Meaning::Source;
        }
        self.port(name)
    }

    /// What "instance.port" means.
    fn port(&self, name: &str) -> Meaning<'m> {
        let mut unclear = None;
        for instance in beginnings(name) {
            let port = &name[instance.len() + 1..];
            match self.items.get_key_value(instance) {
                Some((instance, Item::Use(made))) => match self.output(instance, made, Some(port)) {
                    inside @ Meaning::Inside(_) => drop(unclear.get_or_insert(inside)),
                    clear => return clear,
                },
                _ if self.lost.contains(instance) => return Meaning::Lost,
                _ => {}
            }
        }
        let lost = if self.lost.contains(name) { Meaning::Lost } else { Meaning::Unknown };
        unclear.unwrap_or(lost)
    }

    /// What an output of an instance means; the first where no port is named.
    fn output(&self, instance: &'m str, made: &'m Use, port: Option<&str>) -> Meaning<'m> {
        let Some((name, of)) = self.macros.usable(&made.of.value) else { return Meaning::Lost };
        let output = match port {
            Some(port) => of.outputs.get(port),
            None => of.outputs.values().next(),
        };
        let port = port.unwrap_or_default().to_owned();
        match output {
            None if port.is_empty() => Meaning::Lost,
            None => Meaning::Inside(Inside { instance, name, of, port }),
            Some(output) => {
                let at = output.at.as_ref().map(|at| self.inside(name, of).meaning(&at.value));
                match at {
                    Some(Meaning::Outlet(at)) => Meaning::Outlet(format!("{instance}.{at}")),
                    _ => Meaning::Lost,
                }
            }
        }
    }

    /// The inside of a macro.
    pub fn inside(&self, name: &'m str, of: &'m Macro) -> Section<'m> {
        Section { items: &of.items, of: Some((name, of)), lost: &of.lost, ..*self }
    }

    /// Tells that a cord comes from something that is not here; `holder` is what was searched.
    pub fn told_missing(
        &self,
        reader: &str,
        cord: &Placed<String>,
        holder: &str,
        reported: usize,
    ) -> Diagnostic {
        let guess = reported < MOST_GUESSED;
        let message = format!("{reader} is driven by {}, which is not in {holder}", cord.value);
        let hint = guess.then(|| suggestion(&cord.value, &self.known())).flatten();
        Diagnostic::at(Code::UnknownName, cord.span, message).maybe_hint(hint)
    }

    /// Names that cords in this section may say.
    pub fn known(&self) -> Vec<&'m str> {
        let inputs = self.of.into_iter().flat_map(|(_, own)| own.inputs.keys());
        inputs.chain(self.items.keys()).chain(self.drives.keys()).map(String::as_str).collect()
    }
}

/// Where this much is wrong, names are no longer held against all that are known to guess what was meant.
const MOST_GUESSED: usize = 50;

impl Macros {
    /// A macro that can be written out.
    pub fn usable(&self, name: &str) -> Option<(&str, &Macro)> {
        let (name, found) = self.defined.get_key_value(name)?;
        (!self.unusable.contains(name)).then_some((name.as_str(), found))
    }

    /// Finds macros that hold themselves and those that stand too deep inside each other.
    pub fn order(&mut self, findings: &mut Findings) {
        let holding = self.holding();
        let mut depths = vec![0; self.defined.len()];
        // A component comes after those that it holds.
        for mut members in kosaraju_scc(&holding) {
            members.sort_unstable();
            let first = members[0];
            let finding = if members.len() > 1 || holding.contains_edge(first, first) {
                Some(self.ring(&members))
            } else {
                let inside = holding.neighbors(first).map(|held| depths[held.index()]);
                depths[first.index()] = 1 + inside.max().unwrap_or(0);
                (depths[first.index()] > DEEPEST).then(|| self.too_deep(first))
            };
            if let Some(finding) = finding {
                findings.push(finding);
                members.iter().for_each(|member| depths[member.index()] = 0);
                let names: Vec<_> = members.iter().map(|member| self.name(*member).to_owned()).collect();
                self.unusable.extend(names);
            }
        }
    }

    /// Which macros hold instances of which.
    fn holding(&self) -> DiGraph<(), ()> {
        let mut holding = DiGraph::new();
        for _ in &self.defined {
            holding.add_node(());
        }
        for (index, of) in self.defined.values().enumerate() {
            let held: BTreeSet<usize> =
                of.uses().filter_map(|made| self.defined.get_index_of(&made.of.value)).collect();
            for held in held {
                holding.add_edge(NodeIndex::new(index), NodeIndex::new(held), ());
            }
        }
        holding
    }

    fn name(&self, index: NodeIndex) -> &str {
        self.defined.get_index(index.index()).map_or("", |(name, _)| name)
    }

    fn ring(&self, ring: &[NodeIndex]) -> Diagnostic {
        let names: Vec<_> = ring.iter().map(|index| self.name(*index)).collect();
        let message = match names.as_slice() {
            [only] => format!("the macro {only} holds itself"),
            names => format!("the macros {} hold each other", names.join(", ")),
        };
        Diagnostic::at(Code::MacroRing, self.defined[ring[0].index()].span, message)
            .hint("take an instance out of one of them")
    }

    fn too_deep(&self, index: NodeIndex) -> Diagnostic {
        let message = format!("the macro {} holds macros more than {DEEPEST} deep", self.name(index));
        Diagnostic::at(Code::MacroTooLarge, self.defined[index.index()].span, message)
            .hint("write some of them out where they are used")
    }
}

impl Macro {
    /// The instances that it holds.
    pub(super) fn uses(&self) -> impl Iterator<Item = &Use> {
        self.items.values().filter_map(|item| match item {
            Item::Use(made) => Some(made),
            Item::Element(_) => None,
        })
    }
}
