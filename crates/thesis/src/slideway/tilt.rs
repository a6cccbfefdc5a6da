//! Pitch and yaw of a table that is pushed off its middle (4.4, Figs 4.4, 4.5).

use super::units::{KGF, MM};
use super::{Range, SlidewayError};

const STIFFNESS: Range = Range::positive("stiffness of the interface Ks", "N/m");
const LENGTH: Range = Range::positive("length of the table LT", "m");
const CLEARANCE: Range = Range::not_negative("clearance of the gib strip Yc", "m");
const WEIGHT: Range = Range::not_negative("weight W", "N");

/// The factor of eq 2-4 ... 4-4. It assumes that the deflection under the resultant of the pressure, at two thirds of
/// half the length, is on a straight line through the middle.
pub const TILT_FACTOR: f64 = 9.0;
/// The factor for an elastic interface of uniform stiffness, which the text assumes. A moment La FA turns it by
/// La FA / (Ks LT^2 / 12).
pub const UNIFORM_INTERFACE: f64 = 12.0;

/// A table that is pushed off its middle.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::tilt::{Tilt, UNIFORM_INTERFACE};
/// use patchcord_thesis::slideway::units::UM;
///
/// assert!((Tilt::EXAMPLE.pitch()? / UM - 0.75).abs() < 1e-9);
/// let uniform = Tilt { factor: UNIFORM_INTERFACE, ..Tilt::EXAMPLE };
/// assert!((uniform.pitch()? / UM - 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tilt {
    /// Distance of the drive's line from the friction plane (La, pitch) or from the middle (LF, yaw), in m.
    pub offset: f64,
    /// Force of the drive FA, in N.
    pub force: f64,
    /// Stiffness of the interface Ks, in N/m.
    pub stiffness: f64,
    /// Length of the table LT, in m.
    pub length: f64,
    /// [`TILT_FACTOR`] as in the text, or [`UNIFORM_INTERFACE`].
    pub factor: f64,
}

impl Tilt {
    /// The example of the thesis (4.4): 50 kgf, 150 mm off the middle of a table of 450 mm.
    pub const EXAMPLE: Tilt = Tilt {
        offset: 150.0 * MM,
        force: 50.0 * KGF,
        stiffness: 1e5 * KGF / MM,
        length: 450.0 * MM,
        factor: TILT_FACTOR,
    };

    /// Deflection at the edge of the table in m, 9 La FA / (2 Ks LT) (eq 3-4).
    ///
    /// # Errors
    /// If stiffness or length is not above 0.
    pub fn pitch(&self) -> Result<f64, SlidewayError> {
        let (stiffness, length) = (STIFFNESS.check(self.stiffness)?, LENGTH.check(self.length)?);
        Ok(self.factor * self.offset * self.force / (2.0 * stiffness * length))
    }

    /// Angle of pitch in rad, atan(9 La FA / (Ks LT^2)) (eq 2-4).
    ///
    /// # Errors
    /// If stiffness or length is not above 0.
    pub fn pitch_angle(&self) -> Result<f64, SlidewayError> {
        Ok((2.0 * self.pitch()? / self.length).atan())
    }

    /// Sideways deflection at the edge in m, 9 LF FA / (2 Ks LT) + Yc, for a clearance Yc of the gib strip in m (eq
    /// 4-4). Without an offset the deflection is 0, because no force takes up the clearance.
    ///
    /// # Errors
    /// If stiffness or length is not above 0, or the clearance is below 0.
    pub fn yaw(&self, clearance: f64) -> Result<f64, SlidewayError> {
        let (bent, clearance) = (self.pitch()?, CLEARANCE.check(clearance)?);
        Ok(if bent == 0.0 { 0.0 } else { bent + clearance.copysign(bent) })
    }

    /// Angle of yaw in rad, atan(2 dY / LT) (Fig 4.5 (c); eq 5-4 is scanned as dY / (2 LT)).
    ///
    /// # Errors
    /// If stiffness or length is not above 0, or the clearance is below 0.
    pub fn yaw_angle(&self, clearance: f64) -> Result<f64, SlidewayError> {
        Ok((2.0 * self.yaw(clearance)? / self.length).atan())
    }
}

/// The sinking of a table into the interface under its weight, Z0 = W / Ks, in m (Fig 4.5), for N and N/m.
///
/// # Errors
/// If the weight is below 0 or the stiffness not above 0.
pub fn sinking(weight: f64, stiffness: f64) -> Result<f64, SlidewayError> {
    Ok(WEIGHT.check(weight)? / STIFFNESS.check(stiffness)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slideway::units::UM;

    #[test]
    fn example_of_the_text_is_reproduced() {
        assert!((Tilt::EXAMPLE.pitch().unwrap() / UM - 0.75).abs() < 1e-9);
        assert!((Tilt::EXAMPLE.pitch_angle().unwrap() - 3.333e-6).abs() < 1e-9);
        assert!(
            (Tilt { factor: UNIFORM_INTERFACE, ..Tilt::EXAMPLE }.pitch().unwrap() / UM - 1.0).abs() < 1e-9
        );
        assert!((sinking(454.0 * KGF, Tilt::EXAMPLE.stiffness).unwrap() / UM - 4.54).abs() < 1e-9);
    }

    /// The moment of the pressure of a uniform interface about the middle, summed over slices, balances the offset
    /// force.
    #[test]
    fn uniform_interface_has_the_factor_twelve() {
        let even = Tilt { factor: UNIFORM_INTERFACE, ..Tilt::EXAMPLE };
        let (slices, slope) = (2000, 2.0 * even.pitch().unwrap() / even.length);
        let moments = (0..slices).map(|slice| {
            let position = even.length * ((slice as f64 + 0.5) / slices as f64 - 0.5);
            even.stiffness / slices as f64 * slope * position * position
        });
        assert!((moments.sum::<f64>() / (even.offset * even.force) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn only_an_offset_takes_up_the_clearance() {
        let straight = Tilt { offset: 0.0, ..Tilt::EXAMPLE };
        assert_eq!(straight.yaw(0.01 * MM), Ok(0.0));
        assert!((Tilt::EXAMPLE.yaw(0.01 * MM).unwrap() / UM - 10.75).abs() < 1e-9);
        assert!((Tilt { offset: -0.15, ..Tilt::EXAMPLE }.yaw(0.01 * MM).unwrap() / UM + 10.75).abs() < 1e-9);
        assert!((Tilt::EXAMPLE.yaw_angle(0.01 * MM).unwrap() - 4.778e-5).abs() < 1e-8);
        assert!(Tilt::EXAMPLE.yaw(-1.0).is_err());
    }
}
