//! The verdict of a search as a sentence.
//!
//! The sentence has up to four parts: the effects, the ambiguity, the experiment that resolves it, and the remaining
//! part of the gap. Effects of different rounds are joined by "and". Rivals of the same round are joined by "or".

use std::collections::BTreeSet;

use crate::design::detectability::detection_limit::best_sites;
use crate::localise::localisation::indistinguishable_junctions;
use crate::report::detection_limits::limit_sentence;
use crate::report::discriminating_experiment::experiment_sentence;
use crate::report::labels::candidate_label;
use crate::report::ranges::extension_text;
use crate::report::reasons::inconclusive_sentence;
use crate::report::values::percent_text;
use crate::search::outcome::{Outcome, taken_rounds};
use crate::search::round::{Round, Trial};
use crate::search::verdict::Verdict;

/// The verdict as a sentence without a full stop, for example "saturation at u is missing".
pub fn verdict_sentence(outcome: &Outcome) -> String {
    match outcome.verdict {
        Verdict::Named => format!("{}{}", missing_text(outcome), remainder_text(outcome)),
        Verdict::Ambiguous => ambiguous_sentence(outcome),
        Verdict::NothingMissing if outcome.agrees_within_noise => {
            "the patch agrees with the data within the declared noise; no effect was searched".to_owned()
        }
        Verdict::NothingMissing => {
            let least = best_sites(&outcome.detection_limits).into_iter().find_map(limit_sentence);
            let least = least.map(|least| format!("; {least}")).unwrap_or_default();
            format!("no missing effect is detectable in these data{least}")
        }
        Verdict::UnknownEffect => unknown_sentence(outcome),
        Verdict::CannotJudge => {
            let extension = outcome.range_extension.as_ref();
            let reason = outcome.inconclusive.as_ref();
            let reason = reason.map(|reason| format!(": {}", inconclusive_sentence(reason, extension)));
            format!("inconclusive{}", reason.unwrap_or_default())
        }
    }
}

/// The named effects, for example "leak at I2 or drift at I2 is missing".
///
/// One effect gives "is missing", several "are missing". Alternatives of one round count as one.
fn missing_text(outcome: &Outcome) -> String {
    let effects = effects_by_round(outcome);
    let are = if effects.len() > 1 { "are" } else { "is" };
    format!("{} {are} missing", list(&effects))
}

/// The effects of which one is missing, and the experiment that distinguishes them.
///
/// An experiment that would distinguish the effects follows after a semicolon, or the reason why none was found.
fn ambiguous_sentence(outcome: &Outcome) -> String {
    let extension = outcome.range_extension.as_ref().filter(|extension| extension.is_rival);
    let extension =
        extension.map(|extension| format!(", or {}", extension_text(extension))).unwrap_or_default();
    let ambiguity = match taken_rounds(&outcome.rounds).count() {
        0..=1 => "these data cannot distinguish them",
        _ => "these data cannot distinguish what is joined by \"or\"",
    };
    let experiment = match &outcome.discriminating_experiment {
        Some(experiment) => format!("; {}", experiment_sentence(experiment)),
        None if taken_rounds(&outcome.rounds).any(|round| round.rival().is_some()) => {
            "; no drive was found that would distinguish them: every tried drive overloads an amplifier, or the data feed no drive".to_owned()
        }
        None => String::new(),
    };
    format!("{}{extension}: {ambiguity}{experiment}{}", missing_text(outcome), remainder_text(outcome))
}

/// The most likely junctions of an unknown effect, and how far the best effects of the library explain it.
///
/// If the library has effects that explain a part, they are named after the junction with the share that remains.
fn unknown_sentence(outcome: &Outcome) -> String {
    let junctions = indistinguishable_junctions(&outcome.localisations).join(" or ");
    let at_junctions = if junctions.is_empty() { junctions } else { format!(" at {junctions}") };
    let unknown = format!("something is missing{at_junctions} that the library does not have");
    match list(&effects_by_round(outcome)).as_str() {
        "" => unknown,
        effects => {
            let remaining = percent_text(100.0 * outcome.remaining_fraction);
            format!("{unknown}: with {effects}, {remaining} of the gap is left, which is not noise")
        }
    }
}

/// For each taken round, its best effect and those that the data cannot distinguish from it.
///
/// The best effect and one rival are named. Further rivals are only counted, each effect and site once.
fn effects_by_round(outcome: &Outcome) -> Vec<String> {
    let best: Vec<String> =
        taken_rounds(&outcome.rounds).map(|round| trial_label(&round.trials[0])).collect();
    // An effect that occurs twice at a site has two forms, which the note distinguishes.
    let name = |trial: &Trial| match best.iter().filter(|best| **best == trial_label(trial)).count() {
        0..=1 => trial_label(trial),
        _ => format!("{} ({})", trial_label(trial), trial.candidate.note),
    };
    let describe = |round: &Round| {
        let named: Vec<&Trial> = round.trials.iter().take(1).chain(round.rival()).collect();
        // Other forms of a named effect do not count as further effects.
        let is_other = |trial: &&Trial| named.iter().all(|named| trial_label(named) != trial_label(trial));
        let more: BTreeSet<String> = round.rivals().filter(is_other).map(trial_label).collect();
        let named = named.into_iter().map(name).collect::<Vec<_>>().join(" or ");
        match more.len() {
            0 => named,
            1 => format!("{named} (or one more)"),
            more => format!("{named} (or one of {more} more)"),
        }
    };
    taken_rounds(&outcome.rounds).map(describe).collect()
}

/// The remaining part of the gap, if it is larger than an inexact law usually causes. Empty otherwise.
fn remainder_text(outcome: &Outcome) -> String {
    if !outcome.has_substantial_residual() {
        return String::new();
    }
    let validation = (outcome.final_model.validation.excess_reduced_chi2()
        / outcome.base.validation.excess_reduced_chi2())
    .sqrt();
    let [train, validation] =
        [outcome.remaining_fraction, validation].map(|share| percent_text(100.0 * share));
    format!(
        "; {train} of the gap is left, and {validation} in the validation data, which is not noise: the real law may be different"
    )
}

/// The label of the effect of a trial.
fn trial_label(trial: &Trial) -> String {
    candidate_label(&trial.candidate)
}

/// "A", "A, and B" or "A, B, and C". The parts may contain "or".
fn list(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{}, and {last}", first.join(", ")),
    }
}
