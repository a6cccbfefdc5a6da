//! The front panel as a pure state machine: commands in, events and frames out.
//!
//! It knows nothing about sockets, browsers and clocks. A host passes requests to a [`Session`] and sends its answers
//! back: the server of `patchcord panel`, or a worker in a web page.

#![forbid(unsafe_code)]

pub mod command;
mod compiled;
pub mod document;
pub mod event;
pub mod frame;
pub mod limits;
pub mod one_file;
pub mod pages;
pub mod patches;
pub mod places;
pub mod scope;
mod session;
pub mod view;
mod wiring;

pub use session::{Answer, Session, SessionOptions};
