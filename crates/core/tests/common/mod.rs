//! Helpers for tests of whole patches: they build and run programs, find roots of closed solutions, and compare exact
//! derivatives with differences.

#![allow(dead_code, reason = "no test binary uses all helpers")]

pub(crate) mod circuits;
pub(crate) mod curved_patches;
pub(crate) mod files;
pub(crate) mod mutated;
pub(crate) mod pages;
pub(crate) mod random;
pub(crate) mod static_patches;
pub(crate) mod traces;

use std::fs;
use std::path::Path;

use serde_json::Value;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{ParameterValue, Program};
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};
use patchcord_core::solve::Machine;

/// The patch of a file in crates/core/tests/patches, such as "loop-lag".
pub(crate) fn patch(stem: &str) -> Patch {
    read(&format!("crates/core/tests/patches/{stem}.json"))
}

/// A shipped patch, such as "lessons/lorenz".
pub(crate) fn shipped(stem: &str) -> Patch {
    read(&format!("patches/{stem}.json"))
}

/// The slideway with falling friction and friction memory.
pub(crate) fn slideway() -> Patch {
    shipped("thesis/fig-8-16")
}

fn read(file: &str) -> Patch {
    patch_of(&files::repository_path(file))
}

/// The JSON document of a shipped patch.
pub(crate) fn document(stem: &str) -> Value {
    let file = files::repository_path(&format!("patches/{stem}.json"));
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// The patch of a file.
pub(crate) fn patch_of(file: &Path) -> Patch {
    Patch::read(file).unwrap_or_else(|error| panic!("{error}"))
}

/// A patch's circuit with these parameter values.
pub(crate) fn circuit(patch: &Patch, changes: &[(&str, f64)]) -> Circuit {
    Circuit::with_parameters(patch, changes.iter().copied()).unwrap_or_else(|report| panic!("{report}"))
}

/// The program of a circuit.
pub(crate) fn program_of(circuit: &Circuit) -> Program {
    Program::new(circuit).unwrap_or_else(|report| panic!("{report}"))
}

/// A patch's program with these parameter values.
pub(crate) fn program(patch: &Patch, changes: &[(&str, f64)]) -> Program {
    program_of(&circuit(patch, changes))
}

/// The program of a patch made in Rust.
pub(crate) fn built(builder: PatchBuilder) -> Program {
    let patch = builder.build().unwrap_or_else(|report| panic!("{report}"));
    program(&patch, &[])
}

/// An element of a kind.
pub(crate) fn element(kind: &str) -> ElementBuilder {
    ElementBuilder::new(kind)
}

/// A patch in volts: the scale "volt" is 1 V.
pub(crate) fn volts(title: &str) -> PatchBuilder {
    PatchBuilder::new(title).scale("volt", 1, "V").run(1.0, 1e-3)
}

/// A fixed voltage: a step at t = 0.
pub(crate) fn source(builder: PatchBuilder, name: &str, height: f64) -> PatchBuilder {
    builder.drive(name, "volt", element("step").set("height", height))
}

/// A2'' = -4 dz(A2) with a dead zone dz of +-10 V, from 0 V upward. Straight lines of 30 V/s alternate with half swings
/// of 15 V.
pub(crate) fn dead_zone_oscillator() -> Program {
    let builder = volts("dead zone oscillator")
        .element("DZ", element("dead-zone").cord("in", "A2").set("lower", -10).set("upper", 10))
        .element("A1", element("integrator").cords("x4", ["DZ"]).set("initial", 30))
        .element("S1", element("summer").cords("x1", ["A1"]))
        .element("A2", element("integrator").cords("x1", ["S1"]));
    built(builder)
}

/// A mass that sticks and slips, driven by two tables. Most table times are ends of steps of 1 ms, one is within
/// rounding of such an end, some are elsewhere. One table also switches a relay. The diode L gives the lower of that
/// table and the position A2. `fed_back` names the element that drives the feedback pot.
pub(crate) fn driven_by_points(fed_back: &str) -> Patch {
    let height = |time: f64| 50.0 * (90.0 * time).sin() + 25.0 * (31.0 * time).cos();
    let curve = |times: Vec<f64>| {
        let points: Vec<_> = times.into_iter().map(|time| [time, height(time)]).collect();
        element("table").set("points", serde_json::json!(points))
    };
    let mut times: Vec<_> = (0..100).map(|place| f64::from(place) / 100.0).collect();
    times[67] += 4e-13;
    times.extend([0.3337, 0.590_000_1]);
    times.sort_by(f64::total_cmp);
    volts("driven by points")
        .parameter("g", 0.5, "1", [0.0, 1.0])
        .drive("u", "volt", curve(times))
        .drive("w", "volt", curve((1..35).map(|place| 0.028 * f64::from(place)).collect()))
        .element(
            "R",
            element("relay")
                .cord("in", "u")
                .cord("on", "w")
                .cord("off", "ground")
                .set("pull_in", 20)
                .set("drop_out", -20),
        )
        .element("L", element("diode-lower-of").cords("in", ["u", "A2"]))
        .element("P", element("pot").cord("in", fed_back).set("setting", "g"))
        .element("S", element("summer").cords("x1", ["u", "P", "R"]))
        .element("B", element("pot").cord("in", "+100").set("setting", 0.3))
        .element("A1", element("integrator").cords("x10", ["S"]).cords("brake_x10", ["B"]))
        .element("A2", element("integrator").cords("x1", ["A1"]))
        .build()
        .unwrap()
}

/// An oscillator with two delay lines. A table drives it through D1 and through the element `link`. Its output is fed
/// back through D2, which also switches a relay.
pub(crate) fn delay_loop(link: ElementBuilder) -> Patch {
    let height = |time: f64| 30.0 * (40.0 * time).sin() + 15.0 * (113.0 * time).cos();
    let points: Vec<_> =
        (0..=100).map(|place| f64::from(place) / 100.0).map(|time| [time, height(time)]).collect();
    let delay = |from: &str, time: &str| element("delay").cord("in", from).set("delay", time);
    let relay = element("relay").cord("in", "D2").cord("on", "C").cord("off", "ground");
    volts("delay loop")
        .parameter("T", 0.05, "s", [1e-4, 2.0])
        .parameter("F", 0.02, "s", [1e-4, 2.0])
        .drive("u", "volt", element("table").set("points", serde_json::json!(points)))
        .element("C", element("pot").cord("in", "+100").set("setting", 0.1))
        .element("D1", delay("u", "T"))
        .element("D2", delay("A2", "F").set("initial", 2))
        .element("R", relay.set("pull_in", 4).set("drop_out", -4))
        .element("L", link)
        .element("S", element("summer").cords("x1", ["D1", "L", "D2", "R"]))
        .element("A1", element("integrator").cords("x10", ["S", "A1"]))
        .element("A2", element("integrator").cords("x10", ["A1"]))
        .build()
        .unwrap()
}

/// The delay loop whose link is a diode: the lower of D1 and A2.
pub(crate) fn delay_loop_with_diode() -> Patch {
    delay_loop(element("diode-lower-of").cords("in", ["D1", "A2"]))
}

/// A machine after `length` problem seconds of operation in equal steps.
pub(crate) fn run_for(program: &Program, step: f64, length: f64) -> Machine<'_> {
    let mut machine = Machine::new(program, step).unwrap_or_else(|error| panic!("{error}"));
    machine.operate(length).unwrap_or_else(|error| panic!("{error}"));
    machine
}

