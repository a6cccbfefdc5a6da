//! Serves the front panel to a browser on this computer.
//!
//! A [`Server`] has the pages of the panel and a WebSocket at `/session`. Each WebSocket has a session of its own
//! (`patchcord_panel::Session`), on a thread of its own.
//!
//! What protects the computer:
//!
//! * The server listens at the loopback address, unless the options name another one.
//! * A request must name the server by an address or as localhost, so that a page of another site cannot reach it under
//!   a name of that site.
//! * A session needs a random token, which only the address of the panel has. Only the page itself may open its
//!   WebSocket.
//! * The policy of each response permits only scripts, styles and connections of the server itself.
//! * Only the pages and patches in the program are served, never files. A session reads tables below one folder.
//! * [`Limits`] restrict connections, sessions, messages and times.

#![forbid(unsafe_code)]

mod browsers;
mod connections;
mod headers;
mod host;
mod limits;
mod names;
mod routes;
mod server;
mod session_thread;
mod socket;
mod token;

pub use host::GivenPatch;
pub use limits::Limits;
pub use server::{FIRST_PORT, Options, Server, ServerError};
