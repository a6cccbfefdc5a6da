//! A drawing with macros as boxes has the same cords as the circuit.
//!
//! All boxes are replaced by their contents, recursively, and the resulting cords are compared.

use std::collections::BTreeMap;

use super::{CordKey, cords_of};
use patchcord_core::circuit::Circuit;
use patchcord_draw::schematic::{CordSource, Diagram, Jack, Schematic, Symbol};

/// Checks the boxes of a schematic against the circuit; `case` names the case in failures.
pub(super) fn check(schematic: &Schematic, circuit: &Circuit, case: &str) {
    let mut cords = Vec::new();
    BoxExpander { schematic }.open(&schematic.main, "", &BTreeMap::new(), &mut cords);
    cords.sort();
    assert_eq!(cords, cords_of(circuit), "{case}");
    every_signal_is_shown(schematic, circuit, case);
}

/// Replaces boxes by the diagrams of their macros.
struct BoxExpander<'a> {
    /// The schematic with the diagrams of the macros.
    schematic: &'a Schematic,
}

impl BoxExpander<'_> {
    /// Collects the cords of a diagram.
    ///
    /// Names get the prefix, and `ports` contains the drivers of the input ports.
    fn open(
        &self,
        diagram: &Diagram,
        prefix: &str,
        ports: &BTreeMap<String, String>,
        cords: &mut Vec<CordKey>,
    ) {
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
                    let gain = jack.gain.map(|gain| gain.to_string());
                    (driver(jack), format!("{prefix}{}", symbol.name), jack.input.clone(), gain)
                })),
            }
        }
    }

    /// Returns the diagram of the macro of a box.
    fn inside(&self, symbol: &Symbol) -> &Diagram {
        let opened = self.schematic.macros.iter().find(|opened| opened.of == symbol.kind);
        &opened.unwrap_or_else(|| panic!("{} is not opened", symbol.kind)).diagram
    }

    /// Returns the name of the element that drives a jack from this source.
    fn driver(
        &self,
        diagram: &Diagram,
        from: CordSource,
        prefix: &str,
        ports: &BTreeMap<String, String>,
    ) -> String {
        let (index, output) = match from {
            CordSource::Output(index, output) => (index, output),
            CordSource::Reference(name) => return name.to_owned(),
        };
        let symbol = &diagram.symbols[index].symbol;
        match symbol.shape {
            "port-in" => ports[&symbol.name].clone(),
            "macro" => {
                let inside = self.inside(symbol);
                let port = &symbol.outputs[output].port;
                let is_port = |symbol: &Symbol| symbol.shape == "port-out" && symbol.name == *port;
                let end = inside.symbols.iter().find(|placed| is_port(&placed.symbol)).unwrap();
                let prefix = format!("{prefix}{}.", symbol.name);
                self.driver(inside, end.symbol.jacks[0].from, &prefix, &BTreeMap::new())
            }
            _ => format!("{prefix}{}", symbol.name),
        }
    }
}

/// Checks that every signal of an element or a drive is shown at an output or at the box that contains it.
fn every_signal_is_shown(schematic: &Schematic, circuit: &Circuit, case: &str) {
    let mut shown: Vec<&String> = Vec::new();
    for placed in &schematic.main.symbols {
        shown.extend(placed.symbol.outputs.iter().flat_map(|output| &output.signals));
        shown.extend(&placed.symbol.inside);
    }
    shown.sort();
    // Two ports may be the same output.
    shown.dedup();
    let patch = circuit.patch();
    let is_drawn = |name: &String| patch.elements.contains_key(name) || patch.drives.contains_key(name);
    let drawn = patch.signals.iter().filter(|(_, signal)| is_drawn(&signal.element.value));
    let mut expected: Vec<&String> = drawn.map(|(name, _)| name).collect();
    expected.sort();
    assert_eq!(shown, expected, "{case}");
}
