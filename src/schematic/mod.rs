//! The schematic of a circuit: the symbols of the trade, laid out so that signals run from left to right.
//!
//! [`Schematic::new`] makes it of a circuit, [`Schematic::drawing`] draws it. Cords run level and upright; where
//! cords of one output part, there is a dot; what goes back runs below.

mod describe;
mod json;
mod layout;
mod lists;
mod shapes;
mod sheet;
mod symbol;

pub use layout::{Point, Route};
pub use lists::{List, Row};
pub use sheet::{DrawError, Net, PlacedSymbol, Schematic};
pub use symbol::{Jack, Setting, Source, Symbol, Value};
