//! Scope pictures, Bode plots, velocity profiles, schematics and patch panels.
//!
//! [`plot`] renders pictures and line drawings as SVG or PNG. [`picture()`], [`bode()`],
//! [`profile_picture()`] and [`sensitivity_pictures()`] convert results of a run or of an analysis into
//! pictures. [`picture_samples()`] says which samples of a run its pictures need. A [`TraceEnvelope`] has the few
//! samples of a long run that its pictures against time need.
//! [`schematic`] draws a circuit as a schematic or a patch panel. [`html`] has the frame of generated pages.
//! Nothing here computes physics; the data come from the crates below.

#![forbid(unsafe_code)]

mod bode;
mod envelope;
mod family;
mod faults;
pub mod html;
mod picture_data;
mod picture_samples;
mod plane;
pub mod plot;
mod profile_picture;
pub mod schematic;
mod scope;
mod sensitivity;

pub use bode::bode;
pub use envelope::TraceEnvelope;
pub use picture_data::ScopeError;
pub use picture_samples::{PictureSamples, SampleDemand, TooManySamplesError, picture_samples};
pub use plane::ProfilePlane;
pub use profile_picture::{ProfileSignal, profile_picture};
pub use scope::picture;
pub use sensitivity::sensitivity_pictures;
