//! The reasons why a patch cannot be rescaled.

use patchcord_core::document::Report;
use patchcord_core::solve::{RunError, StoppedRunError};

/// The reason why a patch cannot be rescaled.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RescaleError {
    /// The patch has faults.
    #[error(transparent)]
    Patch(Box<Report>),
    /// The settings of the run are invalid.
    #[error("the patch cannot be run: {0}")]
    Settings(RunError),
    /// A run had to stop.
    #[error("the run of the patch stopped: {0}")]
    Run(Box<StoppedRunError>),
    /// The patch cannot have other scales; the text says why.
    #[error("{0}")]
    Impossible(String),
    /// The rescaled patch has faults, for example a pot above 1. The positions are those of its text.
    #[error("the rescaled patch has faults:\n{0}")]
    Faults(Box<Report>),
    /// The rescaled patch does not compute the same as the patch, or it is not known whether it does. It is not returned.
    #[error("the rescaled patch would not compute the same, so it is discarded: {0}")]
    Differs(String),
}
