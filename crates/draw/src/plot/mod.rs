//! Oscilloscope pictures and line drawings as SVG or PNG files.
//!
//! A [`Picture`] describes one screen: its axes, channels, title and note. [`render()`] stacks pictures
//! one below the other and returns the bytes of a file. A [`Drawing`] is a list of lines, areas and
//! texts at fixed positions; [`render_drawing()`] returns the bytes of its file. Both use the same
//! surfaces for SVG and PNG and the same built-in font. This module knows positions and numbers
//! only; the callers choose what the numbers mean.

mod axis;
mod band;
mod callout;
mod cells;
mod clip;
mod colour;
mod density;
mod draw;
mod drawing;
mod error;
mod exposure;
mod font;
mod format;
mod graticule;
mod header;
mod labels;
mod layout;
mod markers;
mod outlines;
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
pub use density::{Strokes, strokes};
pub use drawing::{Align, Drawing, Label, Primitive, render_drawing, text_width, truncate_text};
pub use error::PlotError;
pub use exposure::{Exposure, Shade};
pub(crate) use font::with_minus_sign;
pub use format::Format;
pub use picture::{Channel, Marker, Picture};
pub use render::{Size, check_sheet, render, render_scaled};
pub use theme::{Ink, Theme};
pub use thin::{drop_repeats, thin};
