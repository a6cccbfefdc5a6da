//! The parameters of a circuit, told in a line.

use super::Display;
use patchcord_core::circuit::Circuit;

/// The parameters as a line of small print, in short units: those that are not 0, in the patch or as set.
pub fn parameter_line(circuit: &Circuit) -> String {
    let shown = circuit.parameters().filter(|(_, parameter, value)| *value != 0.0 || parameter.value != 0.0);
    let told = shown.map(|(name, parameter, value)| {
        format!("{name} {}", Display::new(parameter.unit.text(), value).text(value))
    });
    told.collect::<Vec<_>>().join(", ")
}
