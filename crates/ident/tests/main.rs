//! Integration tests of patchcord-ident: experiments, effects and searches.
//!
//! The tests in this file compare each bad experiment in `tests/bad` with its expected report, the `.txt` file of the
//! same name. `PATCHCORD_BLESS=1 cargo test -p patchcord-ident` rewrites the reports.

mod bad;
mod cancellation;
mod codes;
#[path = "../../core/tests/common/mod.rs"]
mod common;
mod custom_effect;
mod detectability;
mod discriminating_experiment;
mod divergence;
#[path = "../../core/tests/known_problems/equations.rs"]
mod equations;
mod experiment_reading;
mod given_files;
mod graft;
mod library;
mod localisation;
mod measured;
mod misspecification;
mod mutation;
mod noise;
mod oscillator;
mod provenance;
mod report_page;
mod residual_analysis;
mod runge_kutta;
mod search;
mod story;

use std::collections::HashSet;
use std::fs;

use patchcord_ident::{Experiment, ExperimentError};

#[test]
fn each_bad_experiment_gets_its_expected_report() {
    for path in bad::experiments() {
        let report = match Experiment::read(&path) {
            Ok(experiment) => format!("{}\n", experiment.warnings),
            Err(error) => format!("{error}\n"),
        };
        let report_path = path.with_extension("txt");
        if std::env::var_os("PATCHCORD_BLESS").is_some() {
            fs::write(&report_path, &report).unwrap();
        }
        let expected = fs::read_to_string(&report_path).unwrap_or_default();
        assert_eq!(expected, report, "PATCHCORD_BLESS=1 rewrites {}", report_path.display());
    }
}

#[test]
fn the_name_of_each_bad_experiment_begins_with_its_diagnostic_code() {
    for path in bad::experiments() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let report = bad::report(&path);
        assert!(report.findings.iter().all(|finding| finding.span.is_some()), "{report}");
        let codes: HashSet<_> = report.findings.iter().map(|finding| finding.code.as_str()).collect();
        if name.starts_with("many-") {
            assert!(codes.len() > 4, "{report}");
            continue;
        }
        assert_eq!(codes.len(), 1, "{name} must get exactly one code:\n{report}");
        assert!(codes.iter().all(|code| name.starts_with(code)), "{name} gets {codes:?}");
    }
}

#[test]
fn the_experiments_of_the_gap_page_are_valid() {
    let page = fs::read_to_string("../../docs/gap.md").unwrap();
    let [spring, slide] =
        ["spring", "slide"].map(|name| format!("../../examples/05_missing_effect/{name}.experiment.json"));
    for file in [&spring, &slide] {
        let text = fs::read_to_string(file).unwrap();
        assert!(page.contains(&format!("```json\n{text}```")), "docs/gap.md does not quote {file}");
    }
    let experiment = Experiment::read(&slide).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(experiment.warnings.to_string(), "");
    assert_eq!(experiment.fit, ["M", "f"]);
    let lengths = [&experiment.train[0], &experiment.validation[0]].map(|record| record.len());
    assert_eq!((lengths, experiment.outputs[0].sigma), ([251, 150], Some(2e-4)));
}

#[test]
fn the_error_for_a_missing_experiment_names_its_path() {
    let error = Experiment::read("no/such/experiment.json").unwrap_err();
    assert!(matches!(error, ExperimentError::File(_)));
    assert!(error.to_string().starts_with("cannot read no/such/experiment.json"), "{error}");
}

#[test]
fn too_few_rows_are_reported_with_a_missing_column() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("e.json");
    fs::copy("tests/base.json", folder.path().join("base.json")).unwrap();
    let experiment =
        r#"{"patch": "base.json", "data": "data.csv", "drives": {"F": "G"}, "outputs": {"x": "x"}}"#;
    fs::write(&path, experiment).unwrap();
    for rows in ["", "0,1,2\n"] {
        fs::write(folder.path().join("data.csv"), format!("t,F,x\n{rows}")).unwrap();
        let report = bad::report(&path);
        let codes: HashSet<_> = report.findings.iter().map(|finding| finding.code.as_str()).collect();
        assert_eq!(codes, HashSet::from(["bad-data", "too-few-samples"]), "{report}");
    }
}
