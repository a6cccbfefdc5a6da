//! Statistics of samples and residuals, independent of patches and experiments.
//!
//! `descriptive` has means, medians and quantiles. `projection` treats samples as vectors. `whiteness` tests whether
//! residuals are white and measures their correlation. `block_comparison` compares two fits of the same data, and
//! `acceptance` has the limits that decide whether an effect is accepted. `rng` draws random numbers.

pub(crate) mod acceptance;
pub mod block_comparison;
pub(crate) mod descriptive;
pub(crate) mod projection;
pub(crate) mod rng;
pub mod whiteness;
