//! Tests of instruments, linear analysis and sweeps.

#[path = "../../core/tests/common/mod.rs"]
mod common;
mod harmonic;
#[path = "../../core/tests/known_problems/mod.rs"]
mod known_problems;
mod linear;
mod phases;
mod sweep;
