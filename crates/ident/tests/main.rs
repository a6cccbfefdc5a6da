//! Experiments: what is read of good ones, and bad ones beside the reports that they must get.
//!
//! `PATCHCORD_BLESS=1 cargo test -p patchcord-ident` rewrites the reports.

mod bad;
mod codes;
#[path = "../../core/tests/common/mod.rs"]
mod common;
#[path = "../../core/tests/known/equations.rs"]
mod equations;
mod graft;
mod integrated;
mod library;
mod limits;
mod measured;
mod mistold;
mod noise;
mod oscillator;
mod own;
mod page;
mod provenance;
mod reading;
mod runaway;
mod search;
mod separate;
mod spoilt;
mod story;
mod unrest;
mod r#where;

use std::collections::HashSet;
use std::fs;

use patchcord_ident::{Experiment, ExperimentError};

#[test]
fn every_bad_experiment_gets_its_report() {
    for path in bad::bad() {
        let found = match Experiment::read(&path) {
            Ok(experiment) => format!("{}\n", experiment.warnings),
            Err(error) => format!("{error}\n"),
        };
        let beside = path.with_extension("txt");
        if std::env::var_os("PATCHCORD_BLESS").is_some() {
            fs::write(&beside, &found).unwrap();
        }
        let expected = fs::read_to_string(&beside).unwrap_or_default();
        assert_eq!(expected, found, "PATCHCORD_BLESS=1 accepts {}", beside.display());
    }
}

#[test]
fn an_experiment_is_called_bad_after_what_is_wrong_with_it() {
    for path in bad::bad() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let report = bad::report(&path);
        assert!(report.findings.iter().all(|finding| finding.span.is_some()), "{report}");
        let codes: HashSet<_> = report.findings.iter().map(|finding| finding.code.as_str()).collect();
        if name.starts_with("many-") {
            assert!(codes.len() > 4, "{report}");
            continue;
        }
        assert_eq!(codes.len(), 1, "{name} has one thing wrong, and is told of several:\n{report}");
        assert!(codes.iter().all(|code| name.starts_with(code)), "{name} is told of {codes:?}");
    }
}

#[test]
fn the_experiment_of_the_page_is_right() {
    let page = fs::read_to_string("../../docs/gap.md").unwrap();
    let shown = page.split("```json\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    assert_eq!(shown, fs::read_to_string("tests/slide.json").unwrap());
    let made = Experiment::read("tests/slide.json".as_ref()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((made.warnings.to_string().as_str(), made.fit), ("", vec!["M".to_owned(), "f".to_owned()]));
    assert_eq!((made.train[0].len(), made.test[0].len(), made.outputs[0].sigma), (251, 150, Some(2e-4)));
}

#[test]
fn an_experiment_that_is_not_there_is_named() {
    let error = Experiment::read("no/such/experiment.json".as_ref()).unwrap_err();
    assert!(matches!(error, ExperimentError::File(_)));
    assert!(error.to_string().starts_with("cannot read no/such/experiment.json"), "{error}");
}
