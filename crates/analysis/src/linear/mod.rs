//! Linear analysis about an operating point: characteristic roots and frequency response.
//!
//! All functions are pure functions of a [`StateSpace`](patchcord_core::ir::StateSpace), which
//! [`Machine::state_space`](patchcord_core::solve::Machine::state_space) computes. `roots` gives the natural modes,
//! `eigenvalues` does the numerical work for them. `response` gives gain and phase over the frequencies of a `band`,
//! and `phase` makes the phase continuous.

mod band;
mod eigenvalues;
mod error;
mod phase;
mod response;
mod roots;

pub use band::FrequencyBand;
pub use error::LinearError;
pub use response::{FrequencyResponse, ResponsePoint, TransferFunction};
pub use roots::{Root, Stability, fastest_state, roots};
