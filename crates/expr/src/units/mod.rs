//! Units of measurement: reading them, checking that they fit, and choosing readable ones.

mod dimension;
mod engineering;
mod error;
mod nearest;
mod read;
mod symbols;
mod unit;
mod write;

pub use dimension::Dimension;
pub use engineering::engineering;
pub use error::UnitError;
pub use nearest::nearest;
pub use unit::Unit;
