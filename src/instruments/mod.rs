//! Instruments: what can be read from a trace.

mod harmonic;
mod quantity;
mod ringing;
mod scope;
mod voltmeter;

pub use harmonic::{Harmonic, HarmonicError, harmonic};
pub use quantity::Display;
pub use ringing::{Ringing, RingingError, ringing};
pub use scope::{ScopeError, picture};
pub use voltmeter::{Extreme, Reading, readings};
