//! Oscilloscope-style pictures, drawn as SVG or PNG.
//!
//! A [`Picture`] says what is on the screen: axes, channels, title and note.
//! [`render`] turns a sheet of pictures, stacked one below the other, into the
//! bytes of a file. Nothing here knows where the numbers come from.

mod axis;
mod clip;
mod draw;
mod error;
mod font;
mod format;
mod graticule;
mod header;
mod layout;
mod marks;
mod palette;
mod picture;
mod raster;
mod render;
mod scales;
mod surface;
mod svg;
mod thin;
mod ticks;
mod trace;

pub use axis::Axis;
pub use error::PlotError;
pub use format::Format;
pub use picture::{Channel, Mark, Picture};
pub use render::{Size, render};
pub use thin::{drop_repeats, thin};
