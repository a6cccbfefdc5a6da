//! The log of a search, as text and as JSON documents.
//!
//! The log has one entry per change of the effects in the patch. It explains how the search reached its result if
//! that took more than one change, for example if an effect was replaced or dropped.

use serde::Serialize;

use crate::report::labels::{effect_label, effect_labels};
use crate::report::ranges::RemainingResidualSummary;
use crate::search::search_log::{Action, LogEntry};

/// An entry of the log as a JSON document.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchLogDocument {
    /// The action, as text.
    pub did: String,
    /// The effects in the patch after the action, each at its site.
    pub effects: Vec<String>,
    /// The residual of the patch with these effects.
    pub left: RemainingResidualSummary,
}

impl From<&LogEntry> for SearchLogDocument {
    /// The residual is that after the action, rms over the noise.
    fn from(entry: &LogEntry) -> Self {
        let [train, validation] = entry.residual_rms;
        SearchLogDocument {
            did: action_text(&entry.action),
            effects: effect_labels(&entry.effects),
            left: RemainingResidualSummary { train, validation },
        }
    }
}

/// An action of the search as text, for example "leak at I2 is taken".
pub fn action_text(action: &Action) -> String {
    match action {
        Action::FitPatch => "the original patch is fitted".to_owned(),
        Action::Take(effect) => format!("{} is taken", effect_label(effect)),
        Action::ContinueUnconfirmed(effect) => {
            format!("{} is added, although it is not confirmed by itself", effect_label(effect))
        }
        Action::TryInPair(effect) => {
            format!(
                "{} is added for a pair, because one of two effects may hide the other",
                effect_label(effect)
            )
        }
        Action::BacktrackFromMore => {
            "the search returns, because the additional effects are not confirmed".to_owned()
        }
        Action::BacktrackFromPair => {
            "the search returns, because no pair is confirmed and leaves only noise".to_owned()
        }
        Action::RefitFromTrial => {
            "the same effects are fitted better, from the estimate of a trial".to_owned()
        }
        Action::RestoreFit => "the earlier fit of the same effects is restored".to_owned(),
        Action::Drop(effect) => format!("{} is dropped", effect_label(effect)),
        Action::Keep(effect) => {
            format!("{} is tried again with the others, and kept", effect_label(effect))
        }
        Action::Replace { by, replaced } => {
            format!("{} replaces {}", effect_label(by), effect_label(replaced))
        }
    }
}
