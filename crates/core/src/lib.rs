//! The engine: patches, circuits, programs, solvers, traces.
//!
//! Five types in a row, each made from the one before by one function: [`patch::Patch`], [`circuit::Circuit`],
//! [`ir::Program`], [`trace::Trace`].

#![cfg_attr(not(feature = "native"), forbid(unsafe_code))]
#![deny(unsafe_code)]

// Unit tests take what the other tests share, where this is the name.
#[cfg(test)]
extern crate self as patchcord_core;

pub mod circuit;
mod delay_line;
mod divided;
pub mod document;
pub mod elements;
mod grid;
pub mod ir;
mod kernel;
mod lower;
pub mod machines;
pub mod output;
pub mod patch;
mod run_settings;
pub mod solve;
pub mod trace;
