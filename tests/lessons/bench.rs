//! What the tests of lessons share: reading a lesson, running it, and waiting for a voltage to pass 0.

use std::path::Path;

use patchcord::circuit::Circuit;
use patchcord::patch::Patch;
use patchcord::program::Program;
use patchcord::solve::{self, Machine, RunSettings};
use patchcord::trace::Trace;

use crate::common::{self, root};

/// A patch of patches/lessons.
pub fn lesson(stem: &str) -> Patch {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("patches/lessons/{stem}.json"));
    Patch::read(&path).unwrap_or_else(|error| panic!("{error}"))
}

/// A lesson's program, with parameters changed.
pub fn program(stem: &str, changes: &[(&str, f64)]) -> Program {
    common::program(&lesson(stem), changes)
}

/// The step that a lesson asks for.
pub fn step_of(stem: &str) -> f64 {
    RunSettings::of(&common::circuit(&lesson(stem), &[])).unwrap().step
}

/// The lesson's own run, with parameters changed and for a time of its own.
pub fn trace(stem: &str, changes: &[(&str, f64)], duration: f64) -> Trace {
    let circuit: Circuit = common::circuit(&lesson(stem), changes);
    let settings = RunSettings::of(&circuit).unwrap().lasting(duration);
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    solve::run(&program, &settings).unwrap_or_else(|error| panic!("{error}"))
}

/// A signal of a trace in the unit of its scale.
pub fn values(trace: &Trace, signal: &str) -> Vec<f64> {
    trace.values(signal).unwrap_or_else(|| panic!("{signal} is not recorded"))
}

/// Runs on until a reading rises through 0, leaves the machine there, and tells the time.
pub fn next_rise<'p>(machine: &mut Machine<'p>, reading: impl Fn(&Machine<'p>) -> f64) -> f64 {
    let stretch = machine.step();
    for _ in 0..1_000_000 {
        let before = machine.clone();
        machine.operate(stretch).unwrap_or_else(|error| panic!("{error}"));
        if reading(&before) < 0.0 && reading(machine) >= 0.0 {
            let after = |length: f64| {
                let mut there = before.clone();
                there.operate(length).unwrap_or_else(|error| panic!("{error}"));
                there
            };
            *machine = after(root(|length| reading(&after(length)), 0.0, stretch));
            return machine.time();
        }
    }
    panic!("it never rises through 0")
}
