//! The schematic of a circuit: the symbols of the trade, laid out so that signals run from left to right.
//!
//! [`Schematic::new`] makes it of a circuit, [`Schematic::drawing`] draws it. Cords run level and upright; where
//! cords of one output part, there is a dot; what goes back runs below.

mod board;
mod describe;
mod heading;
mod json;
mod layout;
mod legend;
mod lists;
mod shapes;
mod sheet;
mod symbol;

pub use board::{Board, Cord, Module};
pub use layout::{Point, Route};
pub use legend::legend;
pub use lists::{List, Row};
pub use sheet::{DrawError, Net, PlacedSymbol, Schematic};
pub use symbol::{Jack, Setting, Source, Symbol, Value};
