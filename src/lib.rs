//! patchcord: a virtual analogue computer.
//!
//! Patches of summers, integrators, potentiometers, diodes and quarter-squares multipliers, written as JSON,
//! wired as a graph, stepped in time in volts, read with the instruments of the period. Five types in a row,
//! each made from the one before: [`patch::Patch`], [`circuit::Circuit`], [`program::Program`],
//! [`trace::Trace`], and what [`instruments`] read.
//!
//! ```
//! use patchcord::{circuit::Circuit, patch::Patch, program::Program, solve};
//!
//! let patch = Patch::read("patches/thesis/fig-8-16.json".as_ref())?;
//! let circuit = Circuit::new(&patch, &[("VcL".into(), 5.08e-3)])?;
//! let program = Program::new(&circuit)?;
//! let settings = solve::RunSettings::of(&circuit)?.lasting(0.1);
//! let trace = solve::run(&program, &settings)?;
//! assert_eq!(trace.track("v_o").unwrap().unit, "m/s");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(feature = "native"), forbid(unsafe_code))]
#![deny(unsafe_code)]
#![warn(missing_docs)]

// Unit tests take what the other tests share, where this is the name.
#[cfg(test)]
extern crate self as patchcord;

pub mod chain;
pub mod circuit;
mod delay_line;
mod divided;
pub mod elements;
pub mod gap;
mod grid;
mod html;
pub mod instruments;
mod kernel;
pub mod linear;
pub mod machines;
pub mod output;
pub mod patch;
pub mod plot;
mod pool;
pub mod program;
pub mod replay;
pub mod schematic;
pub mod slideway;
pub mod solve;
mod spare;
pub mod sweep;
pub mod trace;
