//! The settings of a search.

use std::thread;

use crate::effects::Library;

/// The settings of a search: the effects that it tries, its threads, and the seed of its random numbers.
///
/// # Examples
///
/// ```
/// use patchcord_ident::{Library, SearchSettings};
///
/// let library = Library::shipped();
/// let settings = SearchSettings::new(&library).with_threads(2).with_seed(7);
/// assert_eq!((settings.threads, settings.seed), (2, 7));
/// ```
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct SearchSettings<'a> {
    /// The effects that are tried.
    pub library: &'a Library,
    /// Number of threads that run trials, at least 1. The default is the number of cores. The result does not depend
    /// on it.
    pub threads: usize,
    /// Seed of the random numbers for the starts of the fits. The default is 1. The same seed gives the same result.
    pub seed: u64,
}

impl<'a> SearchSettings<'a> {
    /// The settings for a library, with a thread for each core and the seed 1.
    pub fn new(library: &'a Library) -> Self {
        let threads = thread::available_parallelism().map_or(1, usize::from);
        SearchSettings { library, threads, seed: 1 }
    }

    /// Sets the number of threads. 0 counts as 1.
    #[must_use]
    pub fn with_threads(self, threads: usize) -> Self {
        SearchSettings { threads: threads.max(1), ..self }
    }

    /// Sets the seed.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        SearchSettings { seed, ..self }
    }
}
