//! What stands on a drawing: every element, instances of macros as boxes, or what is inside of one instance.

use std::collections::HashMap;

use super::symbol::Source;
use patchcord_core::circuit::{Circuit, Cord};
use patchcord_core::elements::{Family, Jacks};
use patchcord_core::patch::{Inlet, Instance};

/// How much is opened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Show<'a> {
    /// Elements only, those of instances too.
    Elements,
    /// Outermost instances as boxes.
    Boxes,
    /// What is inside of an instance, with its ports; instances inside it as boxes.
    Inside(&'a str),
}

/// What is drawn as one symbol.
#[derive(Debug, Clone, Copy)]
pub(super) enum Item<'a> {
    /// An element or a drive, by its index in the circuit.
    Element(usize),
    /// An instance, by its name.
    Instance(&'a str, &'a Instance),
    /// An input port of the opened instance.
    Inlet(&'a str),
    /// An output port of the opened instance, and the element that it is.
    Outlet(&'a str, &'a str),
}

/// The items of a drawing, and which of them stands for an element.
pub(super) struct View<'a> {
    pub circuit: &'a Circuit,
    /// Input ports first, output ports last.
    pub items: Vec<Item<'a>>,
    /// For every element, its item.
    item_of: Vec<Option<usize>>,
    index_of: HashMap<&'a str, usize>,
    /// The instance that is opened.
    around: Option<&'a Instance>,
    /// What names inside the opened instance begin with.
    pub prefix: String,
}

impl<'a> View<'a> {
    pub fn new(circuit: &'a Circuit, show: Show<'a>) -> View<'a> {
        let elements = circuit.elements();
        let (around, prefix) = match show {
            Show::Inside(name) => (circuit.patch().instances.get(name), format!("{name}.")),
            Show::Elements | Show::Boxes => (None, String::new()),
        };
        let names = elements.iter().enumerate().map(|(index, element)| (element.name.as_str(), index));
        let mut view = View {
            circuit,
            items: around
                .into_iter()
                .flat_map(|around| around.inputs.keys())
                .map(|name| Item::Inlet(name))
                .collect(),
            item_of: vec![None; elements.len()],
            index_of: names.collect(),
            around,
            prefix,
        };
        view.place_elements(show);
        let outlets = around.into_iter().flat_map(|around| &around.outputs);
        view.items.extend(outlets.map(|(port, element)| Item::Outlet(port, element)));
        view
    }

    fn place_elements(&mut self, show: Show<'a>) {
        let boxes = boxes(self.circuit, show);
        let mut placed: HashMap<&str, usize> = HashMap::new();
        for (index, element) in self.circuit.elements().into_iter().enumerate() {
            let is_inside = self.around.is_none() || element.name.starts_with(&self.prefix);
            if element.kind.family == Family::Reference || !is_inside {
                continue;
            }
            let next = self.items.len();
            let (key, item) = match boxes.get(element.name.as_str()) {
                Some((name, instance)) => (*name, Item::Instance(name, instance)),
                None => (element.name.as_str(), Item::Element(index)),
            };
            let item_index = *placed.entry(key).or_insert(next);
            if item_index == next {
                self.items.push(item);
            }
            self.item_of[index] = Some(item_index);
        }
    }

    /// A name as it is called where it is drawn.
    pub fn local<'n>(&self, name: &'n str) -> &'n str {
        name.strip_prefix(self.prefix.as_str()).unwrap_or(name)
    }

    /// What is plugged into an element: the cord, and where it comes from.
    pub fn cords(&self, element: usize) -> Vec<(Cord, Source)> {
        let name = &self.circuit.element(element).name;
        let mut cords = self.circuit.cords(element);
        cords.sort_by_key(|(_, cord)| cord.input);
        let inlets = self.around.into_iter().flat_map(|around| around.inputs.values().enumerate());
        let mut fed: Vec<(usize, &Inlet, &str)> = inlets
            .flat_map(|(port, inlet)| inlet.feeds.iter().map(move |feed| (port, inlet, feed)))
            .filter(|(.., feed)| feed.element == *name)
            .map(|(port, inlet, feed)| (port, inlet, feed.jack.as_str()))
            .collect();
        let source = |(from, cord): (usize, Cord)| {
            let driver = &self.circuit.element(from).name;
            let jack = self.jack_name(element, cord);
            let is_fed = |(_, inlet, fed): &(usize, &Inlet, &str)| drives(inlet, driver) && *fed == jack;
            let port = fed.iter().position(is_fed).map(|at| Source::Output(fed.swap_remove(at).0, 0));
            Some((cord, port.or_else(|| self.source(from))?))
        };
        cords.into_iter().filter_map(source).collect()
    }

    /// The key of a jack in the document.
    fn jack_name(&self, element: usize, cord: Cord) -> String {
        let input = &self.circuit.element(element).kind.inputs[cord.input];
        match input.jacks {
            Jacks::Gains => format!("{}{}", input.name, cord.gain),
            _ => input.name.to_owned(),
        }
    }

    /// What is plugged into the input ports of an instance, port by port.
    pub fn plugged(&self, instance: &'a Instance) -> impl Iterator<Item = (&'a str, Source)> {
        instance.inputs.iter().filter_map(|(port, inlet)| Some((port.as_str(), self.port_source(inlet)?)))
    }

    /// Where a port of an instance is fed from: a port of the opened one, or an output.
    fn port_source(&self, inlet: &Inlet) -> Option<Source> {
        let outer = self.around.zip(inlet.port.as_ref());
        match outer.and_then(|(around, port)| around.inputs.get_index_of(port)) {
            Some(port) => Some(Source::Output(port, 0)),
            None => self.source_named(inlet.driver.as_ref()?),
        }
    }

    /// Where the cord of an output port of the opened instance comes from.
    pub fn source_named(&self, element: &str) -> Option<Source> {
        self.source(*self.index_of.get(element)?)
    }

    /// Where the cords of an element come from in this drawing.
    fn source(&self, element: usize) -> Option<Source> {
        let from = self.circuit.element(element);
        if let Some(item) = self.item_of[element] {
            let outlet = match self.items[item] {
                Item::Instance(_, instance) => instance.outputs.values().position(|at| *at == from.name)?,
                _ => 0,
            };
            return Some(Source::Output(item, outlet));
        }
        let mut ports = self.around.into_iter().flat_map(|around| around.inputs.values());
        match ports.position(|inlet| drives(inlet, &from.name)) {
            Some(port) => Some(Source::Output(port, 0)),
            None => Some(Source::Reference(reference(&from.name))),
        }
    }
}

fn drives(inlet: &Inlet, driver: &str) -> bool {
    inlet.driver.as_deref() == Some(driver)
}

/// For every element in a box its box.
fn boxes<'a>(circuit: &'a Circuit, show: Show<'a>) -> HashMap<&'a str, (&'a str, &'a Instance)> {
    let around = match show {
        Show::Elements => return HashMap::new(),
        Show::Boxes => None,
        Show::Inside(name) => Some(name),
    };
    let instances = circuit.patch().instances.iter();
    let drawn = instances.filter(|(_, instance)| instance.around.as_deref() == around);
    drawn
        .flat_map(|(name, instance)| {
            instance.members.iter().map(move |member| (member.as_str(), (name.as_str(), instance)))
        })
        .collect()
}

/// The name of a reference as the machine has it.
fn reference(name: &str) -> &'static str {
    let known = patchcord_core::elements::REFERENCES.iter().find(|(known, _)| *known == name);
    known.map_or("ground", |(known, _)| known)
}
