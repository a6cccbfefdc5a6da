//! The patch panel of a circuit: the cords of the document and the outputs that can be plugged in.

use std::collections::{HashMap, HashSet};

use patchcord_core::circuit::Circuit;
use patchcord_core::elements::{Jacks, Kind, OutputStage, Transfer};

use super::document::CordPlace;
use super::netlist::Link;

/// A cord of the document.
pub(super) struct Cord {
    /// Its place in the document.
    pub place: CordPlace,
    /// The cord in the circuit. `None` if it leads to an instance of a macro.
    pub wired: Option<WiredCord>,
}

impl Cord {
    /// Whether another cord comes from the same output to the same element.
    fn is_twin(&self, other: &Cord) -> bool {
        other.place.element == self.place.element && other.place.source == self.place.source
    }
}

/// A cord of the circuit.
#[derive(Debug, Clone, Copy)]
pub(super) struct WiredCord {
    /// Index of the element that it leads to.
    pub element: usize,
    /// Its index among the cords of the element.
    pub index: usize,
    /// The input, the source and the gain.
    pub link: Link,
}

/// An output that can be plugged in.
pub(super) struct Output {
    /// Its name in the document.
    pub name: String,
    /// Index of its element. `None` if the name is that of a port whose element is not known.
    pub element: Option<usize>,
    /// Whether a cord reads it. References count as read.
    pub is_read: bool,
}

/// The cords and outputs of a circuit.
pub(super) struct Panel<'a> {
    pub circuit: &'a Circuit,
    /// The cords in the order of the document.
    pub cords: Vec<Cord>,
    /// The outputs: drives, elements, references, and the ports of instances that the document names.
    pub outputs: Vec<Output>,
    /// A name that nothing in the patch has, for a new element.
    pub new_name: String,
}

/// The references that can always be plugged in.
const REFERENCES: [&str; 2] = ["+100", "-100"];
/// The gains that summing inputs have on most machines.
const GAINS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

impl<'a> Panel<'a> {
    /// The panel of a circuit.
    pub(super) fn new(circuit: &'a Circuit) -> Self {
        let elements = circuit.elements().into_iter().enumerate();
        let indices = elements.map(|(index, element)| (element.name.as_str(), index));
        let indices: HashMap<&str, usize> = indices.collect();
        let elements = circuit.patch().value()["elements"].as_object();
        let names = elements.into_iter().flat_map(|elements| elements.keys());
        let cords: Vec<Cord> = names.flat_map(|name| cords_of(circuit, name, indices.get(&**name))).collect();
        let outputs = outputs(circuit, &cords, &indices);
        Panel { circuit, cords, outputs, new_name: new_name(circuit) }
    }

    /// The kind of an element of the circuit.
    pub(super) fn kind(&self, element: usize) -> &'static Kind {
        self.circuit.element(element).kind
    }

    /// The elements of the document that are no instances of macros, with their indices.
    pub(super) fn elements(&self) -> impl Iterator<Item = (&'a str, usize)> {
        let circuit = self.circuit;
        let written = &circuit.patch().value()["elements"];
        let elements = circuit.elements().into_iter().enumerate();
        elements
            .filter(move |(_, element)| written.get(&element.name).is_some())
            .map(|(index, element)| (element.name.as_str(), index))
    }

    /// The cords into an element of the circuit.
    pub(super) fn cords_into(&self, element: usize) -> impl Iterator<Item = WiredCord> {
        self.cords.iter().filter_map(|cord| cord.wired).filter(move |wired| wired.element == element)
    }

    /// Whether another jack of the same element has a cord from the same output, so that a text must name the jack.
    pub(super) fn is_ambiguous(&self, cord: &Cord) -> bool {
        self.cords.iter().any(|other| cord.is_twin(other) && other.place.jack != cord.place.jack)
    }

    /// Whether an earlier cord comes from the same output to the same jack. A change of either is the same.
    pub(super) fn is_repeated(&self, cord: usize) -> bool {
        let own = &self.cords[cord];
        self.cords[..cord].iter().any(|other| own.is_twin(other) && other.place.jack == own.place.jack)
    }

    /// The names of the jacks of a summing input, with their gains: those of the machine. On a machine with all gains,
    /// the usual ones and those that the patch uses.
    pub(super) fn jacks(&self, element: usize, input: usize) -> Vec<(String, f64)> {
        let mut gains = self.circuit.input_gains(element).to_vec();
        if gains.is_empty() {
            gains.extend(GAINS);
            let wired = self.cords.iter().filter_map(|cord| cord.wired);
            for WiredCord { element, link, .. } in wired {
                let is_summing = self.kind(element).inputs[link.input].jacks == Jacks::Gains;
                if is_summing && !gains.contains(&link.factor) {
                    gains.push(link.factor);
                }
            }
        }
        let prefix = self.kind(element).inputs[input].name;
        gains.into_iter().map(|gain| (format!("{prefix}{gain}"), gain)).collect()
    }

    /// Whether an element inverts an output with gain 1.
    pub(super) fn inverts(&self, element: usize, output: usize) -> bool {
        let kind = self.kind(element);
        let is_plain = self.circuit.element(element).settings.iter().all(Option::is_none);
        let is_inverter =
            kind.transfer == Transfer::Inverting && kind.output == OutputStage::Amplifier && is_plain;
        match self.circuit.cords(element).as_slice() {
            [(from, cord)] => is_inverter && *from == output && cord.gain == 1.0,
            _ => false,
        }
    }
}

