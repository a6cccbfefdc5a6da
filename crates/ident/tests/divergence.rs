//! A patch with a wrong sign in a loop, whose fit diverges from the data.

use serde_json::json;

use super::noise::white;
use super::search::search_modified;
use patchcord_core::patch::Edit;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::inconclusive::Inconclusive;
use patchcord_ident::search::{Outcome, Verdict};

/// The outcome of the search with an oscillator whose spring force has the wrong sign.
///
/// `noise` is the standard deviation in N of noise that is added to the measured force.
fn search_with_reversed_spring(noise: f64) -> Outcome {
    search_modified("nothing", |experiment| {
        let reversed = [
            Edit::new("elements/BX", json!({"kind": "inverter", "in": "IX"})),
            Edit::new("elements/PK/in", json!("BX")),
        ];
        experiment.patch = experiment.patch.with_edits("reversed.json", &reversed).unwrap();
        for record in experiment.train.iter_mut().chain(&mut experiment.validation) {
            record.drives.iter_mut().chain(&mut record.outputs).for_each(|column| column.truncate(600));
            let mut white = white(1);
            record.drives[0].iter_mut().for_each(|force| *force += noise * white());
        }
    })
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn divergence_is_reported_and_no_effect_is_searched_for_if_a_spring_has_the_wrong_sign() {
    for noise in [0.0, 0.05] {
        let outcome = search_with_reversed_spring(noise);
        let Some(Inconclusive::Divergence(divergence)) = &outcome.inconclusive else {
            panic!("{}", verdict_sentence(&outcome))
        };
        assert_eq!((outcome.verdict, divergence.output.as_str()), (Verdict::CannotJudge, "x"));
        assert!(outcome.rounds.is_empty() && outcome.effects.is_empty());
        assert!(
            verdict_sentence(&outcome).contains("the fit diverges: it leaves "),
            "{}",
            verdict_sentence(&outcome)
        );
        assert!(
            verdict_sentence(&outcome).contains("check the signs in the loops of the patch"),
            "{}",
            verdict_sentence(&outcome)
        );
    }
}
