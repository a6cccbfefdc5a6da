//! Collects the elements of a patch: names, cords, pots and inverters.

use std::collections::{BTreeMap, BTreeSet};

use patchcord_core::document::Diagnostic;
use patchcord_core::patch::ElementBuilder;
use serde_json::Value;

use super::design::{Block, Design};
use super::elements;
use super::flow::signal_flow;
use super::names::ElementNames;
use super::needs::{polarity_nodes, resolved};
use super::notes::{GainStep, signed};
use super::polarity::{Polarities, choose_polarities};
use crate::graph::{NodeId, Operation};

/// The elements of a patch.
pub(super) struct Assembly<'a> {
    /// The plan with its scales.
    pub design: &'a Design<'a>,
    /// The circuits of the nodes.
    pub blocks: &'a [Block],
    /// The polarities of the nodes.
    pub polarities: Polarities,
    /// The steps of the gain rule.
    pub steps: Vec<GainStep>,
    /// The name of the element or drive with the output of each node. It is empty for references and aliases.
    outputs: Vec<String>,
    /// The names that are free.
    names: ElementNames,
    /// The elements without inverters.
    elements: Vec<(String, ElementBuilder)>,
    /// The inverters, by the output that each inverts.
    inverters: BTreeMap<String, (String, ElementBuilder)>,
    /// The names of the pots, by input and setting.
    pots: BTreeMap<(String, String), String>,
}

impl<'a> Assembly<'a> {
    /// Assembles the circuits of all nodes, with names that are numbered in the order of the elements.
    ///
    /// # Errors
    /// The nodes that have no circuit.
    pub(super) fn of(design: &'a Design<'a>, blocks: &'a [Block]) -> Result<Self, Vec<Diagnostic>> {
        let polarities = choose_polarities(&polarity_nodes(design, blocks));
        let draft = Assembly::with_names(design, blocks, polarities.clone(), design.names.elements())?;
        let drafted = draft.into_elements();
        let names = design.names.numbered(drafted.iter().map(|(name, _)| name));
        Assembly::with_names(design, blocks, polarities, names)
    }

    /// Assembles the circuits of all nodes with these names.
    ///
    /// # Errors
    /// The nodes that have no circuit.
    fn with_names(
        design: &'a Design<'a>,
        blocks: &'a [Block],
        polarities: Polarities,
        mut names: ElementNames,
    ) -> Result<Self, Vec<Diagnostic>> {
        let output = |id: NodeId| match (design.input.operation(id), letter(design, blocks, id)) {
            (Operation::Drive(name), _) => name.clone(),
            (_, Some(letter)) => names.next(letter),
            (_, None) => String::new(),
        };
        let outputs = design.input.plan.ids().map(output).collect();
        let mut assembly = Assembly {
            design,
            blocks,
            polarities,
            steps: Vec::new(),
            outputs,
            names,
            elements: Vec::new(),
            inverters: BTreeMap::new(),
            pots: BTreeMap::new(),
        };
        let nodes = signal_flow(&design.input.plan).into_iter();
        let faults: Vec<Diagnostic> = nodes.filter_map(|id| elements::add(&mut assembly, id).err()).collect();
        if faults.is_empty() { Ok(assembly) } else { Err(faults) }
    }

    /// The polarity of the output of a node.
    pub(super) fn polarity(&self, id: NodeId) -> i8 {
        self.polarities.outputs[id.0 as usize]
    }

    /// The name of the output of a node with a circuit of its own.
    pub(super) fn output(&self, id: NodeId) -> &str {
        &self.outputs[id.0 as usize]
    }

    /// The next free name of an element with this letter.
    pub(super) fn next_name(&mut self, letter: char) -> String {
        self.names.next(letter)
    }

    /// Adds an element.
    pub(super) fn add(&mut self, name: String, element: ElementBuilder) {
        self.elements.push((name, element));
    }

    /// Adds the element with the output of a node, with a note.
    pub(super) fn add_output(&mut self, id: NodeId, element: ElementBuilder) {
        let note = signed(self.design.input.description(id), self.polarity(id));
        self.elements.push((self.outputs[id.0 as usize].clone(), element.note(&note)));
    }

