//! The progress of a search in words.

use crate::effects::PlacedEffect;
use crate::report::labels::{effect_label, effect_labels};
use crate::search::progress::SearchPhase;

/// The phase of a search in words, for example "best effects fitted, round 1". `round` counts from 1.
pub fn phase_text(phase: SearchPhase, round: usize) -> String {
    match phase {
        SearchPhase::Base => "fitting the patch".to_owned(),
        SearchPhase::Quick => format!("effects tried quickly, round {round}"),
        SearchPhase::Full => format!("best effects fitted, round {round}"),
        SearchPhase::Growing => format!("best effects fitted step by step, round {round}"),
        SearchPhase::Localisation => "locating the missing effect".to_owned(),
    }
}

/// What a search has found so far: the effects in the patch, and the best one of the round. Empty at first.
pub fn findings_text(added: &[PlacedEffect], best: Option<&PlacedEffect>) -> String {
    let mut texts = Vec::new();
    if !added.is_empty() {
        texts.push(format!("in the patch: {}", effect_labels(added).join(" and ")));
    }
    texts.extend(best.map(|best| format!("best so far: {}", effect_label(best))));
    texts.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_progress_has_the_phase_and_the_round() {
        let texts = [
            (SearchPhase::Base, "fitting the patch"),
            (SearchPhase::Quick, "effects tried quickly, round 2"),
            (SearchPhase::Full, "best effects fitted, round 2"),
            (SearchPhase::Growing, "best effects fitted step by step, round 2"),
            (SearchPhase::Localisation, "locating the missing effect"),
        ];
        for (phase, text) in texts {
            assert_eq!(phase_text(phase, 2), text);
        }
    }

    #[test]
    fn the_progress_has_the_effects_that_are_found() {
        let placed =
            |effect: &str, site: &str| PlacedEffect { effect: effect.to_owned(), site: site.to_owned() };
        let (leak, saturation) = (placed("leak", "I2"), placed("saturation", "u"));
        assert_eq!(findings_text(&[], None), "");
        assert_eq!(findings_text(&[], Some(&saturation)), "best so far: saturation at u");
        let text = "in the patch: leak at I2; best so far: saturation at u";
        assert_eq!(findings_text(&[leak], Some(&saturation)), text);
    }
}
