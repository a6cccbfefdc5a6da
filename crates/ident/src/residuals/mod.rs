//! Residual analysis: what the residuals of a fitted model reveal about the data and the model.
//!
//! [`divergence`] and [`misspecification`] find errors that no missing effect explains: an unstable model, or a wrong
//! sign or unit in the experiment. [`residual_analysis`] finds sources of coloured residuals other than a missing
//! effect: noise of drives, drives between samples (`intersample`), and slow sensor noise. [`correlation`] compares the
//! residuals with every signal.

pub mod correlation;
pub mod divergence;
pub(crate) mod intersample;
pub mod misspecification;
pub(crate) mod output_motion;
pub mod residual_analysis;
