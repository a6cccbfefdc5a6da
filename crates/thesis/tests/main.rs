//! Tests of the slideway study.

mod chain;
mod claims;
#[path = "../../core/tests/common/mod.rs"]
mod common;
#[path = "../../core/tests/known/mod.rs"]
mod known;
mod others;
mod slideway;
mod thesis;
