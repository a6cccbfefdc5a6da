//! Linear analysis about an operating point: characteristic roots and frequency response, pure functions of a
//! [`StateSpace`](patchcord_core::ir::StateSpace), which [`Machine::state_space`](patchcord_core::solve::Machine::state_space) gives.

mod eigenvalues;
mod error;
mod response;
mod roots;

pub use error::LinearError;
pub use response::{Band, Response, ResponsePoint, Transfer};
pub use roots::{Root, Stability, fastest, roots};
