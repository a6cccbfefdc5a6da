//! Tests of the comparison of trials and of the decisions of a round.

use crate::effects::attach::EffectPlacement;
use crate::fit::base_fit::fit_base;
use crate::fit::extended_model::find_sites;
use crate::fit::extended_model::fit_trial;
use crate::fit::signal_extents::signal_extents;
use std::path::Path;

use super::*;
use crate::Experiment;
use crate::effects::Library;
use crate::fit::extended_model::TrialRequest;
use crate::fit::problem::Problem;
use crate::fit::schedule::Effort;

/// A quickly fitted trial of a saturation, on data in which a saturation is missing. The tests change copies of
/// it.
fn template() -> (Candidate, FittedModel) {
    let path = Path::new("tests/hidden/saturation/experiment.json");
    let experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
    let problem = Problem::of(&experiment).unwrap();
    let base = fit_base(&problem, &experiment.patch, &experiment.fit, 1).unwrap().unwrap();
    let (sites, peaks) = (find_sites(&problem, &base).unwrap(), signal_extents(&problem, &base).unwrap());
    let library = Library::shipped();
    let mut all = library.iter().flat_map(|effect| EffectPlacement::all(effect, &sites));
    let saturation = all.find(|placement| placement.effect.name == "saturation").unwrap();
    let request = TrialRequest {
        effort: Effort::QUICK,
        target_chi2: f64::INFINITY,
        previous: None,
        effect_values: None,
    };
    fit_trial(&problem, &base, &saturation, &peaks, request).unwrap()
}

/// A trial with this number of parameters whose residual is a sine. Its amplitude is `train` in training and alternates
/// between the two values of `validation` in validation.
fn trial(
    template: &(Candidate, FittedModel),
    name: &str,
    parameters: usize,
    train: f64,
    validation: [f64; 2],
) -> (Candidate, FittedModel) {
    let (mut candidate, mut model) = template.clone();
    name.clone_into(&mut candidate.effect);
    model.variant.fit = (0..parameters).map(|number| format!("p{number}")).collect();
    for (fitted, amplitudes) in [(&mut model.train, [train; 2]), (&mut model.validation, validation)] {
        let wave = (0..2000_u32).map(|k| amplitudes[(k / 100 % 2) as usize] * (0.2 * f64::from(k)).sin());
        fitted.residuals = vec![vec![wave.collect()]];
        fitted.chi2 = fitted.residuals[0][0].iter().map(|value| value * value).sum();
        fitted.data_count = 2000;
    }
    (model.ljung_box_z, model.autocorrelation_time) = (100.0, 20.0);
    (candidate, model)
}

/// The best effect of a round, and the number of tied trials.
fn judged(template: &(Candidate, FittedModel), tried: Vec<(Candidate, FittedModel)>) -> (String, usize) {
    let (_, before) = trial(template, "", 2, 100.0, [100.0; 2]);
    let round = Round::new(&before, Vec::new(), tried);
    (round.trials[0].candidate.effect.clone(), round.tied)
}

#[test]
fn a_simpler_trial_is_preferred_to_a_coloured_one_that_is_no_better() {
    let template = template();
    let compare = |simple: &str, validation: [f64; 2], colour: f64| {
        let mut rich = trial(&template, "rich", 4, 9.0, validation);
        rich.1.ljung_box_z = colour;
        judged(&template, vec![trial(&template, simple, 3, 10.0, [20.0; 2]), rich])
    };
    let with_other = |validation: [f64; 2], colour: f64| compare("simple", validation, colour);
    assert_eq!(with_other([28.6, 5.0], 100.0), ("simple".to_owned(), 1));
    // A trial that is better, even if not significantly, or has a white residual stays in front.
    assert_eq!(with_other([28.0, 5.0], 100.0), ("rich".to_owned(), 2));
    assert_eq!(with_other([28.6, 5.0], 0.0), ("rich".to_owned(), 1));
    // A trial counts as its alias unless it is clearly better.
    let with_alias = |validation: [f64; 2]| compare(&template.0.aliases[0], validation, 100.0);
    assert_eq!(with_alias([28.0, 5.0]), ("overflow".to_owned(), 1));
    assert_eq!(with_alias([24.0, 5.0]), ("rich".to_owned(), 2));
}

#[test]
fn a_better_fit_is_rejected_if_it_makes_a_taken_effect_tentative() {
    let template = template();
    let (_, before) = trial(&template, "", 2, 100.0, [100.0; 2]);
    let rejudge = |validation: [f64; 2], better: [f64; 2]| {
        let with = |train, validation| trial(&template, "a", 3, train, validation);
        let mut round = Round::new(&before, Vec::new(), vec![with(9.0, validation)]);
        let original = (round.taken, round.tentative);
        (original, round.rejudge(with(8.9, better).1).map(|_| (round.taken, round.tentative)))
    };
    let (taken, tentative) = ((true, false), (false, true));
    assert_eq!(rejudge([0.0, 110.0], [0.0, 109.0]), (taken, Some(taken)));
    assert_eq!(rejudge([0.0, 110.0], [0.0, 122.0]), (taken, None));
    assert_eq!(rejudge([0.0, 122.0], [0.0, 121.0]), (tentative, Some(tentative)));
    assert_eq!(rejudge([0.0, 122.0], [0.0, 110.0]), (tentative, Some(taken)));
}

#[test]
fn a_decrease_of_chi2_below_the_required_delta_bic_is_not_visible() {
    let template = template();
    let with = |amplitude: f64| trial(&template, "", 3, amplitude, [1.0; 2]).1;
    // Noise of 2000 samples. The best of 40 trials needs a decrease of chi2 by 11.
    let is_visible = |amplitude: f64| can_be_visible(&with(1.414), &with(amplitude), 40);
    assert!(is_visible(1.409) && !is_visible(1.411));
}

#[test]
fn among_equal_trials_one_that_predicts_the_validation_records_is_preferred() {
    let template = template();
    let best_with = |train: f64, validation: [f64; 2]| {
        let mut best = trial(&template, "best", 3, 1.4, [0.2, 3.0]);
        let mut rival = trial(&template, "rival", 3, train, validation);
        (best.1.ljung_box_z, rival.1.ljung_box_z) = (0.0, 0.0);
        judged(&template, vec![best, rival]).0
    };
    assert_eq!(best_with(1.402, [1.5, 1.5]), "rival");
    // Its delta_bic is too low, or it does not predict the validation records either.
    assert_eq!(best_with(1.8, [1.5, 1.5]), "best");
    assert_eq!(best_with(1.402, [1.6, 1.6]), "best");
}

#[test]
fn training_distinguishes_coloured_trials_that_validation_does_not() {
    let template = template();
    let with_rival = |rival: [f64; 2], colour: f64| {
        let mut best = trial(&template, "best", 3, 10.0, [30.0, 10.0]);
        let mut rival = trial(&template, "rival", 3, 12.0, rival);
        (best.1.ljung_box_z, rival.1.ljung_box_z) = (colour, colour);
        judged(&template, vec![best, rival])
    };
    assert_eq!(with_rival([10.0, 30.0], 100.0), ("best".to_owned(), 1));
    // Validation favours the rival, or the residuals are white.
    assert_eq!(with_rival([10.0, 28.0], 100.0), ("best".to_owned(), 2));
    assert_eq!(with_rival([10.0, 30.0], 0.0), ("best".to_owned(), 2));
}
