//! Outputs that are measured the wrong way round.

use patchcord::gap::Experiment;
use patchcord::gap::blind::Blind;
use patchcord::gap::effect::Library;
use patchcord::gap::search::{Means, Outcome, Verdict};
use patchcord::gap::stage::Problem;

/// What comes of an experiment whose output is told with so many times its value.
fn searched(name: &str, factor: f64) -> Outcome {
    let path = format!("tests/gap/hidden/{name}/experiment.json");
    let mut experiment = Experiment::read(path.as_ref()).unwrap_or_else(|error| panic!("{error}"));
    for record in experiment.train.iter_mut().chain(&mut experiment.test) {
        record.outputs.iter_mut().flatten().for_each(|value| *value *= factor);
    }
    let (library, problem) = (Library::shipped(), Problem::of(&experiment).unwrap());
    let with = Means { library: &library, threads: 2, seed: 1 };
    problem.search(&experiment.patch, &experiment.fit, &with, |_| ()).unwrap().unwrap()
}

#[test]
fn no_effect_is_named_for_a_sign() {
    let found = searched("nothing", -1.0);
    let Some(Blind::Turned(turned)) = &found.blind else { panic!("{:?}", found.blind) };
    assert_eq!((found.verdict, turned.outputs.as_slice()), (Verdict::CannotJudge, &["x".to_owned()][..]));
    assert!(turned.leaves[0] > 5.0 && (turned.leaves[1] - 1.0).abs() < 0.05, "{:?}", turned.leaves);
    assert!(found.sentence().starts_with("these data cannot judge: with x turned round the patch leaves "));
    assert!(found.rounds.is_empty() && found.effects.is_empty());
    // With an effect missing, too, the sign comes first.
    assert_eq!(searched("relay", -1.0).verdict, Verdict::CannotJudge);
}
