//! The design chain: from oil, load, area, stiffness and surface to friction, from friction to the circuit of Fig 8.16 with its
//! potentiometer settings, from the circuit to a run, and from the run to the critical velocity, beside what the equations say and what
//! lowers it.
//!
//! ```
//! use patchcord_thesis::chain::{Chain, Inputs, Settings};
//! use patchcord_thesis::slideway::units::{KGF, POISE};
//!
//! let inputs = Inputs::of_study(0.34 * POISE, 450.0 * KGF, 27.6e6);
//! let chain = Chain::new(&inputs, &Settings::default())?;
//! let rising = chain.simulation.critical.rising.unwrap();
//! assert!((3e-3..12e-3).contains(&rising), "{rising} m/s");
//! # Ok::<(), patchcord_thesis::chain::ChainError>(())
//! ```
//!
//! Everything is in SI units. Physics comes from [`slideway`](crate::slideway), circuit and run from the rest of the library; here is
//! which law gives which number.

mod advice;
mod document;
mod error;
mod inputs;
mod origin;
mod parameters;
mod pictures;
mod predictions;
mod ramp;
mod settings;
mod simulation;
mod table_9_2;

pub use advice::{Advice, Outcome, Verdict};
pub use error::{Beyond, ChainError};
pub use inputs::{Input, Inputs};
pub use origin::{Origin, Other};
pub use parameters::Parameters;
pub use pictures::pictures;
pub use predictions::{Prediction, Predictions};
pub use ramp::Ramp;
pub use settings::Settings;
pub use simulation::{Pot, Simulation};
pub use table_9_2::{Compared, table_9_2};

use crate::slideway::design::Design;
use patchcord_analysis::pool;

/// The whole chain.
#[derive(Debug)]
pub struct Chain {
    /// What it began with.
    pub inputs: Inputs,
    /// The same as the study's design equation has it.
    pub design: Design,
    /// Where the numbers of the friction come from, and what other laws say.
    pub origins: Vec<Origin>,
    /// The circuit, its run, and the critical velocity read off it.
    pub simulation: Simulation,
    /// What equations say of the critical velocity.
    pub predictions: Predictions,
    /// What lowers it, each tried by a run.
    pub advice: Vec<Advice>,
    /// What the reader should know of ranges that were left.
    pub notes: Vec<String>,
}

impl Chain {
    /// Goes through the chain, and through it again for every advice.
    ///
    /// # Errors
    /// Where a law does not hold for the inputs, the circuit cannot be set so, or the run cannot be made.
    pub fn new(inputs: &Inputs, settings: &Settings) -> Result<Chain, ChainError> {
        Chain::watched(inputs, settings, |_, _| ())
    }

    /// The same; `progress` is told again and again how many of all critical velocities have been found.
    ///
    /// # Errors
    /// Those of [`Chain::new`].
    pub fn watched(
        inputs: &Inputs,
        settings: &Settings,
        mut progress: impl FnMut(u64, u64),
    ) -> Result<Chain, ChainError> {
        settings.check()?;
        let design = inputs.design()?;
        let parameters = settings.parameters(&design)?;
        let mut progress = |done| progress(done, 1 + advice::COUNT);
        let simulate = |title: &String| Simulation::new(title, &parameters, settings);
        // On a thread of its own, so that progress is told meanwhile.
        let made = pool::each(&[inputs.title()], 1, simulate, &mut progress);
        let simulation = made.into_iter().collect::<Result<Vec<_>, _>>()?.remove(0);
        let predictions = Predictions::new(&design, &parameters);
        let advice = advice::all(&design, &simulation, settings, |tried| progress(1 + tried));
        let notes = inputs.notes().into_iter().chain(simulation.note()).collect();
        Ok(Chain {
            inputs: *inputs,
            design,
            origins: origin::all(inputs, &design, &parameters, settings),
            simulation,
            predictions,
            advice,
            notes,
        })
    }
}
