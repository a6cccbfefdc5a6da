//! Rounds in words, and what they did not try as a document.

use std::collections::HashSet;

use serde::Serialize;

use crate::data::measured::plural;
use crate::fit::extended_model::LeftOut;
use crate::search::outcome::Outcome;
use crate::search::round::Round;
use patchcord_analysis::instruments::number;

/// An effect that was not tried at a place, as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SkippedTrialDocument {
    /// The effect.
    pub name: String,
    /// The element that it would act on.
    pub junction: String,
    /// Why it was not tried.
    pub why: String,
    /// The round, counted from 1; absent if no search was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<usize>,
}

impl SkippedTrialDocument {
    /// The document of an effect that was not tried in a round, or before any search.
    pub fn of(skipped: &LeftOut, step: Option<usize>) -> Self {
        let LeftOut { effect, junction, why } = skipped.clone();
        SkippedTrialDocument { name: effect, junction, why, step }
    }
}

/// Which effect is not tried at which place, and why, in a line.
pub fn skipped_trial_sentence(skipped: &LeftOut) -> String {
    let why = skipped.why.lines().next().unwrap_or_default();
    format!("{} at {} is not tried: {why}", skipped.effect, skipped.junction)
}

/// What a round of an outcome came to, which effects next to it were dropped later, and why what it took has no name.
pub fn round_sentence(outcome: &Outcome, round: &Round) -> String {
    let is_kept = |own: &str| outcome.effects.iter().any(|effect| effect.named() == own);
    let dropped = round.beside.iter().filter(|own| !is_kept(own));
    let dropped: String = dropped.map(|own| format!(" Later {own} was dropped.")).collect();
    let is_nameless = round.taken && !outcome.verdict.has_names();
    let nameless = if is_nameless { " It is not named: what is left in the end is too much." } else { "" };
    judgement(round) + &dropped + nameless
}

/// How many effects were tried, and in how many ways: places, forms, and what they read there.
pub fn trial_count_text(round: &Round) -> String {
    let effects: HashSet<&str> = round.trials.iter().map(|trial| trial.candidate.effect.as_str()).collect();
    let [effects, ways] =
        [(effects.len(), "effect"), (round.trials.len(), "way")].map(|(n, noun)| plural(n, noun));
    format!("{effects} tried in {ways}")
}

/// What the round came to.
fn judgement(round: &Round) -> String {
    let Some(best) = round.trials.first() else { return "nothing fits".to_owned() };
    let held = format!(
        "on the data held back it lowers the sum of squares by {} times that of the noise (95 %: {})",
        number(round.confirmed.sum),
        round.confirmed.interval().map(number).join(" ... ")
    );
    let beside = match round.beside.is_empty() {
        true => String::new(),
        false => format!("Beside {}, ", round.beside.join(" and ")),
    };
    let score = format!("{beside}{} is the best, with a score of {}", best.named(), number(best.score));
    match (round.taken, round.tied) {
        (true, 1) => format!("{score}; {held}. It is taken."),
        (true, 2) => {
            format!("{score}; {held}. It is taken, although the data cannot tell it from another.")
        }
        (true, tied) => format!(
            "{score}; {held}. It is taken, although the data cannot tell it from {} others.",
            tied - 1
        ),
        (false, _) if best.score <= round.needed => {
            format!(
                "{score}, which is less than the {} that so many trials ask for. None is taken.",
                number(round.needed)
            )
        }
        (false, _) if !round.closes_enough() => format!(
            "{score}; but it closes only {} % of what is left, and what it leaves is no noise. None is taken.",
            number(100.0 * round.closed())
        ),
        (false, _) => format!("{score}; but {held}, which is no evidence. None is taken."),
    }
}
