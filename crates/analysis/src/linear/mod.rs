//! Linear analysis about an operating point: characteristic roots and frequency response.
//!
//! All functions are pure functions of a [`StateSpace`](patchcord_core::ir::StateSpace), which
//! [`Machine::state_space`](patchcord_core::solve::Machine::state_space) computes. `roots` gives the natural modes,
//! `eigenvalues` does the numerical work for them, and `response` gives gain and phase over a band of frequencies.

mod eigenvalues;
mod error;
mod response;
mod roots;

pub use error::LinearError;
pub use response::{FrequencyBand, FrequencyResponse, ResponsePoint, TransferFunction};
pub use roots::{Root, Stability, fastest_state, roots};
