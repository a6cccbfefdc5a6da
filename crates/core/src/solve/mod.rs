//! Runs a program: integration, located events, overload lamps, phases, recording and derivatives.
//!
//! `machine` joins the modules. `evaluate`, `runge_kutta`, `tableau` and `dense_output` take a step and interpolate in
//! it; `state` and `buffers` hold its data, and `step_control` adapts its length. `events`, `event_location`,
//! `grazing`, `turning_points`, `levels` and `discontinuities` find the events and jumps at which a step has to end.
//! `fast_path` runs a compiled or interpreted kernel while no event is due, and `batch` runs kernels in lanes.
//! `settings`, `settings_blocks`, `settings_curves` and `settings_check` describe a run; `operation`, `player` and
//! `run` play its phases. `recorder` records signals, `extrema` and `lamps` find their peaks and overloads, and
//! `sensitivity` computes derivatives. `limit_drive` measures how integrators are driven against their limits, and
//! `cord_chains` follows cords from element to element. `step_check`, `check_plan`, `step_comparison` and
//! `thinned_trace` find steps that are too long. `controls` and `drive_table` change settings, and `readings` reads a
//! machine. `drive_sections` evaluates drives for another solver. `live` plays a run in pieces for an operator who
//! watches and interferes, and `transfer` continues it with another program.

mod amplifier_peaks;
mod batch;
mod buffers;
mod check_plan;
mod controls;
mod cord_chains;
mod dense_output;
mod discontinuities;
mod drive_sections;
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
mod limit_drive;
mod linear;
mod live;
mod machine;
mod minimum_search;
mod observer;
mod operation;
mod player;
mod readings;
mod recorder;
mod run;
mod runge_kutta;
mod sensitivity;
mod settings;
mod settings_blocks;
mod settings_check;
mod settings_curves;
mod state;
mod step_check;
mod step_comparison;
mod step_control;
mod stopped_run;
mod tableau;
mod thinned_trace;
mod time_setting;
mod transfer;
mod turning_points;
mod turns;

pub use crate::document::{
    MAX_TOLERANCE, MIN_TOLERANCE, ParameterChange, Phase, SwitchCondition, is_tolerance,
};
pub use crate::kernel::{Backend, LANES};
pub use crate::trace::{LimitDrive, Overload, WorkCounters};
pub use dense_output::Curve as StateCurve;
pub use drive_sections::DriveSections;
pub use drive_table::{CurveError, DriveTableError, set_curve, set_drive_table};
pub use error::RunError;
pub use live::{Checkpoint, LiveRun, LiveState};
pub use machine::{Machine, MachineMode};
pub use recorder::WatchedPoints;
pub use run::{check, machine_after, run, run_batch, run_in_blocks, run_with_progress, sufficient_step};
pub use runge_kutta::{advance_states, weighted_sum};
pub use settings::RunSettings;
pub use settings_blocks::BLOCK_SAMPLES;
pub use stopped_run::StoppedRunError;
pub use tableau::{DORMAND_PRINCE, Stage, StageWeight, Tableau};
pub use time_setting::TimeSetting;
