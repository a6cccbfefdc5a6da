//! Signs and units that are told wrongly.

use super::search::spoilt;
use patchcord_ident::Experiment;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::residuals::misspecification::{Mistold, Otherwise};
use patchcord_ident::search::inconclusive::Blind;
use patchcord_ident::search::{Outcome, Verdict};

/// What comes of an experiment whose output is told so many times too large.
fn scaled(name: &str, factor: f64) -> Outcome {
    spoilt(name, |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.test);
        records.flat_map(|record| record.outputs.iter_mut().flatten()).for_each(|value| *value *= factor);
    })
}

/// Holds an outcome to a verdict that tells what is wrong, with noise alone left then, and gives that.
fn mistold(found: &Outcome, near: f64) -> &Mistold {
    let Some(Blind::Mistold(own)) = &found.blind else { panic!("{:?}", found.blind) };
    assert_eq!(found.verdict, Verdict::CannotJudge);
    assert!(own.leaves[0] > 5.0 && (own.leaves[1] - 1.0).abs() < near, "{:?}", own.leaves);
    assert!(found.rounds.is_empty() && found.effects.is_empty());
    own
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn no_effect_is_named_for_a_sign() {
    let found = scaled("nothing", -1.0);
    assert_eq!(mistold(&found, 0.05).otherwise, Otherwise::Turned(vec!["x".to_owned()]));
    assert!(
        verdict_sentence(&found)
            .starts_with("these data cannot judge: with x turned round the patch leaves ")
    );
    // With an effect missing, too, the sign comes first.
    assert!(matches!(scaled("relay", -1.0).blind, Some(Blind::Mistold(_))));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn no_effect_is_named_for_a_unit() {
    for (factor, told) in [(1e3, "a thousandth of x"), (1e-3, "a thousand times x")] {
        let found = scaled("nothing", factor);
        mistold(&found, 0.05);
        let begins = format!("these data cannot judge: with {told} the patch leaves ");
        assert!(verdict_sentence(&found).starts_with(&begins), "{}", verdict_sentence(&found));
        assert!(
            verdict_sentence(&found).contains("look at the units of columns and drives"),
            "{}",
            verdict_sentence(&found)
        );
    }
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_output_in_another_unit_is_told_beside_one_that_is_right() {
    let found = spoilt("bias", |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.test);
        records.flat_map(|record| &mut record.outputs[1]).for_each(|value| *value *= 1e3);
        experiment.outputs[1].sigma = experiment.outputs[1].sigma.map(|sigma| 1e3 * sigma);
    });
    let Some(Blind::Mistold(own)) = &found.blind else { panic!("{}", verdict_sentence(&found)) };
    assert_eq!(own.otherwise, Otherwise::Thousandth(vec!["h2".to_owned()]));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn a_unit_is_told_of_pieces_and_of_what_may_stand_off() {
    let found = spoilt("nothing", |experiment| {
        (experiment.pieces, experiment.outputs[0].offset) = (Some(2.0), true);
        let records = experiment.train.iter_mut().chain(&mut experiment.test);
        records.flat_map(|record| record.outputs.iter_mut().flatten()).for_each(|value| *value *= 1e-3);
    });
    assert_eq!(mistold(&found, 0.05).otherwise, Otherwise::Thousandfold(vec!["x".to_owned()]));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn no_effect_is_named_for_times_in_another_unit() {
    let found = spoilt("nothing", |experiment: &mut Experiment| {
        for record in experiment.train.iter_mut().chain(&mut experiment.test) {
            // So coarse a record takes long; a few samples tell as well.
            let columns = record.outputs.iter_mut().chain(&mut record.drives);
            columns.for_each(|column| column.truncate(400));
            record.interval *= 1e3;
        }
    });
    // Three standard errors of 400 samples.
    assert_eq!(mistold(&found, 0.1).otherwise, Otherwise::ThousandthOfTimes);
    assert!(verdict_sentence(&found).ends_with(
        "look at the unit of \"time\", which is s where none is told, and at what makes the patch quick or slow: jacks of integrators, units of parameters"
    ));
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn no_effect_is_named_for_times_that_are_too_short() {
    let found = spoilt("nothing", |experiment: &mut Experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.test);
        records.for_each(|record| record.interval *= 1e-3);
    });
    assert_eq!(mistold(&found, 0.05).otherwise, Otherwise::ThousandfoldTimes);
}
