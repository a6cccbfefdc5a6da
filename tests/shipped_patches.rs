//! Every patch that comes with the program can be run as it stands.

use std::thread;

use patchcord::circuit::Circuit;
use patchcord::ir::Program;
use patchcord::patch::Patch;
use patchcord::solve::{self, RunSettings};

fn every_patch() -> Vec<Patch> {
    crate::common::files::shipped().iter().map(|file| crate::common::patch_of(file)).collect()
}

fn circuit(patch: &Patch) -> Circuit {
    crate::common::circuit(patch, &[])
}

#[test]
fn shipped_patches_give_neither_errors_nor_warnings() {
    for patch in every_patch() {
        let warnings = circuit(&patch).warnings();
        assert!(warnings.findings.is_empty(), "{warnings}");
    }
}

#[test]
fn shipped_patches_run_without_overload() {
    let patches = every_patch();
    thread::scope(|scope| {
        for patch in &patches {
            scope.spawn(|| runs_without_overload(patch));
        }
    });
}

/// Runs a patch as it stands, from beginning to end.
fn runs_without_overload(patch: &Patch) {
    let circuit = circuit(patch);
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let trace = solve::run(&program, &RunSettings::of(&circuit).unwrap());
    let trace = trace.unwrap_or_else(|error| panic!("{}: {error}", patch.file()));
    assert_eq!(trace.overloads().count(), 0, "{}: {:?}", patch.file(), trace.sweeps);
}

/// Less of no schematic is used: emptiness hides how a circuit hangs together.
const LEAST_USED: f64 = 0.5;

#[test]
fn every_shipped_patch_is_drawn() {
    for patch in every_patch() {
        let circuit = circuit(&patch);
        crate::drawn::check(&circuit, patch.file());
        for diagram in crate::drawn::diagrams(&crate::drawn::schematic(&circuit)) {
            let used = crate::drawn::marks::used_share(diagram);
            assert!(used > LEAST_USED, "{}: {used} of the drawing is used", patch.file());
        }
    }
}
