//! Fits and searches that are cancelled, and the trials that a search reports.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::library;
use patchcord_ident::effects::Library;
use patchcord_ident::{
    Experiment, ModelError, Outcome, Problem, Progress, SearchPhase, SearchSettings, TrialResult, fit_base,
    search,
};

/// The experiment of docs/gap.md: a spring that lacks its damping.
const SPRING: &str = "../../examples/05_missing_effect/spring.experiment.json";

/// The result of a search on two threads with a flag that `progress` may set, and all reports.
fn search_with_flag(
    library: &Library,
    is_set: bool,
    progress: impl Fn(&Progress) -> bool + Sync,
) -> (Result<Option<Outcome>, ModelError>, Vec<Progress>) {
    let experiment = Experiment::read(SPRING).unwrap_or_else(|error| panic!("{error}"));
    let cancel = Arc::new(AtomicBool::new(is_set));
    let problem = Problem::of(&experiment).unwrap().with_cancel(&cancel);
    let settings = SearchSettings::new(library).with_threads(2);
    let mut reports = Vec::new();
    let outcome = search(&experiment, &problem, &settings, |report| {
        cancel.fetch_or(progress(&report), Ordering::Relaxed);
        reports.push(report);
    });
    (outcome, reports)
}

#[test]
fn a_search_that_is_cancelled_before_its_start_fits_nothing() {
    let (outcome, reports) = search_with_flag(&Library::shipped(), true, |_| false);
    assert!(matches!(outcome, Err(ModelError::Cancelled)));
    assert!(reports.iter().all(|report| report.phase == SearchPhase::Base), "{reports:?}");
}

#[test]
fn a_fit_can_be_cancelled() {
    let experiment = Experiment::read(SPRING).unwrap_or_else(|error| panic!("{error}"));
    let cancel = Arc::new(AtomicBool::new(true));
    let problem = Problem::of(&experiment).unwrap().with_cancel(&cancel);
    let fit = || fit_base(&problem, &experiment.patch, &experiment.fit, 1);
    assert!(matches!(fit(), Err(ModelError::Cancelled)));
    cancel.store(false, Ordering::Relaxed);
    assert!(fit().unwrap().is_some());
}

/// At most the trial that the other thread was completing is reported after the flag was set.
#[test]
fn a_search_that_is_cancelled_during_the_trials_ends_with_them() {
    let (outcome, reports) = search_with_flag(&Library::shipped(), false, |report| report.trial.is_some());
    assert!(matches!(outcome, Err(ModelError::Cancelled)));
    let first = reports.iter().position(|report| report.trial.is_some()).unwrap();
    assert!(reports[first].phase == SearchPhase::Quick && reports[first].total > 10, "{reports:?}");
    assert!(reports.len() - first <= 2, "{:?}", &reports[first..]);
}

#[test]
fn a_search_can_be_cancelled_in_each_phase() {
    let library = library::with_effects(&["viscous-friction", "coulomb-friction", "constant-bias"]);
    for phase in [SearchPhase::Base, SearchPhase::Quick, SearchPhase::Full] {
        let (outcome, reports) = search_with_flag(&library, false, |report| report.phase == phase);
        assert!(matches!(outcome, Err(ModelError::Cancelled)), "{phase:?}");
        assert_eq!(reports.last().map(|report| report.phase), Some(phase));
    }
}

/// A flag that is never set does not change the result.
#[test]
fn every_trial_is_reported_with_its_residual() {
    let library = library::with_effects(&["viscous-friction", "coulomb-friction", "constant-bias"]);
    let (outcome, reports) = search_with_flag(&library, false, |_| false);
    let outcome = outcome.unwrap().unwrap();
    assert_eq!(outcome.verdict.as_str(), "named");
    let of_phase =
        |phase: SearchPhase| reports.iter().filter(move |report| report.round == 1 && report.phase == phase);
    assert!(reports.iter().all(|report| report.trial.is_some() == (report.done > 0)), "{reports:?}");
    // A round may be repeated. It reports its beginning and every trial.
    assert_eq!(of_phase(SearchPhase::Quick).count() as u64 % (1 + reports[1].total), 0);
    // The residual of a trial decreases from the quick fit to the full one.
    let smallest = |phase: SearchPhase| {
        let trials = of_phase(phase).filter_map(|report| report.trial.as_ref());
        let fitted =
            trials.filter_map(|TrialResult { effect, residual_rms, .. }| Some((effect, (*residual_rms)?)));
        fitted.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
    };
    let [(_, quick), (best, full)] = [SearchPhase::Quick, SearchPhase::Full].map(smallest);
    assert!(full <= quick, "{full} {quick}");
    assert_eq!(*best, outcome.effects[0].placed_effect());
    let reported = outcome.rounds[0].trials[0].model.train.normalised_rms();
    assert!((full - reported).abs() < 0.01, "{full} {reported}");
}
