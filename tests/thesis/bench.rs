//! Shipped patches on the bench: set, run, recorded.

use std::collections::HashMap;
use std::path::Path;

use patchcord::circuit::Circuit;
use patchcord::patch::{Amount, Patch};
use patchcord::program::Program;
use patchcord::solve::{self, Machine, RunSettings};
use patchcord::trace::Trace;

/// Parameters set anew, in SI, which is what the thesis's patches declare.
pub type Changes = Vec<(String, f64)>;

pub fn changes(named: &[(&str, f64)]) -> Changes {
    named.iter().map(|(name, value)| (name.to_string(), *value)).collect()
}

/// A patch of the thesis, such as "fig-8-16".
pub fn circuit(stem: &str, changes: &Changes) -> Circuit {
    let file = format!("{}/patches/thesis/{stem}.json", env!("CARGO_MANIFEST_DIR"));
    let patch = Patch::read(Path::new(&file)).unwrap_or_else(|error| panic!("{error}"));
    Circuit::new(&patch, changes).unwrap_or_else(|report| panic!("{changes:?}\n{report}"))
}

pub fn program_of(circuit: &Circuit) -> Program {
    Program::new(circuit).unwrap_or_else(|report| panic!("{report}"))
}

/// Runs a patch of the thesis with its own step.
pub fn run(stem: &str, changes: &Changes, duration: f64, every: f64, record: &[&str]) -> Trace {
    let circuit = circuit(stem, changes);
    let own = RunSettings::of(&circuit).unwrap();
    let record = record.iter().map(|name| name.to_string()).collect();
    let settings = RunSettings { every, record, ..own.lasting(duration) };
    solve::run(&program_of(&circuit), &settings).unwrap_or_else(|error| panic!("{error}"))
}

/// Runs a patch made in the test, as its own plan says.
pub fn run_patch(patch: &Patch) -> Trace {
    let circuit = Circuit::new(patch, &[]).unwrap_or_else(|report| panic!("{report}"));
    let settings = RunSettings::of(&circuit).unwrap();
    solve::run(&program_of(&circuit), &settings).unwrap_or_else(|error| panic!("{error}"))
}

pub fn lit(trace: &Trace) -> Vec<&str> {
    trace.overloads().map(|overload| overload.element.as_str()).collect()
}

/// Largest magnitude.
pub fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |peak, value| peak.max(value.abs()))
}

/// A velocity in m/s that is nothing beside any that the thesis's patches move with.
const STANDING_STILL: f64 = 1e-9;

/// Largest difference of two velocities, as a share of the peak of what was expected.
pub fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let differences: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    peak(&differences) / peak(expected).max(STANDING_STILL)
}

/// Pot settings of a patch of the thesis, by name.
pub fn pots(stem: &str, changes: &Changes) -> HashMap<String, f64> {
    let circuit = circuit(stem, changes);
    let settings = circuit.elements().into_iter().filter(|element| element.kind.name == "pot").map(|pot| {
        let Some(Amount::Formula(formula)) = pot.settings[0].as_ref().map(|placed| &placed.value) else {
            panic!("{} has no setting", pot.name)
        };
        (pot.name.clone(), formula.evaluate(circuit.quantities()).unwrap())
    });
    settings.collect()
}

/// Voltages in initial condition, which is what the voltmeter reads in problem check.
pub fn volts_at_rest(stem: &str, elements: &[&str]) -> Vec<f64> {
    let program = program_of(&circuit(stem, &vec![]));
    let machine = Machine::new(&program, 2e-5).unwrap();
    assert!(!machine.is_overloaded());
    elements.iter().map(|element| machine.voltage(element).unwrap()).collect()
}

/// Peak to peak over the 40 samples from each on: 40 ms, about two periods near the critical velocity.
pub fn swing(velocity: &[f64]) -> Vec<f64> {
    let span = |window: &[f64]| {
        let bounds = window.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
        bounds.1 - bounds.0
    };
    velocity.windows(40).map(span).collect()
}
