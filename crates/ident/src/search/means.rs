//! What a search is made with.

use crate::effects::Library;

/// What a search is made with.
#[derive(Debug, Clone, Copy)]
pub struct Means<'a> {
    /// The effects that may be missing.
    pub library: &'a Library,
    /// How many threads try them; what is found does not depend on it.
    pub threads: usize,
    /// What the points are drawn by from which the patch is fitted.
    pub seed: u64,
}
