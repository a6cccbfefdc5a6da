//! Derivatives of runs by parameters: against closed solutions, and against differences of whole runs.

#[path = "../common/mod.rs"]
mod common;

mod bench;
mod circuits;
mod closed;
#[allow(dead_code, reason = "this binary takes what it needs")]
#[path = "../thesis/dice.rs"]
mod dice;
mod differences;
mod phases;
mod random;
mod refused;
mod shipped;