/// The voltage at the output of an element.
pub(crate) fn voltage(machine: &Machine<'_>, element: &str) -> f64 {
    machine.voltage(element).unwrap_or_else(|error| panic!("{error}"))
}

/// The root of a function between `low` and `high`, by bisection. The function has different signs at the two.
pub(crate) fn root(function: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low, high);
    let rising = function(low) < function(high);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (function(middle) < 0.0) == rising { low = middle } else { high = middle }
    }
    high
}

/// The configuration of a property test with `cases` random cases. It keeps no file of past failures: a case that
/// failed becomes a separate test.
pub(crate) fn random_cases(cases: u32) -> proptest::test_runner::Config {
    proptest::test_runner::Config { cases, failure_persistence: None, ..Default::default() }
}

/// The observed order of convergence: the slope of the straight line through (log step, log error).
pub(crate) fn convergence_order(steps: &[f64], errors: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let logs = |values: &[f64]| values.iter().map(|value| value.ln()).collect::<Vec<_>>();
    let (x, y) = (logs(steps), logs(errors));
    let (mean_x, mean_y) = (mean(&x), mean(&y));
    let products: f64 = x.iter().zip(&y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    products / x.iter().map(|x| (x - mean_x).powi(2)).sum::<f64>()
}

/// Compares a program's exact derivatives with central differences of its rates, at instants away from kinks.
pub(crate) fn check_derivatives(program: &Program, step: f64, instants: &[f64]) {
    check_derivatives_except(program, step, instants, &[]);
}

/// The same comparison without the states in `held`. These are at a kink (stuck, resting, at a limit) and cannot be
/// varied in both directions.
pub(crate) fn check_derivatives_except(program: &Program, step: f64, instants: &[f64], held: &[&str]) {
    for instant in instants {
        let machine = run_for(program, step, *instant);
        let exact = machine.linearise();
        for (column, state) in
            exact.states.iter().enumerate().filter(|(_, state)| !held.contains(&state.as_str()))
        {
            let found = difference_by_state(&machine, state, machine.states()[column]);
            let derivatives: Vec<f64> = exact.by_states.iter().map(|row| row[column]).collect();
            assert_close(&derivatives, &found, &format!("by {state} at {instant} s"));
        }
        for (column, parameter) in program.parameters().iter().enumerate() {
            if is_at_edge(parameter) {
                continue;
            }
            let size_si = parameter.value.abs().max(1e-3 * parameter.declared.per_unit);
            let found = difference_by_parameter(
                &machine,
                &parameter.declared.name,
                parameter.value / parameter.declared.per_unit,
                size_si / parameter.declared.per_unit,
            );
            let derivatives: Vec<f64> = exact.by_parameters.iter().map(|row| row[column] * size_si).collect();
            assert_close(&derivatives, &found, &format!("by {} at {instant} s", parameter.declared.name));
        }
    }
}

/// Whether a parameter is at an end of its range, where it cannot be varied in both directions.
fn is_at_edge(parameter: &ParameterValue) -> bool {
    let value = parameter.value / parameter.declared.per_unit;
    parameter.declared.range.is_some_and(|(low, high)| value <= low || value >= high)
}

/// The difference of all rates per volt of a state.
fn difference_by_state(machine: &Machine<'_>, state: &str, volts: f64) -> Vec<f64> {
    let rates = |volts: f64| {
        let mut moved = machine.clone();
        moved.set_state(state, volts).unwrap_or_else(|error| panic!("{error}"));
        moved.rates().to_vec()
    };
    // Most rates are linear in the states, so a wide difference reduces the effect of rounding.
    central_difference(rates, volts, 1e-3)
}

/// The difference of all rates per fraction of a parameter's size, so that every entry is in volts per second.
fn difference_by_parameter(machine: &Machine<'_>, name: &str, value: f64, size: f64) -> Vec<f64> {
    let rates = |fraction: f64| {
        let mut changed = machine.clone();
        changed
            .set_parameter(name, value + fraction * size)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        changed.rates().to_vec()
    };
    central_difference(rates, 0.0, 1e-5)
}

fn central_difference(rates: impl Fn(f64) -> Vec<f64>, centre: f64, distance: f64) -> Vec<f64> {
    let (above, below) = (rates(centre + distance), rates(centre - distance));
    above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * distance)).collect()
}

/// Asserts that derivatives equal differences. The error of a difference is about the square of its distance, 1e-10,
/// plus the rounding of the rates divided by the distance.
fn assert_close(derivatives: &[f64], differences: &[f64], context: &str) {
    for (row, (derivative, difference)) in derivatives.iter().zip(differences).enumerate() {
        let allowed = 1e-7 * (1.0 + derivative.abs());
        let is_close = (derivative - difference).abs() <= allowed;
        assert!(is_close, "rate {row} {context}: derivative {derivative}, difference {difference}");
    }
}
