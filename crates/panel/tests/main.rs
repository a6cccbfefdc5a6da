//! Integration tests of the panel's session.

mod pictures;
mod protocol;
mod session;
