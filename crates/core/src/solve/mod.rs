//! Running a program: the machine with its modes, steps, located events, overloads and recording.
//!
//! `machine` joins the parts. `state`, `buffers`, `evaluate`, `runge_kutta` and `dense_output` take and interpolate a
//! step; `step_control` adapts its length. `events`, `event_location`, `grazing`, `turning_points` and
//! `discontinuities` find what happens within it. `fast_path` and `batch` run kernels instead, alone and side by side.
//! `operation`, `player` and `run` go through the phases of a run, `recorder` keeps its record, and `sensitivity` its
//! derivatives.

mod batch;
mod buffers;
mod controls;
mod dense_output;
mod discontinuities;
mod drive_table;
mod error;
mod evaluate;
mod event_location;
mod events;
mod extrema;
mod fast_path;
mod grazing;
mod lamps;
mod levels;
mod linear;
mod machine;
mod observer;
mod operation;
mod player;
mod recorder;
mod run;
mod runge_kutta;
mod sensitivity;
mod state;
mod step_control;
mod tableau;
mod turning_points;

pub use crate::document::{Change, LEAST_TOLERANCE, Phase, Until};
pub use crate::kernel::{Backend, LANES};
pub use crate::trace::{Overload, Work};
pub use drive_table::{DriveTableError, set_curve, set_drive_table};
pub use error::{RunError, Stopped, TimeSetting};
pub use machine::{Machine, MachineMode};
pub use run::{RunSettings, check, machine_after, run, run_abreast, run_watched};
