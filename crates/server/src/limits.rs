//! Limits, so that no client can use up the computer.

use std::time::Duration;

use patchcord_panel::limits::MAX_REQUEST_BYTES;

/// The limits of a server.
#[derive(Debug, Clone)]
pub struct Limits {
    /// How many sessions there are at most. Each has a machine and a thread.
    pub sessions: usize,
    /// How many connections are served at a time, without those of sessions. Further ones wait.
    pub connections: usize,
    /// How long a connection may wait for the complete header of its next request.
    pub header: Duration,
    /// How long a connection may last that is not a session.
    pub connection: Duration,
    /// How long a session stays without a message of its page, or while the page does not read an answer.
    pub silence: Duration,
    /// Size of the largest message to a session in bytes.
    pub message: usize,
    /// How long the server waits for a page that is loaded again, before the last browser counts as closed.
    pub reload: Duration,
}

impl Default for Limits {
    /// The limits of `patchcord panel`.
    fn default() -> Self {
        Limits {
            sessions: 16,
            connections: 256,
            header: Duration::from_secs(10),
            connection: Duration::from_secs(60),
            silence: Duration::from_secs(600),
            message: MAX_REQUEST_BYTES,
            reload: Duration::from_secs(3),
        }
    }
}
