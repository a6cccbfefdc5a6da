//! Limits, so that no client can use up the computer.

use std::time::Duration;

use patchcord_compare::limits::MAX_REQUEST_BYTES as MAX_COMPARISON_BYTES;
use patchcord_panel::limits::MAX_REQUEST_BYTES;

/// The limits of a server.
#[derive(Debug, Clone)]
pub struct Limits {
    /// How many sessions there are at most. Each has a machine and a thread.
    pub sessions: usize,
    /// How many comparisons with measured data there are at most. A search uses all cores.
    pub comparisons: usize,
    /// How many connections are served at a time, without those of sessions and comparisons. Further ones wait.
    pub connections: usize,
    /// How long a connection may wait for the complete header of its next request.
    pub header: Duration,
    /// How long a connection may last that is neither a session nor a comparison.
    pub connection: Duration,
    /// How long a session or a comparison stays without a message of its page, or while the page does not read an
    /// answer. While it carries out a request, it stays.
    pub silence: Duration,
    /// Size of the largest message to a session in bytes.
    pub message: usize,
    /// Size of the largest message to a comparison in bytes.
    pub comparison_message: usize,
    /// How long the server waits for a page that is loaded again, before the last browser counts as closed.
    pub reload: Duration,
}

impl Default for Limits {
    /// The limits of `patchcord panel`.
    fn default() -> Self {
        Limits {
            sessions: 16,
            comparisons: 2,
            connections: 256,
            header: Duration::from_secs(10),
            connection: Duration::from_secs(60),
            silence: Duration::from_secs(600),
            message: MAX_REQUEST_BYTES,
            comparison_message: MAX_COMPARISON_BYTES,
            reload: Duration::from_secs(3),
        }
    }
}
