//! Derivatives of runs by parameters: against closed solutions, and against differences of whole runs.

mod bench;
mod closed;
mod differences;
mod phases;
mod random;
mod refused;
mod shipped;
