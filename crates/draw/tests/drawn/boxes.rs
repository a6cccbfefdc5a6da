//! A drawing with macros as boxes says the same as the circuit: boxes are opened again and again, and the cords that
//! come out are compared.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_draw::schematic::{Diagram, Jack, Schematic, Source, Symbol};

/// From, to, jack.
type Cord = (String, String, String);

/// Looks at the boxes of a schematic.
pub fn check(drawn: &Schematic, circuit: &Circuit, what: &str) {
    let mut cords = Vec::new();
    Opener { drawn }.open(&drawn.main, "", &BTreeMap::new(), &mut cords);
    cords.sort();
    assert_eq!(cords, cords_of(circuit), "{what}");
    every_signal_is_told(drawn, circuit, what);
}

fn cords_of(circuit: &Circuit) -> Vec<Cord> {
    let mut cords = Vec::new();
    for (index, element) in circuit.elements().into_iter().enumerate() {
        for (from, cord) in circuit.cords(index) {
            let from = circuit.element(from).name.clone();
            let jack = format!("{} {}", element.kind.inputs[cord.input].name, cord.gain);
            cords.push((from, element.name.clone(), jack));
        }
    }
    cords.sort();
    cords
}

struct Opener<'a> {
    drawn: &'a Schematic,
}

impl Opener<'_> {
    /// The cords of a diagram, where names begin with `prefix` and `ports` tells what drives the input ports.
    fn open(&self, diagram: &Diagram, prefix: &str, ports: &BTreeMap<String, String>, cords: &mut Vec<Cord>) {
        for placed in &diagram.symbols {
            let symbol = &placed.symbol;
            let driver = |jack: &Jack| self.driver(diagram, jack.from, prefix, ports);
            match symbol.shape {
                "macro" => {
                    let ports = symbol.jacks.iter().map(|jack| (jack.input.clone(), driver(jack))).collect();
                    let prefix = format!("{prefix}{}.", symbol.name);
                    self.open(self.inside(symbol), &prefix, &ports, cords);
                }
                "port-in" | "port-out" => (),
                _ => cords.extend(symbol.jacks.iter().map(|jack| {
                    let gain = jack.gain.unwrap_or(1.0);
                    (driver(jack), format!("{prefix}{}", symbol.name), format!("{} {gain}", jack.input))
                })),
            }
        }
    }

    fn inside(&self, symbol: &Symbol) -> &Diagram {
        let opened = self.drawn.macros.iter().find(|opened| opened.of == symbol.kind);
        &opened.unwrap_or_else(|| panic!("{} is not opened", symbol.kind)).diagram
    }

    fn driver(
        &self,
        diagram: &Diagram,
        from: Source,
        prefix: &str,
        ports: &BTreeMap<String, String>,
    ) -> String {
        let (index, outlet) = match from {
            Source::Output(index, outlet) => (index, outlet),
            Source::Reference(name) => return name.to_owned(),
        };
        let symbol = &diagram.symbols[index].symbol;
        match symbol.shape {
            "port-in" => ports[&symbol.name].clone(),
            "macro" => {
                let inside = self.inside(symbol);
                let port = &symbol.outlets[outlet].port;
                let is_it = |symbol: &Symbol| symbol.shape == "port-out" && symbol.name == *port;
                let end = inside.symbols.iter().find(|placed| is_it(&placed.symbol)).unwrap();
                let prefix = format!("{prefix}{}.", symbol.name);
                self.driver(inside, end.symbol.jacks[0].from, &prefix, &BTreeMap::new())
            }
            _ => format!("{prefix}{}", symbol.name),
        }
    }
}

/// Every signal of an element or a drive stands at an output, or at the box in which it is read.
fn every_signal_is_told(drawn: &Schematic, circuit: &Circuit, what: &str) {
    let mut told: Vec<&String> = Vec::new();
    for placed in &drawn.main.symbols {
        told.extend(placed.symbol.outlets.iter().flat_map(|outlet| &outlet.signals));
        told.extend(&placed.symbol.inside);
    }
    told.sort();
    // Two ports may be one output.
    told.dedup();
    let patch = circuit.patch();
    let is_drawn = |name: &String| patch.elements.contains_key(name) || patch.drives.contains_key(name);
    let drawn = patch.signals.iter().filter(|(_, signal)| is_drawn(&signal.at.value));
    let mut wanted: Vec<&String> = drawn.map(|(name, _)| name).collect();
    wanted.sort();
    assert_eq!(told, wanted, "{what}");
}
