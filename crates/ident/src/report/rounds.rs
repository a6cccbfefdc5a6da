//! Rounds and their trials, as sentences and as JSON documents.
//!
//! A round sentence names the best trial, its score, the change of chi-squared in the validation data, and the
//! decision. The same sentence is used on the terminal and on the HTML page.

use patchcord_core::document::plural;
use std::collections::HashSet;

use serde::Serialize;

use crate::effects::PlacedEffect;
use crate::fit::extended_model::{SkipReason, SkippedTrial};
use crate::report::labels::{candidate_label, effect_label, effect_labels, label};
use crate::report::values::{format_pure_number, percent_text};
use crate::search::outcome::Outcome;
use crate::search::round::{Round, Trial};
use crate::statistics::block_comparison::Advantage;

/// A round of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoundDocument {
    /// Its number, counted from 1.
    pub step: usize,
    /// Number of trials.
    pub tried: usize,
    /// The effect of the best trial; null if there is none.
    pub best: Option<String>,
    /// The score that the best trial needs, as a decrease of BIC.
    pub needed: f64,
    /// Whether the best trial was taken.
    pub taken: bool,
    /// Number of trials that the data cannot distinguish from the best, which is counted too.
    pub tied: usize,
    /// The fraction of the gap that the best trial explains, in squares.
    pub closes: f64,
    /// By how much the best trial lowers the chi-squared of the validation data.
    pub confirmed: ConfirmationDocument,
    /// Distance of the best trial's residual from white noise, in standard deviations.
    pub from_white: Option<f64>,
    /// The effects that were in the patch already.
    pub beside: Vec<String>,
    /// The residual of the patch without and with the best trial.
    pub gap: RoundExcessSummary,
}

impl RoundDocument {
    /// A round without trials has null as `best` and `from_white`. `confirmed` is a comparison on the validation data
    /// only.
    pub(super) fn of(number: usize, round: &Round) -> Self {
        let Advantage { sum, standard_error, .. } = round.validation_advantage;
        let best = round.trials.first();
        RoundDocument {
            step: number,
            tried: round.trials.len(),
            best: best.map(|best| best.candidate.effect.clone()),
            needed: round.required_delta_bic,
            taken: round.taken,
            tied: round.tied,
            closes: round.explained_fraction(),
            confirmed: ConfirmationDocument {
                by: sum,
                error: standard_error,
                interval: round.validation_advantage.confidence_interval(),
            },
            from_white: best.map(|best| best.model.ljung_box_z),
            beside: effect_labels(&round.other_effects),
            gap: RoundExcessSummary {
                before: round.before.train.normalised_rms(),
                best: best.map(|best| best.model.train.normalised_rms()),
            },
        }
    }
}

/// By how much a trial lowers the chi-squared of the validation data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConfirmationDocument {
    /// The difference.
    pub by: f64,
    /// Its standard error.
    pub error: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
}

/// The residual in the training data without and with the best trial of a round, rms over the noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoundExcessSummary {
    /// Without it.
    pub before: f64,
    /// With it; null if there is no trial.
    pub best: Option<f64>,
}

/// A trial of a round.
///
/// A trial is one effect in one form at one site, with one choice of the signals that it reads.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RivalDocument {
    /// The round, counted from 1.
    pub step: usize,
    /// The effect.
    pub name: String,
    /// The form of the effect, as text; empty if there is only one.
    pub form: String,
    /// The element that it acts on.
    pub junction: String,
    /// The signals that it reads, if there is a choice.
    pub reads: Vec<String>,
    /// The score: the decrease of BIC by the effect.
    pub score: f64,
    /// The score that the best trial of the round needs.
    pub needed: f64,
    /// The residual in the training data, rms over the noise.
    pub gap: f64,
    /// The residual in the validation data, rms over the noise.
    #[serde(rename = "held_out_gap")]
    pub validation_gap: f64,
    /// By how much the best trial has a smaller chi-squared.
    pub behind: AdvantageSummary,
    /// Whether the data cannot distinguish it from the best trial.
    pub tied: bool,
    /// Whether it was fitted completely, or only quickly.
    pub gone_through: bool,
}

