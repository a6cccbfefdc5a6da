//! The physics of a machine-tool slideway, as the thesis on its stick-slip derives it, in pure functions.
//!
//! All arguments and results are in SI units. Formulas that the thesis fitted in kgf, mm, P and cm/s are kept as
//! printed; the functions convert units at their beginning and end ([`units`]). "eq 34-7" is equation 34 of the
//! thesis's chapter 7. If a sum of the thesis and its fitted formula differ, both are given and the documentation names
//! the difference. A value outside the range of a law gives a [`SlidewayError`], never a plausible number.
//!
//! Chapter 2 is in [`adhesion`] and [`history`], chapter 4 in [`hydraulics`] and [`tilt`]. Chapter 7 goes from one
//! ridge to the lubricated joint: [`ridge`], [`crossing`], [`asperities`], [`joint`], [`dry_friction`],
//! [`boundary_film`], [`wedge`], [`oil`], [`lubricated`]. Chapter 8 is in [`falling`] and [`scaling`], chapter 9 in
//! [`stability`], [`describing`], [`simulated`], [`measured`] and [`design`].
//!
//! The lag of solid friction behind velocity is also called frictional memory. Its time constant Tc is the field
//! `memory`, and VcL, the velocity from which there is no solid friction, is the field `limit`.
//!
//! # Examples
//!
//! The critical velocity of the thesis's simulated table, by the criterion of Routh and Hurwitz:
//!
//! ```
//! use patchcord_thesis::slideway::falling::FallingFriction;
//! use patchcord_thesis::slideway::stability::DrivenTable;
//! use patchcord_thesis::slideway::units::MM_PER_S;
//!
//! // Tc = 6.5 ms, VcL = 10.16 mm/s.
//! let (table, friction) = (DrivenTable::simulated(6.5e-3), FallingFriction::simulated(10.16 * MM_PER_S));
//! let critical = table.critical_velocity(&friction)?;
//! assert!((critical / MM_PER_S - 6.73).abs() < 0.01);
//!
//! // Below it a small disturbance of steady sliding grows, above it the disturbance decays.
//! assert!(!table.is_stable(friction.slope(0.9 * critical)?)?);
//! assert!(table.is_stable(friction.slope(1.1 * critical)?)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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

/// Asserts that a number agrees with the expected one within a relative tolerance.
#[cfg(test)]
#[track_caller]
fn assert_close(got: f64, expected: f64, tolerance: f64) {
    assert!((got / expected - 1.0).abs() < tolerance, "got {got}, expected {expected}");
}
