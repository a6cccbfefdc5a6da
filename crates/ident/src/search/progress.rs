//! Progress of a search.

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

/// The current phase of a search, and its completed work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
}

impl Progress {
    /// The beginning of a phase that does not count trials.
    pub(crate) fn of(phase: SearchPhase) -> Progress {
        Progress { round: 0, phase, done: 0, total: 0 }
    }
}
