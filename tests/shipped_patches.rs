//! Every shipped patch can be checked, run and drawn without changes.

use std::thread;

use patchcord::circuit::Circuit;
use patchcord::ir::Program;
use patchcord::patch::Patch;
use patchcord::solve::{self, RunSettings};

fn every_patch() -> Vec<Patch> {
    crate::common::files::shipped_files().iter().map(|file| crate::common::patch_of(file)).collect()
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
            scope.spawn(|| check_run(patch));
        }
    });
}

/// Runs a patch and checks that nothing overloads.
fn check_run(patch: &Patch) {
    let circuit = circuit(patch);
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let trace = solve::run(&program, &RunSettings::of(&circuit).unwrap());
    let trace = trace.unwrap_or_else(|error| panic!("{}: {error}", patch.file()));
    assert_eq!(trace.overloads().count(), 0, "{}: {:?}", patch.file(), trace.repetitions);
}

/// The smallest fraction of a drawing that a schematic must use. Empty space hides the structure of a circuit.
const MIN_USED: f64 = 0.5;

#[test]
fn every_shipped_patch_is_drawn() {
    for patch in every_patch() {
        let circuit = circuit(&patch);
        crate::schematic_checks::check(&circuit, patch.file());
        for diagram in crate::schematic_checks::diagrams(&crate::schematic_checks::schematic(&circuit)) {
            let used = crate::schematic_checks::legibility::used_fraction(diagram);
            assert!(used > MIN_USED, "{}: {used} of the drawing is used", patch.file());
        }
    }
}
