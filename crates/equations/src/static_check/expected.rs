//! The expected voltages of all outputs.

use std::collections::BTreeMap;

use patchcord_core::ir::{Register, SignalInfo};

use super::causes::spread;
use super::solution::{Origin, Solution};
use super::tolerances::Tolerances;
use super::wired::Wired;

/// The voltages that follow from the equations: named outputs have their values in the equations, and the others follow
/// from their inputs.
pub(super) struct Expected {
    /// The voltages of all registers. `None` if a loop has no single solution.
    pub voltages: Option<Vec<f64>>,
    /// For every register, whether it depends on an output that the equations determine and that differs in the wiring.
    /// The law of an element is the same on both sides, so its output differs only if an input does.
    differs: Vec<Option<()>>,
}

/// A signal whose value the equations determine.
pub(super) struct Determined {
    /// Its value in SI.
    pub value: f64,
    /// The voltage that represents it.
    pub volts: f64,
    /// The sum of the sizes of the terms of its equation, in volts.
    pub size: f64,
}

/// The value of a signal if the equations determine it. A scale of 0 represents nothing.
pub(super) fn determined(
    wired: &Wired<'_>,
    solution: &Solution<'_>,
    signal: &SignalInfo,
) -> Option<Determined> {
    let (_, per_volt) = wired.place(&signal.name).filter(|(_, per_volt)| *per_volt != 0.0)?;
    let known = solution.quantity(&signal.name, 0).filter(|known| known.origin == Origin::Equations)?;
    let (volts, size) = (known.value / per_volt, known.size / per_volt.abs());
    Some(Determined { value: known.value, volts, size })
}

impl Expected {
    /// The expected voltages of a circuit.
    pub(super) fn new(wired: &Wired<'_>, solution: &Solution<'_>, tolerances: &Tolerances<'_>) -> Self {
        let (mut point, mut given) = (wired.point.clone(), wired.given.clone());
        // Outputs whose expected voltages do not follow from their inputs, each with whether the wiring differs.
        let mut fixed: BTreeMap<Register, Option<()>> = BTreeMap::new();
        let outputs = wired.program.element_outputs();
        for (state, law) in wired.program.state_laws().iter().enumerate() {
            let Some((change, size)) = stated_change(wired, solution, state) else { continue };
            let volts = point.states[state];
            point.states[state] += change;
            let differs = !Tolerances::agree([point.states[state], volts], size, 0.0);
            fixed.insert(outputs[law.element].register, differs.then_some(()));
        }
        for signal in wired.program.signals().iter().filter(|signal| signal.is_named) {
            let Some(determined) = determined(wired, solution, signal) else { continue };
            let Some(element) = wired.element_at(signal.register) else { continue };
            if wired.state_at(signal.register).is_none() && !given.contains_key(&signal.register) {
                given.insert(signal.register, determined.volts);
                let differs = !tolerances.output_agrees(element, determined.volts, determined.size);
                fixed.insert(signal.register, differs.then_some(()));
            }
        }
        let states = vec![None; point.states.len()];
        let differs =
            spread(wired.program, &states, &|register, from| fixed.get(&register).copied().unwrap_or(from));
        Expected { voltages: wired.program.unlimited_voltages_at(&point, &given), differs }
    }

    /// Whether the expected voltage of a register differs from the wired one because of an output in front of it.
    pub(super) fn differs(&self, register: Register) -> bool {
        self.differs[register.index()].is_some()
    }
}

/// The change of a state in volts if it gets the initial value that the equations state, with the size of their terms in
/// volts. `None` if they state none.
fn stated_change(wired: &Wired<'_>, solution: &Solution<'_>, state: usize) -> Option<(f64, f64)> {
    let handle = solution.handles[state].as_ref()?;
    let known = solution.quantity(&handle.name, handle.order)?;
    let own = wired.quantity(&handle.name, handle.order).filter(|_| known.origin == Origin::Equations)?;
    let slope = wired.slope(handle, state)?;
    Some(((known.value - own) / slope, known.size / slope.abs()))
}
