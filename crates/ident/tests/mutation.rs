//! Randomly mutated experiments and data are either read or rejected with a report. No input causes a panic.

use std::fs;
use std::path::Path;

use crate::common::mutated::mutated;
use crate::common::random::SplitMix64;
use patchcord_ident::{Experiment, ExperimentError, examine};

/// Mutated inputs of each test.
const ROUNDS: usize = 1500;

/// Reads an experiment and checks it or its report. True if it was rejected.
fn is_rejected(folder: &Path, text: &str) -> bool {
    match Experiment::parse_in(folder, "mutated.json", text) {
        Ok(read) => {
            assert!(!read.warnings.has_errors(), "{}", read.warnings);
            assert_consistent(&read);
            false
        }
        Err(ExperimentError::Invalid { experiment, .. }) => {
            assert!(experiment.has_errors(), "rejected without an error:\n{experiment}\n{text}");
            assert!(experiment.findings.iter().all(|finding| finding.span.is_some()), "{experiment}\n{text}");
            true
        }
        Err(error) => panic!("{error}"),
    }
}

/// Asserts what every experiment that was read guarantees: data exist, lengths agree, drives are finite, and each
/// record begins and ends with finite outputs.
fn assert_consistent(experiment: &Experiment) {
    assert!(
        !experiment.outputs.is_empty() && !experiment.train.is_empty() && !experiment.validation.is_empty()
    );
    for record in experiment.train.iter().chain(&experiment.validation) {
        assert!(record.interval.is_normal() && record.begin.is_finite());
        assert_eq!(
            (record.drives.len(), record.outputs.len()),
            (experiment.drives.len(), experiment.outputs.len())
        );
        assert!(record.drives.iter().chain(&record.outputs).all(|samples| samples.len() == record.len()));
        assert!(record.drives.iter().flatten().all(|sample| sample.is_finite()));
        for samples in &record.outputs {
            assert!(samples.iter().all(|sample| !sample.is_infinite()));
            assert!(samples[0].is_finite() && samples[samples.len() - 1].is_finite());
            examine(samples, record.interval);
        }
    }
}

#[test]
fn each_mutated_experiment_is_read_or_rejected() {
    let folder = Path::new("../../examples/05_missing_effect");
    let good = fs::read_to_string(folder.join("slide.experiment.json")).unwrap();
    let mut random = SplitMix64(0x9e37_79b9_7f4a_7c15);
    let rejected = (0..ROUNDS).filter(|_| is_rejected(folder, &mutated(&good, &mut random))).count();
    assert!((ROUNDS / 2..ROUNDS).contains(&rejected), "{rejected} of {ROUNDS} are rejected");
}

#[test]
fn each_mutated_data_file_is_read_or_rejected() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy("tests/base.json", folder.path().join("base.json")).unwrap();
    let good = fs::read_to_string("tests/good.csv").unwrap();
    let experiment =
        r#"{"patch": "base.json", "data": "data.csv", "drives": {"F": "F"}, "outputs": {"x": "x"}}"#;
    let mut random = SplitMix64(0x2545_f491_4f6c_dd1d);
    let mut rejected = 0;
    for _ in 0..ROUNDS {
        fs::write(folder.path().join("data.csv"), mutated(&good, &mut random)).unwrap();
        rejected += usize::from(is_rejected(folder.path(), experiment));
    }
    assert!((ROUNDS / 4..ROUNDS).contains(&rejected), "{rejected} of {ROUNDS} are rejected");
}
