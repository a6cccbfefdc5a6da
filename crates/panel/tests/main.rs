//! Integration tests of the panel's session.

mod protocol;
mod session;
