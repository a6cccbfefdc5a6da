//! Integration tests of the panel's session.

mod limits;
mod random_commands;
mod session;
