//! Table T9-2: twelve measured critical velocities compared with the thesis's equation, Routh-Hurwitz and runs.

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
use patchcord_analysis::parallel;

/// Weight of the measured table in N: 450 kgf (9.3).
const WEIGHT: f64 = 450.0 * KGF;

/// A measured critical velocity compared with calculated ones, all in m/s.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementComparison {
    /// The cell of Table T9-2.
    pub cell: Measurement,
    /// The parameters of the circuit: Fs and VcL of the measurement, and the Tc of the oil by eq 17-9.
    pub parameters: Parameters,
    /// The measured critical velocity.
    pub measured: f64,
    /// The critical velocity by eq 18-9.
    pub equation: Prediction,
    /// The critical velocity by Routh-Hurwitz.
    pub stability: Prediction,
    /// The critical velocity that was read from a run.
    pub run: CriticalVelocity,
    /// The critical velocity of the same run with half the threshold and with twice the threshold.
    pub nearby_thresholds: [CriticalVelocity; 2],
    /// The critical velocity of a run with the cell's own Tc. With this Tc eq 7-9 gives the measured velocity.
    pub with_cell_memory: CriticalVelocity,
}

/// Compares the twelve cells, in the order of [`TABLE_9_2`].
///
/// Only the velocity command is taken from the parameters that `settings` sets.
///
/// # Errors
/// If a run fails.
///
/// # Examples
///
/// The comparison makes 24 runs, which take some seconds:
///
/// ```no_run
/// use patchcord_thesis::chain::{Settings, table_9_2};
///
/// for row in table_9_2(&Settings::default())? {
///     println!("measured {} m/s, by the run {} m/s", row.measured, row.run.rising?);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn table_9_2(settings: &Settings) -> Result<Vec<MeasurementComparison>, ChainError> {
    let compare = |cell: &Measurement| compare(cell, settings);
    let compared = parallel::with_threads(settings.threads, || parallel::map(&TABLE_9_2, compare, |_| ()));
    compared.into_iter().collect()
}

/// Compares one cell.
fn compare(cell: &Measurement, settings: &Settings) -> Result<MeasurementComparison, ChainError> {
    let parameters = parameters(cell)?;
    let run = |parameters: &Parameters| Simulation::new("", parameters, settings);
    let with_cell_memory = Parameters { memory: cell.memory, ..parameters };
    let simulation = run(&parameters)?;
    Ok(MeasurementComparison {
        cell: *cell,
        parameters,
        measured: cell.critical_velocity()?,
        equation: fitted(&parameters),
        stability: stability(&parameters),
        run: simulation.critical,
        nearby_thresholds: simulation.nearby_thresholds,
        with_cell_memory: run(&with_cell_memory)?.critical,
    })
}

/// The parameters of the circuit for a cell, with the Tc of its oil by eq 17-9.
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
