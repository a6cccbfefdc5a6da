//! The log of a search: every change of the effects in the patch, and the residual after it.

use crate::effects::PlacedEffect;
use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::FittedModel;

/// One action of a search.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Action {
    /// The patch as it was is fitted: the first entry of every log.
    FitPatch,
    /// The best effect of a round is taken.
    Take(PlacedEffect),
    /// The search continues with the best effect of a round, which is not confirmed by itself.
    ContinueUnconfirmed(PlacedEffect),
    /// The search continues with an effect because one of two effects may hide the other.
    TryInPair(PlacedEffect),
    /// The search returns to an earlier state because the larger set of effects is not confirmed.
    BacktrackFromMore,
    /// The search returns to an earlier state because no pair is both confirmed and leaves only noise.
    BacktrackFromPair,
    /// The same effects are fitted better from the estimate of a trial.
    RefitFromTrial,
    /// The fit from before the refinement is restored, because it has the same effects and a smaller residual.
    RestoreFit,
    /// An effect is dropped.
    Drop(PlacedEffect),
    /// An effect is tried again with the others in the patch, and kept.
    Keep(PlacedEffect),
    /// An effect replaces another.
    Replace {
        /// The new effect.
        by: PlacedEffect,
        /// The effect that it replaces.
        replaced: PlacedEffect,
    },
}

/// An entry of the log.
#[derive(Debug, Clone, PartialEq)]
pub struct LogEntry {
    /// The action.
    pub action: Action,
    /// The effects in the patch after the action.
    pub effects: Vec<PlacedEffect>,
    /// Rms residual over the noise after the action: of the training records, then of the validation records.
    pub residual_rms: [f64; 2],
}

impl LogEntry {
    /// The entry for an action that leads to `effects` and `model`.
    pub(crate) fn new(action: Action, effects: &[Candidate], model: &FittedModel) -> LogEntry {
        let effects = effects.iter().map(Candidate::placed_effect).collect();
        let residual_rms = [&model.train, &model.validation].map(|fitted| fitted.normalised_rms());
        LogEntry { action, effects, residual_rms }
    }
}
