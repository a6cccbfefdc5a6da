//! The settings of a search.

use crate::effects::Library;

/// The settings of a search.
#[derive(Debug, Clone, Copy)]
pub struct SearchSettings<'a> {
    /// The effects that are tried.
    pub library: &'a Library,
    /// Number of threads that run trials, at least 1. The result does not depend on it.
    pub threads: usize,
    /// Seed of the random numbers for the starts of the fits. The same seed gives the same result.
    pub seed: u64,
}
