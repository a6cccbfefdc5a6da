//! Tests of instruments, linear analysis and sweeps.

#[path = "../../core/tests/common/mod.rs"]
mod common;
mod harmonic;
#[path = "../../core/tests/known/mod.rs"]
mod known;
mod linear;
mod phases;
mod sweep;
