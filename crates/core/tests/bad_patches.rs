//! Every bad patch of tests/patches/bad gets the report that is stored next to it.
//!
//! `PATCHCORD_BLESS=1 cargo test -p patchcord-core` rewrites the reports.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::common::mutated::mutated;
use crate::common::random::SplitMix64;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, DocumentError, Report};
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;

const FOLDER: &str = "tests/patches/bad";

/// The name of every bad patch with the report of the first phase that refuses it, or its warnings if none does.
static REPORTS: LazyLock<Vec<(String, Report)>> = LazyLock::new(|| {
    let paths = fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path());
    let mut patches: Vec<PathBuf> = paths.filter(|path| path.extension().unwrap() == "json").collect();
    patches.sort();
    let report = |path: PathBuf| {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let text = fs::read_to_string(&path).unwrap();
        let report = check(&format!("{name}.json"), &text, &[]).unwrap_or_else(|report| *report);
        (name, report)
    };
    patches.into_iter().map(report).collect()
});

/// Checks a patch text through all phases and returns its warnings.
///
/// # Errors
///
/// The report of the phase that refuses it.
fn check(file: &str, text: &str, changes: &[(String, f64)]) -> Result<Report, Box<Report>> {
    let patch = Patch::parse_in(Path::new(FOLDER), file, text)?;
    let circuit = Circuit::with_parameters(&patch, changes.iter().cloned())?;
    Program::new(&circuit)?;
    Ok(circuit.warnings())
}

/// The difference between a text and a file, or None if they are equal. Writes the file first if PATCHCORD_BLESS is
/// set.
fn difference(path: &Path, found: &str) -> Option<String> {
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        fs::write(path, found).unwrap();
    }
    let expected = fs::read_to_string(path).unwrap_or_default();
    let message = format!("== {}\n-- expected\n{expected}\n-- found\n{found}", path.display());
    (expected != found).then_some(message)
}

#[test]
fn every_bad_patch_gets_its_report() {
    let differences: Vec<String> = REPORTS
        .iter()
        .filter_map(|(name, report)| {
            let path = Path::new(FOLDER).join(format!("{name}.txt"));
            difference(&path, &format!("{report}\n"))
        })
        .collect();
    assert!(differences.is_empty(), "PATCHCORD_BLESS=1 accepts these\n{}", differences.join("\n"));
}

#[test]
fn every_report_has_findings_with_a_position() {
    assert!(REPORTS.len() >= 45, "only {} bad patches", REPORTS.len());
    for (name, report) in REPORTS.iter() {
        assert!(!report.findings.is_empty(), "{name} is accepted");
        assert!(report.findings.iter().all(|finding| finding.span.is_some()), "{name}:\n{report}");
    }
}

#[test]
fn the_name_of_a_bad_patch_begins_with_the_code_of_its_report() {
    for (name, report) in REPORTS.iter().filter(|(name, _)| !name.starts_with("many-")) {
        let codes: HashSet<_> = report.findings.iter().map(|finding| finding.code.as_str()).collect();
        assert_eq!(codes.len(), 1, "the report of {name} must have one code:\n{report}");
        assert!(
            codes.iter().all(|code| name.starts_with(code)),
            "the report of {name} has the codes {codes:?}"
        );
    }
}

#[test]
fn bytes_that_are_not_utf8_are_reported_with_their_position() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("latin.json");
    fs::write(&path, b"{\n  \"patchcord\": 1,\n  \"title\": \"\xe9tude\"\n}\n").unwrap();
    let Err(DocumentError::Text(report)) = Patch::read(&path) else { panic!("latin 1 is accepted") };
    let [finding] = report.findings.as_slice() else { panic!("one finding is expected:\n{report}") };
    assert_eq!((finding.code, report.line_and_column(finding.span.unwrap().start)), (Code::SYNTAX, (3, 13)));
    assert!(finding.hint.as_ref().unwrap().contains("UTF-8"));
}

#[test]
fn a_missing_file_is_named() {
    let error = Patch::read("no/such/patch.json").unwrap_err();
    assert!(error.to_string().starts_with("cannot read no/such/patch.json"), "{error}");
}

/// The codes and messages of the report on changed parameters of a valid patch.
fn findings_of_changes(changes: &[(&str, f64)]) -> Vec<(Code, String)> {
    let changes: Vec<_> = changes.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let Err(report) = check("fig-8-16.json", &good_patch(), &changes) else { return Vec::new() };
    assert!(report.findings.iter().all(|finding| finding.hint.is_some()), "{report}");
    report.findings.into_iter().map(|finding| (finding.code, finding.message)).collect()
}

#[test]
fn changed_parameters_are_checked_like_the_patch() {
    assert!(findings_of_changes(&[("M", 600.0)]).is_empty());
    let findings = findings_of_changes(&[("M", f64::NAN), ("Vcl", 1e-3), ("K", 1e12), ("f", f64::INFINITY)]);
    let codes: Vec<_> = findings.iter().map(|(code, _)| *code).collect();
    for code in [Code::NOT_FINITE, Code::UNKNOWN_NAME, Code::OUTSIDE_RANGE] {
        assert!(codes.contains(&code), "{findings:?}");
    }
    assert_eq!(findings.len(), 4, "{findings:?}");
}

#[test]
fn a_changed_parameter_can_move_a_setting_out_of_its_range() {
    let text = fs::read_to_string(Path::new(FOLDER).join("setting-range.json")).unwrap();
    let report = check("setting-range.json", &text, &[("T".to_owned(), 0.05)]).unwrap_err();
    let outside = report.findings.iter().filter(|finding| finding.code == Code::SETTING_OUTSIDE);
    assert_eq!(outside.count(), 2, "{report}");
}

fn good_patch() -> String {
    fs::read_to_string("../../patches/thesis/fig-8-16.json").unwrap()
}

/// Asserts that a report that refuses a patch has an error, and that its positions are inside the text.
fn check_refusal(report: &Report, text: &str) {
    assert!(report.has_errors(), "refused without an error:\n{report}\n{text}");
    assert!(report.findings.iter().all(|finding| finding.span.is_some()), "{report}\n{text}");
    let lines = report.text.lines().count() + 1;
    assert!(report.documents().iter().all(|finding| finding.line.unwrap() <= lines));
}

/// Checks random mutations of a valid patch. At least half of them are refused.
fn mutate(good: &str, rounds: usize) {
    let mut random = SplitMix64(0x9e37_79b9_7f4a_7c15);
    let mut refused = 0;
    for _ in 0..rounds {
        let text = mutated(good, &mut random);
        match check("mutated.json", &text, &[]) {
            Err(report) => {
                refused += 1;
                check_refusal(&report, &text);
            }
            Ok(warnings) => assert!(!warnings.has_errors(), "{warnings}"),
        }
    }
    assert!((rounds / 2..rounds).contains(&refused), "{refused} of {rounds} are refused");
}

#[test]
fn mutated_patches_get_a_report_or_a_circuit() {
    mutate(&good_patch(), 4000);
}

#[test]
fn mutated_macros_get_a_report_or_a_circuit() {
    mutate(&fs::read_to_string("tests/patches/lags-in-macros.json").unwrap(), 4000);
}
