//! Running a program: the machine with its modes, steps, located changes of mode, overloads, recording.

mod delay_line;
mod error;
mod events;
mod grid;
mod hands;
mod machine;
mod overload;
mod rk4;
mod run;
mod watch;

pub use error::RunError;
pub use machine::{Machine, MachineMode, Work};
pub use overload::Overload;
pub use run::{RunSettings, run};
