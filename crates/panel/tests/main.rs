//! Integration tests of the panel's session.

mod limits;
mod pictures;
mod protocol;
mod random_commands;
mod session;
mod way_back;
