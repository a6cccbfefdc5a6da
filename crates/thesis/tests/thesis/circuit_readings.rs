//! Readings of the shipped circuits: overload lamps, potentiometer settings, initial voltages and swings.

use std::collections::HashMap;

use crate::common::program_of;
use crate::known_problems::runs::circuit;
use patchcord_core::patch::Amount;
use patchcord_core::solve::Machine;
use patchcord_core::trace::Trace;

pub(crate) use crate::common::document;

/// Names of the elements whose overload lamp lit.
pub(super) fn overloaded_elements(trace: &Trace) -> Vec<&str> {
    trace.overloads().map(|overload| overload.element.as_str()).collect()
}

/// Pot settings of a patch, by name.
pub(super) fn pots(stem: &str, changes: &[(&str, f64)]) -> HashMap<String, f64> {
    let circuit = circuit(stem, changes);
    let settings = circuit.elements().into_iter().filter(|element| element.kind.name == "pot").map(|pot| {
        let Some(Amount::Formula(formula)) = pot.settings[0].as_ref().map(|placed| &placed.value) else {
            panic!("{} has no setting", pot.name)
        };
        (pot.name.clone(), formula.evaluate(circuit.quantities()).unwrap())
    });
    settings.collect()
}

/// Voltages in initial condition, as the voltmeter reads them in problem check.
pub(super) fn initial_voltages(stem: &str, elements: &[&str]) -> Vec<f64> {
    let program = program_of(&circuit(stem, &[]));
    let machine = Machine::new(&program, 2e-5).unwrap();
    assert!(!machine.is_overloaded());
    elements.iter().map(|element| machine.voltage(element).unwrap()).collect()
}

/// The peak-to-peak value over 40 samples, from each sample on: 40 ms, about two periods near the critical velocity.
pub(super) fn swing(velocity: &[f64]) -> Vec<f64> {
    let span = |window: &[f64]| {
        let bounds = window.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
        bounds.1 - bounds.0
    };
    velocity.windows(40).map(span).collect()
}
