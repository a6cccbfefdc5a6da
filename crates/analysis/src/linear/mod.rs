//! Linear analysis about an operating point: characteristic roots and frequency response.
//!
//! All functions are pure functions of a [`StateSpace`](patchcord_core::ir::StateSpace), which
//! [`Machine::state_space`](patchcord_core::solve::Machine::state_space) computes. `roots` gives the natural modes,
//! `eigenvalues` does the numerical work for them. `growth` finds the loop behind a motion that grows, and `start` the traps
//! at the start of a run. `response` gives gain and phase over the frequencies of a `band`, and `phase` makes the phase
//! continuous.

mod band;
pub mod codes;
mod eigenvalues;
mod error;
mod growth;
mod phase;
mod response;
mod roots;
mod start;

pub use band::FrequencyBand;
pub use error::LinearError;
pub use growth::{GrowingLoop, growing_loop, growth_warning, unintended_growth};
pub use response::{FrequencyResponse, ResponsePoint, TransferFunction};
pub use roots::{Root, Stability, fastest_state, roots};
pub use start::start_warnings;

use patchcord_core::ir::Program;

/// Largest number of states, delay lines and drives of a linear model. The time for its roots grows with the third power.
const MAX_VARIABLES: usize = 500;
/// Largest number of derivatives of a linear model. They take 8 bytes each.
const MAX_ENTRIES: usize = 5_000_000;

/// Checks that the linear model of a program is not too large.
///
/// # Errors
/// If it has more than 500 states, delay lines and drives together, or more than 5 million derivatives. Their number is
/// the number of states, delay lines and drives, times the number of states, delay lines and recordable signals. The
/// recordable signals include every drive and every element.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::linear::check_size;
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
///
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let program = Program::new(&Circuit::new(&PatchBuilder::new("decay").element("A1", decay).build()?)?)?;
/// assert!(check_size(&program).is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn check_size(program: &Program) -> Result<(), LinearError> {
    let [rows, variables] = program.state_space_size();
    let entries = rows.saturating_mul(variables);
    if variables <= MAX_VARIABLES && entries <= MAX_ENTRIES {
        return Ok(());
    }
    Err(LinearError::TooLarge { variables, entries, max_variables: MAX_VARIABLES, max_entries: MAX_ENTRIES })
}
