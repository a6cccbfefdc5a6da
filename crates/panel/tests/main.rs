//! Integration tests of the panel's session.

mod client;
mod faceplates;
mod files;
mod limits;
mod pictures;
mod random_commands;
mod session;
mod way_back;
