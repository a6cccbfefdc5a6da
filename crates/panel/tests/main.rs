//! Integration tests of the panel's session.

mod session;
