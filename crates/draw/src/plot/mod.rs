//! Oscilloscope-style pictures and line drawings, drawn as SVG or PNG.
//!
//! A [`Picture`] says what is on the screen: axes, channels, title and note.
//! [`render`] turns a sheet of pictures, stacked one below the other, into the
//! bytes of a file. A [`Drawing`] is lines, areas and texts in their places, and
//! [`render_drawing`] makes a file of it. Nothing here knows where the numbers come from.

mod axis;
mod band;
mod clip;
mod draw;
mod drawing;
mod error;
mod font;
mod format;
mod graticule;
mod header;
mod labels;
mod layout;
mod marks;
mod palette;
mod picture;
mod raster;
mod render;
mod scales;
mod surface;
mod svg;
mod theme;
mod thin;
mod ticks;
mod trace;

pub use axis::Axis;
pub use clip::Area;
pub use drawing::{Align, Drawing, Label, Stroke, render_drawing, text_width, text_within};
pub use error::PlotError;
pub use format::Format;
pub use picture::{Channel, Mark, Picture};
pub use render::{Size, render};
pub use theme::{Ink, Theme};
pub use thin::{drop_repeats, thin};
