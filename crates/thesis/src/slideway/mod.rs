//! The physics of a machine-tool slideway, as the study of its stick-slip derives it, in pure functions.
//!
//! Everything that is handed in or out is in SI units; formulas that the study fitted in kgf, mm, P and cm/s are kept as
//! printed and converted at their edges ([`units`]). "eq 34-7" is equation 34 of the study's chapter 7. Where its sums and
//! its fitted formulas differ, both are here, and say so. What lies outside the range of a law is a [`SlidewayError`],
//! never a plausible number.

pub mod adhesion;
pub mod asperities;
pub mod boundary_film;
pub mod crossing;
pub mod describing;
pub mod design;
pub mod dry_friction;
pub mod falling;
pub mod history;
pub mod hydraulics;
pub mod joint;
pub mod lubricated;
pub mod material;
pub mod measured;
pub mod oil;
pub mod power_law;
pub mod ridge;
pub mod scaling;
pub mod simulated;
pub mod stability;
pub mod tilt;
pub mod units;
pub mod wedge;

mod ellipse;
mod range;
mod root;

pub use range::{Range, SlidewayError};

/// Holds a number to another, within a share of it.
#[cfg(test)]
#[track_caller]
fn near(got: f64, wanted: f64, share: f64) {
    assert!((got / wanted - 1.0).abs() < share, "{got}, not {wanted}");
}
