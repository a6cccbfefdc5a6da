//! Instruments: what can be read from a trace.

mod quantity;
mod scope;
mod voltmeter;

pub use quantity::Display;
pub use scope::{ScopeError, picture};
pub use voltmeter::{Extreme, Reading, readings};
