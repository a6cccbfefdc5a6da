//! The content of a drawing.
//!
//! A drawing shows every element of a circuit, or macro instances as boxes, or the inside of one
//! instance. A view lists the items of the drawing in order and finds the source of each cord among
//! them.

use std::collections::HashMap;

use super::symbol::CordSource;
use patchcord_core::circuit::{Circuit, Cord};
use patchcord_core::elements::{Family, Jacks};
use patchcord_core::patch::{Instance, InstanceInput};

/// The part of a circuit that a drawing shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ViewScope<'a> {
    /// All elements, including those inside instances.
    Elements,
    /// The outermost elements, with instances as boxes.
    Boxes,
    /// The inside of the named instance with its ports; instances inside it are boxes.
    Inside(&'a str),
}

/// An item that is drawn as one symbol.
#[derive(Debug, Clone, Copy)]
pub(super) enum ViewItem<'a> {
    /// An element or a drive: its index in the circuit.
    Element(usize),
    /// An instance of a macro, with its name.
    Instance(&'a str, &'a Instance),
    /// An input port of the opened instance.
    InputPort(&'a str),
    /// An output port of the opened instance: its name and the element that drives it.
    OutputPort(&'a str, &'a str),
}

/// The items of a drawing.
pub(super) struct View<'a> {
    /// The circuit that is drawn.
    pub circuit: &'a Circuit,
    /// The items: input ports first, output ports last.
    pub items: Vec<ViewItem<'a>>,
    /// For each element, the index of its item; `None` if the drawing does not show it.
    item_of: Vec<Option<usize>>,
    /// The index of each element by name.
    index_of: HashMap<&'a str, usize>,
    /// The opened instance; `None` if the drawing shows the whole circuit.
    enclosing: Option<&'a Instance>,
    /// The prefix of names inside the opened instance, such as `spool.`; may be empty.
    pub prefix: String,
}

