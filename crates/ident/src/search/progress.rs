//! Progress of a search.

use crate::effects::PlacedEffect;

/// A phase of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SearchPhase {
    /// The patch is fitted without any effect.
    Base,
    /// Every effect is fitted quickly at every site.
    Quick,
    /// The best trials are fitted completely.
    Full,
    /// The best trials are fitted to longer and longer parts of the records.
    Growing,
    /// The missing force is estimated at every junction.
    Localisation,
}

/// A completed trial: an effect at a site, fitted.
///
/// Trials run on several threads, so their order varies. An effect with several forms has a trial for each of them, and
/// the best trials are fitted again in later phases.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TrialResult {
    /// The effect and the element on which it acts.
    pub effect: PlacedEffect,
    /// The rms of the training residuals, in units of the noise, of the best fit of this trial so far. None if the
    /// effect cannot be tried at the site, or the patch with it cannot be run.
    pub residual_rms: Option<f64>,
}

/// The current phase of a search, its completed work, and what is found so far.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Number of the effect that is searched for, from 1. Zero outside rounds.
    pub round: usize,
    /// The current phase.
    pub phase: SearchPhase,
    /// Number of completed trials of this phase.
    pub done: u64,
    /// Number of trials of this phase. Zero if the phase does not count trials.
    pub total: u64,
    /// The effects that are in the patch during this phase. A later phase may replace or drop them.
    pub added: Vec<PlacedEffect>,
    /// The effect with the smallest residual so far among the trials of this round. None before the first trial.
    pub best: Option<PlacedEffect>,
    /// The trial that was completed just now. None at the beginning of a phase.
    pub trial: Option<TrialResult>,
}

impl Progress {
    /// The beginning of a phase that does not count trials.
    pub(crate) fn of(phase: SearchPhase) -> Progress {
        Progress { round: 0, phase, done: 0, total: 0, added: Vec::new(), best: None, trial: None }
    }
}
