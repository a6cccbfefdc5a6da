//! Linear analysis about an operating point: characteristic roots and frequency response, pure functions of a
//! [`StateSpace`](crate::program::StateSpace), which [`Machine::state_space`](crate::solve::Machine::state_space) gives.

mod bode;
mod eigenvalues;
mod error;
mod response;
mod roots;

pub use bode::bode;
pub use error::LinearError;
pub use response::{Band, Response, ResponsePoint, Transfer};
pub use roots::{Root, Stability, fastest, roots};