impl<'a> View<'a> {
    /// Lists the items of a drawing.
    ///
    /// The order is that of the document, with the input ports before and the output ports after the elements.
    /// An instance that is a box takes the place of its first element.
    pub(super) fn new(circuit: &'a Circuit, scope: ViewScope<'a>) -> View<'a> {
        let elements = circuit.elements();
        let (enclosing, prefix) = match scope {
            ViewScope::Inside(name) => (circuit.patch().instances.get(name), format!("{name}.")),
            ViewScope::Elements | ViewScope::Boxes => (None, String::new()),
        };
        let names = elements.iter().enumerate().map(|(index, element)| (element.name.as_str(), index));
        let mut view = View {
            circuit,
            items: enclosing
                .into_iter()
                .flat_map(|enclosing| enclosing.inputs.keys())
                .map(|name| ViewItem::InputPort(name))
                .collect(),
            item_of: vec![None; elements.len()],
            index_of: names.collect(),
            enclosing,
            prefix,
        };
        view.add_elements(scope);
        let outputs = enclosing.into_iter().flat_map(|enclosing| &enclosing.outputs);
        view.items.extend(outputs.map(|(port, element)| ViewItem::OutputPort(port, element)));
        view
    }

    /// Adds an item for each element or for the instance that contains it.
    fn add_elements(&mut self, scope: ViewScope<'a>) {
        let boxes = boxes(self.circuit, scope);
        let mut added: HashMap<&str, usize> = HashMap::new();
        for (index, element) in self.circuit.elements().into_iter().enumerate() {
            let is_inside = self.enclosing.is_none() || element.name.starts_with(&self.prefix);
            if element.kind.family == Family::Reference || !is_inside {
                continue;
            }
            let next = self.items.len();
            let (key, item) = match boxes.get(element.name.as_str()) {
                Some((name, instance)) => (*name, ViewItem::Instance(name, instance)),
                None => (element.name.as_str(), ViewItem::Element(index)),
            };
            let item_index = *added.entry(key).or_insert(next);
            if item_index == next {
                self.items.push(item);
            }
            self.item_of[index] = Some(item_index);
        }
    }

    /// Returns a name without the prefix of the opened instance.
    pub(super) fn local<'n>(&self, name: &'n str) -> &'n str {
        name.strip_prefix(self.prefix.as_str()).unwrap_or(name)
    }

    /// Returns the cords into an element with their sources, in the order of the inputs.
    pub(super) fn cords(&self, element: usize) -> Vec<(Cord, CordSource)> {
        let name = &self.circuit.element(element).name;
        let mut cords = self.circuit.cords(element);
        cords.sort_by_key(|(_, cord)| cord.input);
        let ports = self.enclosing.into_iter().flat_map(|enclosing| enclosing.inputs.values().enumerate());
        let mut driven: Vec<(usize, &InstanceInput, &str)> = ports
            .flat_map(|(port, input)| input.driven_jacks.iter().map(move |jack| (port, input, jack)))
            .filter(|(.., jack)| jack.element == *name)
            .map(|(port, input, jack)| (port, input, jack.jack.as_str()))
            .collect();
        let source = |(from, cord): (usize, Cord)| {
            let driver = &self.circuit.element(from).name;
            let jack = self.jack_name(element, cord);
            let is_driven =
                |(_, input, key): &(usize, &InstanceInput, &str)| drives(input, driver) && *key == jack;
            let index = driven.iter().position(is_driven);
            let port = index.map(|index| CordSource::Output(driven.swap_remove(index).0, 0));
            Some((cord, port.or_else(|| self.source(from))?))
        };
        cords.into_iter().filter_map(source).collect()
    }

    /// Returns the key of a jack in the patch file, such as `x10`.
    fn jack_name(&self, element: usize, cord: Cord) -> String {
        let input = &self.circuit.element(element).kind.inputs[cord.input];
        match input.jacks {
            Jacks::Gains => format!("{}{}", input.name, cord.gain),
            _ => input.name.to_owned(),
        }
    }

    /// Returns the sources of the input ports of an instance in order; ports without a cord are omitted.
    pub(super) fn port_sources(&self, instance: &'a Instance) -> impl Iterator<Item = (&'a str, CordSource)> {
        instance.inputs.iter().filter_map(|(port, input)| Some((port.as_str(), self.port_source(input)?)))
    }

    /// Returns the source of an input port of an instance: a port of the opened instance or an output.
    fn port_source(&self, input: &InstanceInput) -> Option<CordSource> {
        let outer = self.enclosing.zip(input.outer_port.as_ref());
        match outer.and_then(|(enclosing, port)| enclosing.inputs.get_index_of(port)) {
            Some(port) => Some(CordSource::Output(port, 0)),
            None => self.source_named(input.driver.as_ref()?),
        }
    }

    /// Returns the source that an element is in this drawing; `None` if it is unknown.
    pub(super) fn source_named(&self, element: &str) -> Option<CordSource> {
        self.source(*self.index_of.get(element)?)
    }

    /// Returns the source for the output of an element in this drawing.
    ///
    /// `None` if the element is inside a box and is not one of its outputs.
    fn source(&self, element: usize) -> Option<CordSource> {
        let from = self.circuit.element(element);
        if let Some(item) = self.item_of[element] {
            let output = match self.items[item] {
                ViewItem::Instance(_, instance) => {
                    instance.outputs.values().position(|at| *at == from.name)?
                }
                _ => 0,
            };
            return Some(CordSource::Output(item, output));
        }
        let mut ports = self.enclosing.into_iter().flat_map(|enclosing| enclosing.inputs.values());
        match ports.position(|input| drives(input, &from.name)) {
            Some(port) => Some(CordSource::Output(port, 0)),
            None => Some(CordSource::Reference(reference(&from.name))),
        }
    }
}

/// Whether an element drives an input port of an instance from outside.
fn drives(input: &InstanceInput, driver: &str) -> bool {
    input.driver.as_deref() == Some(driver)
}

/// Returns the instance that contains each element in a box.
fn boxes<'a>(circuit: &'a Circuit, scope: ViewScope<'a>) -> HashMap<&'a str, (&'a str, &'a Instance)> {
    let enclosing = match scope {
        ViewScope::Elements => return HashMap::new(),
        ViewScope::Boxes => None,
        ViewScope::Inside(name) => Some(name),
    };
    let instances = circuit.patch().instances.iter();
    let drawn = instances.filter(|(_, instance)| instance.parent.as_deref() == enclosing);
    drawn
        .flat_map(|(name, instance)| {
            instance.members.iter().map(move |member| (member.as_str(), (name.as_str(), instance)))
        })
        .collect()
}

/// Returns the name of a reference in the table of references.
fn reference(name: &str) -> &'static str {
    let known = patchcord_core::elements::REFERENCES.iter().find(|(known, _)| *known == name);
    known.map_or("ground", |(known, _)| known)
}
