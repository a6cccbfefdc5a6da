//! What tests of whole patches share: the journey to a program, roots of closed solutions, and exact
//! derivatives held against differences.

#![allow(dead_code, reason = "every test binary takes what it needs")]

pub mod circuits;
pub mod dice;
pub mod files;
pub mod mutated;
pub mod pages;
pub mod traces;

use std::fs;
use std::path::Path;

use serde_json::Value;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{ParameterSlot, Program};
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};
use patchcord_core::solve::Machine;

/// A patch of crates/core/tests/patches.
pub fn patch(stem: &str) -> Patch {
    read(&format!("crates/core/tests/patches/{stem}.json"))
}

/// A patch that comes with the program, such as "lessons/lorenz".
pub fn shipped(stem: &str) -> Patch {
    read(&format!("patches/{stem}.json"))
}

/// The slideway with falling friction and friction memory.
pub fn slideway() -> Patch {
    shipped("thesis/fig-8-16")
}

fn read(file: &str) -> Patch {
    patch_of(&files::rooted(file))
}

/// The document of a patch as it was written.
pub fn document(stem: &str) -> Value {
    let file = files::rooted(&format!("patches/{stem}.json"));
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// The patch of a file.
pub fn patch_of(file: &Path) -> Patch {
    Patch::read(file).unwrap_or_else(|error| panic!("{error}"))
}

/// A patch's circuit, with parameters changed.
pub fn circuit(patch: &Patch, changes: &[(&str, f64)]) -> Circuit {
    let changes: Vec<_> = changes.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    Circuit::new(patch, &changes).unwrap_or_else(|report| panic!("{report}"))
}

/// A circuit's program.
pub fn program_of(circuit: &Circuit) -> Program {
    Program::new(circuit).unwrap_or_else(|report| panic!("{report}"))
}

/// A patch's program, with parameters changed.
pub fn program(patch: &Patch, changes: &[(&str, f64)]) -> Program {
    program_of(&circuit(patch, changes))
}

/// The program of a patch made in Rust.
pub fn built(builder: PatchBuilder) -> Program {
    let patch = builder.build().unwrap_or_else(|report| panic!("{report}"));
    program(&patch, &[])
}

/// An element of a kind.
pub fn element(kind: &str) -> ElementBuilder {
    ElementBuilder::new(kind)
}

/// A patch in volts: the scale "volt" is 1 V.
pub fn volts(title: &str) -> PatchBuilder {
    PatchBuilder::new(title).scale("volt", 1, "V").run(1.0, 1e-3)
}

/// A fixed voltage: a step at t = 0.
pub fn source(builder: PatchBuilder, name: &str, height: f64) -> PatchBuilder {
    builder.drive(name, "volt", element("step").set("height", height))
}

/// A2'' = -4 dz(A2), dz a dead zone of +-10 V, from 0 V upward: level flight at 30 V/s between half swings of 15 V.
pub fn play() -> Program {
    let builder = volts("play")
        .element("DZ", element("dead-zone").cord("in", "A2").set("lower", -10).set("upper", 10))
        .element("A1", element("integrator").cords("x4", ["DZ"]).set("initial", 30))
        .element("S1", element("summer").cords("x1", ["A1"]))
        .element("A2", element("integrator").cords("x1", ["S1"]));
    built(builder)
}

/// A mass that sticks and slips, driven by curves through points: most lie on the ends of steps of 1 ms, one within rounding
/// of an end, some elsewhere. One curve also switches a relay, and a diode L gives the lower of it and the way A2. What is fed back is
/// told.
pub fn driven_by_points(fed_back: &str) -> Patch {
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

/// An oscillator behind one delay line, D1, through which a curve drives it, beside a link; it comes back through another, D2,
/// by which a relay switches.
pub fn late(link: ElementBuilder) -> Patch {
    let height = |time: f64| 30.0 * (40.0 * time).sin() + 15.0 * (113.0 * time).cos();
    let points: Vec<_> =
        (0..=100).map(|place| f64::from(place) / 100.0).map(|time| [time, height(time)]).collect();
    let delay = |from: &str, time: &str| element("delay").cord("in", from).set("delay", time);
    let relay = element("relay").cord("in", "D2").cord("on", "C").cord("off", "ground");
    volts("late")
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

/// The same with a diode that takes the lower of what comes and what swings.
pub fn late_and_bent() -> Patch {
    late(element("diode-lower-of").cords("in", ["D1", "A2"]))
}

/// A machine that has run for a time.
pub fn ran(program: &Program, step: f64, length: f64) -> Machine<'_> {
    let mut machine = Machine::new(program, step).unwrap_or_else(|error| panic!("{error}"));
    machine.operate(length).unwrap_or_else(|error| panic!("{error}"));
    machine
}

/// The voltage at an output.
pub fn voltage(machine: &Machine<'_>, element: &str) -> f64 {
    machine.voltage(element).unwrap_or_else(|error| panic!("{error}"))
}

/// Where a function changes its sign between two places at which it has different ones.
pub fn root(function: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low, high);
    let rising = function(low) < function(high);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (function(middle) < 0.0) == rising { low = middle } else { high = middle }
    }
    high
}

