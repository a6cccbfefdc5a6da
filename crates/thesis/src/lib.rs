//! The slideway study: its physics, its design chain, its figures and its claims.

#![forbid(unsafe_code)]

pub mod chain;
pub mod replay;
pub mod slideway;
