//! Every patch that comes with the program can be run as it stands.

mod drawn;

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;

use patchcord::circuit::Circuit;
use patchcord::patch::Patch;
use patchcord::program::Program;
use patchcord::solve::{self, RunSettings};

/// Fragments, which run only once they are attached to something.
const FRAGMENTS: &str = "effects";

fn patches_in(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != FRAGMENTS) {
            found.extend(patches_in(&path));
        } else if path.extension().is_some_and(|extension| extension == "json") {
            found.push(path);
        }
    }
    found
}

fn every_patch() -> Vec<Patch> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("patches");
    let patches = patches_in(&folder);
    assert!(patches.len() >= 5, "{patches:?}");
    patches.iter().map(|path| Patch::read(path).unwrap_or_else(|error| panic!("{error}"))).collect()
}

fn circuit(patch: &Patch) -> Circuit {
    Circuit::new(patch, &[]).unwrap_or_else(|report| panic!("{report}"))
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
        drawn::check(&circuit, patch.file());
        for diagram in drawn::diagrams(&drawn::schematic(&circuit)) {
            let used = drawn::marks::used_share(diagram);
            assert!(used > LEAST_USED, "{}: {used} of the drawing is used", patch.file());
        }
    }
}
