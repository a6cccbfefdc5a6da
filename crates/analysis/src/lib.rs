//! Everything that patchcord computes from a trace or from a program.
//!
//! `format` prints quantities with few digits and a unit prefix.
//! `instruments` reads quantities off one recorded trace: extremes, frequencies, critical velocities.
//! `linear` linearises a program about an operating point and computes its eigenvalues and frequency response.
//! `sweep` runs a patch for many parameter values and writes one CSV row per combination.
//! `parallel` distributes such work over threads. Results do not depend on the number of threads.

#![forbid(unsafe_code)]

pub mod format;
pub mod instruments;
pub mod linear;
pub mod parallel;
pub mod sweep;
