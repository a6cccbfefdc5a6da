//! Running a program: the machine with its modes, steps, located changes of mode, overloads, recording.

mod breaks;
mod control;
mod convoy;
mod error;
mod events;
mod feed;
mod glide;
mod hands;
mod level_source;
mod linear;
mod locate;
mod machine;
mod operation;
mod overload;
mod peaks;
mod player;
mod recorder;
mod run;
mod sensitivity;
mod stride;
mod suspicion;
mod tableau;
mod turn;
mod watch;

pub use crate::document::{Change, LEAST_TOLERANCE, Phase, Until};
pub use crate::kernel::{Backend, LANES};
pub use crate::trace::{Overload, Work};
pub use error::{RunError, Stopped, TimeSetting};
pub use feed::bend;
pub use feed::{FeedError, feed};
pub use hands::preset;
pub use machine::{Machine, MachineMode};
pub use run::{RunSettings, check, machine_after, run, run_abreast, run_watched};
