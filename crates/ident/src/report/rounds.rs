//! Rounds as sentences, and trials that were not made as JSON documents.
//!
//! A round sentence names the best trial, its score, the change of chi-squared in the validation data, and the
//! decision. The same sentence is used on the terminal and on the HTML page.

use std::collections::HashSet;

use serde::Serialize;

use crate::data::measured_file::plural;
use crate::fit::extended_model::SkippedTrial;
use crate::search::outcome::Outcome;
use crate::search::round::Round;
use patchcord_analysis::format::number;

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
    pub fn of(skipped: &SkippedTrial, step: Option<usize>) -> Self {
        let SkippedTrial { effect, junction, reason } = skipped.clone();
        SkippedTrialDocument { name: effect, junction, why: reason, step }
    }
}

/// Which effect is not tried at which place, and why, in one line. Only the first line of the reason is used.
pub fn skipped_trial_sentence(skipped: &SkippedTrial) -> String {
    let why = skipped.reason.lines().next().unwrap_or_default();
    format!("{} at {} is not tried: {why}", skipped.effect, skipped.junction)
}

/// The result of a round, which other effects were dropped later, and why a taken effect has no name in the verdict.
pub fn round_sentence(outcome: &Outcome, round: &Round) -> String {
    let is_kept = |label: &str| outcome.effects.iter().any(|effect| effect.label() == label);
    let dropped = round.other_effects.iter().filter(|label| !is_kept(label));
    let dropped: String = dropped.map(|label| format!(" {label} was dropped later.")).collect();
    let is_unnamed = round.taken && !outcome.verdict.has_names();
    let unnamed = if is_unnamed { " It is not named, because the final residual is too large." } else { "" };
    result_sentence(round) + &dropped + unnamed
}

/// The number of effects and of trials, for example "10 effects tried in 27 ways". Ways are places, forms and signals
/// that are read.
pub fn trial_count_text(round: &Round) -> String {
    let effects: HashSet<&str> = round.trials.iter().map(|trial| trial.candidate.effect.as_str()).collect();
    let [effects, ways] =
        [(effects.len(), "effect"), (round.trials.len(), "way")].map(|(n, noun)| plural(n, noun));
    format!("{effects} tried in {ways}")
}

/// The best trial of a round, its score, and whether it is taken.
///
/// A trial is not taken for one of three reasons: its score is too low for the number of trials, it explains too little
/// of the gap, or the validation data do not confirm it. The sentence names the first that applies.
fn result_sentence(round: &Round) -> String {
    let Some(best) = round.trials.first() else { return "no effect can be tried".to_owned() };
    let validation = format!(
        "it lowers the chi-squared of the validation data by {} (95 %: {})",
        number(round.validation_advantage.sum),
        round.validation_advantage.confidence_interval().map(number).join(" ... ")
    );
    let context = match round.other_effects.is_empty() {
        true => String::new(),
        false => format!("With {} in the patch, ", round.other_effects.join(" and ")),
    };
    let score = format!(
        "{context}{} is the best, with a score (delta BIC) of {}",
        best.label(),
        number(best.delta_bic)
    );
    match (round.taken, round.tied) {
        (true, 1) => format!("{score}; {validation}. It is taken."),
        (true, 2) => {
            format!(
                "{score}; {validation}. It is taken, although the data cannot distinguish it from another."
            )
        }
        (true, tied) => format!(
            "{score}; {validation}. It is taken, although the data cannot distinguish it from {} others.",
            tied - 1
        ),
        (false, _) if best.delta_bic <= round.required_delta_bic => {
            format!(
                "{score}, which is less than the {} required for this number of trials. None is taken.",
                number(round.required_delta_bic)
            )
        }
        (false, _) if !round.has_sufficient_effect() => format!(
            "{score}; but it explains only {} % of the gap (in squares), and the rest is not noise. None is taken.",
            number(100.0 * round.explained_fraction())
        ),
        (false, _) => format!("{score}; but {validation}, which is not significant. None is taken."),
    }
}
