//! The slideway study: its physics, its design chain, its figures and its claims.
//!
//! [`slideway`] holds the physics as pure functions. [`chain`] calculates friction parameters from design data,
//! simulates the circuit of Fig 8.16 with them and reads the critical velocity. [`replay`] draws the figures of the
//! study and checks its claims.

#![forbid(unsafe_code)]

pub mod chain;
pub mod replay;
pub mod slideway;
