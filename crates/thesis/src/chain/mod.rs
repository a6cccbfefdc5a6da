//! The design chain from the data of a slideway to its critical velocity.
//!
//! 1. [`Inputs`] (oil, load, area, stiffness, surface) give the friction [`Parameters`].
//! 2. The parameters give the circuit of Fig 8.16 and its potentiometer settings.
//! 3. A run of the circuit under a velocity command that rises and falls gives the critical velocity ([`Simulation`]).
//! 4. The equations of the thesis give the critical velocity for comparison ([`Predictions`]).
//! 5. Every design rule of section 9.5 is tested by a further run ([`Advice`]).
//!
//! # Examples
//!
//! A table of 450 kgf on oil of 0.34 P, with a drive of 27.6 kN/mm. The critical velocity of the rising command is read
//! from a run:
//!
//! ```
//! use patchcord_thesis::chain::{Chain, Inputs, Settings};
//! use patchcord_thesis::slideway::units::{KGF, POISE};
//!
//! let inputs = Inputs::of_thesis(0.34 * POISE, 450.0 * KGF, 27.6e6);
//! let chain = Chain::new(&inputs, &Settings::default())?;
//! let rising = chain.simulation.critical.rising?;
//! assert!((3e-3..12e-3).contains(&rising), "{rising} m/s");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! All quantities are in SI units. The physics is in [`slideway`](crate::slideway). This module decides which law
//! gives which number.

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

pub use advice::{Advice, AdviceOutcome, AdviceVerdict};
pub use document::template;
pub use error::{ChainError, RangeViolation};
pub use inputs::{Input, Inputs};
pub use origin::{AlternativeValue, Origin};
pub use parameters::Parameters;
pub use pictures::pictures;
pub use predictions::{Prediction, Predictions};
pub use ramp::Ramp;
pub use settings::Settings;
pub use simulation::{PotSetting, Simulation};
pub use table_9_2::{MeasurementComparison, table_9_2};

use crate::slideway::design::Design;

/// The result of the whole chain.
///
/// # Examples
///
/// With a drive of 20 kN/mm the runs confirm every rule of section 9.5. The table of parameters names the law that
/// gave each:
///
/// ```
/// use patchcord_thesis::chain::{AdviceVerdict, Chain, Inputs, Settings};
/// use patchcord_thesis::slideway::units::{KGF, POISE};
///
/// let inputs = Inputs::of_thesis(0.34 * POISE, 450.0 * KGF, 20e6);
/// let chain = Chain::new(&inputs, &Settings::default())?;
/// assert!(chain.advice.iter().all(|advice| advice.verdict == AdviceVerdict::Confirmed));
///
/// let limit = chain.origins.iter().find(|origin| origin.name == "VcL").ok_or("VcL")?;
/// assert_eq!((limit.unit, limit.from.as_str()), ("m/s", "eq 11-9"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Chain {
    /// The input data.
    pub inputs: Inputs,
    /// The inputs in the form that the thesis's design equation (eq 93-9) takes.
    pub design: Design,
    /// The parameters of the circuit with the law that gives each, in the order of [`Parameters::NAMES`].
    pub origins: Vec<Origin>,
    /// The circuit, its run, and the critical velocity that was read from the run.
    pub simulation: Simulation,
    /// The critical velocity by the equations of the thesis.
    pub predictions: Predictions,
    /// The rules of section 9.5 that lower the critical velocity, each tested by a run; in the order of 9.5, a to g.
    pub advice: Vec<Advice>,
    /// Warnings for the reader: inputs outside the measured ranges, and oscillation whose end is not seen.
    pub notes: Vec<String>,
}

impl Chain {
    /// Calculates the chain, and once more for every rule of section 9.5.
    ///
    /// # Errors
    /// If a law does not hold for the inputs, the circuit cannot be set, or the run fails.
    pub fn new(inputs: &Inputs, settings: &Settings) -> Result<Chain, ChainError> {
        Chain::with_progress(inputs, settings, |_, _| ())
    }

    /// Calculates the chain and reports progress.
    ///
    /// `progress` receives the number of finished runs and the number of all runs, several times until both are equal.
    ///
    /// # Errors
    /// The errors of [`Chain::new`].
    pub fn with_progress(
        inputs: &Inputs,
        settings: &Settings,
        mut progress: impl FnMut(u64, u64) + Send,
    ) -> Result<Chain, ChainError> {
        settings.check()?;
        let design = inputs.design()?;
        let parameters = settings.parameters(&design)?;
        let mut progress = |done| progress(done, 1 + advice::COUNT);
        progress(0);
        let simulation = Simulation::new(&inputs.title(), &parameters, settings)?;
        progress(1);
        let predictions = Predictions::new(&design, &parameters);
        let advice = advice::all(&design, &simulation, settings, |done| progress(1 + done));
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
