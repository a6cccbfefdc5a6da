//! A patch that runs away from the data.

use serde_json::json;

use super::noise::white;
use super::search::spoilt;
use patchcord_core::patch::Edit;
use patchcord_ident::report::sentence::verdict_sentence;
use patchcord_ident::search::inconclusive::Blind;
use patchcord_ident::search::{Outcome, Verdict};

/// What comes of an oscillator whose spring pushes, fed with a force that has so much noise.
fn pushed(noise: f64) -> Outcome {
    spoilt("nothing", |experiment| {
        let turned = [
            Edit::new("elements/BX", json!({"kind": "inverter", "in": "IX"})),
            Edit::new("elements/PK/in", json!("BX")),
        ];
        experiment.patch = experiment.patch.edited("turned.json", &turned).unwrap();
        for record in experiment.train.iter_mut().chain(&mut experiment.test) {
            record.drives.iter_mut().chain(&mut record.outputs).for_each(|column| column.truncate(600));
            let mut white = white(1);
            record.drives[0].iter_mut().for_each(|force| *force += noise * white());
        }
    })
}

#[test]
#[ignore = "takes several seconds: a whole search"]
fn no_effect_is_sought_where_a_spring_has_the_wrong_sign() {
    for noise in [0.0, 0.05] {
        let found = pushed(noise);
        let Some(Blind::Runaway(own)) = &found.blind else { panic!("{}", verdict_sentence(&found)) };
        assert_eq!((found.verdict, own.output.as_str()), (Verdict::CannotJudge, "x"));
        assert!(found.rounds.is_empty() && found.effects.is_empty());
        assert!(
            verdict_sentence(&found).contains("the patch runs away: it leaves "),
            "{}",
            verdict_sentence(&found)
        );
        assert!(
            verdict_sentence(&found).contains("look at the signs in its loops"),
            "{}",
            verdict_sentence(&found)
        );
    }
}