/// So many random cases, without a file of past failures: a case that failed becomes a test of its own.
pub fn random_cases(cases: u32) -> proptest::test_runner::Config {
    proptest::test_runner::Config { cases, failure_persistence: None, ..Default::default() }
}

/// The slope of the straight line through (log step, log error): the order that is reached.
pub fn order(steps: &[f64], errors: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let logs = |values: &[f64]| values.iter().map(|value| value.ln()).collect::<Vec<_>>();
    let (x, y) = (logs(steps), logs(errors));
    let (mean_x, mean_y) = (mean(&x), mean(&y));
    let products: f64 = x.iter().zip(&y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    products / x.iter().map(|x| (x - mean_x).powi(2)).sum::<f64>()
}

/// Holds a program's exact derivatives against central differences of its rates, at instants away from kinks.
pub fn check_derivatives(program: &Program, step: f64, instants: &[f64]) {
    check_derivatives_but(program, step, instants, &[]);
}

/// The same, where some states stand at a kink (stuck, resting, at a limit) and cannot be moved both ways.
pub fn check_derivatives_but(program: &Program, step: f64, instants: &[f64], held: &[&str]) {
    for instant in instants {
        let machine = ran(program, step, *instant);
        let exact = machine.linearise();
        for (column, state) in
            exact.states.iter().enumerate().filter(|(_, state)| !held.contains(&state.as_str()))
        {
            let found = difference_by_state(&machine, state, machine.states()[column]);
            let told: Vec<f64> = exact.by_states.column(column).iter().copied().collect();
            compare(&told, &found, &format!("by {state} at {instant} s"));
        }
        for (column, slot) in program.parameters().iter().enumerate() {
            if is_at_edge(slot) {
                continue;
            }
            let si = slot.value.abs().max(1e-3 * slot.per_unit);
            let found =
                difference_by_parameter(&machine, &slot.name, slot.value / slot.per_unit, si / slot.per_unit);
            let told = exact.by_parameters.column(column);
            let told: Vec<f64> = told.iter().map(|slope| slope * si).collect();
            compare(&told, &found, &format!("by {} at {instant} s", slot.name));
        }
    }
}

/// Whether a parameter stands at an end of its range, from which it cannot be turned both ways.
fn is_at_edge(slot: &ParameterSlot) -> bool {
    let value = slot.value / slot.per_unit;
    slot.range.is_some_and(|(low, high)| value <= low || value >= high)
}

fn difference_by_state(machine: &Machine<'_>, state: &str, volts: f64) -> Vec<f64> {
    let rates = |volts: f64| {
        let mut moved = machine.clone();
        moved.set_state(state, volts).unwrap_or_else(|error| panic!("{error}"));
        moved.rates().to_vec()
    };
    // Most rates are straight lines of the states: a wide difference keeps rounding out.
    central(rates, volts, 1e-3)
}

/// The difference per share of the parameter, so that every entry is in volts per second.
fn difference_by_parameter(machine: &Machine<'_>, name: &str, value: f64, size: f64) -> Vec<f64> {
    let rates = |share: f64| {
        let mut turned = machine.clone();
        turned.set(name, value + share * size).unwrap_or_else(|error| panic!("{name}: {error}"));
        turned.rates().to_vec()
    };
    central(rates, 0.0, 1e-5)
}

fn central(rates: impl Fn(f64) -> Vec<f64>, at: f64, distance: f64) -> Vec<f64> {
    let (above, below) = (rates(at + distance), rates(at - distance));
    above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * distance)).collect()
}

/// Differences are good to about the square of their distance, 1e-10, and to rounding of rates over distance.
fn compare(told: &[f64], found: &[f64], what: &str) {
    for (row, (told, found)) in told.iter().zip(found).enumerate() {
        let allowed = 1e-7 * (1.0 + told.abs());
        assert!((told - found).abs() <= allowed, "rate {row} {what}: {told} against {found}");
    }
}
