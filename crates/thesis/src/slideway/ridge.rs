//! One ridge of a ground surface: a low triangle, approximated by an arc in contact.

use super::ellipse::CROSS_ANGLE;
use super::units::UM;
use super::{Range, SlidewayError};

const OVERLAP: Range = Range::new("overlap", "m", 0.0, 1.0);

/// The profile of a ridge (Fig 7.1): a triangle of base width B and height Z.
///
/// # Examples
///
/// ```
/// use patchcord_thesis::slideway::ridge::Ridge;
/// use patchcord_thesis::slideway::units::UM;
///
/// // The ridge of ground cast iron: 50 um wide and 2.5 um high (eq 9-7).
/// assert!((Ridge::GROUND.radius()? / UM - 126.25).abs() < 1e-6);
/// assert!((Ridge::GROUND.climb()? - 0.05).abs() < 1e-12);
///
/// let flat = Ridge { height: 0.0, ..Ridge::GROUND };
/// assert!(flat.radius().is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ridge {
    /// Base width B, in m.
    pub width: f64,
    /// Height Z, in m.
    pub height: f64,
}

impl Ridge {
    /// The ridge of the thesis's ground cast iron: B = 50 um, Z = 2.5 um (7.2).
    pub const GROUND: Ridge = Ridge { width: 50.0 * UM, height: 2.5 * UM };

    /// Permitted widths.
    pub const WIDTHS: Range = Range::new("width of a ridge", "m", 1e-9, 0.1);
    /// Permitted heights.
    pub const HEIGHTS: Range = Range::new("height of a ridge", "m", 1e-9, 0.1);

    /// Radius of the arc through both ends of the base and the crest, in m: R = (4 Z^2 + B^2) / (8 Z), eq 9-7.
    ///
    /// # Errors
    /// If width or height is outside 1e-9 ... 0.1 m.
    pub fn radius(&self) -> Result<f64, SlidewayError> {
        let (width, height) = self.size()?;
        Ok((4.0 * height.powi(2) + width.powi(2)) / (8.0 * height))
    }

    /// Area in m2 that two such wedges share if they overlap by h in m and cross at an angle in radians:
    /// (h B / Z)^2 / (2 sin beta), eq 5-7.
    ///
    /// # Errors
    /// If width or height is out of its range, the overlap is outside 0 ... 1 m, or the angle outside 30 ... 90
    /// degrees.
    pub fn overlap_area(&self, overlap: f64, angle: f64) -> Result<f64, SlidewayError> {
        let (width, height) = self.size()?;
        let diagonal = OVERLAP.check(overlap)? * width / height;
        Ok(diagonal.powi(2) / (2.0 * CROSS_ANGLE.check(angle)?.sin()))
    }

    /// The slope tan(theta) = Z / B that friction climbs, 0.05 for ground iron (eq 47-7).
    ///
    /// The flank itself is twice as steep. The thesis uses the slope of the flank for the speed of approach (eq 104-7).
    ///
    /// # Errors
    /// If width or height is outside 1e-9 ... 0.1 m.
    pub fn climb(&self) -> Result<f64, SlidewayError> {
        self.size().map(|(width, height)| height / width)
    }

    fn size(&self) -> Result<(f64, f64), SlidewayError> {
        Ok((Self::WIDTHS.check(self.width)?, Self::HEIGHTS.check(self.height)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arc_passes_through_crest_and_ends() {
        let radius = Ridge::GROUND.radius().unwrap();
        assert!((radius - 126.25 * UM).abs() < 1e-12);
        let sagitta = radius - (radius.powi(2) - (Ridge::GROUND.width / 2.0).powi(2)).sqrt();
        assert!((sagitta - Ridge::GROUND.height).abs() < 1e-12);
    }

    #[test]
    fn wedges_at_right_angles_meet_in_a_square() {
        // |x| + |y| < h B / (2 Z): half the square of its diagonal.
        let area = Ridge::GROUND.overlap_area(UM, std::f64::consts::FRAC_PI_2).unwrap();
        assert!((area / (UM * UM) - 200.0).abs() < 1e-9);
    }

    #[test]
    fn a_ridge_without_height_has_no_arc() {
        let flat = Ridge { height: 0.0, ..Ridge::GROUND };
        assert!(flat.radius().is_err() && flat.climb().is_err() && flat.overlap_area(UM, 1.0).is_err());
    }
}
