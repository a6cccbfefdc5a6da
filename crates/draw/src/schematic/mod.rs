//! The schematic of a circuit: the symbols of the trade, laid out so that signals run from left to right.
//!
//! [`Schematic::new`] makes it of a circuit, [`Schematic::drawing`] draws it. Cords run level and upright; where
//! cords of one output part, there is a dot; what goes back runs below.

mod board;
mod describe;
mod diagram;
mod heading;
mod json;
mod layout;
mod legend;
mod lists;
mod shapes;
mod sheet;
mod symbol;
mod view;

pub use board::{Board, Cord, Link, Module};
pub use diagram::{Diagram, Net, PlacedSymbol};
pub use layout::{Point, Route};
pub use legend::legend;
pub use lists::{List, Row};
pub use sheet::{DrawError, Opened, Schematic};
pub use symbol::{Jack, Outlet, Setting, Source, Standing, Symbol, Value};
