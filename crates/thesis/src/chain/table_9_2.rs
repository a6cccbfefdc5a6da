//! Table T9-2: twelve measured critical velocities, beside the study's equation, Routh-Hurwitz and runs.

use super::error::ChainError;
use super::parameters::Parameters;
use super::predictions::{Prediction, fitted, stability};
use super::settings::Settings;
use super::simulation::Simulation;
use crate::slideway::SlidewayError;
use crate::slideway::measured::{Measurement, TABLE_9_2};
use crate::slideway::simulated::OilLaw;
use crate::slideway::stability::SIMULATED_DAMPING;
use crate::slideway::units::{GRAVITY, KGF};
use patchcord_analysis::instruments::CriticalVelocity;
use patchcord_analysis::pool;

/// Weight of the table that was measured, in N.
const WEIGHT: f64 = 450.0 * KGF;

/// A measured critical velocity beside what is worked out for it, all in m/s.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The cell.
    pub cell: Measurement,
    /// What the circuit was set by: Fs and VcL of the measurements, and the Tc of the oil by eq 17-9.
    pub parameters: Parameters,
    /// Measured.
    pub measured: f64,
    /// By eq 18-9.
    pub equation: Prediction,
    /// By Routh-Hurwitz.
    pub stability: Prediction,
    /// Read off a run.
    pub run: CriticalVelocity,
    /// The same with half of the threshold, and with twice as much.
    pub nearby: [CriticalVelocity; 2],
    /// Read off a run with the cell's own Tc, which makes eq 7-9 give what was measured.
    pub own_memory: CriticalVelocity,
}

/// The twelve cells, in the order of [`TABLE_9_2`]. Of what is set only the command counts.
///
/// # Errors
/// Where a run cannot be made.
pub fn table_9_2(settings: &Settings) -> Result<Vec<Compared>, ChainError> {
    pool::each(&TABLE_9_2, settings.threads, |cell| compared(cell, settings), |_| ()).into_iter().collect()
}

fn compared(cell: &Measurement, settings: &Settings) -> Result<Compared, ChainError> {
    let parameters = parameters(cell)?;
    let run = |parameters: &Parameters| Simulation::new("", parameters, settings);
    let own = Parameters { memory: cell.memory, ..parameters };
    let simulation = run(&parameters)?;
    Ok(Compared {
        cell: *cell,
        parameters,
        measured: cell.critical_velocity()?,
        equation: fitted(&parameters),
        stability: stability(&parameters),
        run: simulation.critical,
        nearby: simulation.nearby,
        own_memory: run(&own)?.critical,
    })
}

fn parameters(cell: &Measurement) -> Result<Parameters, SlidewayError> {
    Ok(Parameters {
        mass: WEIGHT / GRAVITY,
        stiffness: cell.stiffness,
        damping: SIMULATED_DAMPING,
        static_friction: cell.friction().static_friction,
        limit: cell.limit,
        memory: OilLaw::AT_450_KGF.memory(cell.viscosity)?,
    })
}
