//! Numbers and tracks: descriptive statistics, whiteness, comparison of fits block by block, projections, random numbers.

pub(crate) mod acceptance;
pub mod block_comparison;
pub(crate) mod descriptive;
pub(crate) mod directions;
pub(crate) mod rng;
pub mod whiteness;
