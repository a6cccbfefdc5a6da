//! Tests of the thesis on slideways: its physics, its design chain, its claims and its circuits.

mod chain;
mod claims;
#[path = "../../core/tests/common/mod.rs"]
mod common;
#[path = "../../core/tests/known_problems/mod.rs"]
mod known_problems;
mod others;
mod surface_model;
mod thesis;
mod velocity_readings;
