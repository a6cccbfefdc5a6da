//! What a fitted model leaves: coloured residuals and their sources, correlations, divergence, misspecified units and signs.

pub mod correlation;
pub mod divergence;
pub(crate) mod intersample;
pub mod misspecification;
pub(crate) mod output_motion;
pub mod residual_analysis;
