//! Every code of a diagnostic has a bad input, and docs/diagnostics.md lists them all.
//!
//! `PATCHCORD_BLESS=1 cargo test -p patchcord-ident` rewrites the page.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::bad;
use crate::common::files::check_fresh;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Report};
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;

/// Where bad patches are.
const PATCHES: &str = "../core/tests/patches/bad";

/// The report of the phase that refuses the patch, or else the warnings.
fn report(path: &Path) -> Report {
    let judged = |text: &str| -> Result<Report, Box<Report>> {
        let file = path.file_name().unwrap().to_str().unwrap();
        let patch = Patch::parse_in(Path::new(PATCHES), file, text)?;
        let circuit = Circuit::new(&patch, &[])?;
        Program::new(&circuit)?;
        Ok(circuit.warnings())
    };
    judged(&fs::read_to_string(path).unwrap()).unwrap_or_else(|report| *report)
}

fn bad_patches() -> Vec<PathBuf> {
    let paths = fs::read_dir(PATCHES).unwrap().map(|entry| entry.unwrap().path());
    paths.filter(|path| path.extension().unwrap() == "json").collect()
}

#[test]
fn every_code_has_a_bad_patch_or_experiment() {
    let of_patches = bad_patches().into_iter().flat_map(|path| report(&path).findings);
    let of_experiments = bad::bad().into_iter().flat_map(|path| bad::report(&path).findings);
    let shown: HashSet<Code> = of_patches.chain(of_experiments).map(|finding| finding.code).collect();
    let missing: Vec<_> = Code::ALL.iter().filter(|code| !shown.contains(code)).collect();
    assert!(
        missing.is_empty(),
        "no patch in {PATCHES} and no experiment in {} gets {missing:?}",
        bad::FOLDER
    );
}

/// The bad patch whose report opens the page.
const EXAMPLE: &str = "unknown-name-cord";

fn diagnostics_page() -> String {
    let example = report(&Path::new(PATCHES).join(format!("{EXAMPLE}.json")));
    let rows: String = Code::ALL.iter().map(|code| row(*code)).collect();
    format!(
        "# Diagnostics\n\n\
         What patchcord says about a patch that it cannot run, or that it runs with a doubt, and about the experiments of \
         [gap.md](gap.md). All findings come \
         at once, each with a code that never changes, its place in the file, what is wrong, and what to \
         do:\n\n```text\n{example}\n```\n\n\
         An *error* stops the patch; a *warning* does not. With `--json` every finding is an object of `code`, \
         `severity`, `file`, `line`, `column`, `message` and `hint`. The terminal shows the first 50 findings and \
         says how many more there are; `--json` gives all of them. Of a file of data the first ten faults are told: \
         the rest of it is not read then. For every code there are patches in \
         `crates/core/tests/patches/bad`, or experiments in `crates/ident/tests/bad`, named after it, each beside the report that it gets. What keeps a run from beginning or from going \
         on has codes of its own: [patch-format.md](patch-format.md#the-recorded-table) lists them.\n\n\
         | code | severity | meaning | what to do |\n|---|---|---|---|\n{rows}\n\
         This page is written by `PATCHCORD_BLESS=1 cargo test -p patchcord-ident codes`.\n"
    )
}

fn row(code: Code) -> String {
    let (severity, meaning) = (code.severity().as_str(), code.meaning());
    format!("| `{}` | {severity} | {meaning} | {} |\n", code.as_str(), code.advice())
}

#[test]
fn the_page_of_diagnostics_is_not_stale() {
    check_fresh("docs/diagnostics.md", diagnostics_page().as_bytes(), "patchcord-ident");
}