/// The cords of an element or instance of the document. `index` is that of the element in the circuit.
fn cords_of(circuit: &Circuit, name: &str, index: Option<&usize>) -> Vec<Cord> {
    let written: Vec<(&str, &str)> = circuit.patch().written_cords(name).collect();
    let wired = index.map_or_else(Vec::new, |index| circuit.cords(*index));
    // The cords of an element are in the same order in both.
    let is_complete = wired.len() == written.len();
    let mut found: Vec<Cord> = Vec::new();
    for (place, (jack, source)) in written.into_iter().enumerate() {
        let position = found.iter().filter(|cord| cord.place.jack == jack).count();
        let wired = index.filter(|_| is_complete).map(|element| {
            let (from, cord) = wired[place];
            let link = Link { input: cord.input, from, factor: cord.gain };
            WiredCord { element: *element, index: place, link }
        });
        let [element, jack, source] = [name, jack, source].map(str::to_owned);
        found.push(Cord { place: CordPlace { element, jack, position, source }, wired });
    }
    found
}

/// The outputs that can be plugged in.
fn outputs(circuit: &Circuit, cords: &[Cord], indices: &HashMap<&str, usize>) -> Vec<Output> {
    let patch = circuit.patch();
    let written = &patch.value()["elements"];
    let elements = patch.elements.keys().filter(|name| written.get(name).is_some());
    let sources = cords.iter().map(|cord| &cord.place.source);
    let names = patch.drives.keys().chain(elements).chain(sources).map(String::as_str).chain(REFERENCES);
    let read: HashSet<&str> = cords.iter().map(|cord| &*cord.place.source).chain(REFERENCES).collect();
    let ports = cords.iter().filter_map(|cord| Some((&*cord.place.source, cord.wired?.link.from)));
    let ports: HashMap<&str, usize> = ports.collect();
    let mut known = HashSet::new();
    let output = |name: &str| Output {
        name: name.to_owned(),
        element: indices.get(name).or(ports.get(name)).copied(),
        is_read: read.contains(name),
    };
    names.filter(|name| known.insert(*name)).map(output).collect()
}

/// A name that nothing in a patch has.
fn new_name(circuit: &Circuit) -> String {
    let is_free = |name: &String| is_free_name(circuit, name);
    (1..).map(|number| format!("N{number}")).find(is_free).unwrap_or_default()
}

/// Whether nothing in a patch has a name. The names inside of macros do not count.
pub(crate) fn is_free_name(circuit: &Circuit, name: &str) -> bool {
    let patch = circuit.patch();
    !(patch.elements.contains_key(name)
        || patch.instances.contains_key(name)
        || patch.drives.contains_key(name)
        || patch.signals.contains_key(name)
        || patch.parameters.contains_key(name)
        || patch.scales.contains_key(name)
        || circuit.auxiliary_quantities().any(|auxiliary| auxiliary == name))
}

#[cfg(test)]
mod tests {
    use patchcord_core::patch::Patch;

    use super::*;

    /// The circuit of a patch with these sections.
    fn circuit(sections: &str) -> Circuit {
        let text =
            format!(r#"{{"patchcord": 1, "scales": {{"one": {{"per_volt": 1, "unit": "1"}}}}, {sections}}}"#);
        Circuit::new(&Patch::parse("p.json", &text).unwrap()).unwrap_or_else(|report| panic!("{report}"))
    }

    #[test]
    fn a_new_name_is_that_of_no_element_and_no_signal() {
        let circuit = circuit(
            r#""elements": {"N1": {"kind": "integrator", "in": {"x1": ["N1"]}}},
               "signals": {"N2": {"at": "N1", "scale": "one"}}"#,
        );
        assert_eq!(Panel::new(&circuit).new_name, "N3");
    }

    #[test]
    fn the_cords_of_the_document_are_those_of_the_circuit() {
        let circuit = circuit(
            r#""elements": {"A": {"kind": "integrator", "in": {"x10": ["M", "A"], "x1": ["B"]}},
                            "B": {"kind": "inverter", "in": "A"},
                            "M": {"kind": "multiplier", "mode": "product", "a": "A", "b": "ground"}}"#,
        );
        let panel = Panel::new(&circuit);
        let index = |name: &str| circuit.elements().iter().position(|element| element.name == name).unwrap();
        for cord in &panel.cords {
            let wired = cord.wired.unwrap();
            assert_eq!(index(&cord.place.element), wired.element);
            assert_eq!(index(&cord.place.source), wired.link.from);
        }
        let own = &panel.cords[1];
        assert_eq!((own.place.jack.as_str(), own.place.position), ("x10", 1));
        assert_eq!(own.wired.unwrap().link.factor, 10.0);
        let names: Vec<&str> = panel.outputs.iter().map(|output| output.name.as_str()).collect();
        assert_eq!(names, ["A", "B", "M", "ground", "+100", "-100"]);
        assert!(panel.inverts(index("B"), index("A")) && !panel.inverts(index("A"), index("A")));
    }

    #[test]
    fn the_gains_of_a_patch_extend_those_of_the_unlimited_machine() {
        let circuit = circuit(r#""elements": {"A": {"kind": "integrator", "in": {"x4": ["A"]}}}"#);
        let jacks = Panel::new(&circuit).jacks(3, 0);
        let names: Vec<&str> = jacks.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["x1", "x10", "x100", "x1000", "x4"]);
    }
}
