//! The way of a search: every change of what stands in the patch beside what it had, and what it left.

use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::Stage;

/// What the search did. Names of effects have their places, as in "leak at I2".
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Action {
    /// The patch as it was is fitted: the first entry of every log.
    FitPatch,
    /// The best effect of a round is taken.
    Take(String),
    /// The search continues with the best effect of a round, which is not confirmed by itself.
    ContinueUnconfirmed(String),
    /// The search continues with an effect because one of two effects may hide the other.
    TryInPair(String),
    /// The search returns to what it had before, as more effects are not confirmed together.
    BacktrackFromMore,
    /// The search returns to what it had before, as no pair is confirmed together and leaves only noise.
    BacktrackFromPair,
    /// The same effects are fitted better from the estimate of a trial.
    RefitFromTrial,
    /// The fit of the same effects from before they were tried again one by one is restored, as it leaves less.
    RestoreFit,
    /// An effect is dropped.
    Drop(String),
    /// An effect is tried again with the others in the patch, and kept.
    Keep(String),
    /// An effect replaces another.
    Replace {
        /// The new effect.
        by: String,
        /// The effect that it replaces.
        replaced: String,
    },
}

/// One of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// What was done.
    pub did: Action,
    /// The effects that stood in the patch then, with where they act.
    pub effects: Vec<String>,
    /// What was left then in training and of the data held back, in noise, rms.
    pub left: [f64; 2],
}

impl Change {
    /// What was done, and what came of it.
    pub(crate) fn new(did: Action, effects: &[Candidate], stage: &Stage) -> Change {
        let effects = effects.iter().map(Candidate::named).collect();
        let left = [&stage.train, &stage.test].map(|fitted| fitted.over_noise());
        Change { did, effects, left }
    }
}
