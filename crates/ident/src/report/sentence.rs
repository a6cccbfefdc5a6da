//! The verdict of a search in words.

use std::collections::BTreeSet;

use crate::design::detectability::detection_limit::best_places;
use crate::localise::force::nearest;
use crate::report::detection_limits::limit_sentence;
use crate::report::discriminating_experiment::experiment_sentence;
use crate::report::ranges::extension_text;
use crate::report::reasons::inconclusive_sentence;
use crate::search::outcome::{Outcome, taken};
use crate::search::round::{Round, Trial};
use crate::search::verdict::Verdict;
use patchcord_analysis::instruments::number;

/// The verdict in words.
pub fn verdict_sentence(outcome: &Outcome) -> String {
    match outcome.verdict {
        Verdict::Named => format!("{}{}", missing(outcome), left_over(outcome)),
        Verdict::Ambiguous => untold_apart(outcome),
        Verdict::NothingMissing => {
            let least = best_places(&outcome.limits).into_iter().find_map(limit_sentence);
            let least = least.map(|least| format!("; {least}")).unwrap_or_default();
            format!("nothing is missing that these data would show{least}")
        }
        Verdict::UnknownEffect => nameless(outcome),
        Verdict::CannotJudge => {
            let why = outcome
                .blind
                .as_ref()
                .map(|why| format!(": {}", inconclusive_sentence(why, outcome.beyond.as_ref())));
            let why = why.unwrap_or_default();
            format!("these data cannot judge{why}")
        }
    }
}

/// What is missing.
fn missing(outcome: &Outcome) -> String {
    let effects = taken_told(outcome);
    let are = if effects.len() > 1 { "are" } else { "is" };
    format!("{} {are} missing", listed(&effects))
}

/// What may be missing, and what would tell.
fn untold_apart(outcome: &Outcome) -> String {
    let beyond = outcome.beyond.as_ref().filter(|own| own.is_rival);
    let beyond = beyond.map(|own| format!(", or {}", extension_text(own))).unwrap_or_default();
    let cannot_tell = match taken(&outcome.rounds).count() {
        0..=1 => "these data cannot tell",
        _ => "these data cannot tell which, where there is an \"or\"",
    };
    let would = match &outcome.separating {
        Some(own) => format!("; {}", experiment_sentence(own)),
        None if taken(&outcome.rounds).any(|round| round.rival().is_some()) => {
            "; no experiment was found that would: under each drive that was tried an amplifier overloads, or there is none that data feed".to_owned()
        }
        None => String::new(),
    };
    format!("{}{beyond}: {cannot_tell}{would}{}", missing(outcome), left_over(outcome))
}

/// Where something is missing that has no name, and how far effects lead.
fn nameless(outcome: &Outcome) -> String {
    let at = nearest(&outcome.whereabouts).join(" or ");
    let at = if at.is_empty() { at } else { format!(" at {at}") };
    let nameless = format!("something is missing{at} that the library does not have");
    match listed(&taken_told(outcome)).as_str() {
        "" => nameless,
        effects => {
            let left = number(100.0 * outcome.left);
            format!("{nameless}: with {effects} {left} % of the gap would be left, which is no noise")
        }
    }
}

/// What each round took, with what the data cannot tell from it.
fn taken_told(outcome: &Outcome) -> Vec<String> {
    let bests: Vec<String> = taken(&outcome.rounds).map(|round| round.trials[0].named()).collect();
    // The same at the same place is another form of it.
    let named = |trial: &Trial| match bests.iter().filter(|best| **best == trial.named()).count() {
        0..=1 => trial.named(),
        _ => format!("{} ({})", trial.named(), trial.candidate.note),
    };
    let told = |round: &Round| {
        let both: Vec<&Trial> = round.trials.iter().take(1).chain(round.rival()).collect();
        // Nor are other forms of one of them more.
        let is_other = |trial: &&Trial| both.iter().all(|own| own.named() != trial.named());
        let more: BTreeSet<String> = round.rivals().filter(is_other).map(|trial| trial.named()).collect();
        let both = both.into_iter().map(named).collect::<Vec<_>>().join(" or ");
        match more.len() {
            0 => both,
            1 => format!("{both} (or one more)"),
            more => format!("{both} (or one of {more} more)"),
        }
    };
    taken(&outcome.rounds).map(told).collect()
}

/// What is left besides what is named, where that is more than a law of another shape leaves mostly, in words.
fn left_over(outcome: &Outcome) -> String {
    if !outcome.leaves_much() {
        return String::new();
    }
    let held = (outcome.last.test.unexplained() / outcome.base.test.unexplained()).sqrt();
    let [train, test] = [outcome.left, held].map(|share| number(100.0 * share));
    format!(
        "; {train} % of the gap is left, and {test} % on the data held back, which is no noise: the law may be another"
    )
}

/// "A", "A, and B", "A, B, and C": what is listed may itself be "X or Y".
fn listed(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{}, and {last}", first.join(", ")),
    }
}
