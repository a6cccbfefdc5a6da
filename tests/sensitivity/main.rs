//! Derivatives of runs by parameters: against closed solutions, and against differences of whole runs.

#[path = "../common/mod.rs"]
mod common;

mod bench;
mod closed;
mod differences;
mod phases;
mod refused;
