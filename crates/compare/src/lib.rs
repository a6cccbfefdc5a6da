//! The comparison of a patch with measured data, as a session for the front panel.
//!
//! A user selects columns of a data file, turns parameters until the residual is small, and lets a search find the
//! effect that the patch lacks. The session knows nothing about sockets, browsers and clocks. A host passes requests to
//! a [`Comparison`] and sends its responses back. docs/panel-protocol.md documents both.
//!
//! [`command`] and [`event`] are the protocol. `columns` lists what a user can select, and `suggestion` suggests an
//! experiment. `whole_runs` simulates, and `curves` makes the curves. `searching` reports the progress of a search, and
//! `found` its outcome.

#![forbid(unsafe_code)]

mod columns;
pub mod command;
mod curves;
pub mod event;
mod experiment;
mod found;
pub mod limits;
mod message;
mod searching;
mod session;
mod suggestion;
mod whole_runs;

pub use session::{Comparison, ComparisonOptions};
