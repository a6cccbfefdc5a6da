//! Pictures: scope pictures, Bode plots, velocity profiles, schematics and patch panels.

#![forbid(unsafe_code)]

mod bode;
mod family;
pub mod html;
mod plane;
pub mod plot;
mod profile_picture;
pub mod schematic;
mod scope;
mod sensitivity;

pub use bode::bode;
pub use plane::Plane;
pub use profile_picture::{Drawn, profile_picture};
pub use scope::{ScopeError, picture};
pub use sensitivity::sensitivity_pictures;
