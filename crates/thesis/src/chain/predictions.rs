//! The critical velocity by the equations of the thesis.

use super::parameters::Parameters;
use crate::slideway::describing::{Oscillation, end_of_sticking};
use crate::slideway::design::{Design, DesignEquation};
use crate::slideway::{SlidewayError, simulated};

/// A critical velocity by an equation in m/s, or the reason why there is none.
pub type Prediction = Result<f64, SlidewayError>;

/// The critical velocity by every equation of the thesis.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::chain::{Inputs, Parameters, Predictions};
/// use patchcord_thesis::slideway::units::{KGF, POISE};
///
/// let design = Inputs::of_thesis(0.34 * POISE, 450.0 * KGF, 20e6).design()?;
/// let parameters = Parameters::of_design(&design)?;
/// let predictions = Predictions::new(&design, &parameters);
///
/// // Every critical velocity is below VcL, at which solid friction vanishes.
/// assert!(predictions.fitted? < parameters.limit && predictions.derived? < parameters.limit);
/// assert_eq!(predictions.critical_slope?, parameters.table().critical_slope()?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Predictions {
    /// Eq 93-9 with the constants as printed.
    pub printed: Prediction,
    /// Eq 93-9 with the constants that follow from eq 11-9, 12-9 and 18-9.
    pub derived: Prediction,
    /// By eq 7-9: the slope of friction equals the slope at which oscillation ceased in the thesis's simulation. With
    /// the Tc of 450 kgf this is eq 18-9, with that of 850 kgf eq 21-9.
    pub fitted: Prediction,
    /// By Routh-Hurwitz: the slope of friction equals the critical slope (eq 32-9).
    pub stability: Prediction,
    /// The critical slope of friction by Routh-Hurwitz, in N s/m (eq 32-9).
    pub critical_slope: Prediction,
    /// The frequency of small motions at the critical slope, in rad/s (eq 40-9).
    pub boundary_frequency: Prediction,
    /// By the describing function without Tc: the slope of friction equals f (eq 90-9).
    pub without_memory: Prediction,
    /// By the describing function with Tc: the limit cycle that just reaches standstill. Stick-slip occurs below it.
    pub sticking: Result<Oscillation, SlidewayError>,
}

impl Predictions {
    /// Predictions for a design. Eq 93-9 takes the design; the other equations take the parameters of the circuit.
    pub fn new(design: &Design, parameters: &Parameters) -> Self {
        Predictions {
            printed: DesignEquation::PRINTED.critical_velocity(design),
            derived: DesignEquation::derived().critical_velocity(design),
            fitted: fitted(parameters),
            stability: stability(parameters),
            critical_slope: parameters.table().critical_slope(),
            boundary_frequency: parameters.table().boundary_frequency(),
            without_memory: parameters.friction().velocity_of_least(parameters.damping),
            sticking: end_of_sticking(&parameters.table(), &parameters.friction()),
        }
    }
}

/// The critical velocity by eq 7-9.
pub(super) fn fitted(parameters: &Parameters) -> Prediction {
    let slope = simulated::slope(parameters.memory, parameters.stiffness)?;
    parameters.friction().velocity_at_slope(slope)
}

/// The critical velocity by Routh-Hurwitz: eq 32-9 with eq 41-8.
pub(super) fn stability(parameters: &Parameters) -> Prediction {
    parameters.table().critical_velocity(&parameters.friction())
}
