//! Units of measurement: parsing, dimensions, and the choice of readable prefixes.
//!
//! A unit text is parsed into factors, each a prefix, a symbol and a power. The factors give the
//! size of the unit in SI units and its dimension. Two quantities are comparable if their dimensions
//! are equal. For display, the prefix of the first factor is chosen so that values lie between 1 and
//! 1000.
//!
//! `conversion` has the only rule for conversions between units, also for angles and revolutions. `label`
//! reads units in the names of columns, which are written less strictly.

mod conversion;
mod dimension;
mod engineering;
mod error;
mod format;
mod label;
mod nearest;
mod parse;
mod symbols;
mod synonyms;
mod unit;

pub use conversion::{Conversion, ConversionError};
pub use dimension::Dimension;
pub use engineering::engineering;
pub use error::UnitError;
pub use label::UnitLabel;
pub use nearest::nearest;
pub use parse::plain_superscript;
pub use unit::Unit;
