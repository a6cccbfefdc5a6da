//! Integration tests of the panel's session.

mod limits;
mod protocol;
mod random_commands;
mod session;
