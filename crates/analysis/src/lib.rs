//! What can be read from a trace and from a program: instruments, linear analysis, sweeps.

#![forbid(unsafe_code)]

pub mod instruments;
pub mod linear;
pub mod pool;
pub mod spare;
pub mod sweep;
