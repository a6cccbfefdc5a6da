//! Each diagnostic code has at least one bad patch or bad experiment, and docs/diagnostics.md lists all codes.
//!
//! The tests are in this crate because it sees both the patches of core and its experiments.
//! `PATCHCORD_BLESS=1 cargo test -p patchcord-ident` rewrites the page.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::bad;
use crate::common::files::assert_up_to_date;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Report};
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_ident::codes;

/// Folder of the bad patches, relative to this package.
const PATCHES: &str = "../core/tests/patches/bad";

/// The report of the first phase that rejects the patch (parsing, resolving, lowering), or its warnings if none does.
fn report(path: &Path) -> Report {
    let checked = |text: &str| -> Result<Report, Box<Report>> {
        let file = path.file_name().unwrap().to_str().unwrap();
        let patch = Patch::parse_in(Path::new(PATCHES), file, text)?;
        let circuit = Circuit::new(&patch)?;
        Program::new(&circuit)?;
        Ok(circuit.warnings())
    };
    checked(&fs::read_to_string(path).unwrap()).unwrap_or_else(|report| *report)
}

/// The paths of all bad patches.
fn bad_patches() -> Vec<PathBuf> {
    let paths = fs::read_dir(PATCHES).unwrap().map(|entry| entry.unwrap().path());
    paths.filter(|path| path.extension().unwrap() == "json").collect()
}

#[test]
fn every_code_has_a_bad_patch_or_experiment() {
    let of_patches = bad_patches().into_iter().flat_map(|path| report(&path).findings);
    let of_experiments = bad::experiments().into_iter().flat_map(|path| bad::report(&path).findings);
    let covered: HashSet<Code> = of_patches.chain(of_experiments).map(|finding| finding.code).collect();
    let codes = Code::ALL.iter().chain(codes::ALL);
    let missing: Vec<_> = codes.filter(|code| !covered.contains(code)).collect();
    assert!(
        missing.is_empty(),
        "no patch in {PATCHES} and no experiment in {} gets {missing:?}",
        bad::FOLDER
    );
}

/// The codes of patches, then those of equations and of the linear analysis, which have tests of their own, then those of
/// experiments.
fn all_codes() -> impl Iterator<Item = &'static Code> {
    let others = patchcord_equations::codes::ALL.iter().chain(patchcord_analysis::linear::codes::ALL);
    Code::ALL.iter().chain(others).chain(codes::ALL)
}

/// The bad patch whose report is the example at the top of the page.
const EXAMPLE: &str = "unknown-name-cord";

/// The text of docs/diagnostics.md.
fn diagnostics_page() -> String {
    let example = report(&Path::new(PATCHES).join(format!("{EXAMPLE}.json")));
    let rows: String = all_codes().map(|code| table_row(*code)).collect();
    format!(
        "# Diagnostics\n\n\
         This page lists every diagnostic code of patches and of the experiments of [gap.md](gap.md). It is for \
         readers and scripts that process a report. All findings are reported at once. Each has a code that never \
         changes, its place in the file, the error, and the remedy:\n\n```text\n{example}\n```\n\n\
         An *error* stops the patch; a *warning* does not. Only `patchcord check` compares the wiring with stated \
         equations. With `--json` every finding is an object of `code`, \
         `severity`, `file`, `line`, `column`, `message` and `hint`. The terminal shows the first 50 findings and \
         the number of the others; `--json` gives all of them. In a file of data the first ten faults are reported, \
         and the rest of the file is not read.\n\n\
         Every code has bad patches in `crates/core/tests/patches/bad`, `crates/equations/tests/patches/bad` or \
         `tests/traps`, bad problems in `crates/equations/tests/problems`, or bad experiments in \
         `crates/ident/tests/bad`. They are named after the code or the fault, and the expected report is next to each. \
         Errors that keep a run from beginning or stop it have separate codes: \
         [patch-format.md](patch-format.md#the-recorded-table) lists them.\n\n\
         | code | severity | meaning | what to do |\n|---|---|---|---|\n{rows}\n\
         This page is written by `PATCHCORD_BLESS=1 cargo test -p patchcord-ident codes`.\n"
    )
}

/// The row of the page's table for a code.
fn table_row(code: Code) -> String {
    let (severity, meaning) = (code.severity().as_str(), code.meaning());
    format!("| `{}` | {severity} | {meaning} | {} |\n", code.as_str(), code.advice())
}

#[test]
fn the_diagnostics_page_is_up_to_date() {
    assert_up_to_date("docs/diagnostics.md", diagnostics_page().as_bytes(), "patchcord-ident");
}
