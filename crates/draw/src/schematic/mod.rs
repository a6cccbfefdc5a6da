//! Schematics and patch panels of a circuit.
//!
//! [`Schematic::new`] converts a circuit into symbols, lays them out so that signals run from left to
//! right, and routes the cords. [`Schematic::drawing`] returns the drawing. Cords consist of horizontal
//! and vertical lines, a dot marks each branch, and feedback runs below its row. [`Board`] is the patch
//! panel with modules, jacks and cords. [`legend()`] shows every symbol.

mod board;
mod describe;
mod diagram;
mod heading;
mod json;
mod layout;
mod legend;
mod lists;
mod live;
mod number_text;
mod settings;
mod shapes;
mod sheet;
mod symbol;
mod view;

pub use board::{Board, Cord, Link, Module, jack_label};
pub use diagram::{Diagram, Net, PlacedSymbol};
pub use layout::{Point, Route};
pub use legend::legend;
pub use lists::{List, ListRow};
pub use settings::{number as setting_number, of_element as settings_of_element};
pub use sheet::{DrawError, OpenedMacro, Schematic};
pub use symbol::{CordSource, ElementState, Jack, SettingValue, Symbol, SymbolOutput, SymbolSetting};
