//! Data with a wrong sign, output unit or time unit: the search must report the misspecification and name no effect.

use super::search::search_modified;
use patchcord_ident::Experiment;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::residuals::misspecification::{Misspecification, Respecification};
use patchcord_ident::search::inconclusive::Inconclusive;
use patchcord_ident::search::{Outcome, Verdict};

/// The outcome of the search in a hidden case whose outputs are multiplied by `factor`.
fn search_scaled(name: &str, factor: f64) -> Outcome {
    search_modified(name, |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.validation);
        records.flat_map(|record| record.outputs.iter_mut().flatten()).for_each(|value| *value *= factor);
    })
}

/// Asserts that the outcome is a misspecification, and returns it.
///
/// The residual must be above 5 times the noise as specified, and within `tolerance` of the noise if corrected.
fn assert_misspecified(outcome: &Outcome, tolerance: f64) -> &Misspecification {
    let Some(Inconclusive::Misspecification(misspecification)) = &outcome.inconclusive else {
        panic!("{:?}", outcome.inconclusive)
    };
    assert_eq!(outcome.verdict, Verdict::CannotJudge);
    let [specified, corrected] = misspecification.normalised_rms;
    assert!(specified > 5.0 && (corrected - 1.0).abs() < tolerance, "{specified} {corrected}");
    assert!(outcome.rounds.is_empty() && outcome.effects.is_empty());
    misspecification
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_reversed_output_is_reported_and_no_effect_is_named() {
    let outcome = search_scaled("nothing", -1.0);
    assert_eq!(
        assert_misspecified(&outcome, 0.05).respecification,
        Respecification::SignFlip(vec!["x".to_owned()])
    );
    assert!(
        verdict_sentence(&outcome).starts_with("inconclusive: with the sign of x reversed the patch leaves ")
    );
    // The sign is reported first even if an effect is missing, too.
    assert!(matches!(search_scaled("relay", -1.0).inconclusive, Some(Inconclusive::Misspecification(_))));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_wrong_output_unit_is_reported_and_no_effect_is_named() {
    for (factor, correction) in [(1e3, "x divided by 1000"), (1e-3, "x multiplied by 1000")] {
        let outcome = search_scaled("nothing", factor);
        assert_misspecified(&outcome, 0.05);
        let beginning = format!("inconclusive: with {correction} the patch leaves ");
        assert!(verdict_sentence(&outcome).starts_with(&beginning), "{}", verdict_sentence(&outcome));
        assert!(
            verdict_sentence(&outcome).contains("check the units of parameters, columns and drives"),
            "{}",
            verdict_sentence(&outcome)
        );
    }
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_one_output_with_a_wrong_unit_is_identified() {
    let outcome = search_modified("bias", |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.validation);
        records.flat_map(|record| &mut record.outputs[1]).for_each(|value| *value *= 1e3);
        experiment.outputs[1].sigma = experiment.outputs[1].sigma.map(|sigma| 1e3 * sigma);
    });
    let Some(Inconclusive::Misspecification(misspecification)) = &outcome.inconclusive else {
        panic!("{}", verdict_sentence(&outcome))
    };
    assert_eq!(misspecification.respecification, Respecification::UnitScaleDown(vec!["h2".to_owned()]));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_wrong_unit_is_identified_with_pieces_and_with_an_offset() {
    let outcome = search_modified("nothing", |experiment| {
        (experiment.piece_duration, experiment.outputs[0].has_offset) = (Some(2.0), true);
        let records = experiment.train.iter_mut().chain(&mut experiment.validation);
        records.flat_map(|record| record.outputs.iter_mut().flatten()).for_each(|value| *value *= 1e-3);
    });
    assert_eq!(
        assert_misspecified(&outcome, 0.05).respecification,
        Respecification::UnitScaleUp(vec!["x".to_owned()])
    );
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn times_a_thousandfold_too_long_are_reported_and_no_effect_is_named() {
    let outcome = search_modified("nothing", |experiment: &mut Experiment| {
        for record in experiment.train.iter_mut().chain(&mut experiment.validation) {
            // The run lasts a thousand times as long. 400 samples keep the test short and still suffice.
            let columns = record.outputs.iter_mut().chain(&mut record.drives);
            columns.for_each(|column| column.truncate(400));
            record.interval *= 1e3;
        }
    });
    // The tolerance is three standard errors of the rms of 400 samples.
    assert_eq!(assert_misspecified(&outcome, 0.1).respecification, Respecification::TimeScaleDown);
    assert!(verdict_sentence(&outcome).ends_with(
        "check the unit of \"time\", which is s if none is specified, and what sets the speed of the patch: jacks of integrators and units of parameters"
    ));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn times_a_thousandfold_too_short_are_reported_and_no_effect_is_named() {
    let outcome = search_modified("nothing", |experiment: &mut Experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.validation);
        records.for_each(|record| record.interval *= 1e-3);
    });
    assert_eq!(assert_misspecified(&outcome, 0.05).respecification, Respecification::TimeScaleUp);
}
