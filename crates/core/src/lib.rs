//! The engine: it reads patches, checks and compiles them, runs them and records the results.
//!
//! A patch passes through five types. Each is made from the one before by one function that can be called alone:
//! [`patch::Patch`] (the document), [`circuit::Circuit`] (checked and resolved), [`ir::Program`] (primitive
//! operations), [`solve::Machine`] (a running program) and [`trace::Trace`] (the recorded run).
//!
//! Modules depend on each other in one direction only. Drawing, the command line and the instruments live in other
//! crates.

#![cfg_attr(not(feature = "native"), forbid(unsafe_code))]
#![deny(unsafe_code)]

// Unit tests share helpers with the integration tests, which refer to this crate by its name.
#[cfg(test)]
extern crate self as patchcord_core;

pub mod chords;
pub mod circuit;
mod delay_line;
mod divided_differences;
pub mod document;
pub mod elements;
mod grid;
pub mod ir;
mod kernel;
pub mod low_discrepancy;
mod lower;
pub mod machines;
mod multiply_add;
pub mod output;
mod parabola;
pub mod patch;
mod run_settings;
pub mod solve;
pub mod trace;
