//! What equations say of the critical velocity.

use super::parameters::Parameters;
use crate::slideway::describing::{Oscillation, end_of_sticking};
use crate::slideway::design::{Design, DesignEquation};
use crate::slideway::{SlidewayError, simulated};

/// A critical velocity by an equation, in m/s, or why there is none.
pub type Prediction = Result<f64, SlidewayError>;

/// What equations say of the critical velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct Predictions {
    /// Eq 93-9 with the constants as printed.
    pub printed: Prediction,
    /// Eq 93-9 with the constants that follow from the equations which it was made of.
    pub derived: Prediction,
    /// Where friction falls by what oscillation ceased at in the study's simulation (eq 7-9): with the Tc of 450 kgf it is eq 18-9, with
    /// that of 850 kgf eq 21-9.
    pub fitted: Prediction,
    /// Where friction falls by what Routh-Hurwitz allows (eq 32-9).
    pub stability: Prediction,
    /// The slope of friction that it allows, in N s/m.
    pub critical_slope: Prediction,
    /// The frequency at which small motions swing there, in rad/s (eq 40-9).
    pub boundary_frequency: Prediction,
    /// By the describing function without Tc: where friction falls by f (eq 90-9).
    pub without_memory: Prediction,
    /// By the describing function with Tc: where the swing just reaches standstill; below, it is stick-slip.
    pub sticking: Result<Oscillation, SlidewayError>,
}

impl Predictions {
    /// Those for a design whose circuit is set by these parameters. Eq 93-9 takes the design, the others the parameters.
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

/// Eq 7-9.
pub(super) fn fitted(parameters: &Parameters) -> Prediction {
    let slope = simulated::slope(parameters.memory, parameters.stiffness)?;
    parameters.friction().velocity_at_slope(slope)
}

/// Eq 32-9 with eq 41-8.
pub(super) fn stability(parameters: &Parameters) -> Prediction {
    parameters.table().critical_velocity(&parameters.friction())
}
