//! patchcord: a virtual analogue computer.
//!
//! Patches of summers, integrators, potentiometers, diodes and quarter-squares multipliers, written as JSON,
//! wired as a graph, stepped in time in volts, read with the instruments of the period. Five types in a row,
//! each made from the one before: [`patch::Patch`], [`circuit::Circuit`], [`ir::Program`],
//! [`trace::Trace`], and what [`instruments`] read.
//!
//! ```
//! use patchcord::{circuit::Circuit, ir::Program, patch::Patch, solve};
//!
//! let patch = Patch::read("patches/thesis/fig-8-16.json".as_ref())?;
//! let circuit = Circuit::new(&patch, &[("VcL".into(), 5.08e-3)])?;
//! let program = Program::new(&circuit)?;
//! let settings = solve::RunSettings::of(&circuit)?.lasting(0.1);
//! let trace = solve::run(&program, &settings)?;
//! assert_eq!(trace.track("v_o").unwrap().unit, "m/s");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub use patchcord_analysis::{instruments, linear, sweep};
pub use patchcord_core::{circuit, document, elements, ir, machines, output, patch, solve, trace};
pub use patchcord_draw as draw;
pub use patchcord_expr as expr;
pub use patchcord_ident as ident;
pub use patchcord_thesis as thesis;