impl RivalDocument {
    /// `behind` compares the residuals of the trial with those of the best trial of the round, sample by sample.
    pub(super) fn of(number: usize, round: &Round, trial: &Trial) -> Self {
        RivalDocument {
            step: number,
            name: trial.candidate.effect.clone(),
            form: trial.candidate.note.clone(),
            junction: trial.candidate.site.clone(),
            reads: trial.candidate.reads.clone(),
            score: trial.delta_bic,
            needed: round.required_delta_bic,
            gap: trial.model.train.normalised_rms(),
            validation_gap: trial.model.validation.normalised_rms(),
            behind: AdvantageSummary {
                by: trial.best_advantage.sum,
                error: trial.best_advantage.standard_error,
            },
            tied: round.is_tied(trial),
            gone_through: trial.model.is_thorough,
        }
    }
}

/// By how much the best trial of a round has a smaller chi-squared than another, in the compared records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdvantageSummary {
    /// The difference.
    pub by: f64,
    /// Its standard error.
    pub error: f64,
}

/// An effect that was not tried at a site, as a JSON document.
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
        SkippedTrialDocument {
            name: skipped.effect.clone(),
            junction: skipped.site.clone(),
            why: skip_reason_text(&skipped.reason),
            step,
        }
    }
}

/// Why an effect is not tried at a site. The text of an invalid patch has several lines.
fn skip_reason_text(reason: &SkipReason) -> String {
    match reason {
        SkipReason::NoScale => {
            "its size cannot be estimated: its input is always zero, or the residuals have no dominant frequency"
                .to_owned()
        }
        SkipReason::NotRunnable => "the patch with this effect cannot be run from any start".to_owned(),
        SkipReason::Model(error) => error.to_string(),
    }
}

/// Which effect is not tried at which site, and why, in one line. Only the first line of the reason is used.
pub fn skipped_trial_sentence(skipped: &SkippedTrial) -> String {
    let reason = skip_reason_text(&skipped.reason);
    let first_line = reason.lines().next().unwrap_or_default();
    format!("{} is not tried: {first_line}", label(&skipped.effect, &skipped.site))
}

/// The result of a round, which other effects were dropped later, and why a taken effect has no name in the verdict.
pub fn round_sentence(outcome: &Outcome, round: &Round) -> String {
    let is_kept = |placed: &PlacedEffect| outcome.effects.iter().any(|kept| kept.placed_effect() == *placed);
    let dropped = round.other_effects.iter().filter(|placed| !is_kept(placed));
    let dropped: String =
        dropped.map(|placed| format!(" {} was dropped later.", effect_label(placed))).collect();
    let is_unnamed = round.taken && !outcome.verdict.has_names();
    let unnamed = if is_unnamed { " It is not named, because the final residual is too large." } else { "" };
    result_sentence(round) + &dropped + unnamed
}

/// The number of effects and of trials, for example "10 effects tried in 27 ways". Ways are sites, forms and signals
/// that are read.
pub fn trial_count_text(round: &Round) -> String {
    let effects: HashSet<&str> = round.trials.iter().map(|trial| trial.candidate.effect.as_str()).collect();
    let [effects, ways] =
        [(effects.len(), "effect"), (round.trials.len(), "way")].map(|(count, noun)| plural(count, noun));
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
        format_pure_number(round.validation_advantage.sum),
        round.validation_advantage.confidence_interval().map(format_pure_number).join(" ... ")
    );
    let context = match round.other_effects.is_empty() {
        true => String::new(),
        false => format!("With {} in the patch, ", effect_labels(&round.other_effects).join(" and ")),
    };
    let score = format!(
        "{context}{} is the best, with a score (delta BIC) of {}",
        candidate_label(&best.candidate),
        format_pure_number(best.delta_bic)
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
                format_pure_number(round.required_delta_bic)
            )
        }
        (false, _) if !round.has_sufficient_effect() => format!(
            "{score}; but it explains only {} of the gap (in squares), and the rest is not noise. None is taken.",
            percent_text(100.0 * round.explained_fraction())
        ),
        (false, _) => format!("{score}; but {validation}, which is not significant. None is taken."),
    }
}
