//! What pages use WebSockets for, and how many of them.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::Semaphore;

use crate::limits::Limits;

/// What a page uses a WebSocket for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// A session of the panel.
    Session,
    /// A comparison with measured data.
    Comparison,
}

/// The WebSockets with one purpose.
pub(crate) struct Service {
    /// The purpose.
    pub purpose: Purpose,
    /// How many there are at most.
    pub max: usize,
    /// One permit for each further one.
    pub slots: Arc<Semaphore>,
    /// Size of the largest message to one of them in bytes.
    pub message: usize,
    /// How long one stays without a message of its page while it does nothing, or while the page does not read.
    pub silence: Duration,
}

impl Service {
    /// The service for a purpose, with the limits of a server.
    pub(crate) fn new(purpose: Purpose, limits: &Limits) -> Self {
        let (max, message) = match purpose {
            Purpose::Session => (limits.sessions, limits.message),
            Purpose::Comparison => (limits.comparisons, limits.comparison_message),
        };
        Service { purpose, max, slots: Arc::new(Semaphore::new(max)), message, silence: limits.silence }
    }
}
