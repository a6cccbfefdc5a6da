//! Changes of scales and gains that bring the output of an amplifier into its range, as sentences with numbers.
//!
//! An output with a scaled signal changes with the scale. Any other output changes with the gains of its inputs. Factors
//! are round, so that the new numbers are easy to write and to remember.

mod factor;
mod gains;
mod scale;

pub(crate) use factor::{enlargement, reduction};
pub(crate) use scale::{Rescaling, inverted_by, scale_change, scaled_signal};

use gains::gain_changes;
use patchcord_core::circuit::Circuit;

/// Index of the element with this name.
pub(crate) fn element_index(circuit: &Circuit, name: &str) -> Option<usize> {
    circuit.elements().iter().position(|element| element.name == name)
}

/// How to make an output without a scaled signal smaller by a factor.
pub(crate) fn smaller_output(circuit: &Circuit, element: usize, factor: f64) -> String {
    let name = &circuit.element(element).name;
    match gain_changes(circuit, element, 1.0 / factor) {
        Some(changes) => {
            format!(
                "make {name} {factor} times smaller: {changes}; then multiply by {factor} where other amplifiers use it"
            )
        }
        None => format!(
            "reduce {} by larger scales, so that {name} gets {factor} times smaller",
            drivers(circuit, element)
        ),
    }
}

/// How to make an output without a scaled signal larger by a factor.
pub(crate) fn larger_output(circuit: &Circuit, element: usize, factor: f64) -> String {
    let name = &circuit.element(element).name;
    match gain_changes(circuit, element, factor) {
        Some(changes) => {
            format!(
                "make {name} {factor} times larger: {changes}; then divide by {factor} where other amplifiers use it"
            )
        }
        None => format!(
            "enlarge {} by smaller scales, so that {name} gets {factor} times larger",
            drivers(circuit, element)
        ),
    }
}

/// The outputs that drive an element, each once: "A1 and A2".
fn drivers(circuit: &Circuit, element: usize) -> String {
    let mut names: Vec<&str> = Vec::new();
    for (from, _) in circuit.cords(element) {
        let name = circuit.element(from).name.as_str();
        if from != element && !names.contains(&name) {
            names.push(name);
        }
    }
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => names.concat(),
    }
}

#[cfg(test)]
mod tests;
