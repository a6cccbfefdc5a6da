//! Outputs that are measured the wrong way round.

use patchcord::gap::blind::Blind;
use patchcord::gap::search::{Outcome, Verdict};

use super::search::spoilt;

/// What comes of an experiment whose output is told turned round.
fn turned(name: &str) -> Outcome {
    spoilt(name, |experiment| {
        let records = experiment.train.iter_mut().chain(&mut experiment.test);
        records.flat_map(|record| record.outputs.iter_mut().flatten()).for_each(|value| *value *= -1.0);
    })
}

#[test]
fn no_effect_is_named_for_a_sign() {
    let found = turned("nothing");
    let Some(Blind::Turned(own)) = &found.blind else { panic!("{:?}", found.blind) };
    assert_eq!((found.verdict, own.outputs.as_slice()), (Verdict::CannotJudge, &["x".to_owned()][..]));
    assert!(own.leaves[0] > 5.0 && (own.leaves[1] - 1.0).abs() < 0.05, "{:?}", own.leaves);
    assert!(found.sentence().starts_with("these data cannot judge: with x turned round the patch leaves "));
    assert!(found.rounds.is_empty() && found.effects.is_empty());
    // With an effect missing, too, the sign comes first.
    assert_eq!(turned("relay").verdict, Verdict::CannotJudge);
}
