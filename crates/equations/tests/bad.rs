//! Patches whose wiring does not solve their equations, typical mistakes of beginners, and problems that cannot be
//! scaled or whose patch differs from them.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use crate::files::{assert_up_to_date, json_files_in, repository_path};
use crate::problem_files::problem_file;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Report};
use patchcord_core::ir::Program;
use patchcord_core::machines;
use patchcord_core::patch::{Patch, Problem};
use patchcord_equations::{
    ScaleError, ScaleOptions, codes, compare_equations, equation_findings, scale_problem,
};

/// The patches of a folder of this crate's tests.
fn patches(folder: &str) -> Vec<PathBuf> {
    json_files_in(&repository_path("crates/equations/tests/patches").join(folder))
}

/// The findings about a patch: those of its check, or else those of its equations.
fn report(path: &Path) -> Report {
    let text = std::fs::read_to_string(path).unwrap();
    let file = path.file_name().unwrap().to_str().unwrap();
    let checked = || -> Result<Report, Box<Report>> {
        let patch = Patch::parse(file, &text)?;
        let circuit = Circuit::new(&patch)?;
        let program = Program::new(&circuit)?;
        let mut findings = circuit.warnings().findings;
        let compared = compare_equations(&circuit, &program);
        findings.extend(equation_findings(&circuit, &program, &compared));
        Ok(Report::new(patch.file(), patch.text(), findings))
    };
    checked().unwrap_or_else(|report| *report)
}

/// The bad problems.
fn problems() -> Vec<PathBuf> {
    json_files_in(&repository_path("crates/equations/tests/problems"))
}

/// The faults of a problem that cannot be scaled, or the warnings about one whose patch differs from it.
fn problem_report(path: &Path) -> Report {
    let text = std::fs::read_to_string(path).unwrap();
    let file = path.file_name().unwrap().to_str().unwrap();
    let problem = Problem::parse(file, &text).unwrap_or_else(|report| panic!("{report}"));
    match scale_problem(&problem, &ScaleOptions::default()) {
        Err(ScaleError::Problem(report)) => *report,
        Err(error) => panic!("{file}: {error}"),
        Ok(scaled) if scaled.warnings.findings.is_empty() => panic!("{file} has a patch"),
        Ok(scaled) => scaled.warnings,
    }
}

/// The warnings about a problem that needs more parts than the machine has.
fn report_on_small_machine() -> Report {
    let problem = Problem::read(problem_file("projectile")).unwrap_or_else(|error| panic!("{error}"));
    let machine = machines::find("solartron-1451").unwrap();
    let options = ScaleOptions { machine, ..ScaleOptions::default() };
    scale_problem(&problem, &options).unwrap_or_else(|error| panic!("{error}")).warnings
}

#[test]
fn every_bad_problem_has_its_report() {
    for path in problems() {
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let expected = format!("crates/equations/tests/problems/{stem}.txt");
        let report = format!("{}\n", problem_report(&path));
        assert_up_to_date(&expected, report.as_bytes(), "patchcord-equations");
    }
}

#[test]
fn every_bad_patch_has_its_report() {
    for folder in ["bad", "traps"] {
        for path in patches(folder) {
            let stem = path.file_stem().unwrap().to_str().unwrap();
            let expected = format!("crates/equations/tests/patches/{folder}/{stem}.txt");
            assert_up_to_date(&expected, format!("{}\n", report(&path)).as_bytes(), "patchcord-equations");
        }
    }
}

#[test]
fn every_code_has_a_bad_patch_or_problem() {
    let of_patches = patches("bad").into_iter().flat_map(|path| report(&path).findings);
    let of_problems = problems().into_iter().flat_map(|path| problem_report(&path).findings);
    let of_machine = report_on_small_machine().findings;
    let found = of_patches.chain(of_problems).chain(of_machine);
    let found: HashSet<Code> = found.map(|finding| finding.code).collect();
    for code in codes::ALL {
        assert!(found.contains(code), "{}", code.as_str());
    }
}

/// The mistakes of the traps and a part of the report that names the cause first.
#[test]
fn the_first_change_names_the_mistake() {
    let cases = [
        ("car2", "put an inverter between road and T"),
        ("g1", "plug P1 into x10 of A1 in place of x1"),
        ("g2", "plug B1 into P1 in place of A2"),
        ("g6c", "give the scale velocity the unit mm/s"),
        ("lv2", "put an inverter between A1 and PA"),
    ];
    for (trap, cause) in cases {
        let path = repository_path("crates/equations/tests/patches/traps").join(format!("{trap}.json"));
        let report = report(&path);
        let hint = report.findings[0].advice().to_owned();
        let (_, fixes) = hint.split_once("corrects it: ").unwrap_or_else(|| panic!("{trap}: {hint}"));
        assert!(fixes.starts_with(cause), "{trap}: {fixes}");
    }
}
