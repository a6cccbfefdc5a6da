//! Units of measurement: parsing, dimensions, and the choice of readable prefixes.
//!
//! A unit text is parsed into factors, each a prefix, a symbol and a power. The factors give the
//! size of the unit in SI units and its dimension. Two quantities are comparable if their dimensions
//! are equal. For display, the prefix of the first factor is chosen so that values lie between 1 and
//! 1000.

mod dimension;
mod engineering;
mod error;
mod format;
mod nearest;
mod parse;
mod symbols;
mod synonyms;
mod unit;

pub use dimension::Dimension;
pub use engineering::engineering;
pub use error::UnitError;
pub use nearest::nearest;
pub use unit::Unit;
