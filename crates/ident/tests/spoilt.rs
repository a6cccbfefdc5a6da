//! Whatever happens to an experiment or its data, it is read or told what is wrong with it.

use std::fs;
use std::path::Path;

use crate::common::mutated::{Dice, mutated};
use patchcord_ident::{Experiment, ExperimentError, examine};

const ROUNDS: usize = 1500;

/// Looks at what was read of a text; whether it was refused.
fn is_refused(folder: &Path, text: &str) -> bool {
    match Experiment::parse_in(folder, "spoilt.json", text) {
        Ok(made) => {
            assert!(!made.warnings.has_errors(), "{}", made.warnings);
            check(&made);
            false
        }
        Err(ExperimentError::Wrong { experiment, .. }) => {
            assert!(experiment.has_errors(), "refused without an error:\n{experiment}\n{text}");
            assert!(experiment.findings.iter().all(|finding| finding.span.is_some()), "{experiment}\n{text}");
            true
        }
        Err(error) => panic!("{error}"),
    }
}

/// What is promised of every experiment.
fn check(made: &Experiment) {
    assert!(!made.outputs.is_empty() && !made.train.is_empty() && !made.test.is_empty());
    for record in made.train.iter().chain(&made.test) {
        assert!(record.interval.is_normal() && record.begin.is_finite());
        assert_eq!((record.drives.len(), record.outputs.len()), (made.drives.len(), made.outputs.len()));
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
fn a_spoilt_experiment_is_read_or_refused() {
    let good = fs::read_to_string("tests/slide.json").unwrap();
    let mut dice = Dice(0x9e37_79b9_7f4a_7c15);
    let refused = (0..ROUNDS).filter(|_| is_refused("tests".as_ref(), &mutated(&good, &mut dice))).count();
    assert!((ROUNDS / 2..ROUNDS).contains(&refused), "{refused} of {ROUNDS} are refused");
}

#[test]
fn spoilt_data_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy("tests/base.json", folder.path().join("base.json")).unwrap();
    let good = fs::read_to_string("tests/good.csv").unwrap();
    let experiment =
        r#"{"patch": "base.json", "data": "data.csv", "drives": {"F": "F"}, "outputs": {"x": "x"}}"#;
    let mut dice = Dice(0x2545_f491_4f6c_dd1d);
    let mut refused = 0;
    for _ in 0..ROUNDS {
        fs::write(folder.path().join("data.csv"), mutated(&good, &mut dice)).unwrap();
        refused += usize::from(is_refused(folder.path(), experiment));
    }
    assert!((ROUNDS / 4..ROUNDS).contains(&refused), "{refused} of {ROUNDS} are refused");
}
