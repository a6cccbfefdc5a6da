//! The cancellation of a fit or a search: a flag that another thread, or the receiver of the progress, sets.
//!
//! The flag is checked before every model is compiled and before every run. A run that is left out counts as failed, so
//! a fit ends at once. Its result is not used, because the flag is checked at the end of the first fit, after each trial
//! and at the end of the search.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::fit::model::ModelError;

/// The flag that cancels a fit or a search. By default there is none.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cancellation(Option<Arc<AtomicBool>>);

impl Cancellation {
    /// The cancellation by a flag.
    pub(crate) fn by(flag: &Arc<AtomicBool>) -> Self {
        Cancellation(Some(Arc::clone(flag)))
    }

    /// Whether the fit or the search is cancelled.
    pub(crate) fn is_requested(&self) -> bool {
        self.0.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Does nothing as long as the fit or the search is not cancelled.
    ///
    /// # Errors
    /// [`ModelError::Cancelled`] if it is.
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        if self.is_requested() { Err(ModelError::Cancelled) } else { Ok(()) }
    }
}
