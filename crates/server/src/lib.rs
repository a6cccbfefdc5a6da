//! Serves the front panel to a browser on this computer.
//!
//! A [`Server`] has the pages of the panel and two WebSockets, each of which has a thread of its own:
//!
//! * `/session` is a session of the panel (`patchcord_panel::Session`).
//! * `/compare` is a comparison with measured data (`patchcord_compare::Comparison`). While it searches, messages report
//!   its progress. The search ends when the page closes the connection.
//!
//! What protects the computer:
//!
//! * The server listens at the loopback address, unless the options name another one.
//! * A request must name the server by an address or as localhost, so that a page of another site cannot reach it under
//!   a name of that site.
//! * A WebSocket needs a random token, which only the address of the panel has, and only the page itself may open it.
//! * The policy of each response permits only scripts, styles and connections of the server itself.
//! * Only the pages, patches and data in the program are served, and the patch of the options; never files. A session
//!   reads patches and tables below one folder.
//! * [`Limits`] restrict connections, sessions, comparisons, messages and times.

#![forbid(unsafe_code)]

mod browsers;
mod connections;
mod engines;
mod headers;
mod host;
mod limits;
mod names;
mod reasons;
mod routes;
mod server;
mod service;
mod socket;
mod token;
mod worker;

pub use host::GivenPatch;
pub use limits::Limits;
pub use server::{FIRST_PORT, Options, Server, ServerError};
