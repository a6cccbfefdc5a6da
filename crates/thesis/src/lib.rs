//! The thesis on slideways: its physics, its design chain, its figures and its claims.
//!
//! D. G. Fox, "Non-linear friction behaviour between plain cast iron slideways travelling at slow speeds", is a thesis
//! on the stick-slip of machine-tool slideways. Its circuits are in `patches/thesis`.
//!
//! * [`slideway`] has the physics as pure functions.
//! * [`chain`] calculates friction parameters from design data, simulates the circuit of Fig 8.16 with them and reads
//!   the critical velocity.
//! * [`replay`] draws the figures of the thesis and examines its claims.
//!
//! # Examples
//!
//! The critical velocity of a table of 450 kgf on oil of 0.34 P, by the design equation of the thesis:
//!
//! ```
//! use patchcord_thesis::chain::Inputs;
//! use patchcord_thesis::slideway::design::DesignEquation;
//! use patchcord_thesis::slideway::units::{KGF, MM_PER_S, POISE};
//!
//! // A drive of 27.6 kN/mm.
//! let design = Inputs::of_thesis(0.34 * POISE, 450.0 * KGF, 27.6e6).design()?;
//! let velocity = DesignEquation::derived().critical_velocity(&design)?;
//! assert!((velocity / MM_PER_S - 5.4).abs() < 0.1, "{velocity} m/s");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod chain;
pub mod replay;
pub mod slideway;