    /// The name of an output with the value of a node and this polarity. An inverter is added if it is necessary.
    pub(super) fn voltage(&mut self, id: NodeId, polarity: i8) -> String {
        let (source, sign) = resolved(self.blocks, id);
        let wanted = polarity * sign;
        match self.blocks[source.0 as usize] {
            Block::Reference => reference(wanted).to_owned(),
            Block::Ground => "ground".to_owned(),
            _ if self.polarity(source) == wanted => self.output(source).to_owned(),
            _ => self.inverter(source),
        }
    }

    /// The name of an output with the value of a node, and its polarity. No inverter is necessary.
    pub(super) fn any_voltage(&mut self, id: NodeId) -> (String, i8) {
        let (source, sign) = resolved(self.blocks, id);
        let own = match self.blocks[source.0 as usize] {
            Block::Reference | Block::Ground => 1,
            _ => self.polarity(source),
        };
        (self.voltage(id, own * sign), own * sign)
    }

    /// The name of the inverter of the output of a node.
    fn inverter(&mut self, source: NodeId) -> String {
        let output = self.output(source).to_owned();
        if let Some((name, _)) = self.inverters.get(&output) {
            return name.clone();
        }
        let name = self.names.next('B');
        let note = signed(self.design.input.description(source), -self.polarity(source));
        let inverter = ElementBuilder::new("inverter").cord("in", &output).note(&note);
        self.inverters.insert(output, (name.clone(), inverter));
        name
    }

    /// The name of a pot at an output. Equal pots are shared.
    pub(super) fn pot(&mut self, input: &str, setting: &Value, note: &str) -> String {
        let key = (input.to_owned(), setting.to_string());
        if let Some(name) = self.pots.get(&key) {
            return name.clone();
        }
        let name = self.names.next('P');
        let pot = ElementBuilder::new("pot").cord("in", input).set("setting", setting.clone()).note(note);
        self.elements.push((name.clone(), pot));
        self.pots.insert(key, name.clone());
        name
    }

    /// The output at which a quantity can be read, and the factor of the signal: -1 if it is inverted. The output of an
    /// inverter is preferred to an inverted one.
    pub(super) fn reading(&self, id: NodeId) -> (&str, f64) {
        let (source, sign) = resolved(self.blocks, id);
        let output = self.output(source);
        match self.blocks[source.0 as usize] {
            Block::Reference => (reference(sign), 1.0),
            Block::Ground => ("ground", 1.0),
            _ if self.polarity(source) == sign => (output, 1.0),
            _ => match self.inverters.get(output) {
                Some((inverter, _)) => (inverter.as_str(), 1.0),
                None => (output, -1.0),
            },
        }
    }

    /// The element whose output has the value of a node, of either polarity. `None` for references and 0 V.
    pub(super) fn output_of(&self, id: NodeId) -> Option<&str> {
        Some(self.output(resolved(self.blocks, id).0)).filter(|output| !output.is_empty())
    }

    /// All elements in the order of the signal flow, each followed by its inverter. The inverters of drives come first.
    pub(super) fn into_elements(mut self) -> Vec<(String, ElementBuilder)> {
        let names: BTreeSet<&String> = self.elements.iter().map(|(name, _)| name).collect();
        let of_drives: Vec<String> =
            self.inverters.keys().filter(|output| !names.contains(output)).cloned().collect();
        let mut all: Vec<_> = of_drives.iter().filter_map(|drive| self.inverters.remove(drive)).collect();
        for (name, element) in self.elements {
            let inverter = self.inverters.remove(&name);
            all.push((name, element));
            all.extend(inverter);
        }
        all
    }
}

/// The name of the reference voltage with a polarity.
fn reference(polarity: i8) -> &'static str {
    if polarity > 0 { "+100" } else { "-100" }
}

/// The letter of the element with the output of a node. `None` if the node has no element.
fn letter(design: &Design<'_>, blocks: &[Block], id: NodeId) -> Option<char> {
    let operation = design.input.operation(id);
    match &blocks[id.0 as usize] {
        Block::Reference | Block::Ground | Block::Drive | Block::Alias { .. } => None,
        Block::Share(_) => Some('P'),
        Block::Amplifier { .. } if matches!(operation, Operation::Integral { .. }) => Some('A'),
        Block::Amplifier { .. } => Some('B'),
        Block::Element => Some(match operation {
            Operation::Product(_) => 'M',
            Operation::Function { .. } | Operation::Curve { .. } => 'F',
            Operation::Switch { .. } => 'C',
            Operation::Delay { .. } => 'L',
            _ => 'D',
        }),
    }
}
